//! The times at which pictures are taken.

use std::ops::Range;

use lumivox_console::Failure;

use crate::args::Refused;

use super::LATEST_S;

const FORM: &str =
    "seconds, such as 1.5, or a range START..END, such as 0..4 (0.. ends with the motion)";

/// The most pictures of a sequence.
pub const MOST_PICTURES: u32 = 1_000_000;

/// A time on the command line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeChoice {
    /// One time, s.
    At(f64),
    /// From the first number to just before the second, s; `None` is the end of the motion.
    Range(f64, Option<f64>),
}

/// Parses `SECONDS`, `START..END` or `START..`.
pub fn time(text: &str) -> Result<TimeChoice, Refused> {
    let seconds = |text: &str| {
        let value: f64 = text.trim().parse().map_err(|_| {
            Refused::Malformed(format!("expected {FORM}, but \"{text}\" is not a number"))
        })?;
        // This comparison also rejects NaN.
        if value.abs() <= LATEST_S {
            return Ok(value);
        }
        Err(Refused::OutOfRange(format!("times must be from -{LATEST_S} to {LATEST_S} seconds")))
    };
    let Some((start, end)) = text.split_once("..") else {
        return seconds(text).map(TimeChoice::At);
    };
    let start = seconds(start)?;
    if end.trim().is_empty() {
        return Ok(TimeChoice::Range(start, None));
    }
    let end = seconds(end)?;
    if end <= start {
        return Err(Refused::OutOfRange("the range must end after it starts".to_owned()));
    }
    Ok(TimeChoice::Range(start, Some(end)))
}

/// Evenly spaced times. The start is included and the end is not, so that a motion that ends as it
/// began can loop without a picture shown twice.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// The first time and the end, s.
    pub range_s: Range<f64>,
    /// Times per second.
    pub fps: f64,
    /// The number of times, at least one.
    pub count: u32,
}

impl Moments {
    /// Divides a range into times.
    ///
    /// # Errors
    /// A [`Failure`] of input when it is empty, or would take more than a million pictures.
    pub fn new(range_s: Range<f64>, fps: f64) -> anyhow::Result<Self> {
        let Range { start, end } = range_s;
        if end <= start {
            return Err(Failure::input(format!(
                "the range of time is empty: the motion ends at {end} s, before {start} s; \
                 give --time START..END"
            ))
            .into());
        }
        // The tolerance prevents an extra picture by rounding errors.
        let count = ((end - start) * fps - 1e-6).ceil().max(1.0);
        if count > f64::from(MOST_PICTURES) {
            return Err(Failure::input(format!(
                "{count} pictures from {start} to {end} s at {fps} a second are more than \
                 {MOST_PICTURES}; shorten the range or lower --fps"
            ))
            .into());
        }
        Ok(Self { range_s, fps, count: count as u32 })
    }

    /// The time of picture `number`, s.
    pub fn time_s(&self, number: u32) -> f64 {
        self.range_s.start + f64::from(number) / self.fps
    }

    /// The share of the range that has passed at picture `number`, from 0 to below 1.
    pub fn share(&self, number: u32) -> f64 {
        (self.time_s(number) - self.range_s.start) / (self.range_s.end - self.range_s.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_moments_or_ranges() {
        assert_eq!(time("1.5"), Ok(TimeChoice::At(1.5)));
        assert_eq!(time("-2"), Ok(TimeChoice::At(-2.0)));
        assert_eq!(time("0..4"), Ok(TimeChoice::Range(0.0, Some(4.0))));
        assert_eq!(time(" -1.5 .. .5 "), Ok(TimeChoice::Range(-1.5, Some(0.5))));
        assert_eq!(time("0.5.."), Ok(TimeChoice::Range(0.5, None)));
        for text in ["4..0", "1..1", "1e9", "nan", "0..inf"] {
            assert!(matches!(time(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        for text in ["", "..", "..4", "now", "0..4..8", "0-4"] {
            assert!(matches!(time(text), Err(Refused::Malformed(_))), "{text}");
        }
    }

    #[test]
    fn time_ranges_include_the_start_but_not_the_end() {
        let moments = Moments::new(1.0..3.0, 24.0).unwrap();
        assert_eq!(moments.count, 48);
        assert_eq!(moments.time_s(0), 1.0);
        assert!(moments.time_s(47) < 3.0);
        assert_eq!(moments.share(24), 0.5);
        // Ten times 1.1 is a little more than 11, since 1.1 has no exact binary fraction.
        assert_eq!(Moments::new(0.0..1.1, 10.0).unwrap().count, 11);
        assert_eq!(Moments::new(0.0..0.31, 10.0).unwrap().count, 4);
        assert_eq!(Moments::new(0.0..1e-9, 24.0).unwrap().count, 1);
        assert!(Moments::new(2.0..2.0, 24.0).unwrap_err().to_string().contains("empty"));
        let error = Moments::new(0.0..1e4, 1000.0).unwrap_err().to_string();
        assert!(error.contains("10000000 pictures"), "{error}");
    }
}
