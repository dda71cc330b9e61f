//! Readers of a command's arguments, by kind. Each error names what was expected.

use std::ops::RangeInclusive;

use glam::{Vec3, Vec4};

use super::suggest;
use crate::Failure;
use crate::values::Refused;
use crate::values::number::{Number, in_words as range_in_words, read};

/// The largest coordinate, m. There `f32` resolves 64 m.
pub const FARTHEST_M: f32 = 1e9;

/// The range of world coordinates, m, and of similar values.
pub const PLACE: RangeInclusive<f32> = -FARTHEST_M..=FARTHEST_M;

/// The error that a value is not what was expected.
pub fn wrong(what: &str, expected: &str, got: &str) -> Failure {
    Failure::input(format!("{what} is {expected}; got \"{got}\""))
}

/// Turns a parser's refusal of `got` into an error about `what`.
pub fn refused(what: &str, got: &str) -> impl Fn(Refused) -> Failure {
    move |refused| Failure::input(format!("{what}: {refused}; got \"{got}\""))
}

/// A number in a range.
pub fn number<T: Number>(text: &str, what: &str, range: RangeInclusive<T>) -> Result<T, Failure> {
    read(text, &range).map_err(|_| wrong(what, &range_in_words(&range), text))
}

/// An angle in degrees, as radians. It is read in f64, so that every `f32` of radians can be
/// written.
pub fn angle(text: &str, what: &str, range_deg: RangeInclusive<f64>) -> Result<f32, Failure> {
    let angle = read(text, &range_deg).map_err(|_| {
        let (low, high) = (range_deg.start(), range_deg.end());
        wrong(what, &format!("an angle from {low} to {high} degrees"), text)
    })?;
    Ok(angle.to_radians() as f32)
}

/// An angle in radians as degrees, in the fewest digits that [`angle`] reads back exactly.
pub fn degrees(angle_rad: f32) -> String {
    lumivox_scene::degrees(angle_rad).to_string()
}

/// Three numbers, in three words or in one with commas.
pub fn vector(words: &[&str], what: &str, range: RangeInclusive<f32>) -> Result<Vec3, Failure> {
    let parts: Vec<&str> = words.iter().flat_map(|word| word.split(',')).collect();
    let &[x, y, z] = parts.as_slice() else {
        return Err(wrong(what, "three numbers X Y Z", &words.join(" ")));
    };
    let part = |text: &str| number(text.trim(), what, range.clone());
    Ok(Vec3::new(part(x)?, part(y)?, part(z)?))
}

/// A direction of unit length. A vector of unit length up to rounding is not changed, because
/// scripts must reproduce every bit.
pub fn direction(words: &[&str], what: &str) -> Result<Vec3, Failure> {
    let along = vector(words, what, -1e6..=1e6)?;
    let is_unit = (along.as_dvec3().length() - 1.0).abs() <= 1e-5;
    let unit = if is_unit { Some(along) } else { along.try_normalize() };
    unit.ok_or_else(|| {
        Failure::input(format!("{what} has no direction; got \"{}\"", words.join(" ")))
    })
}

/// A colour of three linear components, and alpha if there is a fourth word.
pub fn color(words: &[&str], what: &str, alpha: f32) -> Result<Vec4, Failure> {
    let parts: Vec<&str> = words.iter().flat_map(|word| word.split(',')).collect();
    match *parts.as_slice() {
        [r, g, b] => Ok(vector(&[r, g, b], what, 0.0..=1.0)?.extend(alpha)),
        [r, g, b, a] => {
            Ok(vector(&[r, g, b], what, 0.0..=1.0)?.extend(number(a, what, 0.0..=1.0)?))
        }
        _ => Err(wrong(what, "three numbers R G B from 0 to 1", &words.join(" "))),
    }
}

/// On or off.
pub fn switch(text: &str, what: &str) -> Result<bool, Failure> {
    match text {
        "on" | "true" | "yes" | "1" => Ok(true),
        "off" | "false" | "no" | "0" => Ok(false),
        _ => Err(wrong(what, "on or off", text)),
    }
}

/// The new state of a switch: the requested one, or the opposite of the present one.
pub fn toggled(arguments: &[&str], what: &str, is_on: bool) -> Result<bool, Failure> {
    arguments.first().map_or(Ok(!is_on), |text| switch(text, what))
}

/// `on` or `off`.
pub fn on_or_off(is_on: bool) -> &'static str {
    if is_on { "on" } else { "off" }
}

/// One of several names.
pub fn choice<'a>(text: &str, what: &str, names: &[&'a str]) -> Result<&'a str, Failure> {
    names.iter().find(|name| **name == text).copied().ok_or_else(|| {
        let expected = in_words(names);
        let like = suggest::like(text, names.iter().copied());
        let like = like.map(|like| format!("; did you mean \"{like}\"?")).unwrap_or_default();
        Failure::input(format!("{what} is {expected}; got \"{text}\"{like}"))
    })
}

/// `a, b or c`.
pub fn in_words(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}

/// Three numbers with commas, which read back to the same bits.
pub fn commas(v: Vec3) -> String {
    format!("{},{},{}", v.x, v.y, v.z)
}

/// Three numbers in three words, which read back to the same bits.
pub fn spaces(v: Vec3) -> String {
    format!("{} {} {}", v.x, v.y, v.z)
}

/// Three numbers with commas for people, to a millionth.
pub fn rounded(v: Vec3) -> String {
    commas(v.map(|x| (x * 1e6).round() / 1e6 + 0.0))
}

/// Three numbers for people, to a thousandth.
pub fn short(v: Vec3) -> String {
    // Rounded first, so that nearly zero has no sign.
    v.to_array().map(|x| format!("{:.3}", (x * 1e3).round() / 1e3 + 0.0)).join(" ")
}

/// One word that is a number in a range.
///
/// # Errors
/// When there is not exactly one word, or it is not a number in the range.
pub fn number_of(words: &[&str], what: &str, range: RangeInclusive<f32>) -> Result<f32, Failure> {
    match words {
        [word] => number(word, what, range),
        _ => Err(Failure::input(format!("{what} is one number; got {}", words.len()))),
    }
}
