/// A number with so many significant digits, as markup for [`crate::render::text::Line::math`]:
/// `9.81`, `0.0032`, `1.2·10^{-7}`.
pub fn significant(value: f64, digits: usize) -> String {
    let digits = digits.max(1) - 1;
    let scientific = format!("{value:.digits$e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    match exponent.parse::<i32>() {
        Ok(exponent @ -3..=5) => {
            let decimals = (digits as i32 - exponent).max(0) as usize;
            trimmed(&format!("{value:.decimals$}"))
        }
        Ok(exponent) => format!("{}·10^{{{exponent}}}", trimmed(mantissa)),
        Err(_) => scientific,
    }
}

/// Without zeros at the end that say nothing.
fn trimmed(decimal: &str) -> String {
    let kept = if decimal.contains('.') { decimal.trim_end_matches('0').trim_end_matches('.') } else { decimal };
    if kept == "-0" { "0".to_owned() } else { kept.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn writes_numbers_as_people_do() {
        let written: Vec<String> = [9.8125, 0.00321, 123456.0, 1234567.0, 1.25e-7, 0.0, -0.0, -2.0, 1e300, 0.1 + 0.2]
            .iter()
            .map(|&value| significant(value, 3))
            .collect();
        let expected =
            ["9.81", "0.00321", "123456", "1.23·10^{6}", "1.25·10^{-7}", "0", "0", "-2", "1·10^{300}", "0.3"];
        assert_eq!(written, expected);
        assert_eq!(significant(f64::NAN, 3), "NaN");
    }
}
