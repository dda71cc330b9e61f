//! The one table of the fields of lights. The checks of scenes, the console, panels, the page and
//! Python read it.

use std::fmt;

use glam::Vec3;

use super::light::LightKind::{Directional, Point, Spot};
use super::{Attenuation, Light, LightKind};

/// A field of a light.
#[derive(Clone, Copy, Debug)]
pub struct LightField {
    /// Its name in the console.
    pub name: &'static str,
    /// Other names in the console.
    pub aliases: &'static [&'static str],
    /// Its name in records of the page and of Python, with the unit.
    pub key: &'static str,
    /// Its title in panels and messages.
    pub title: &'static str,
    /// Its meaning in a few words, in lower case.
    pub summary: &'static str,
    /// The form of its value.
    pub form: LightForm,
    /// The kinds of light that have the field.
    pub kinds: &'static [LightKind],
    unit: &'static str,
    /// The least and the greatest number that may be set. Files may exceed them, except the maximum
    /// of an angle and a minimum of at least 0.
    range: (f64, f64),
    /// The name of the field that is its upper limit.
    limit: Option<&'static str>,
    get: fn(&Light) -> Option<Vec3>,
    set: fn(&mut Light, Vec3),
    /// Removes the value; `None` if the field always has one.
    clear: Option<fn(&mut Light)>,
}

/// The form of a field's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightForm {
    /// A number.
    Number,
    /// Linear red, green and blue.
    Color,
    /// A position.
    Position,
    /// A direction. Vectors of any length are accepted, and stored with unit length.
    Direction,
    /// The factors of an [`Attenuation`]; not all are zero.
    Attenuation,
}

impl LightForm {
    /// The names of a vector's numbers; `None` for one number.
    pub const fn parts(self) -> Option<[&'static str; 3]> {
        match self {
            Self::Number => None,
            Self::Color => Some(["r", "g", "b"]),
            Self::Position | Self::Direction => Some(["x", "y", "z"]),
            Self::Attenuation => Some(["constant", "linear", "quadratic"]),
        }
    }
}

/// A value of a record of a light; numbers are in the field's unit.
#[derive(Clone, Debug, PartialEq)]
pub enum LightValue {
    /// No value: unlimited, or the default of the renderer.
    None,
    /// The name or the kind.
    Text(String),
    /// A number.
    Number(f64),
    /// Three numbers.
    Vector([f64; 3]),
}

impl fmt::Display for LightValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => write!(f, "none"),
            Self::Text(text) => write!(f, "{text}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Vector([x, y, z]) => write!(f, "{x} {y} {z}"),
        }
    }
}

const ALL: &[LightKind] = &LightKind::ALL;
const LAMPS: &[LightKind] = &[Point, Spot];
/// Excludes 0.
const ABOVE_0: f64 = f64::MIN_POSITIVE;
const ANY: f64 = f64::INFINITY;
/// Angles are stored in radians.
const DEGREE: &str = "°";
/// lux for parallel light.
const CANDELA: &str = "cd";

/// The defaults of rows.
const ROW: LightField = LightField {
    name: "",
    aliases: &[],
    key: "",
    title: "",
    summary: "",
    form: LightForm::Number,
    kinds: ALL,
    unit: "",
    range: (0.0, 1e6),
    limit: None,
    get: |_| None,
    set: |_, _| (),
    clear: None,
};

/// All fields, in the order in which records are read: limits before what they limit.
pub const LIGHT_FIELDS: &[LightField] = &[
    LightField {
        aliases: &["intensity", "illuminance"],
        unit: CANDELA,
        range: (0.0, 1e10),
        get: |light| Some(one(light.intensity)),
        set: |light, value| light.intensity = value.x,
        ..row("strength", "intensity", "Strength", "luminous intensity; of a sun illuminance")
    },
    LightField {
        aliases: &["colour"],
        form: LightForm::Color,
        get: |light| Some(light.color),
        set: |light, value| light.color = value,
        ..row("color", "color", "Colour", "linear red, green and blue")
    },
    LightField {
        form: LightForm::Position,
        kinds: LAMPS,
        unit: "m",
        range: (-1e9, 1e9),
        get: |light| Some(light.position),
        set: |light, value| light.position = value,
        ..row("position", "position", "Position", "place in the world")
    },
    LightField {
        form: LightForm::Direction,
        kinds: &[Spot, Directional],
        range: (-ANY, ANY),
        get: |light| Some(light.direction),
        set: |light, value| light.direction = value,
        ..row("direction", "direction", "Direction", "in which the light travels")
    },
    LightField {
        kinds: LAMPS,
        unit: "m",
        get: |light| Some(one(light.radius_m)),
        set: |light, value| light.radius_m = value.x,
        ..row("radius", "radius_m", "Radius", "of the source, for soft shadows")
    },
    LightField {
        kinds: LAMPS,
        unit: "m",
        range: (ABOVE_0, 1e9),
        get: |light| light.range_m.map(one),
        set: |light, value| light.range_m = Some(value.x),
        clear: Some(|light| light.range_m = None),
        ..row("range", "range_m", "Range", "distance beyond which the light may be cut off")
    },
    LightField {
        kinds: &[Spot],
        unit: DEGREE,
        range: (ABOVE_0, 90.0),
        get: |light| Some(one(light.outer_angle_rad)),
        set: |light, value| {
            light.outer_angle_rad = value.x;
            light.inner_angle_rad = light.inner_angle_rad.min(value.x);
        },
        ..row("outer", "outer_angle_deg", "Outer angle", "from the axis to the end of the light")
    },
    LightField {
        kinds: &[Spot],
        unit: DEGREE,
        limit: Some("outer"),
        get: |light| Some(one(light.inner_angle_rad)),
        set: |light, value| light.inner_angle_rad = value.x,
        ..row("inner", "inner_angle_deg", "Inner angle", "from the axis to the fall-off")
    },
    LightField {
        kinds: &[Directional],
        unit: DEGREE,
        range: (0.0, 90.0),
        get: |light| Some(one(light.angular_radius_rad)),
        set: |light, value| light.angular_radius_rad = value.x,
        ..row("angular_radius", "angular_radius_deg", "Angular radius", "for soft shadows")
    },
    LightField {
        form: LightForm::Attenuation,
        get: |light| {
            let Attenuation { constant, linear, quadratic } = light.attenuation?;
            Some(Vec3::new(constant, linear, quadratic))
        },
        set: |light, value| {
            let [constant, linear, quadratic] = value.to_array();
            light.attenuation = Some(Attenuation { constant, linear, quadratic });
        },
        clear: Some(|light| light.attenuation = None),
        ..row("attenuation", "attenuation", "Attenuation", "fall-off in the look vxct")
    },
];

const fn row(
    name: &'static str,
    key: &'static str,
    title: &'static str,
    summary: &'static str,
) -> LightField {
    LightField { name, key, title, summary, ..ROW }
}

/// Formats a bound in few characters.
fn short(number: f64) -> String {
    if number.abs() >= 1e6 { format!("{number:e}") } else { number.to_string() }
}

/// Stores a number as a vector.
fn one(number: f32) -> Vec3 {
    Vec3::new(number, 0.0, 0.0)
}

/// An angle in radians as degrees, with the fewest decimals that give back its bits.
pub fn degrees(angle_rad: f32) -> f64 {
    let exact = f64::from(angle_rad).to_degrees();
    let short = (0..=12).filter_map(|digits| format!("{exact:.digits$}").parse::<f64>().ok());
    let is_exact = |short: &f64| (short.to_radians() as f32).to_bits() == angle_rad.to_bits();
    short.chain([exact]).find(is_exact).unwrap_or(exact)
}

impl Light {
    /// The light's name, kind, and the fields of that kind by key.
    pub fn record(&self) -> impl Iterator<Item = (&'static str, LightValue)> {
        let own = [("name", &*self.name), ("kind", self.kind.name())];
        let own = own.map(|(key, text)| (key, LightValue::Text(text.to_owned())));
        own.into_iter().chain(self.kind.fields().map(|field| (field.key, field.value(self))))
    }

    /// The light of a record. Values that are left out are those of [`Self::typical`]; fields that
    /// the kind does not have are ignored.
    ///
    /// # Errors
    /// A message, if the kind or a field is unknown, or a value is not allowed.
    pub fn of_record(record: &[(&str, LightValue)]) -> Result<Self, String> {
        let find = |key: &str| Some(&record.iter().find(|(other, _)| *other == key)?.1);
        let mut light = Self::default();
        let name = match find("name") {
            Some(LightValue::Text(name)) => name.clone(),
            None => light.name.clone(),
            Some(other) => return Err(format!("its name is {other}, but must be a text")),
        };
        if let Some(kind) = find("kind").map(LightValue::to_string) {
            let [most @ .., last] = LightKind::ALL.map(LightKind::name);
            let known = LightKind::ALL.into_iter().find(|known| known.name() == kind);
            light.kind = known.ok_or_else(|| {
                let kinds = format!("{} or {last}", most.join(", "));
                format!("light \"{name}\": its kind is \"{kind}\", but must be {kinds}")
            })?;
        }
        light = Self { name: name.clone(), ..Self::typical(light.kind) };
        let keys = || ["name", "kind"].into_iter().chain(LIGHT_FIELDS.iter().map(|row| row.key));
        if let Some((other, _)) = record.iter().find(|(other, _)| keys().all(|key| key != *other)) {
            let keys = keys().collect::<Vec<_>>().join(", ");
            return Err(format!("light \"{name}\" has no \"{other}\"; lights have {keys}"));
        }
        for field in light.kind.fields() {
            let Some(value) = find(field.key) else { continue };
            field.set_value(&mut light, value).map_err(|allowed| {
                format!("light \"{name}\": its {} is {value}, but must be {allowed}", field.key)
            })?;
        }
        Ok(light)
    }
}

impl LightField {
    /// `true` if the field may have no value.
    pub fn is_optional(&self) -> bool {
        self.clear.is_some()
    }

    /// The unit of the field for a light of this kind; empty if it has none.
    pub fn unit(&self, kind: LightKind) -> &'static str {
        if self.unit == CANDELA { kind.unit() } else { self.unit }
    }

    /// The least and the greatest number that may be set for a light.
    pub fn range(&self, light: &Light) -> (f64, f64) {
        let limit = self.limit.and_then(|name| LIGHT_FIELDS.iter().find(|row| row.name == name));
        match limit.map(|limit| limit.value(light)) {
            Some(LightValue::Number(limit)) => (self.range.0, limit),
            _ => self.range,
        }
    }

    /// The field's value in a light: numbers with the fewest digits that give back their bits.
    pub fn value(&self, light: &Light) -> LightValue {
        let shown = |number: f32| match self.unit {
            DEGREE => degrees(number),
            _ => number.to_string().parse().unwrap_or(f64::from(number)),
        };
        match (self.get)(light) {
            None => LightValue::None,
            Some(value) if self.form == LightForm::Number => LightValue::Number(shown(value.x)),
            Some(value) => LightValue::Vector(value.to_array().map(shown)),
        }
    }

    /// Sets the field of a light.
    ///
    /// # Errors
    /// The allowed values in words, if `value` is not one of them; the light is then unchanged.
    pub fn set_value(&self, light: &mut Light, value: &LightValue) -> Result<(), String> {
        let radians = |number: f64| if self.unit == DEGREE { number.to_radians() } else { number };
        let mut changed = light.clone();
        let stored = match (value, self.form) {
            (LightValue::None, _) => None,
            (&LightValue::Number(number), LightForm::Number) => Some(one(radians(number) as f32)),
            (LightValue::Vector(vector), LightForm::Direction) => {
                super::to_unit(vector.map(|number| number as f32).into())
            }
            (LightValue::Vector(vector), form) if form != LightForm::Number => {
                Some(vector.map(|number| number as f32).into())
            }
            _ => return Err(self.expected(light)),
        };
        match (stored, self.clear) {
            (Some(stored), _) => (self.set)(&mut changed, stored),
            (None, Some(clear)) => clear(&mut changed),
            (None, None) => return Err(self.expected(light)),
        }
        self.check_within(&changed, self.range(&changed)).map_err(|_| self.expected(light))?;
        *light = changed;
        Ok(())
    }

    /// Checks the field of a light of a scene: lights of files may be brighter, larger and farther
    /// away than those that users set.
    ///
    /// # Errors
    /// The allowed values in words.
    pub fn check(&self, light: &Light) -> Result<(), String> {
        let (low, high) = self.range(light);
        let low = if low < 0.0 { -ANY } else { low };
        let high = if self.unit == DEGREE { high } else { ANY };
        self.check_within(light, (low, high))
    }

    fn check_within(&self, light: &Light, (low, high): (f64, f64)) -> Result<(), String> {
        let fits = |number: f64| number.is_finite() && low <= number && number <= high;
        let is_allowed = match (self.value(light), (self.get)(light)) {
            (LightValue::Vector(numbers), Some(stored)) => {
                let is_allowed = match self.form {
                    LightForm::Direction => (stored.length() - 1.0).abs() <= 1e-3,
                    LightForm::Attenuation => (ABOVE_0..ANY).contains(&stored.element_sum().into()),
                    _ => true,
                };
                numbers.into_iter().all(fits) && is_allowed
            }
            (LightValue::Number(number), _) => fits(number),
            _ => true,
        };
        if is_allowed { Ok(()) } else { Err(self.expected(light)) }
    }

    /// The allowed values in words: `a number from 0 to 1e10, cd`.
    pub fn expected(&self, light: &Light) -> String {
        let what = match self.form.parts() {
            Some(parts) => format!("three numbers {}", parts.join(" ").to_uppercase()),
            None if self.unit == DEGREE => "an angle".to_owned(),
            None => "a number".to_owned(),
        };
        let (low, high) = self.range(light);
        let from = if low > 0.0 {
            " above 0".to_owned()
        } else if low.is_finite() {
            format!(" from {}", short(low))
        } else {
            String::new()
        };
        let to = match self.limit {
            Some(limit) => format!(" to {limit}, {high}"),
            None if high.is_finite() => format!(" to {}", short(high)),
            None => String::new(),
        };
        let unit = match self.unit(light.kind) {
            "" => String::new(),
            DEGREE => " degrees".to_owned(),
            unit => format!(", {unit}"),
        };
        let is_any = !matches!(self.form, LightForm::Direction | LightForm::Attenuation);
        let not_0 = if is_any { "" } else { ", not all 0" };
        let or_none = if self.is_optional() { ", or none" } else { "" };
        format!("{what}{from}{to}{unit}{not_0}{or_none}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The destructuring names all fields, so that a new one must be listed here, too.
    #[test]
    fn the_light_table_covers_every_field() {
        let Light {
            name: _,
            kind: _,
            intensity: _,
            color: _,
            position: _,
            direction: _,
            radius_m: _,
            range_m: _,
            outer_angle_rad: _,
            inner_angle_rad: _,
            angular_radius_rad: _,
            attenuation: _,
        } = Light::default();
        assert_eq!(LIGHT_FIELDS.len(), 10);
        for light in LightKind::ALL.map(Light::typical) {
            let record: Vec<_> = light.record().collect();
            assert_eq!(Light::of_record(&record), Ok(light.clone()));
            assert!(light.kind.fields().all(|field| field.check(&light).is_ok()));
        }
    }

    #[test]
    fn values_out_of_range_change_nothing() {
        let mut light = Light::typical(Spot);
        for (name, value, allowed) in [
            ("strength", LightValue::Number(-1.0), "a number from 0 to 1e10, cd"),
            ("strength", LightValue::None, "a number from 0 to 1e10, cd"),
            ("range", LightValue::Number(0.0), "a number above 0 to 1e9, m, or none"),
            ("outer", LightValue::Number(90.1), "an angle above 0 to 90 degrees"),
            ("inner", LightValue::Number(31.0), "an angle from 0 to outer, 30 degrees"),
            ("direction", LightValue::Vector([0.0; 3]), "three numbers X Y Z, not all 0"),
            (
                "color",
                LightValue::Vector([0.0, f64::NAN, 0.0]),
                "three numbers R G B from 0 to 1e6",
            ),
        ] {
            let field = LIGHT_FIELDS.iter().find(|field| field.name == name).unwrap();
            assert_eq!(field.set_value(&mut light, &value), Err(allowed.to_owned()));
        }
        assert_eq!(light, Light::typical(Spot));
    }
}
