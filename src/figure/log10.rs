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

#[cfg(test)]
mod tests {
    use super::log10;

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
