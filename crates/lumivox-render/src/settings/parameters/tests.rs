use super::*;
use lumivox::VolumeKind;

fn defaults() -> RenderSettings {
    RenderSettings::default()
}

/// Values at the ends of a parameter's range, and values just outside.
fn ends(kind: Kind) -> (Vec<Value>, Vec<Value>) {
    match kind {
        Kind::Switch => (vec![Value::Switch(true), Value::Switch(false)], vec![]),
        Kind::Whole { low, high, multiple } => {
            let mut beyond = vec![Value::Whole(high + multiple)];
            beyond.extend(low.checked_sub(multiple).map(Value::Whole));
            (vec![Value::Whole(low), Value::Whole(high)], beyond)
        }
        Kind::Number { low, high, words, off } => {
            let mut within = vec![Value::Number(low), Value::Number(high)];
            within.extend(words.iter().map(|word| Value::Word(word)));
            within.extend(off.map(Value::Number));
            let step = 1e-3 * (high - low);
            (within, vec![Value::Number(low - step), Value::Number(high + step)])
        }
        Kind::Vector { low, below } => {
            let vector = |number| Value::Vector(glam::Vec3::splat(number));
            (vec![vector(low), vector(0.5 * below)], vec![vector(below), vector(low - 0.1)])
        }
        Kind::Choice(choices) => {
            (choices.iter().map(|choice| Value::Choice(choice.name)).collect(), vec![])
        }
    }
}

/// Whether the settings are valid, as far as can be checked without a device or a scene.
fn is_valid(settings: &RenderSettings) -> bool {
    let limits = wgpu::Limits { max_texture_dimension_2d: 32_768, ..wgpu::Limits::default() };
    let (low, high) = (glam::Vec3::ZERO, glam::Vec3::ONE);
    let grid = lumivox::Grid::fit(low, high, settings.resolution, settings.grid_offset);
    settings.validate(&limits).is_ok() && grid.is_ok()
}

#[test]
fn parameter_names_are_unique_and_groups_contiguous() {
    let names: Vec<_> = PARAMETERS.iter().flat_map(Parameter::names).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), names.len());
    let mut groups: Vec<_> = PARAMETERS.iter().map(|parameter| parameter.group).collect();
    groups.dedup();
    assert_eq!(groups, Group::ALL);
}

#[test]
fn parameters_round_trip_through_set_get_and_text() {
    for parameter in PARAMETERS.iter() {
        for value in ends(parameter.kind).0 {
            let mut settings = defaults();
            parameter.set(&mut settings, value).expect("in range");
            assert_eq!(parameter.get(&settings), value, "{parameter:?}");
            assert_eq!(parameter.parse(&value.to_string()), Ok(value), "{parameter:?}");
        }
    }
}

#[test]
fn a_parameter_changes_nothing_but_itself() {
    for parameter in PARAMETERS.iter() {
        let mut settings = defaults();
        parameter.set(&mut settings, parameter.get(&defaults())).expect("the default");
        // Setting an option of the octree also selects the octree.
        if parameter.needs.is_none() {
            assert_eq!(settings, defaults(), "{parameter:?}");
        }
        for value in ends(parameter.kind).0 {
            parameter.set(&mut settings, value).expect("in range");
            for other in PARAMETERS.iter() {
                let is_asked_for = parameter.needs.is_some_and(|(name, _)| name == other.name);
                if other.name != parameter.name && !is_asked_for {
                    assert_eq!(other.get(&settings), other.get(&defaults()), "{parameter:?}");
                }
            }
        }
    }
}

#[test]
fn parameter_ranges_match_the_renderers_checks() {
    for parameter in PARAMETERS.iter() {
        let (within, beyond) = ends(parameter.kind);
        for value in within {
            let mut settings = defaults();
            // Some views need an octree, and some need light of earlier frames.
            settings.volume = VolumeKind::Octree;
            settings.trace.temporal = true;
            parameter.set(&mut settings, value).expect("in range");
            assert!(is_valid(&settings), "{parameter:?} {value}");
        }
        for value in beyond {
            let mut settings = defaults();
            parameter.set(&mut settings, value).expect_err("out of range");
            parameter.write(&mut settings, value);
            // Every `u64` is a valid volume memory.
            if parameter.name != "volume_memory" {
                assert!(!is_valid(&settings), "{parameter:?} {value}");
            }
        }
    }
}

#[test]
fn errors_of_bad_values_list_valid_ones() {
    let error = |name, text| {
        Parameter::find(name).expect("a parameter").parse(text).expect_err("no value").to_string()
    };
    assert_eq!(
        error("resolution", "100"),
        "resolution is a multiple of 8 from 16 to 1024 (voxels); got \"100\""
    );
    assert_eq!(error("volume", "sparse"), "volume is dense, octree or cascades; got \"sparse\"");
    assert_eq!(
        error("clearance", "0.05"),
        "clearance is a number from 0.1 to 1, or 0 (ratio); got \"0.05\""
    );
    assert!(error("exposure", "NaN").ends_with("or auto, or auto-each (stops); got \"NaN\""));
    assert!(error("grid_offset", "0,0").contains("three numbers x,y,z"));
    assert_eq!(Parameter::find("nothing").map(|p| p.name), None);
}

/// The lines of the settings' debug output, one for each field.
fn fields(settings: &RenderSettings) -> Vec<String> {
    format!("{settings:#?}").lines().map(str::to_owned).collect()
}

/// Without a row, a field could not be set, and a change of it would redo nothing.
#[test]
fn every_settings_field_has_a_parameter_row() {
    let defaults = RenderSettings { volume: VolumeKind::Octree, ..defaults() };
    let shown = fields(&defaults);
    let mut is_written = vec![false; shown.len()];
    for parameter in PARAMETERS.iter() {
        for value in ends(parameter.kind).0 {
            let mut settings = defaults.clone();
            parameter.set(&mut settings, value).expect("in range");
            let after = fields(&settings);
            let same_begin = shown.iter().zip(&after).take_while(|(a, b)| a == b).count();
            let same_end = shown.iter().rev().zip(after.iter().rev());
            let same_end = same_end.take_while(|(a, b)| a == b).count();
            let end = (shown.len() - same_end).max(same_begin);
            is_written[same_begin..end].fill(true);
        }
    }
    let left: Vec<&str> =
        shown.iter().zip(is_written).filter(|(_, is)| !is).map(|(l, _)| l.trim()).collect();
    let names = left.iter().filter_map(|line| line.strip_suffix(',')?.split_once(": "));
    let names: Vec<&str> = names.map(|(name, _)| name).collect();
    // In the output, each number of a vector has its own line.
    let numbers: Vec<&str> = left
        .iter()
        .copied()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .collect();
    // Fields without rows here: the picture's size, the grid's box, hooks and the look (their rows
    // are defined with them), other views, lines, and timing.
    let of_caller = [
        "grid_bounds",
        "octree_builder",
        "voxelizer",
        "injection",
        "look",
        "cone_model",
        "beside",
        "lines",
        "timing",
    ];
    assert_eq!((names, numbers), (of_caller.to_vec(), vec!["640,", "360,"]));
}

#[test]
fn presets_provide_parameter_defaults() {
    let high = PresetChoice::Cones(lumivox::Preset::High);
    let value = |name| Parameter::find(name).expect("a parameter").default(high);
    assert_eq!(value("cones"), Value::Choice("12"));
    assert_eq!(value("bounces"), Value::Whole(16));
}
