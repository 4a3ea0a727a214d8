//! Numbers and units as text, and the round numbers at which axes and grids have their ticks.

use crate::picture::Language;

/// Formats `value` with `digits` significant digits, without trailing zeros, as markup for
/// [`crate::picture::text::Line::math`]: `9.81`, `0.0032`, `1.2·10^{-7}`.
pub fn format_significant(value: f64, digits: usize) -> String {
    let digits = digits.max(1) - 1;
    let scientific = format!("{value:.digits$e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    match exponent.parse::<i32>() {
        Ok(exponent @ -3..=5) => {
            let decimals = (digits as i32 - exponent).max(0) as usize;
            with_minus(&trim_zeros(&format!("{value:.decimals$}")))
        }
        Ok(exponent) => with_minus(&format!("{}·10^{{{exponent}}}", trim_zeros(mantissa))),
        Err(_) => scientific,
    }
}

/// Replaces hyphens by minus signs.
fn with_minus(number: &str) -> String {
    number.replace('-', "−")
}

/// Removes trailing zeros after the decimal point, and the sign of zero.
fn trim_zeros(decimal: &str) -> String {
    let kept = if decimal.contains('.') { decimal.trim_end_matches('0').trim_end_matches('.') } else { decimal };
    if kept == "-0" { "0".to_owned() } else { kept.to_owned() }
}

/// The smallest number of the form 1, 2 or 5 × 10ⁿ that is at least `min`; infinite if there is none.
///
/// Found by multiplying and dividing by 10, because the logarithms of the standard library differ between platforms.
pub fn nice_spacing(min: f64) -> f64 {
    if min.is_nan() || min > 1e308 {
        return f64::INFINITY;
    }
    let mut power = 1.0;
    while power < min {
        power *= 10.0;
    }
    while power / 10.0 >= min && power > f64::MIN_POSITIVE {
        power /= 10.0;
    }
    [power / 5.0, power / 2.0].into_iter().find(|&candidate| candidate >= min).unwrap_or(power)
}

/// The largest number of the form 1, 2 or 5 × 10ⁿ that is at most `max`, which is positive and finite.
pub fn nice_below(max: f64) -> f64 {
    let above = nice_spacing(max);
    // Candidates around it, because dividing rounds.
    [above, above / 2.0, above / 2.5, above / 5.0].into_iter().find(|&nice| nice <= max && is_nice(nice)).unwrap_or(max)
}

/// Returns true for numbers of the form 1, 2 or 5 × 10ⁿ.
fn is_nice(number: f64) -> bool {
    nice_spacing(number * (1.0 - 1e-9)) <= number * (1.0 + 1e-9)
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

/// The exponential function, bit-identical on every platform because it uses only + − × and ÷: the series of
/// exp(x/1024) to the 14th power of x, squared ten times. Accurate to about twelve digits; 0 below −700.
pub fn exp(value: f64) -> f64 {
    if value < -700.0 {
        return 0.0;
    }
    let part = value / 1024.0;
    let series = (1..=14).rev().fold(1.0, |sum, order| 1.0 + part / f64::from(order) * sum);
    (0..10).fold(series, |power, _| power * power)
}

/// Formats a multiple of `spacing` with as many decimals as the spacing has, at most 12.
pub fn tick_label(value: f64, spacing: f64) -> String {
    let mut decimals = 0;
    let mut unit = 1.0;
    while spacing < unit * (1.0 - 1e-9) && decimals < 12 {
        unit /= 10.0;
        decimals += 1;
    }
    with_minus(&format!("{value:.decimals$}"))
}

/// A unit of measurement, with the prefixes that are usual for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    symbol: &'static str,
    /// The powers of ten of its smallest and largest prefix, multiples of 3.
    prefixes: [i32; 2],
}

impl Unit {
    /// Time.
    pub const SECOND: Unit = Unit { symbol: "s", prefixes: [-18, 0] };
    /// Length.
    pub const METRE: Unit = Unit { symbol: "m", prefixes: [-18, 3] };
    /// Speed.
    pub const METRE_PER_SECOND: Unit = Unit { symbol: "m/s", prefixes: [-18, 3] };
    /// Energy.
    pub const JOULE: Unit = Unit { symbol: "J", prefixes: [-18, 18] };
    /// Force.
    pub const NEWTON: Unit = Unit { symbol: "N", prefixes: [-18, 18] };
    /// Impulse.
    pub const NEWTON_SECOND: Unit = Unit { symbol: "N·s", prefixes: [-18, 18] };
    /// Mass.
    pub const KILOGRAM: Unit = Unit { symbol: "kg", prefixes: [0, 0] };
    /// Pressure in two dimensions: force per length.
    pub const NEWTON_PER_METRE: Unit = Unit { symbol: "N/m", prefixes: [-18, 18] };
    /// Volume in two dimensions.
    pub const SQUARE_METRE: Unit = Unit { symbol: "m²", prefixes: [0, 0] };
    /// Probability density of a speed.
    pub const SECOND_PER_METRE: Unit = Unit { symbol: "s/m", prefixes: [0, 0] };
    /// Velocity weighted by the square root of a mass.
    pub const ROOT_JOULE: Unit = Unit { symbol: "√J", prefixes: [0, 0] };
    /// Momentum.
    pub const MOMENTUM: Unit = Unit { symbol: "kg·m/s", prefixes: [0, 0] };

    /// The unit with the prefix for quantities of this size: none from 0.01 to 100 000.
    pub fn for_size(self, size: f64) -> ScaledUnit {
        let mut exponent = 0;
        if size.is_finite() && size > 0.0 && !(0.01..1e5).contains(&size) {
            let scaled_by = |exponent| ScaledUnit { unit: self, exponent }.scaled(size);
            while scaled_by(exponent) < 1.0 && exponent > self.prefixes[0] {
                exponent -= 3;
            }
            while scaled_by(exponent) >= 1000.0 && exponent < self.prefixes[1] {
                exponent += 3;
            }
        }
        ScaledUnit { unit: self, exponent }
    }

    /// Formats a quantity with `digits` significant digits and its unit, as markup for
    /// [`crate::picture::text::Line::math`]: `9.81 "m/s"`, `20 "µm"`.
    pub fn format(self, value: f64, digits: usize) -> String {
        let unit = self.for_size(value.abs());
        format!("{} \"{unit}\"", format_significant(unit.scaled(value), digits))
    }
}

/// A unit with a prefix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledUnit {
    unit: Unit,
    /// The power of ten of the prefix, a multiple of 3.
    exponent: i32,
}

impl ScaledUnit {
    /// The number of these units in a quantity in SI units.
    pub fn scaled(self, value: f64) -> f64 {
        let power = (0..self.exponent.unsigned_abs() / 3).fold(1.0, |power, _| power * 1000.0);
        if self.exponent < 0 { value * power } else { value / power }
    }
}

impl std::fmt::Display for ScaledUnit {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        let prefixes = ["a", "f", "p", "n", "µ", "m", "", "k", "M", "G", "T", "P", "E"];
        write!(out, "{}{}", prefixes[(self.exponent / 3 + 6) as usize], self.unit.symbol)
    }
}

/// The format of simulated times: the unit suits the whole run, the decimals suit the time between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeFormat {
    unit: ScaledUnit,
    decimals: usize,
    language: Language,
}

impl TimeFormat {
    /// The format of times up to `duration` with differences of `interval`, both s.
    pub fn new(interval: f64, duration: f64, language: Language) -> TimeFormat {
        let unit = Unit::SECOND.for_size(duration);
        let (mut decimals, mut place) = (0, 1.0);
        while unit.scaled(interval) < place * (1.0 - 1e-9) && decimals < 9 {
            (decimals, place) = (decimals + 1, place / 10.0);
        }
        TimeFormat { unit, decimals, language }
    }

    /// The format with `more` additional decimals.
    pub fn finer(self, more: usize) -> TimeFormat {
        TimeFormat { decimals: self.decimals + more, ..self }
    }

    /// The time without its unit.
    pub fn number(self, time: f64) -> String {
        self.language.decimal(with_minus(&format!("{:.*}", self.decimals, self.unit.scaled(time))))
    }

    /// The unit.
    pub fn unit(self) -> ScaledUnit {
        self.unit
    }
}

impl Default for TimeFormat {
    /// The format for the default rate, 60 Hz, in English.
    fn default() -> TimeFormat {
        TimeFormat::new(1.0 / 60.0, 1.0, Language::English)
    }
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
            ["9.81", "0.00321", "123456", "1.23·10^{6}", "1.25·10^{−7}", "0", "0", "−2", "1·10^{300}", "0.3"];
        assert_eq!(written, expected);
        assert_eq!(format_significant(f64::NAN, 3), "NaN");
    }

    #[test]
    fn round_numbers_below_a_number_are_the_largest_ones() {
        let below: Vec<f64> = [1.0, 1.99, 2.0, 4.9, 5.0, 9.99, 10.0, 0.3].map(nice_below).into();
        assert_eq!(below, [1.0, 1.0, 2.0, 2.0, 5.0, 5.0, 10.0, 0.2]);
        for max in [3e-9, 7.7e12, 1e300, 2.5e-300] {
            assert!(nice_below(max) <= max && nice_below(max) > max / 2.6, "{max}");
        }
    }

    #[test]
    fn units_have_a_prefix_if_their_number_would_have_many_digits() {
        let lengths: Vec<String> =
            [0.0, 1.6e-5, 2e-6, 0.0099, 0.01, 4.25, 99_999.0, 123_456.0, 1e7, -3e-9, 1e-30, f64::INFINITY]
                .map(|length| Unit::METRE.format(length, 3).replace('"', ""))
                .into();
        let expected = [
            "0 m",
            "16 µm",
            "2 µm",
            "9.9 mm",
            "0.01 m",
            "4.25 m",
            "99999 m",
            "123 km",
            "10000 km",
            "−3 nm",
            "1·10^{−12} am",
            "inf m",
        ];
        assert_eq!(lengths, expected);
        assert_eq!(Unit::SECOND.format(86_400.0, 6), "86400 \"s\"");
        assert_eq!(Unit::JOULE.format(7.5e12, 3), "7.5 \"TJ\"");
    }

    #[test]
    fn times_have_the_decimals_of_a_step() {
        let text = |rate: f64, duration: f64, time: f64| {
            let format = TimeFormat::new(1.0 / rate, duration, Language::English);
            format!("{} {}", format.number(time), format.unit())
        };
        assert_eq!(text(60.0, 10.0, 1.25), "1.25 s");
        assert_eq!(text(5.0, 10.0, 1.2), "1.2 s");
        assert_eq!(text(1.0, 86_400.0, 86_399.0), "86399 s");
        assert_eq!(text(1000.0, 2.0, 0.5), "0.500 s");
        assert_eq!(text(1e6, 3e-4, 1.2e-5), "12 µs");
        assert_eq!(text(1e7, 3e-4, -1.25e-5), "−12.5 µs");
    }

    #[test]
    #[expect(clippy::disallowed_methods, reason = "the comparison has a tolerance")]
    fn exponentials_are_accurate_to_ten_digits() {
        for value in [-699.0, -300.5, -20.0, -1.0, -1e-3, 0.0, 0.5, 3.0] {
            let (found, exact) = (exp(value), f64::exp(value));
            assert!((found - exact).abs() <= 1e-10 * exact, "{value}: {found:e} {exact:e}");
        }
        assert_eq!([exp(-1e300), exp(f64::NEG_INFINITY)], [0.0; 2]);
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
