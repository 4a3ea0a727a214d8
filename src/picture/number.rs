//! Numbers as text, and the round numbers at which axes and grids have their ticks.

/// Formats `value` with `digits` significant digits, without trailing zeros, as markup for
/// [`crate::picture::text::Line::math`]: `9.81`, `0.0032`, `1.2·10^{-7}`.
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

/// The smallest number of the form 1, 2 or 5 × 10ⁿ that is at least `min`.
///
/// Found by multiplying and dividing by 10, because the logarithms of the standard library differ between platforms.
pub fn nice_spacing(min: f64) -> f64 {
    let mut power = 1.0;
    while power < min {
        power *= 10.0;
    }
    while power / 10.0 >= min && power > f64::MIN_POSITIVE {
        power /= 10.0;
    }
    [power / 5.0, power / 2.0].into_iter().find(|&candidate| candidate >= min).unwrap_or(power)
}

/// The multiples of `spacing` from `low` to `high` in ascending order, both ends included. A multiple outside counts as
/// inside if its distance to the end is at most `tolerance` spacings.
pub fn multiples_within([low, high]: [f64; 2], spacing: f64, tolerance: f64) -> impl Iterator<Item = f64> {
    let (first, last) = ((low / spacing - tolerance).ceil(), (high / spacing + tolerance).floor());
    let count = if last >= first { ((last - first) as u64).saturating_add(1) } else { 0 };
    // Adding 0 turns −0 into 0.
    (0..count).map(move |index| (first + index as f64) * spacing + 0.0)
}

/// The decimal logarithm of a number, bit-identical on every platform because it uses only + − × ÷ and √.
///
/// Powers of ten are factored out; then three square roots bring the mantissa near 1, where ln m = 2·(y + y³/3 + y⁵/5 +
/// …) with y = (m − 1)/(m + 1). The result is accurate to about twelve digits, far more than a diagram shows. Returns
/// −∞ for zero, and NaN for negative numbers, infinity and NaN.
pub fn log10(value: f64) -> f64 {
    if value == 0.0 {
        return f64::NEG_INFINITY;
    }
    if !(value > 0.0 && value.is_finite()) {
        return f64::NAN;
    }
    let (mut mantissa, mut exponent) = (value, 0.0);
    while mantissa >= 10.0 {
        (mantissa, exponent) = (mantissa / 10.0, exponent + 1.0);
    }
    while mantissa < 1.0 {
        (mantissa, exponent) = (mantissa * 10.0, exponent - 1.0);
    }
    let root = mantissa.sqrt().sqrt().sqrt();
    let y = (root - 1.0) / (root + 1.0);
    let square = y * y;
    let series = [11.0, 9.0, 7.0, 5.0, 3.0, 1.0].into_iter().fold(0.0, |sum, odd| sum * square + 1.0 / odd);
    exponent + 16.0 * y * series / std::f64::consts::LN_10
}

/// Formats a multiple of `spacing` with as many decimals as the spacing has, at most 12.
pub fn tick_label(value: f64, spacing: f64) -> String {
    let mut decimals = 0;
    let mut unit = 1.0;
    while spacing < unit * (1.0 - 1e-9) && decimals < 12 {
        unit /= 10.0;
        decimals += 1;
    }
    format!("{value:.decimals$}")
}

/// A page coordinate or length rounded to 1/100 px, displayed without trailing zeros.
pub struct Hundredths(pub f64);

impl std::fmt::Display for Hundredths {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        // Adding 0 turns −0 into 0.
        write!(out, "{}", (self.0 * 100.0).round() / 100.0 + 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn very_small_and_very_large_numbers_have_a_power_of_ten() {
        let written: Vec<String> = [9.8125, 0.00321, 123456.0, 1234567.0, 1.25e-7, 0.0, -0.0, -2.0, 1e300, 0.1 + 0.2]
            .iter()
            .map(|&value| format_significant(value, 3))
            .collect();
        let expected =
            ["9.81", "0.00321", "123456", "1.23·10^{6}", "1.25·10^{-7}", "0", "0", "-2", "1·10^{300}", "0.3"];
        assert_eq!(written, expected);
        assert_eq!(format_significant(f64::NAN, 3), "NaN");
    }

    #[test]
    fn logarithms_are_accurate_to_eleven_decimals() {
        for (value, expected) in
            [(1.0, 0.0), (10.0, 1.0), (1e-17, -17.0), (2.0, std::f64::consts::LOG10_2), (9.99, 0.999_565_488_225_98)]
        {
            assert!((log10(value) - expected).abs() < 1e-11, "{value}: {}", log10(value));
        }
        assert!(log10(5e-324) < -323.0 && log10(f64::MAX) > 308.0);
        assert_eq!(log10(0.0), f64::NEG_INFINITY);
        assert!(log10(-1.0).is_nan() && log10(f64::INFINITY).is_nan());
    }
}
