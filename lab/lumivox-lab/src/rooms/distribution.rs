//! Median, 90th percentile and worst of many rooms, as tables in Markdown.

use lumivox_console::report::counted;

use super::RoomFigures;
use super::random::{Kind, RoomLight};

/// The groups of walls by thickness: name, least thickness, and upper bound, m.
const WALLS: [(&str, f32, f32); 4] = [
    ("sheets", 0.0, 0.005),
    ("walls of 1 to 5 cm", 0.005, 0.07),
    ("walls of 10 to 20 cm", 0.07, 0.25),
    ("walls of 30 to 60 cm", 0.25, 1.0),
];

/// A percentile of the absolute values (nearest rank); `share` is from 0 to 1. `None` without
/// values.
fn percentile(values: &[f64], share: f64) -> Option<f64> {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let rank = (share * sizes.len() as f64).ceil().max(1.0) as usize;
    sizes.get(rank - 1).copied()
}

/// The rooms that were measured at a resolution.
pub fn at<'a>(
    resolution: u32,
    rooms: impl IntoIterator<Item = &'a RoomFigures>,
) -> Vec<&'a RoomFigures> {
    rooms.into_iter().filter(|room| room.resolution == resolution).collect()
}

/// The head of a table of [`row`]s; `of` names the first column.
pub fn heading(of: &str) -> String {
    format!(
        "| {of} | rooms | error: median | 90 % | worst | truth's noise: median | 90 % | picture: bias | RMSE | 90 % \
         | dark rooms | leak: median | worst |\n\
         | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n"
    )
}

/// The row of some rooms: errors of lit rooms and the standard error of their truth, bias and RMSE
/// of pictures, leaks of dark rooms.
pub fn row(name: &str, rooms: &[&RoomFigures]) -> String {
    let values = |of: fn(&RoomFigures) -> Option<f64>| -> Vec<f64> {
        rooms.iter().filter_map(|room| of(room)).collect()
    };
    let errors = values(|room| room.error_percent);
    let noises = values(|room| room.noise_percent);
    let biases = values(|room| room.bias_percent);
    let rmses = values(|room| room.rmse_percent);
    let leaks = values(|room| room.leak_percent);
    let figure = |values: &[f64], share: f64| {
        percentile(values, share).map_or("-".to_owned(), |value| format!("{value:.1}"))
    };
    let figures = [
        rooms.len().to_string(),
        figure(&errors, 0.5),
        figure(&errors, 0.9),
        figure(&errors, 1.0),
        figure(&noises, 0.5),
        figure(&noises, 0.9),
        figure(&biases, 0.5),
        figure(&rmses, 0.5),
        figure(&rmses, 0.9),
        leaks.len().to_string(),
        figure(&leaks, 0.5),
        figure(&leaks, 1.0),
    ];
    format!("| {name} | {} |\n", figures.join(" | "))
}

/// The table of rooms by kind, walls, sides, turn and light; groups without rooms are left out.
pub fn by_group(rooms: &[&RoomFigures]) -> String {
    let mut text = heading("group");
    let mut add = |name: &str, is_in: &dyn Fn(&RoomFigures) -> bool| {
        let group: Vec<&RoomFigures> = rooms.iter().copied().filter(|room| is_in(room)).collect();
        if !group.is_empty() {
            text += &row(name, &group);
        }
    };
    add("all", &|_| true);
    for kind in Kind::ALL {
        add(kind.name(), &|room| room.kind == kind.name());
    }
    for (name, from, to) in WALLS {
        add(name, &|room| (from..to).contains(&room.wall_m));
    }
    add("one-sided", &|room| !room.is_double_sided);
    add("two-sided", &|room| room.is_double_sided);
    add("along the grid", &|room| !room.is_turned);
    add("turned", &|room| room.is_turned);
    for light in RoomLight::ALL {
        add(&format!("light: {}", light.name()), &|room| room.light == light.name());
    }
    text
}

/// A sentence that names the rooms with negative or infinite light.
pub fn faults(rooms: &[&RoomFigures]) -> String {
    let faulty: Vec<String> = rooms
        .iter()
        .filter(|room| room.is_faulty())
        .map(|room| format!("{} ({} voxels)", room.name, room.resolution))
        .collect();
    if faulty.is_empty() {
        return "No reading and no pixel is negative or not finite.".to_owned();
    }
    let count = counted(faulty.len(), "case", "cases");
    format!("Light is negative or not finite in {count}: {}.", faulty.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_the_nearest_rank_of_absolute_values() {
        let values = [-10.0, 1.0, -2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        assert_eq!(percentile(&values, 0.5), Some(5.0));
        assert_eq!(percentile(&values, 0.9), Some(9.0));
        assert_eq!(percentile(&values, 1.0), Some(10.0));
        assert_eq!(percentile(&[2.0], 0.5), Some(2.0));
        assert_eq!(percentile(&[], 0.5), None);
    }

    #[test]
    fn rooms_are_counted_in_each_of_their_groups() {
        let lit = RoomFigures::example("tent", Some(-30.0), None);
        let dark = RoomFigures::example("plain", None, Some(0.25));
        let table = by_group(&[&lit, &dark]);
        for line in [
            "| all | 2 | 30.0 | 30.0 | 30.0 | 0.5 | 0.5 | 4.0 | 5.0 | 5.0 | 1 | 0.2 | 0.2 |",
            "| plain | 1 | - | - | - | - | - | 4.0 | 5.0 | 5.0 | 1 | 0.2 | 0.2 |",
            "| tent | 1 | 30.0 | 30.0 | 30.0 | 0.5 | 0.5 | 4.0 | 5.0 | 5.0 | 0 | - | - |",
            "| walls of 10 to 20 cm | 2 |",
            "| two-sided | 2 |",
        ] {
            assert!(table.contains(line), "{line} is missing in {table}");
        }
        assert!(!table.contains("one-sided"), "{table}");
    }

    #[test]
    fn rooms_with_impossible_light_are_named() {
        let good = RoomFigures::example("plain", Some(1.0), None);
        assert!(faults(&[&good]).starts_with("No reading"));
        let negative = RoomFigures { cones: vec![Some(-0.1)], ..good.clone() };
        let infinite = RoomFigures { cones: vec![None], name: "tent-3".to_owned(), ..good.clone() };
        let words = faults(&[&good, &negative, &infinite]);
        assert!(words.contains("2 cases: plain-1 (64 voxels), tent-3 (64 voxels)"), "{words}");
    }
}
