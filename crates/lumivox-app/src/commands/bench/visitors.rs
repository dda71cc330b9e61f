//! `lumivox bench --import`: results of the page's benchmark (`page/benchmark.js`), checked, and as
//! a table by GPU.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use lumivox_console::Failure;
use lumivox_scene::read_regular;
use serde::Deserialize;

/// The kind and the version of the file.
const KIND: &str = "lumivox visitor";
const FORMAT: u32 = 1;
/// The cases of the page, with the headings of the table.
const CASES: [(&str, &str); 4] = [
    ("cornell still", "Cornell box, still"),
    ("cornell moving", "lamp and block move"),
    ("atrium still", "atrium, still"),
    ("atrium moving", "sun moves"),
];
/// The least and the greatest time of a frame, ms.
const FRAME_MS: [f64; 2] = [0.02, 60_000.0];
/// The fewest frames of a measurement.
const FEWEST_FRAMES: u32 = 3;
/// The longest that the page measures a case, ms, unless three frames take longer.
const LONGEST_MS: f64 = 10_000.0;
/// A moving frame does all that a still one does, and takes at least this share of its time.
const LEAST_MOVING: f64 = 0.5;
/// The longest name of a GPU, bytes.
const LONGEST_NAME: usize = 160;

/// The kind of a file.
#[derive(Debug, Deserialize)]
struct Head {
    kind: String,
    format: u32,
}

/// A visitor's result.
#[derive(Debug, Deserialize)]
struct Visit {
    /// The version of Lumivox.
    lumivox: String,
    gpu: Gpu,
    clock: Clock,
    cases: Vec<Measured>,
}

#[derive(Debug, Deserialize)]
struct Gpu {
    name: String,
    /// Whether the processor computes what a GPU would.
    is_fallback: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Clock {
    /// The GPU's own.
    Timestamps,
    /// The browser's, from a frame's first call until the GPU has done it.
    Frames,
}

#[derive(Debug, Deserialize)]
struct Measured {
    id: String,
    frames: u32,
    median_ms: f64,
    p95_ms: f64,
}

/// Reads the files; returns the table in Markdown.
///
/// # Errors
/// When a file cannot be read, has another format, or has figures that cannot be true. The message
/// names file, place and remedy.
pub fn table(files: &[impl AsRef<Path>]) -> anyhow::Result<String> {
    let mut by_gpu: BTreeMap<(String, Clock), Group> = BTreeMap::new();
    for file in files.iter().map(AsRef::as_ref) {
        let bytes = read_regular(file).map_err(|error| {
            let reason = format!("cannot be read: {error}; check the path and its permissions");
            Failure::input(format!("{}: {reason}", file.display()))
        })?;
        let visit = read(&bytes)
            .map_err(|problem| Failure::input(format!("{}: {problem}", file.display())))?;
        let name = visit.gpu.name.trim().to_owned();
        by_gpu
            .entry((name.to_lowercase(), visit.clock))
            .or_insert_with(|| Group::new(name))
            .add(&visit);
    }
    let mut text = String::from("| GPU | results | clock |");
    text.extend(CASES.iter().map(|(_, heading)| format!(" {heading} |")));
    text += "\n| --- | --: | --- |";
    text.extend(CASES.iter().map(|_| " --: |"));
    text.push('\n');
    let mut groups: Vec<(Clock, Group)> =
        by_gpu.into_iter().map(|((_, clock), group)| (clock, group)).collect();
    groups.sort_by(|(_, a), (_, b)| a.first_ms().total_cmp(&b.first_ms()));
    for (clock, group) in &groups {
        text += &group.row(*clock);
    }
    Ok(text)
}

/// The results of one GPU.
struct Group {
    name: String,
    visits: u32,
    /// Medians of each of [`CASES`], ms.
    ms: [Vec<f64>; CASES.len()],
}

impl Group {
    fn new(name: String) -> Self {
        Self { name, visits: 0, ms: Default::default() }
    }

    fn add(&mut self, visit: &Visit) {
        self.visits += 1;
        for ((id, _), ms) in CASES.iter().zip(&mut self.ms) {
            ms.extend(visit.cases.iter().filter(|case| case.id == *id).map(|case| case.median_ms));
        }
    }

    /// The first figure, by which GPUs are sorted.
    fn first_ms(&self) -> f64 {
        self.ms.iter().find_map(|ms| median(ms)).unwrap_or(f64::INFINITY)
    }

    fn row(&self, clock: Clock) -> String {
        let clock = match clock {
            Clock::Timestamps => "timestamps",
            Clock::Frames => "whole frames",
        };
        let mut row = format!("| {} | {} | {clock} |", self.name.replace('|', "\\|"), self.visits);
        for ms in &self.ms {
            let cell = median(ms).map_or("-".to_owned(), |ms| match ms {
                ms if ms < 10.0 => format!("{ms:.2}"),
                ms if ms < 100.0 => format!("{ms:.1}"),
                ms => format!("{ms:.0}"),
            });
            row += &format!(" {cell} |");
        }
        row + "\n"
    }
}

/// The median; of an even number the mean of the two in the middle.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let [low, high] = [sorted.len().checked_sub(1)? / 2, sorted.len() / 2];
    Some(0.5 * (sorted[low] + sorted[high]))
}

/// Remedy for files that are not as the page writes them.
const AGAIN: &str = "export it from the page again";

fn parse<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, String> {
    // The error of the library names line and column.
    serde_json::from_slice(bytes)
        .map_err(|error| format!("this is not a result of the page's benchmark: {error}; {AGAIN}"))
}

/// Reads and checks a file.
fn read(bytes: &[u8]) -> Result<Visit, String> {
    // Other versions may have other fields.
    let Head { kind, format } = parse(bytes)?;
    if kind != KIND {
        return Err(format!("kind: is \"{kind}\", not \"{KIND}\"; {AGAIN}"));
    }
    if format != FORMAT {
        return Err(format!(
            "format: is {format}, but this program reads {FORMAT}; use the program of the page's \
             version"
        ));
    }
    let visit: Visit = parse(bytes)?;
    let version = env!("CARGO_PKG_VERSION");
    if visit.lumivox != version {
        return Err(format!(
            "lumivox: is of version {}, and figures of different versions cannot be compared with \
             those of {version}; measure with this version's page",
            visit.lumivox
        ));
    }
    let name = visit.gpu.name.trim();
    if name.is_empty() || name.len() > LONGEST_NAME || name.chars().any(char::is_control) {
        return Err(format!(
            "gpu.name: must be a line of 1 to {LONGEST_NAME} bytes; write the GPU's name there"
        ));
    }
    if visit.gpu.is_fallback && visit.clock == Clock::Timestamps {
        return Err(format!(
            "clock: a software GPU has no true timestamps; {AGAIN}, which then measures frames"
        ));
    }
    check_cases(&visit.cases)?;
    Ok(visit)
}

fn check_cases(cases: &[Measured]) -> Result<(), String> {
    let remedy = "close other programs and pages, and measure again";
    if cases.is_empty() {
        return Err(format!("cases: there are none; {remedy}"));
    }
    let mut seen = BTreeSet::new();
    for (number, case) in cases.iter().enumerate() {
        let fail = |what: String| Err(format!("cases[{number}] ({}): {what}; {remedy}", case.id));
        if !CASES.iter().any(|(id, _)| *id == case.id) {
            let known: Vec<&str> = CASES.iter().map(|(id, _)| *id).collect();
            return fail(format!("this is not measured by the page, but {}", known.join(", ")));
        }
        if !seen.insert(&case.id) {
            return fail("this is there twice".to_owned());
        }
        let Measured { frames, median_ms, p95_ms, .. } = *case;
        if frames < FEWEST_FRAMES {
            return fail(format!("{frames} frames are fewer than {FEWEST_FRAMES}"));
        }
        let [least, most] = FRAME_MS;
        if !(least..=most).contains(&median_ms) {
            return fail(format!("a frame of {median_ms} ms is not within {least} to {most} ms"));
        }
        if !(median_ms..=most).contains(&p95_ms) {
            let what = "95 % of the frames cannot be faster than the median";
            return fail(format!("p95_ms {p95_ms} is below median_ms {median_ms}, but {what}"));
        }
        if frames > FEWEST_FRAMES && f64::from(frames - 1) / 2.0 * median_ms > LONGEST_MS {
            return fail(format!(
                "half of {frames} frames of {median_ms} ms and more take longer than the page measures"
            ));
        }
    }
    for [still, moving] in CASES.as_chunks::<2>().0 {
        let ms = |id: &str| cases.iter().find(|case| case.id == id).map(|case| case.median_ms);
        let (Some(still_ms), Some(moving_ms)) = (ms(still.0), ms(moving.0)) else { continue };
        if moving_ms < LEAST_MOVING * still_ms {
            return Err(format!(
                "cases ({}): {moving_ms} ms cannot be true, since a still frame takes {still_ms} ms; {remedy}",
                moving.0
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn visit(name: &str, still_ms: f64) -> Value {
        let case = |id: &str, ms: f64| json!({ "id": id, "frames": 40, "median_ms": ms, "p95_ms": 1.2 * ms });
        json!({
            "kind": KIND, "format": FORMAT, "lumivox": env!("CARGO_PKG_VERSION"),
            "gpu": { "name": name, "is_fallback": false }, "clock": "frames",
            "cases": [case(CASES[0].0, still_ms), case(CASES[1].0, 3.0 * still_ms)],
        })
    }

    fn problem(value: &Value) -> String {
        read(value.to_string().as_bytes()).unwrap_err()
    }

    #[test]
    fn results_of_a_gpu_are_one_row_sorted_by_time() {
        let folder = tempfile::tempdir().unwrap();
        let files: Vec<_> = [("Slow|1", 40.0), ("Quick 2", 2.0), ("quick 2 ", 4.0)]
            .iter()
            .enumerate()
            .map(|(number, (name, ms))| {
                let file = folder.path().join(format!("{number}.json"));
                std::fs::write(&file, visit(name, *ms).to_string()).unwrap();
                file
            })
            .collect();
        let text = table(&files).unwrap();
        let rows: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(rows[0], "| Quick 2 | 2 | whole frames | 3.00 | 9.00 | - | - |");
        assert_eq!(rows[1], "| Slow\\|1 | 1 | whole frames | 40.0 | 120 | - | - |");
    }

    #[test]
    fn results_that_cannot_be_true_are_refused_with_place_and_remedy() {
        let good = visit("GPU", 5.0);
        read(good.to_string().as_bytes()).unwrap();
        for (place, value, expected) in [
            ("/kind", json!("other"), "kind: is \"other\""),
            ("/format", json!(9), "format: is 9"),
            ("/lumivox", json!("0.0.1"), "lumivox: is of version 0.0.1"),
            ("/gpu/name", json!(" "), "gpu.name: must be"),
            ("/clock", json!("sundial"), "unknown variant `sundial`"),
            ("/cases", json!([]), "cases: there are none"),
            ("/cases/0/id", json!("teapot"), "cases[0] (teapot): this is not measured"),
            ("/cases/1/id", json!(CASES[0].0), "this is there twice"),
            ("/cases/0/frames", json!(1), "1 frames are fewer"),
            ("/cases/0/frames", json!(90_000), "longer than the page measures"),
            ("/cases/0/median_ms", json!(0.001), "is not within"),
            ("/cases/0/p95_ms", json!(1.0), "p95_ms 1 is below"),
            ("/cases/1/median_ms", json!(2.0), "2 ms cannot be true"),
        ] {
            let mut bad = good.clone();
            *bad.pointer_mut(place).unwrap() = value;
            let text = problem(&bad);
            assert!(text.contains(expected), "{place}: {text}");
        }
        let mut software = good;
        software["gpu"]["is_fallback"] = json!(true);
        software["clock"] = json!("timestamps");
        assert!(problem(&software).contains("no true timestamps"));
        assert!(read(b"{").unwrap_err().contains("line 1 column 1"));
    }
}
