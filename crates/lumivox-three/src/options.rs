//! Options by name, as texts.

use glam::Vec3;
use lumivox::settings::SettingError;
use lumivox::{GiConfig, Grid, Preset, TraceSettings, VolumeKind};

use crate::error::PageError;
use crate::gbuffer;

/// Options that a page chooses once.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The configuration of the library.
    pub config: GiConfig,
    /// The settings of the cones.
    pub settings: TraceSettings,
    /// The most faces of voxels that gather light in a frame; `None`: all.
    pub faces_per_frame: Option<u32>,
}

impl Options {
    /// Reads options: their names, and their values in the same order. `bounds` are the lower and
    /// the upper corner of the lit box, m.
    ///
    /// # Errors
    /// When a name is unknown, or a value not allowed.
    pub fn new(bounds: [Vec3; 2], names: &[String], values: &[String]) -> Result<Self, PageError> {
        let mut resolution = 128;
        let mut volume = VolumeKind::Dense;
        let mut is_reversed = false;
        let mut preset = Preset::Realtime;
        let mut faces_per_frame = None;
        let mut memory_budget = None;
        let mut rest = Vec::new();
        for (name, value) in names.iter().zip(values) {
            let bad =
                |expected: &str| PageError::value(format!("{name} is {expected}; got \"{value}\""));
            match name.as_str() {
                "resolution" => {
                    resolution =
                        value.parse().map_err(|_| bad("a multiple of 8 from 16 to 1024"))?;
                }
                "reversed" => is_reversed = value == "true",
                "facesPerFrame" => {
                    let faces = value.parse().map_err(|_| bad("a whole number above 0"))?;
                    faces_per_frame = Some(faces).filter(|faces| *faces > 0);
                }
                "memoryBudget" => {
                    memory_budget = Some(value.parse().map_err(|_| bad("a number of bytes"))?);
                }
                "volume" => {
                    volume = match value.as_str() {
                        "dense" => VolumeKind::Dense,
                        "octree" => VolumeKind::Octree,
                        _ => return Err(bad("dense or octree")),
                    }
                }
                "preset" => {
                    preset = match value.as_str() {
                        "fast" => Preset::Fast,
                        "realtime" => Preset::Realtime,
                        "balanced" => Preset::Balanced,
                        "high" => Preset::High,
                        _ => return Err(bad("fast, realtime, balanced or high")),
                    }
                }
                _ => rest.push((name, value)),
            }
        }
        let mut settings = TraceSettings::preset(preset);
        for (name, value) in rest {
            set(&mut settings, name, value)?;
        }
        let grid = Grid::fit(bounds[0], bounds[1], resolution, Vec3::ZERO)?;
        let gbuffer = Some(gbuffer::module(is_reversed));
        let config = GiConfig { volume, memory_budget, gbuffer, ..GiConfig::new(grid) };
        Ok(Self { config, settings, faces_per_frame })
    }
}

/// Sets one of the cones' settings.
///
/// # Errors
/// When there is no such setting, or its value is not allowed.
pub fn set(settings: &mut TraceSettings, name: &str, value: &str) -> Result<(), PageError> {
    let table = TraceSettings::SETTINGS;
    let Some(row) = table.iter().find(|row| row.name == name) else {
        let known: Vec<&str> = table.iter().map(|row| row.name).collect();
        return Err(PageError::value(format!(
            "there is no option \"{name}\"; the settings of cones are {}",
            known.join(", ")
        )));
    };
    let allowed = row.kind.parse(value, row.unit).filter(|value| row.kind.allows(*value));
    let Some(value) = allowed else {
        let error = SettingError::new(row.name, row.kind, row.unit, value);
        return Err(PageError::value(error.to_string()));
    };
    (row.set)(settings, value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pairs: &[(&str, &str)]) -> Result<Options, PageError> {
        let (names, values): (Vec<_>, Vec<_>) =
            pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).unzip();
        Options::new([Vec3::ZERO, Vec3::ONE], &names, &values)
    }

    #[test]
    fn options_are_read_by_name() {
        let options = of(&[
            ("resolution", "64"),
            ("cones", "12"),
            ("preset", "fast"),
            ("facesPerFrame", "5000"),
            ("volume", "octree"),
        ])
        .unwrap();
        assert_eq!(options.settings.diffuse_cones, 12);
        assert!(!options.settings.temporal, "the preset comes first, wherever it stands");
        assert_eq!(options.config.grid.dimensions.x, 64);
        assert_eq!(options.faces_per_frame, Some(5000));
        assert!(matches!(options.config.volume, VolumeKind::Octree));
    }

    #[test]
    fn invalid_options_are_named_with_valid_values() {
        for (name, value, expected) in [
            ("resolution", "63", "multiple of 8"),
            ("resolution", "many", "multiple of 8"),
            ("preset", "best", "fast, realtime, balanced or high"),
            ("volume", "cloud", "dense or octree"),
            ("cones", "7", "6, 9 or 12"),
            ("step", "9", "from 0.25 to 1"),
            ("glow", "1", "there is no option \"glow\""),
        ] {
            let error = of(&[(name, value)]).unwrap_err();
            assert_eq!(error.code, "value");
            assert!(error.message.contains(expected), "{error}");
        }
    }
}
