use lumivox_render::RenderSettings;

use super::*;

fn values(kind: Kind) -> Vec<Value> {
    match kind {
        Kind::Switch => vec![Value::Switch(true), Value::Switch(false)],
        Kind::Number { low, high, .. } => vec![Value::Number(low), Value::Number(high)],
        Kind::Choice(choices) => choices.iter().map(|choice| Value::Choice(choice.name)).collect(),
        Kind::Whole { .. } | Kind::Vector { .. } => panic!("no classic has such a setting"),
    }
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
    assert_eq!(groups, GROUPS);
    assert_eq!(GROUPS[..Group::ALL.len()], Group::ALL);
}

#[test]
fn classic_parameters_read_back_and_change_nothing_else() {
    for (parameter, _) in classics::rows() {
        let defaults = RenderSettings::default();
        let mut settings = defaults.clone();
        for value in values(parameter.kind) {
            parameter.set(&mut settings, value).expect("in range");
            assert_eq!(parameter.get(&settings), value, "{parameter:?}");
            assert_eq!(parameter.parse(&value.to_string()), Ok(value), "{parameter:?}");
            settings.validate(&wgpu::Limits::default()).expect("in range");
            for other in PARAMETERS.iter() {
                let is_asked_for = parameter.needs.is_some_and(|(name, _)| name == other.name);
                if other.name != parameter.name && !is_asked_for {
                    assert_eq!(other.get(&settings), other.get(&defaults), "{parameter:?}");
                }
            }
        }
    }
}

#[test]
fn presets_are_found_by_their_names() {
    for known in PRESETS {
        assert_eq!(find_preset(known.name()), Some(*known));
        assert!(known.summary().len() > 10, "{}", known.name());
    }
    assert_eq!(PRESETS[..PresetChoice::ALL.len()], PresetChoice::ALL);
    assert!(PRESETS.starts_with(PRESETS_TO_MEASURE));
    assert_eq!(find_preset("Fast"), None);
    let angle = find_parameter("da").expect("a parameter of a look");
    assert_eq!(angle.default(PresetChoice::default()), Value::Number(0.55));
}

/// A preset's settings do not depend on earlier ones.
#[test]
fn presets_do_not_depend_on_earlier_settings() {
    let scene = lumivox_scene::builtin::scene("cornell").unwrap();
    let fresh = RenderSettings::default();
    for before in PRESETS {
        for preset in PRESETS {
            let direct = fresh.with_preset(*preset, Some(&scene));
            let by_way = fresh.with_preset(*before, Some(&scene));
            let by_way = by_way.with_preset(*preset, Some(&scene));
            assert_eq!(by_way, direct, "{} after {}", preset.name(), before.name());
            assert!(direct.look == preset.look(fresh.resolution));
        }
    }
}
