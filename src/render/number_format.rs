/// Formats `value` with `digits` significant digits, without trailing zeros, as markup for
/// [`crate::render::text::Line::math`]: `9.81`, `0.0032`, `1.2·10^{-7}`.
pub fn format_significant(value: f64, digits: usize) -> String {
    let digits = digits.max(1) - 1;
    let scientific = format!("{value:.digits$e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    match exponent.parse::<i32>() {
        Ok(exponent @ -3..=5) => {
            let decimals = (digits as i32 - exponent).max(0) as usize;
            trim_zeros(&format!("{value:.decimals$}"))
        }
        Ok(exponent) => format!("{}·10^{{{exponent}}}", trim_zeros(mantissa)),
        Err(_) => scientific,
    }
}

/// Removes trailing zeros after the decimal point, and the sign of zero.
fn trim_zeros(decimal: &str) -> String {
    let kept = if decimal.contains('.') { decimal.trim_end_matches('0').trim_end_matches('.') } else { decimal };
    if kept == "-0" { "0".to_owned() } else { kept.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::format_significant;

    #[test]
    fn small_and_large_numbers_have_a_power_of_ten() {
        let written: Vec<String> = [9.8125, 0.00321, 123456.0, 1234567.0, 1.25e-7, 0.0, -0.0, -2.0, 1e300, 0.1 + 0.2]
            .iter()
            .map(|&value| format_significant(value, 3))
            .collect();
        let expected =
            ["9.81", "0.00321", "123456", "1.23·10^{6}", "1.25·10^{-7}", "0", "0", "-2", "1·10^{300}", "0.3"];
        assert_eq!(written, expected);
        assert_eq!(format_significant(f64::NAN, 3), "NaN");
    }
}
