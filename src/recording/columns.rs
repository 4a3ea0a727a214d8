//! How the solver's numbers stand in a keyframe.

/// The first format in which they stand by columns.
const SINCE: u32 = 2;

/// Numbers that come body by body as a keyframe of that format has them: where each body has as
/// many, by columns, all first numbers before all second ones, since like numbers compress better.
pub fn by_columns(numbers: &[f64], bodies: usize, format: u32) -> Vec<f64> {
    match format < SINCE || bodies == 0 || !numbers.len().is_multiple_of(bodies) {
        true => numbers.into(),
        false => transposed(numbers, numbers.len() / bodies),
    }
}

/// The numbers of [`by_columns`] body by body again.
pub fn by_bodies(numbers: Vec<f64>, bodies: usize, format: u32) -> Vec<f64> {
    match format < SINCE || bodies == 0 || !numbers.len().is_multiple_of(bodies) {
        true => numbers,
        false => transposed(&numbers, bodies),
    }
}

/// Rows of that width made into columns.
fn transposed(numbers: &[f64], width: usize) -> Vec<f64> {
    (0..width).flat_map(|column| numbers.iter().skip(column).step_by(width)).copied().collect()
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::*;

    #[test]
    fn like_numbers_of_different_bodies_stand_together() {
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(by_columns(&rows, 2, SINCE), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
        assert_eq!(by_columns(&rows, 4, SINCE), rows, "six numbers are not of four bodies");
        assert_eq!(by_columns(&rows, 2, 1), rows, "the first format had no columns");
        assert!(by_columns(&[], 2, SINCE).is_empty());
    }

    proptest! {
        #[test]
        fn they_come_back(bodies in 0_usize..9, numbers in vec(-1.0..1.0, 0..40), format in 1_u32..3) {
            let columns = by_columns(&numbers, bodies, format);
            prop_assert_eq!(by_bodies(columns, bodies, format), numbers);
        }
    }
}
