use super::*;
use lumivox::VolumeKind;

fn defaults() -> RenderSettings {
    RenderSettings::default()
}

/// Values at the ends of what a parameter allows, and just beyond them.
fn ends(kind: Kind) -> (Vec<Value>, Vec<Value>) {
    match kind {
        Kind::Switch => (vec![Value::Switch(true), Value::Switch(false)], vec![]),
        Kind::Whole { low, high, multiple } => {
            let mut beyond = vec![Value::Whole(high + multiple)];
            beyond.extend(low.checked_sub(multiple).map(Value::Whole));
            (vec![Value::Whole(low), Value::Whole(high)], beyond)
        }
        Kind::Number { low, high, word, off } => {
            let mut within = vec![Value::Number(low), Value::Number(high)];
            within.extend(word.map(Value::Word));
            within.extend(off.map(Value::Number));
            let step = 1e-3 * (high - low);
            (within, vec![Value::Number(low - step), Value::Number(high + step)])
        }
        Kind::Vector { low, below } => {
            let vector = |number| Value::Vector(glam::Vec3::splat(number));
            (vec![vector(low), vector(0.5 * below)], vec![vector(below), vector(low - 0.1)])
        }
        Kind::Choice(names) => (names.iter().map(|name| Value::Choice(name)).collect(), vec![]),
    }
}

/// Whether a renderer would take the settings, as far as that shows without a device or a scene.
fn is_valid(settings: &RenderSettings) -> bool {
    let limits = wgpu::Limits { max_texture_dimension_2d: 16_384, ..wgpu::Limits::default() };
    let (low, high) = (glam::Vec3::ZERO, glam::Vec3::ONE);
    let grid = lumivox::Grid::fit(low, high, settings.resolution, settings.grid_offset);
    settings.validate(&limits).is_ok() && grid.is_ok()
}

#[test]
fn names_are_unique_and_groups_stand_together() {
    let names: Vec<_> = PARAMETERS.iter().map(|parameter| parameter.name).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), names.len());
    let mut groups: Vec<_> = PARAMETERS.iter().map(|parameter| parameter.group).collect();
    groups.dedup();
    assert_eq!(groups, Group::ALL);
}

#[test]
fn what_is_set_is_what_is_got_and_written_as_it_is_read() {
    for parameter in PARAMETERS {
        for value in ends(parameter.kind).0 {
            let mut settings = defaults();
            parameter.set(&mut settings, value).expect("in range");
            assert_eq!(parameter.get(&settings), value, "{parameter:?}");
            assert_eq!(parameter.parse(&value.to_string()), Ok(value), "{parameter:?}");
        }
    }
}

/// The parameter that another one sets as well.
fn asks_for(parameter: &Parameter) -> Option<&'static str> {
    match parameter.group {
        Group::Vxct if parameter.name != "look" => Some("look"),
        _ if parameter.name.starts_with("octree_") => Some("volume"),
        _ => None,
    }
}

#[test]
fn a_parameter_changes_nothing_but_itself() {
    for parameter in PARAMETERS {
        let mut settings = defaults();
        parameter.set(&mut settings, parameter.get(&defaults())).expect("the default");
        // An option of the octree asks for one, and one of VXCT's look for that.
        if asks_for(parameter).is_none() {
            assert_eq!(settings, defaults(), "{parameter:?}");
        }
        for value in ends(parameter.kind).0 {
            parameter.set(&mut settings, value).expect("in range");
            for other in PARAMETERS {
                // What VXCT's look would have goes with the resolution.
                let is_asked_for = asks_for(parameter) == Some(other.name)
                    || (parameter.name == "resolution" && asks_for(other) == Some("look"));
                if other.name != parameter.name && !is_asked_for {
                    assert_eq!(other.get(&settings), other.get(&defaults()), "{parameter:?}");
                }
            }
        }
    }
}

#[test]
fn ranges_are_those_that_renderers_check() {
    for parameter in PARAMETERS {
        let (within, beyond) = ends(parameter.kind);
        for value in within {
            let mut settings = defaults();
            // Views of an octree need one.
            settings.volume = VolumeKind::Octree(lumivox::OctreeOptions::default());
            parameter.set(&mut settings, value).expect("in range");
            assert!(is_valid(&settings), "{parameter:?} {value}");
        }
        for value in beyond {
            let mut settings = defaults();
            parameter.set(&mut settings, value).expect_err("out of range");
            (parameter.set)(&mut settings, value);
            // The level depends on the grid, and so does the memory on the device.
            if !matches!(parameter.name, "level" | "volume_memory" | "occlusion_distance") {
                assert!(!is_valid(&settings), "{parameter:?} {value}");
            }
        }
    }
}

#[test]
fn what_is_no_value_says_what_would_be() {
    let error = |name, text| {
        Parameter::find(name).expect("a parameter").parse(text).expect_err("no value").to_string()
    };
    assert_eq!(
        error("resolution", "100"),
        "resolution is a multiple of 8 from 16 to 1024 (voxels); got \"100\""
    );
    assert_eq!(error("volume", "sparse"), "volume is dense or octree; got \"sparse\"");
    assert_eq!(
        error("clearance", "0.05"),
        "clearance is a number from 0.1 to 1, or 0 (ratio); got \"0.05\""
    );
    assert!(error("exposure", "NaN").ends_with("or auto (stops); got \"NaN\""));
    assert!(error("grid_offset", "0,0").contains("three numbers x,y,z"));
    assert_eq!(Parameter::find("nothing").map(|p| p.name), None);
}
