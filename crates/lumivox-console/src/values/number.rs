//! Numbers and lists of numbers.

use std::fmt;
use std::ops::{Range, RangeInclusive};
use std::str::FromStr;

use super::Refused;

/// A type that options and commands read as one number.
pub trait Number: FromStr + PartialOrd + Copy + fmt::Display + fmt::LowerExp + Into<f64> {
    /// Whether the type has no fraction.
    const IS_WHOLE: bool;
}

impl Number for f32 {
    const IS_WHOLE: bool = false;
}

impl Number for f64 {
    const IS_WHOLE: bool = false;
}

impl Number for u32 {
    const IS_WHOLE: bool = true;
}

/// Reads a number within `range`.
pub fn read<T: Number>(text: &str, range: &RangeInclusive<T>) -> Result<T, Refused> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| refusal(is_written::<T>(text), format!("expected {}", in_words(range))))
}

/// `a number from 0 to 1`.
pub fn in_words<T: Number>(range: &RangeInclusive<T>) -> String {
    let name = if T::IS_WHOLE { "a whole number" } else { "a number" };
    // Very small and very large numbers are written with an exponent.
    let end = |number: T| match number.into().abs() {
        size if T::IS_WHOLE || size == 0.0 || (1e-4..1e7).contains(&size) => number.to_string(),
        _ => format!("{number:e}"),
    };
    format!("{name} from {} to {}", end(*range.start()), end(*range.end()))
}

/// Whether the text is a number of this type, in range or not.
fn is_written<T: Number>(text: &str) -> bool {
    if !T::IS_WHOLE {
        return text.parse::<f64>().is_ok();
    }
    let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
    !unsigned.is_empty() && unsigned.bytes().all(|byte| byte.is_ascii_digit())
}

fn refusal(has_form: bool, reason: String) -> Refused {
    if has_form { Refused::OutOfRange(reason) } else { Refused::Malformed(reason) }
}

/// A parser of finite numbers within `range`.
pub fn number(
    range: RangeInclusive<f32>,
) -> impl Fn(&str) -> Result<f32, Refused> + Clone + Send + Sync + 'static {
    move |text| read(text.trim(), &range)
}

/// A parser of whole numbers within `range`.
pub fn whole(
    range: RangeInclusive<u32>,
) -> impl Fn(&str) -> Result<u32, Refused> + Clone + Send + Sync + 'static {
    move |text| read(text.trim(), &range)
}

/// A parser of ranges of whole numbers, `A..B`: from A to before B, which is at most `most`.
pub fn range(
    most: u32,
) -> impl Fn(&str) -> Result<Range<u32>, Refused> + Clone + Send + Sync + 'static {
    move |text| {
        let form = || Refused::Malformed("expected two whole numbers, A..B".to_owned());
        let (first, end) = text.split_once("..").ok_or_else(form)?;
        let read = |text: &str| text.trim().parse::<i128>().map_err(|_| form());
        let (first, end) = (read(first)?, read(end)?);
        if 0 <= first && first < end && end <= i128::from(most) {
            return Ok(first as u32..end as u32);
        }
        Err(Refused::OutOfRange(format!(
            "expected A..B with A from 0, and B above A and at most {most}"
        )))
    }
}

/// The resolution of the voxel grid: a multiple of 8 within the library's range.
pub fn resolution(text: &str) -> Result<u32, Refused> {
    let (low, high) = (lumivox::MIN_RESOLUTION, lumivox::MAX_RESOLUTION);
    let text = text.trim();
    let fits = |n: &u32| (low..=high).contains(n) && n.is_multiple_of(8);
    let resolution = text.parse().ok().filter(fits);
    let reason = || format!("expected a multiple of 8 from {low} to {high}");
    resolution.ok_or_else(|| refusal(is_written::<u32>(text), reason()))
}

/// Three angles in degrees, each from -360 to 360.
pub fn angles(text: &str) -> Result<glam::Vec3, Refused> {
    let angles = list::<3>(text, "X,Y,Z in degrees, such as 0,30,0")?;
    for angle in angles {
        in_range(angle, &(-360.0..=360.0), "each angle")?;
    }
    Ok(angles.into())
}

/// One finite number.
pub fn one(text: &str) -> Result<f32, Refused> {
    let value: f32 = text
        .trim()
        .parse()
        .map_err(|_| Refused::Malformed("expected a number, such as 0.5".to_owned()))?;
    if value.is_finite() {
        return Ok(value);
    }
    Err(Refused::OutOfRange("the number must be finite".to_owned()))
}

/// Exactly `N` finite numbers between commas; `form` describes them, with an example.
pub fn list<const N: usize>(text: &str, form: &str) -> Result<[f32; N], Refused> {
    let values = some(text, form)?;
    values.try_into().map_err(|values: Vec<f32>| {
        Refused::Malformed(format!("expected {form}; got {} numbers", values.len()))
    })
}

/// Any number of finite numbers between commas.
pub fn some(text: &str, form: &str) -> Result<Vec<f32>, Refused> {
    text.split(',')
        .map(|part| {
            one(part).map_err(|refused| match refused {
                Refused::Malformed(_) => {
                    Refused::Malformed(format!("expected {form}, but \"{part}\" is not a number"))
                }
                Refused::OutOfRange(_) => {
                    Refused::OutOfRange(format!("\"{part}\" is not a finite number"))
                }
            })
        })
        .collect()
}

/// Returns `value` if it is in `range`; otherwise an error that begins with `name`.
pub fn in_range(value: f32, range: &RangeInclusive<f32>, name: &str) -> Result<f32, Refused> {
    if range.contains(&value) {
        return Ok(value);
    }
    Err(Refused::OutOfRange(format!("{name} is {}", in_words(range))))
}

#[cfg(test)]
mod tests {
    use std::fmt;

    use super::*;

    fn is_out_of_range<T: fmt::Debug>(result: Result<T, Refused>, needle: &str) {
        match result {
            Err(Refused::OutOfRange(reason)) => assert!(reason.contains(needle), "{reason}"),
            other => panic!("expected an error of range, got {other:?}"),
        }
    }

    fn is_malformed<T: fmt::Debug>(result: &Result<T, Refused>) {
        assert!(matches!(result, Err(Refused::Malformed(_))), "{result:?}");
    }

    #[test]
    fn numbers_have_a_range() {
        let share = number(0.05..=1.0);
        assert_eq!(share("0.05"), Ok(0.05));
        assert_eq!(share(" 1 "), Ok(1.0));
        is_out_of_range(share("1.01"), "from 0.05 to 1");
        is_out_of_range(share("-1"), "from 0.05 to 1");
        for text in ["nan", "inf", "-inf", "1e400", "NaN"] {
            is_out_of_range(share(text), "from 0.05 to 1");
        }
        for text in ["", "a", "0,5", "1 2", "0x10"] {
            is_malformed(&share(text));
        }
    }

    #[test]
    fn whole_numbers_have_a_range() {
        let frames = whole(1..=65_536);
        assert_eq!(frames("65536"), Ok(65_536));
        for text in ["0", "-3", "65537", "4294967297", "99999999999999999999999999999999999999999"]
        {
            is_out_of_range(frames(text), "from 1 to 65536");
        }
        for text in ["", "-", "1.5", "ten", "1e3"] {
            is_malformed(&frames(text));
        }
    }

    #[test]
    fn ranges_must_rise_and_stay_in_bounds() {
        let batches = range(1 << 20);
        assert_eq!(batches("0..4"), Ok(0..4));
        assert_eq!(batches("16 .. 1048576"), Ok(16..1_048_576));
        for text in ["4..4", "5..4", "-1..4", "0..1048577", "0..99999999999999999999"] {
            is_out_of_range(batches(text), "at most 1048576");
        }
        for text in ["4", "a..b", "0...4", "..4", "0..", "1.5..2"] {
            is_malformed(&batches(text));
        }
    }

    #[test]
    fn accepted_resolutions_match_those_of_the_grid() {
        assert_eq!(resolution("16"), Ok(16));
        assert_eq!(resolution("1024"), Ok(1024));
        for text in ["7", "0", "100000", "130", "1032", "-128"] {
            is_out_of_range(resolution(text), "a multiple of 8 from 16 to 1024");
        }
        is_malformed(&resolution("128.0"));
        for text in ["16", "1024", "7", "130"] {
            let fits = lumivox::Grid::fit(
                glam::Vec3::ZERO,
                glam::Vec3::ONE,
                text.parse().unwrap(),
                glam::Vec3::ZERO,
            );
            assert_eq!(fits.is_ok(), resolution(text).is_ok(), "{text}");
        }
    }

    #[test]
    fn rotation_takes_three_angles_within_360_degrees() {
        assert_eq!(angles("-30,0,360"), Ok(glam::Vec3::new(-30.0, 0.0, 360.0)));
        is_out_of_range(angles("0,361,0"), "from -360 to 360");
        is_malformed(&angles("30"));
    }
}
