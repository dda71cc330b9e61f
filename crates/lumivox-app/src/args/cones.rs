//! The settings of the cones: a preset, and changes to it.

use std::ops::RangeInclusive;

use clap::Args;
use lumivox::{TraceResolution, TraceSettings};
use lumivox_console::Failure;
use lumivox_render::parameters::{Group, PARAMETERS, Parameter, Value};
use lumivox_render::{Look, PresetChoice, RenderSettings};

use super::choices;
use super::number::number;

/// What `TraceSettings::validate` allows; a test holds the two together.
const VOXEL_PER_DIAMETER: RangeInclusive<f32> = 0.05..=1.0;
const NORMAL_OFFSET_VOXELS: RangeInclusive<f32> = 0.0..=4.0;
const STEP_PER_VOXEL: RangeInclusive<f32> = 0.25..=1.0;
const MIN_TRANSMITTANCE: RangeInclusive<f32> = 0.0..=0.25;
const SPECULAR_SHARE: RangeInclusive<f32> = 0.02..=1.0;
/// 0, which is off, is allowed besides.
const CLEARANCE: RangeInclusive<f32> = 0.1..=1.0;
const WIDTH_ATTENUATION: RangeInclusive<f32> = 0.0..=64.0;
const LEVEL_GAIN: RangeInclusive<f32> = 1.0..=8.0;
const OCCLUSION_DISTANCE_M: RangeInclusive<f32> = 0.0..=1e9;

/// The cones.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Cones")]
pub struct ConeArgs {
    /// How much is spent on the cones
    ///
    /// All but report and vxct obey the same physics; they differ in noise, sharpness and cost. The options
    /// below change single values of the preset. vxct has cones of its own for the resolution, as VXCT had
    /// (docs/vxct-look.md): of the options below only those of the voxels' bounces change anything there.
    #[arg(long, value_name = "NAME", value_parser = choices::preset_or_look())]
    #[arg(default_value = "balanced")]
    preset: Option<PresetChoice>,

    /// Diffuse cones a pixel and frame: 6, 9 or 12 [default: 6; preset high: 12]
    ///
    /// More: less noise and bias, at proportional cost.
    #[arg(long, value_name = "CONES", value_parser = diffuse_cones, allow_negative_numbers = true)]
    cones: Option<u32>,

    /// Trace one pixel of each 2x2 block [default: off; preset fast: on]
    ///
    /// Each frame takes another one; the rest is filled in by depth and normal. A quarter of the
    /// cost, softer at edges.
    #[arg(long, conflicts_with = "full")]
    half: bool,

    /// Trace every pixel [default: on; preset fast: off]
    #[arg(long)]
    full: bool,

    /// Sampled voxel's edge as a share of the cone's diameter, 0.05 to 1 [default: 0.125; preset
    /// fast: 0.5; preset high: 0.0625; preset report: 1]
    ///
    /// Finer (lower): sharper indirect light, at a higher cost.
    #[arg(long, value_name = "SHARE", value_parser = number(VOXEL_PER_DIAMETER))]
    #[arg(allow_negative_numbers = true)]
    voxel_per_diameter: Option<f32>,

    /// Growth of the sampled voxel's edge per metre travelled and per cosine against the normal, at
    /// most: 0.1 to 1, or 0 for no bound [default: 0.333; preset fast: 0.5; preset
    /// high: 0; preset report: 0]
    ///
    /// Cones that leave at a grazing angle then keep clear of the surface that they start from.
    /// Lower: finer samples near the surface, at a higher cost.
    #[arg(long, value_name = "RATIO", value_parser = clearance, allow_negative_numbers = true)]
    clearance: Option<f32>,

    /// Start of the cones above the surface in voxels, 0 to 4 [default: 0.5; preset
    /// report: 1]
    ///
    /// Cones move away from walls beside them by themselves. Higher passes over near detail, lower makes
    /// oblique surfaces darken themselves.
    #[arg(long, value_name = "VOXELS", value_parser = number(NORMAL_OFFSET_VOXELS))]
    #[arg(allow_negative_numbers = true)]
    normal_offset: Option<f32>,

    /// Distance between samples as a share of the sampled voxel's edge, 0.25 to 1 [default: 1]
    ///
    /// Lower: less noise at a higher cost. The brightness does not depend on it.
    #[arg(long, value_name = "SHARE", value_parser = number(STEP_PER_VOXEL))]
    #[arg(allow_negative_numbers = true)]
    step: Option<f32>,

    /// Share of light below which a cone ends, 0 to 0.25 [default: 0.15]
    ///
    /// The rest of the cone is taken to look like what the cone met. With a lower share a bright sky leaks into closed
    /// rooms; with a higher one the light through dark glass is lost.
    #[arg(long, value_name = "SHARE", value_parser = number(MIN_TRANSMITTANCE))]
    #[arg(allow_negative_numbers = true)]
    min_transmittance: Option<f32>,

    /// Width of a glossy cone as a share of the lobe's solid angle, 0.02 to 1 [default: 0.25;
    /// preset report: 1]
    ///
    /// Lower: sharper but noisier reflections; frames draw other directions, so that their mean is
    /// the whole lobe.
    #[arg(long, value_name = "SHARE", value_parser = number(SPECULAR_SHARE))]
    #[arg(allow_negative_numbers = true)]
    specular_share: Option<f32>,

    /// Leave glossy reflections of indirect light out [default: off]
    #[arg(long)]
    no_specular: bool,

    /// Reach of ambient occlusion in metres, 0 to 1e9 [default: unlimited]
    ///
    /// It changes `--view occlusion` alone, never the light.
    #[arg(long, value_name = "METRES", value_parser = number(OCCLUSION_DISTANCE_M))]
    #[arg(allow_negative_numbers = true)]
    occlusion_distance: Option<f32>,

    /// Draw the cones' directions at random, in each frame others [default: on; preset report: off]
    ///
    /// Without, a fixed set of cones makes bands in place of noise.
    #[arg(long, value_name = "SWITCH", value_parser = choices::switch())]
    jitter: Option<bool>,

    /// Start cones farther where walls are beside them [default: on; preset report: off]
    ///
    /// Without, --normal-offset alone counts, and light leaks along walls.
    #[arg(long, value_name = "SWITCH", value_parser = choices::switch())]
    clear_of_walls: Option<bool>,

    /// Share of a sample's radiance that is lost when the cone is as wide as the scene, 0 to 64
    /// [default: 0; preset report: 1]
    ///
    /// 0 is the physics. Higher dims what is far away.
    #[arg(long, value_name = "SHARE", value_parser = number(WIDTH_ATTENUATION))]
    #[arg(allow_negative_numbers = true)]
    width_attenuation: Option<f32>,

    /// Number that a sample's radiance is multiplied by for each level of its voxel, 1 to 8
    /// [default: 1; preset report: 8]
    ///
    /// 1 is the physics. Higher brightens what is far away, up to what full voxels would give.
    #[arg(long, value_name = "NUMBER", value_parser = number(LEVEL_GAIN))]
    #[arg(allow_negative_numbers = true)]
    level_gain: Option<f32>,

    /// A parameter of VXCT's look by the name of its console; may be given again [default: those of the resolution]
    ///
    /// Such as `shadow_str=2` or `side_cones=on`; `lumivox run -c 'parameters vxct'` lists them with their ranges. With
    /// --preset vxct alone.
    #[arg(long, value_name = "NAME=VALUE", value_parser = vxct_parameter)]
    vxct: Vec<VxctParameter>,
}

/// A value for a parameter of VXCT's look.
type VxctParameter = (&'static Parameter, Value);

fn vxct_parameter(text: &str) -> Result<VxctParameter, String> {
    let of_look = || PARAMETERS.iter().filter(|p| p.group == Group::Vxct && p.name != "look");
    let (name, value) = text.split_once('=').unwrap_or((text, ""));
    let Some(parameter) = of_look().find(|parameter| parameter.name == name) else {
        let names: Vec<&str> = of_look().map(|parameter| parameter.name).collect();
        return Err(format!("it must be one of {}, with its value after =", names.join(", ")));
    };
    let value = parameter.parse(value).map_err(|error| error.to_string())?;
    Ok((parameter, value))
}

fn diffuse_cones(text: &str) -> Result<u32, super::Refused> {
    let cones = super::number::whole(0..=u32::MAX)(text);
    let refused = || super::Refused::OutOfRange("it must be 6, 9 or 12".to_owned());
    match cones {
        Ok(cones @ (6 | 9 | 12)) => Ok(cones),
        Ok(_) | Err(super::Refused::OutOfRange(_)) => Err(refused()),
        Err(malformed) => Err(malformed),
    }
}

fn clearance(text: &str) -> Result<f32, super::Refused> {
    match super::number::one(text)? {
        0.0 => Ok(0.0),
        value if CLEARANCE.contains(&value) => Ok(value),
        _ => Err(super::Refused::OutOfRange(format!(
            "it must be from {} to {}, or 0 for no bound",
            CLEARANCE.start(),
            CLEARANCE.end()
        ))),
    }
}

impl ConeArgs {
    /// The preset that the settings start from.
    pub fn preset(&self) -> PresetChoice {
        self.preset.unwrap_or_default()
    }

    /// How the picture comes about, with voxels of a resolution.
    pub fn look(&self, resolution: u32) -> Look {
        let look = self.preset().look(resolution);
        let mut settings = RenderSettings { look, resolution, ..RenderSettings::default() };
        for (parameter, value) in self.vxct.iter().filter(|_| look != Look::Physical) {
            let _ = parameter.set(&mut settings, *value);
        }
        settings.look
    }

    /// Checks what the options have to do with each other.
    ///
    /// # Errors
    /// When one belongs to another look.
    pub fn check(&self) -> Result<(), Failure> {
        match self.vxct.first() {
            Some((parameter, _)) if self.preset() != PresetChoice::Vxct => {
                Err(Failure::input(format!(
                    "--vxct {}: it belongs to the look vxct; give --preset vxct with it",
                    parameter.name
                )))
            }
            _ => Ok(()),
        }
    }

    /// The preset's settings with the changes made to it.
    pub fn settings(&self) -> TraceSettings {
        let preset = TraceSettings::preset(self.preset().cones());
        let resolution = match (self.half, self.full) {
            (true, _) => TraceResolution::Half,
            (_, true) => TraceResolution::Full,
            _ => preset.resolution,
        };
        TraceSettings {
            diffuse_cones: self.cones.unwrap_or(preset.diffuse_cones),
            voxel_per_diameter: self.voxel_per_diameter.unwrap_or(preset.voxel_per_diameter),
            clearance: self.clearance.unwrap_or(preset.clearance),
            normal_offset_voxels: self.normal_offset.unwrap_or(preset.normal_offset_voxels),
            step_per_voxel: self.step.unwrap_or(preset.step_per_voxel),
            min_transmittance: self.min_transmittance.unwrap_or(preset.min_transmittance),
            specular: preset.specular && !self.no_specular,
            specular_share: self.specular_share.unwrap_or(preset.specular_share),
            occlusion_distance_m: self.occlusion_distance.unwrap_or(preset.occlusion_distance_m),
            resolution,
            jitter: self.jitter.unwrap_or(preset.jitter),
            clear_of_walls: self.clear_of_walls.unwrap_or(preset.clear_of_walls),
            width_attenuation: self.width_attenuation.unwrap_or(preset.width_attenuation),
            level_gain: self.level_gain.unwrap_or(preset.level_gain),
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use lumivox::Preset;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        cones: ConeArgs,
    }

    fn settings(line: &str) -> TraceSettings {
        let words = ["test"].into_iter().chain(line.split_whitespace());
        Line::try_parse_from(words).unwrap().cones.settings()
    }

    #[test]
    fn presets_are_the_librarys() {
        assert_eq!(settings(""), TraceSettings::default());
        assert_eq!(settings("--preset fast"), TraceSettings::preset(Preset::Fast));
        assert_eq!(settings("--preset high"), TraceSettings::preset(Preset::High));
        assert_eq!(settings("--preset report"), TraceSettings::preset(Preset::Report));
        assert_eq!(settings("--preset vxct"), TraceSettings::default());
    }

    #[test]
    fn single_values_change_the_preset() {
        let changed = settings("--preset high --cones 9 --half --no-specular --step 0.5");
        let expected = TraceSettings {
            diffuse_cones: 9,
            resolution: TraceResolution::Half,
            specular: false,
            step_per_voxel: 0.5,
            ..TraceSettings::preset(Preset::High)
        };
        assert_eq!(changed, expected);
        let physical = "--preset report --jitter on --clear-of-walls on --width-attenuation 0 \
                        --level-gain 1 --voxel-per-diameter 0.125 --clearance 0.33333334 \
                        --normal-offset 0.5 --specular-share 0.25";
        assert_eq!(settings(physical), TraceSettings::default());
        assert_eq!(settings("--preset fast --full").resolution, TraceResolution::Full);
        assert!(Line::try_parse_from(["test", "--half", "--full"]).is_err());
        assert!(Line::try_parse_from(["test", "--cones", "7"]).is_err());
    }

    /// Sets one value of the settings.
    type Set = fn(&mut TraceSettings, f32);

    #[test]
    fn ranges_are_the_librarys() {
        let accepted = |set: Set, value: f32| {
            let mut settings = TraceSettings::default();
            set(&mut settings, value);
            settings.validate().is_ok()
        };
        let cases: [(RangeInclusive<f32>, Set); 8] = [
            (VOXEL_PER_DIAMETER, |s, v| s.voxel_per_diameter = v),
            (NORMAL_OFFSET_VOXELS, |s, v| s.normal_offset_voxels = v),
            (STEP_PER_VOXEL, |s, v| s.step_per_voxel = v),
            (MIN_TRANSMITTANCE, |s, v| s.min_transmittance = v),
            (SPECULAR_SHARE, |s, v| s.specular_share = v),
            (CLEARANCE, |s, v| s.clearance = v),
            (WIDTH_ATTENUATION, |s, v| s.width_attenuation = v),
            (LEVEL_GAIN, |s, v| s.level_gain = v),
        ];
        for (range, set) in cases {
            let (low, high) = (*range.start(), *range.end());
            assert!(accepted(set, low) && accepted(set, high), "{range:?}");
            let (below, above) = (low - 0.01, high + 0.01);
            assert!(!accepted(set, below) && !accepted(set, above), "{range:?}");
        }
        assert!(accepted(|s, v| s.clearance = v, 0.0));
        assert_eq!(clearance("0"), Ok(0.0));
        assert!(clearance("0.05").is_err());
    }

    #[test]
    fn the_help_tells_the_presets_values() {
        use clap::CommandFactory;
        let command = Line::command();
        let help_of = |id: &str| {
            let argument = command.get_arguments().find(|a| a.get_id() == id).unwrap();
            argument.get_help().unwrap().to_string()
        };
        let presets = [Preset::Balanced, Preset::Fast, Preset::High, Preset::Report];
        let [balanced, fast, high, report] = presets.map(TraceSettings::preset);
        let expect = |id: &str, text: String| {
            assert!(help_of(id).contains(&text), "{}: {text}", help_of(id));
        };
        let (low, fine) = (balanced.diffuse_cones, high.diffuse_cones);
        expect("cones", format!("[default: {low}; preset high: {fine}]"));
        let told = |value: fn(&TraceSettings) -> f32| {
            let (low, coarse, fine) = (value(&balanced), value(&fast), value(&high));
            let low = (low * 1000.0).floor() / 1000.0;
            let report = value(&report);
            format!(
                "[default: {low}; preset fast: {coarse}; preset high: {fine}; preset report: {report}]"
            )
        };
        let text = told(|p| p.voxel_per_diameter);
        expect("voxel_per_diameter", text);
        let text = told(|p| p.clearance);
        expect("clearance", text);
        let told = |value: fn(&TraceSettings) -> f32| {
            format!("[default: {}; preset report: {}]", value(&balanced), value(&report))
        };
        expect("normal_offset", told(|p| p.normal_offset_voxels));
        expect("specular_share", told(|p| p.specular_share));
        expect("width_attenuation", told(|p| p.width_attenuation));
        expect("level_gain", told(|p| p.level_gain));
        for id in ["jitter", "clear_of_walls"] {
            expect(id, "[default: on; preset report: off]".to_owned());
        }
        assert_eq!([balanced.jitter, balanced.clear_of_walls], [true; 2]);
        assert_eq!([report.jitter, report.clear_of_walls], [false; 2]);
        expect("step", format!("[default: {}]", balanced.step_per_voxel));
        expect("min_transmittance", format!("[default: {}]", balanced.min_transmittance));
        assert!(balanced.occlusion_distance_m.is_infinite() && balanced.specular);
        assert_eq!(
            [fast, balanced, high].map(|preset| preset.resolution),
            [TraceResolution::Half, TraceResolution::Full, TraceResolution::Full]
        );
    }
}
