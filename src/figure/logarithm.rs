/// The logarithm of a positive number to base 10, the same bits everywhere: only + − × ÷ and √.
///
/// Powers of ten are taken out, then three square roots bring the rest near 1, where
/// ln m = 2·(y + y³/3 + y⁵/5 + …) with y = (m − 1)/(m + 1). Good to about twelve digits, which
/// is far more than a diagram shows. Zero gives −∞, what is negative or none is none.
pub fn logarithm(value: f64) -> f64 {
    if value == 0.0 {
        return f64::NEG_INFINITY;
    }
    if !(value > 0.0 && value.is_finite()) {
        return f64::NAN;
    }
    let (mut digit, mut tens) = (value, 0.0);
    while digit >= 10.0 {
        (digit, tens) = (digit / 10.0, tens + 1.0);
    }
    while digit < 1.0 {
        (digit, tens) = (digit * 10.0, tens - 1.0);
    }
    let root = digit.sqrt().sqrt().sqrt();
    let y = (root - 1.0) / (root + 1.0);
    let square = y * y;
    let series = [11.0, 9.0, 7.0, 5.0, 3.0, 1.0].into_iter().fold(0.0, |sum, odd| sum * square + 1.0 / odd);
    tens + 16.0 * y * series / std::f64::consts::LN_10
}

#[cfg(test)]
mod tests {
    use super::logarithm;

    #[test]
    fn knows_logarithms() {
        for (value, expected) in
            [(1.0, 0.0), (10.0, 1.0), (1e-17, -17.0), (2.0, std::f64::consts::LOG10_2), (9.99, 0.999_565_488_225_98)]
        {
            assert!((logarithm(value) - expected).abs() < 1e-11, "{value}: {}", logarithm(value));
        }
        assert!(logarithm(5e-324) < -323.0 && logarithm(f64::MAX) > 308.0);
        assert_eq!(logarithm(0.0), f64::NEG_INFINITY);
        assert!(logarithm(-1.0).is_nan() && logarithm(f64::INFINITY).is_nan());
    }
}
