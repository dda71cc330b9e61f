//! Readings as tables, as JSON, and as a sentence.

use std::fmt::Write as _;
use std::path::PathBuf;

use lumivox_console::report::AdapterReport;
use lumivox_console::shown;
use lumivox_render::measure::Summary;
use serde_json::{Map, Value, json};

use super::places::Places;
use super::readings::Reading;

/// All that was measured.
pub struct Report<'a> {
    /// The name of the scene.
    pub scene: String,
    /// The kind of places.
    pub what: String,
    /// The unit of readings.
    pub unit: &'static str,
    /// Columns and rows of a workplane or a picture.
    pub size: Option<[u32; 2]>,
    /// `cones` or `paths`.
    pub method: &'static str,
    /// Averaged frames; `None` with paths.
    pub frames: Option<u32>,
    /// Samples of a place; `None` with cones.
    pub samples: Option<u32>,
    /// The figures of all readings.
    pub summary: Summary,
    /// The time of the measurement, s.
    pub seconds: f64,
    /// The GPU.
    pub adapter: AdapterReport,
    /// Numbers of the places inside solids.
    pub inside: Vec<usize>,
    /// Numbers of the places in shade that shadow maps miss.
    pub in_lost_shade: Vec<usize>,
    /// The remedy for lost shade, a sentence.
    pub shade_remedy: &'static str,
    /// The places.
    pub places: &'a Places,
    /// The light at the places.
    pub readings: &'a [Reading],
}

impl Report<'_> {
    /// The columns that have readings, each with its name and values.
    fn columns(&self) -> Vec<(String, Vec<Option<f32>>)> {
        let name = if self.unit == "lux" { "lux" } else { "cd_m2" };
        let each = |of: fn(&Reading) -> Option<f32>| self.readings.iter().map(of).collect();
        let all: [(String, Vec<Option<f32>>); 4] = [
            (name.to_owned(), each(|reading| Some(reading.value))),
            (format!("standard_error_{name}"), each(|reading| reading.standard_error)),
            (format!("direct_{name}"), each(|reading| reading.direct)),
            ("openness".to_owned(), each(|reading| reading.openness)),
        ];
        all.into_iter().filter(|(_, values)| values.iter().any(Option::is_some)).collect()
    }

    /// The readings as CSV: the names of the columns, then a line for each reading.
    pub fn csv(&self) -> String {
        let columns = self.columns();
        let names = self.places.columns().iter().copied();
        let names: Vec<&str> = names.chain(columns.iter().map(|(name, _)| name.as_str())).collect();
        let mut text = names.join(",") + "\n";
        for index in 0..self.readings.len() {
            // The shortest text that parses to the same f64 or f32.
            let place = self.places.numbers(index).into_iter().map(|number| number.to_string());
            let values = columns.iter().map(|(_, values)| values[index]);
            let values = values.map(|value| value.map_or(String::new(), |value| value.to_string()));
            text += &place.chain(values).collect::<Vec<_>>().join(",");
            text.push('\n');
        }
        text
    }

    /// The report as one object: the figures, and an array for each column.
    pub fn json(&self) -> Value {
        let Summary { mean, minimum, maximum, uniformity } = self.summary;
        let mut columns = Map::new();
        for (number, name) in self.places.columns().iter().enumerate() {
            let values = (0..self.readings.len()).map(|index| self.places.numbers(index)[number]);
            columns.insert((*name).to_owned(), values.collect());
        }
        for (name, values) in self.columns() {
            columns.insert(name, json!(values));
        }
        json!({
            "scene": self.scene,
            "what": self.what,
            "unit": self.unit,
            "size": self.size,
            "method": self.method,
            "frames": self.frames,
            "samples": self.samples,
            "count": self.readings.len(),
            "mean": mean,
            "minimum": minimum,
            "maximum": maximum,
            "uniformity": uniformity,
            "noise_percent": self.noise_percent(),
            "inside": self.inside,
            "in_lost_shade": self.in_lost_shade,
            "readings": columns,
            "seconds": self.seconds,
            "adapter": self.adapter,
        })
    }

    /// The root of the mean squared standard error over the mean, in percent.
    fn noise_percent(&self) -> Option<f64> {
        let errors = self.readings.iter().map(|reading| reading.standard_error);
        let squares = errors.map(|error| error.map(|error| f64::from(error).powi(2)));
        let sum = squares.sum::<Option<f64>>()?;
        let mean = self.summary.mean;
        (mean > 0.0).then(|| 100.0 * (sum / self.readings.len() as f64).sqrt() / mean)
    }

    /// The scene, the places and the method.
    pub fn title(&self) -> String {
        let method = match (self.frames, self.samples) {
            (Some(frames), _) => format!("cones, {frames} frames"),
            (_, samples) => format!("paths, {} samples", samples.unwrap_or_default()),
        };
        format!("{}, {}; {method}", shown::line(&self.scene), self.what)
    }

    /// The figures.
    pub fn figures(&self) -> String {
        let Summary { mean, minimum, maximum, uniformity } = self.summary;
        let [mean, minimum, maximum] = [mean, minimum, maximum].map(digits);
        let unit = self.unit;
        let mut text = format!("mean {mean} {unit}, least {minimum}, greatest {maximum}");
        if unit == "lux" {
            let _ = write!(text, ", uniformity {uniformity:.3}");
        }
        if let Some(noise) = self.noise_percent() {
            let _ = write!(text, "; noise {noise:.2} %");
        }
        text
    }

    /// The figures and up to twenty readings of points or rays, as text.
    pub fn text(&self, files: &[PathBuf]) -> String {
        const MOST: usize = 20;
        let mut text =
            format!("{} ({} places)\n{}\n", self.title(), self.readings.len(), self.figures());
        let notes = [
            (&self.inside, "inside of solids, where no light comes", "Move them into the air."),
            (
                &self.in_lost_shade,
                "in shade for which the texels of shadow maps are too large",
                self.shade_remedy,
            ),
        ];
        for (places, what, remedy) in notes {
            let Some(&first) = places.first() else { continue };
            let place: Vec<String> =
                self.places.numbers(first)[..3].iter().map(ToString::to_string).collect();
            let _ = writeln!(
                text,
                "{} of them {what}; the first is number {} at {}. {remedy}",
                places.len(),
                first + 1,
                place.join(",")
            );
        }
        let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        if !names.is_empty() {
            let _ = writeln!(text, "{}", names.join(", "));
        } else if self.size.is_none() {
            for (index, reading) in self.readings.iter().take(MOST).enumerate() {
                let place = self.places.numbers(index);
                let place: Vec<String> = place[..3].iter().map(ToString::to_string).collect();
                let error =
                    reading.standard_error.map(|error| format!(" ± {}", digits(error.into())));
                let (value, error) = (digits(reading.value.into()), error.unwrap_or_default());
                let _ = writeln!(text, "  {}: {value}{error} {}", place.join(","), self.unit);
            }
            if self.readings.len() > MOST {
                let _ = writeln!(
                    text,
                    "  and {} more; -o FILE.csv has all",
                    self.readings.len() - MOST
                );
            }
        }
        text
    }
}

/// A number with four significant digits; large ones as whole numbers.
fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let places = 3 - value.abs().log10().floor() as i32;
    if places > 9 { format!("{value:.3e}") } else { format!("{value:.*}", places.max(0) as usize) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in
            [(0.0, "0"), (1234.56, "1235"), (99.956, "99.96"), (0.012_346, "0.01235")]
        {
            assert_eq!(digits(value), text);
        }
        assert_eq!(digits(1.5e-9), "1.500e-9");
    }
}
