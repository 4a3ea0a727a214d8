//! The order of the solver's numbers in a keyframe.

/// The first format version that stores the solver's numbers by columns.
const FIRST_FORMAT: u32 = 2;

/// Transposes per-body rows into columns (format ≥ 2), which compress better.
///
/// Returns `numbers` unchanged if they cannot be divided evenly among the bodies.
pub fn to_columns(numbers: &[f64], bodies: usize, format: u32) -> Vec<f64> {
    match format < FIRST_FORMAT || bodies == 0 || !numbers.len().is_multiple_of(bodies) {
        true => numbers.into(),
        false => transposed(numbers, numbers.len() / bodies),
    }
}

/// Inverts [`to_columns`].
pub fn from_columns(numbers: Vec<f64>, bodies: usize, format: u32) -> Vec<f64> {
    match format < FIRST_FORMAT || bodies == 0 || !numbers.len().is_multiple_of(bodies) {
        true => numbers,
        false => transposed(&numbers, bodies),
    }
}

/// Transposes a matrix with rows of length `width`.
fn transposed(numbers: &[f64], width: usize) -> Vec<f64> {
    (0..width).flat_map(|column| numbers.iter().skip(column).step_by(width)).copied().collect()
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::*;

    #[test]
    fn rows_are_transposed_into_columns() {
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(to_columns(&rows, 2, FIRST_FORMAT), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
        assert_eq!(to_columns(&rows, 4, FIRST_FORMAT), rows, "six numbers cannot be divided among four bodies");
        assert_eq!(to_columns(&rows, 2, 1), rows, "the first format had no columns");
        assert!(to_columns(&[], 2, FIRST_FORMAT).is_empty());
    }

    proptest! {
        #[test]
        fn from_columns_inverts_to_columns(bodies in 0_usize..9, numbers in vec(-1.0..1.0, 0..40), format in 1_u32..3) {
            let columns = to_columns(&numbers, bodies, format);
            prop_assert_eq!(from_columns(columns, bodies, format), numbers);
        }
    }
}
