//! The report in Markdown.

use super::plan::Motion;
use super::report::{Figures, Part, Report, Row};

/// Stages of the library that columns of the tables sum up.
const VOXELIZE: &[&str] = &["voxelize", "volume", "changes"];
const LIGHT: &[&str] = &["shadow maps", "light", "face rays", "emitter rays", "bounce", "filter"];
const TRACE: &[&str] = &["trace"];

/// The page, with the figures of a published report beside those of cases with the same name.
pub fn page(report: &Report, published: Option<&Report>) -> String {
    let published = published
        .filter(|published| report.rows.iter().any(|row| figures_of(published, &row.id).is_some()));
    let page = Page { report, published };
    let mut text = page.head();
    text += &page.still();
    text += &page.moving();
    text += &page.stages();
    text + EXPLANATION
}

const EXPLANATION: &str = "\
## What the figures are

- A case is named `scene/volume/voxels/preset/picture/motion`: scene, kind of volume, voxels along the scene's longest axis,
  preset, width and height in pixels.
- Times are medians in milliseconds, *p95* is what 95 % of the frames do not exceed. *Whole* times are by the clock, from the
  first call until the GPU has done everything; one frame is waited for before the next starts, so they are upper bounds of a
  running program's. Stages are measured in frames of their own, by the clock that the head of this page names.
- *Still*: *all new* is everything voxelized and lit again, with all bounces, of which *voxelize* and *light* are the GPU's
  parts; *frame* is a frame of a picture in which nothing changes, of which *trace* is the part of the cones.
- *Moving*: a lamp (or the sun) and a block move in every frame; the frame voxelizes the block, lights the voxels with one more
  bounce (`Gi::frame`), and draws the picture. *Late* frames showed the voxels of an earlier one.
- *Samples* are the steps of the cones' rays in a frame, counted by the shaders; with `~` an estimate (of pictures of which
  one pixel in four is traced).
";

/// The heading of a column, whether it has published figures beside it, and its cells.
type Column = (&'static str, bool, fn(&Figures) -> String);
/// A kind of work: its title, the motion of its cases, and its times.
type Work = (&'static str, Motion, fn(&Figures) -> Option<&Part>);

struct Page<'a> {
    report: &'a Report,
    published: Option<&'a Report>,
}

/// The figures of a case.
fn figures_of<'a>(report: &'a Report, id: &str) -> Option<&'a Figures> {
    report.rows.iter().find(|row| row.id == id)?.figures.as_ref()
}

impl Page<'_> {
    fn head(&self) -> String {
        let Report { machine, timing, version, build, cases, frames, .. } = self.report;
        let limits = &machine.limits;
        let period =
            machine.timestamp_period_ns.map_or("none".to_owned(), |ns| format!("every {ns} ns"));
        let [vendor, device] = machine.vendor_and_device;
        let mut table = Markdown::new(&["", ""]);
        let mut line = |name: &str, value: String| table.row(&[name.to_owned(), value]);
        line("GPU", format!("{} ({}, {vendor:04x}:{device:04x})", machine.name, machine.kind));
        line("API, driver", format!("{}, {}", machine.backend, machine.driver));
        line("system", format!("{}, {} threads", machine.system, machine.cores));
        line("timestamps", period);
        line(
            "largest buffer, storage binding",
            format!("{}, {} bytes", limits.max_buffer_size, limits.max_storage_buffer_binding_size),
        );
        line(
            "largest texture, 2D and 3D",
            format!("{}, {}", limits.max_texture_dimension_2d, limits.max_texture_dimension_3d),
        );
        line(
            "workgroup: storage, invocations",
            format!(
                "{} bytes, {}",
                limits.max_compute_workgroup_storage_size,
                limits.max_compute_invocations_per_workgroup
            ),
        );
        line("times of stages", format!("by {}: {}", timing.method, timing.reason));
        line("cases", format!("{cases}; at most {frames} frames each"));
        line("Lumivox", format!("{version}, {build} build"));
        let mut text = format!(
            "# Speed on {}\n\nMeasured by `lumivox bench`; nothing here is written by hand.\n\n{}\n",
            escaped(&machine.name),
            table.text()
        );
        if build == "debug" {
            text +=
                "**A debug build**: the CPU's share of whole times is larger than a user's.\n\n";
        }
        if let Some(Report { machine, version, .. }) = self.published {
            text += &format!(
                "*Published* are the figures of version {version} on {} ({}).\n\n",
                escaped(&machine.name),
                escaped(&machine.driver)
            );
        }
        text
    }

    /// A table of the still or the moving cases; columns marked as compared are followed by
    /// published figures.
    fn table(&self, motion: Motion, columns: &[Column]) -> String {
        let mut heading = vec!["case"];
        for (name, is_compared, _) in columns {
            heading.push(name);
            if *is_compared && self.published.is_some() {
                heading.push("published");
            }
        }
        let mut table = Markdown::new(&heading);
        for row in self.report.rows.iter().filter(|row| row.motion == motion) {
            let mut cells = vec![format!("`{}`", row.id.trim_end_matches(suffix(motion)))];
            match &row.figures {
                Some(figures) => {
                    let published = self.published.and_then(|report| figures_of(report, &row.id));
                    for (_, is_compared, cell) in columns {
                        cells.push(cell(figures));
                        if *is_compared && self.published.is_some() {
                            cells.push(published.map_or(NONE.to_owned(), cell));
                        }
                    }
                }
                None => cells.push(problem(row)),
            }
            table.row(&cells);
        }
        table.text()
    }

    fn still(&self) -> String {
        let table = self.table(
            Motion::Still,
            &[
                ("voxels", false, |f| f.voxels.to_string()),
                ("memory, MiB", false, |f| {
                    format!("{:.0}", f.memory_bytes as f64 / f64::from(1 << 20))
                }),
                ("voxelize", true, |f| {
                    figure(f.change.as_ref().and_then(|part| part.sum_of(VOXELIZE)))
                }),
                ("light", true, |f| figure(f.change.as_ref().and_then(|part| part.sum_of(LIGHT)))),
                ("all new", true, |f| figure(f.change.as_ref().map(|part| part.whole.median))),
                ("trace", true, |f| figure(f.frame.sum_of(TRACE))),
                ("frame", true, |f| figure(Some(f.frame.whole.median))),
                ("p95", false, |f| figure(Some(f.frame.whole.p95))),
                ("samples", false, samples),
            ],
        );
        format!("## Still\n\n{table}\n")
    }

    fn moving(&self) -> String {
        let table = self.table(
            Motion::Moving,
            &[
                ("voxelize", true, |f| figure(f.frame.sum_of(VOXELIZE))),
                ("light", true, |f| figure(f.frame.sum_of(LIGHT))),
                ("trace", true, |f| figure(f.frame.sum_of(TRACE))),
                ("frame", true, |f| figure(Some(f.frame.whole.median))),
                ("p95", false, |f| figure(Some(f.frame.whole.p95))),
                ("frames", false, |f| f.frame.runs.to_string()),
                ("late", false, |f| f.late_frames.to_string()),
            ],
        );
        format!("## Moving\n\n{table}\n")
    }

    /// All stages of all cases: the median of each.
    fn stages(&self) -> String {
        let mut text = "## Stages\n\n".to_owned();
        let parts: [Work; 3] = [
            ("All new", Motion::Still, |f| f.change.as_ref()),
            ("A still frame", Motion::Still, |f| Some(&f.frame)),
            ("A moving frame", Motion::Moving, |f| Some(&f.frame)),
        ];
        for (title, motion, part) in parts {
            let measured: Vec<(&Row, &Part)> = self
                .report
                .rows
                .iter()
                .filter(|row| row.motion == motion)
                .filter_map(|row| Some((row, part(row.figures.as_ref()?)?)))
                .collect();
            let mut names: Vec<&str> = Vec::new();
            for stage in measured.iter().flat_map(|(_, part)| &part.stages) {
                if !names.contains(&stage.stage.as_str()) {
                    names.push(&stage.stage);
                }
            }
            if measured.is_empty() {
                continue;
            }
            let heading: Vec<&str> =
                [title].into_iter().chain(names.iter().copied()).chain(["sum", "whole"]).collect();
            let mut table = Markdown::new(&heading);
            for (row, part) in measured {
                let mut cells = vec![format!("`{}`", row.id.trim_end_matches(suffix(motion)))];
                cells.extend(names.iter().map(|name| figure(part.sum_of(&[name]))));
                cells.push(figure(part.sum_of(&names)));
                cells.push(figure(Some(part.whole.median)));
                table.row(&cells);
            }
            text += &format!("{}\n", table.text());
        }
        text
    }
}

/// A missing figure.
const NONE: &str = "-";

/// The end of a case's name; tables omit it, since their titles say it.
fn suffix(motion: Motion) -> &'static str {
    match motion {
        Motion::Still => "/still",
        Motion::Moving => "/moving",
    }
}

fn problem(row: &Row) -> String {
    row.problem.clone().unwrap_or_else(|| "not measured".to_owned())
}

/// A figure, such as milliseconds, with three digits, at most two of them decimals.
fn figure(value: Option<f64>) -> String {
    match value {
        None => NONE.to_owned(),
        Some(value) if value >= 99.95 => format!("{value:.0}"),
        Some(value) if value >= 9.995 => format!("{value:.1}"),
        Some(value) => format!("{value:.2}"),
    }
}

fn samples(figures: &Figures) -> String {
    let Some(cones) = figures.cones else { return NONE.to_owned() };
    let about = if cones.is_counted { "" } else { "~" };
    format!("{about}{} M", figure(Some(cones.samples / 1e6)))
}

/// Text for a cell or a line of Markdown: on one line, with `|` escaped.
fn escaped(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    line.replace('|', "\\|")
}

/// A table in Markdown, its columns as wide as their cells.
struct Markdown {
    rows: Vec<Vec<String>>,
}

impl Markdown {
    fn new(heading: &[&str]) -> Self {
        Self { rows: vec![heading.iter().map(|cell| (*cell).to_owned()).collect()] }
    }

    /// Adds a row; missing cells at its end are empty.
    fn row(&mut self, cells: &[String]) {
        let mut cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        cells.resize(self.rows[0].len(), String::new());
        self.rows.push(cells);
    }

    /// The table. The first column is left-aligned, the others right, unless there are only two.
    fn text(&self) -> String {
        let columns = self.rows[0].len();
        // Ignore long cells, which are reasons: they would widen their column.
        let longest = if columns > 2 { 48 } else { usize::MAX };
        let width = |column: usize| {
            let widths = self.rows.iter().map(|row| row[column].chars().count());
            widths.filter(|width| *width <= longest).max().unwrap_or(0).max(3)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let is_left = |column: usize| column == 0 || columns == 2;
        let mut text = String::new();
        for (number, row) in self.rows.iter().enumerate() {
            text.push('|');
            for (column, cell) in row.iter().enumerate() {
                let width = widths[column];
                text += &if is_left(column) {
                    format!(" {cell:<width$} |")
                } else {
                    format!(" {cell:>width$} |")
                };
            }
            text.push('\n');
            if number == 0 {
                text.push('|');
                for (column, width) in widths.iter().enumerate() {
                    let dashes = "-".repeat(width - 1);
                    text += &if is_left(column) {
                        format!(" {dashes}- |")
                    } else {
                        format!(" {dashes}: |")
                    };
                }
                text.push('\n');
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::super::published;
    use super::*;

    #[test]
    fn published_figures_are_shown_beside_the_same_case() {
        let published = published().unwrap();
        let mut report = published.clone();
        "a faster machine".clone_into(&mut report.machine.name);
        for figures in report.rows.iter_mut().filter_map(|row| row.figures.as_mut()) {
            figures.frame.whole.median = 0.123;
        }
        let row = report.rows.iter().find(|row| row.figures.is_some()).unwrap().clone();
        report.rows.retain(|other| other.id == row.id);
        let text = page(&report, Some(&published));
        assert!(
            text.contains("Speed on a faster machine") && text.contains(&published.machine.name)
        );
        let table = text.lines().skip_while(|line| !line.starts_with("| case "));
        let lines: Vec<&str> = table.take_while(|line| line.starts_with('|')).collect();
        let cells = |line: &str| -> Vec<String> {
            line.split('|').map(|cell| cell.trim().to_owned()).collect()
        };
        let (heading, values) = (cells(lines[0]), cells(lines[2]));
        assert_eq!(heading.len(), values.len());
        let frame = heading.iter().position(|name| name == "frame").unwrap();
        assert_eq!((values[frame].as_str(), heading[frame + 1].as_str()), ("0.12", "published"));
        let theirs = published.rows.iter().find(|other| other.id == row.id).unwrap();
        let theirs = theirs.figures.as_ref().unwrap().frame.whole.median;
        assert_eq!(values[frame + 1], figure(Some(theirs)));

        report.rows[0].id.push_str("/of another name");
        assert!(!page(&report, Some(&published)).contains("ublished"));
    }

    #[test]
    fn figures_have_three_digits() {
        let texts = [0.004, 1.005, 9.996, 12.34, 99.96, 12_345.6].map(|value| figure(Some(value)));
        assert_eq!(texts, ["0.00", "1.00", "10.0", "12.3", "100", "12346"]);
        assert_eq!(figure(None), NONE);
    }
}
