//! A chart of the error at each step of sequences: a panel for each, a line for each preset.

use anyhow::ensure;
use plotters::prelude::*;

use super::{DIM, FONT, INK, SERIES};

/// The errors of one sequence.
#[derive(Clone, Debug)]
pub struct StepPanel {
    /// Its name.
    pub name: String,
    /// For each preset its name, and the errors in percent by step number.
    pub lines: Vec<(String, Vec<(u32, f64)>)>,
}

const PANEL: (u32, u32) = (460, 250);
const HEAD: u32 = 50;
const COLUMNS: usize = 2;

/// Draws the panels as SVG, two side by side. Axes begin at 0.
///
/// # Errors
/// When there are no panels, or an error is not a finite number of at least 0.
pub fn error_by_step(title: &str, panels: &[StepPanel]) -> anyhow::Result<String> {
    ensure!(!panels.is_empty(), "there are no measurements to draw");
    for (panel, (_, line)) in panels.iter().flat_map(|p| p.lines.iter().map(move |l| (p, l))) {
        let bad = line.iter().find(|(_, error)| !error.is_finite() || *error < 0.0);
        ensure!(bad.is_none(), "{}: {bad:?} cannot be drawn; measure it again", panel.name);
    }
    let mut presets: Vec<&str> = Vec::new();
    for (preset, _) in panels.iter().flat_map(|panel| &panel.lines) {
        if !presets.contains(&preset.as_str()) {
            presets.push(preset);
        }
    }
    let color = |preset: &str| {
        let index = presets.iter().position(|name| *name == preset).unwrap_or(0);
        SERIES[index % SERIES.len()]
    };
    let rows = panels.len().div_ceil(COLUMNS);
    let size = (PANEL.0 * COLUMNS as u32, HEAD + PANEL.1 * rows as u32);
    let font = |size: f64, color: RGBColor| (FONT, size).into_font().color(&color);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, body) = root.split_vertically(HEAD);
        head.draw(&Text::new(title.to_owned(), (16, 14), font(20.0, INK)))?;
        let mut x = PANEL.0 as i32 + 60;
        for preset in &presets {
            head.draw(&Circle::new((x, 24), 5, color(preset).filled()))?;
            head.draw(&Text::new((*preset).to_owned(), (x + 10, 16), font(16.0, INK)))?;
            x += 40 + 8 * preset.len() as i32;
        }
        for (area, panel) in body.split_evenly((rows, COLUMNS)).iter().zip(panels) {
            let points = || panel.lines.iter().flat_map(|(_, line)| line);
            let last = points().map(|(step, _)| f64::from(*step)).fold(1.0, f64::max);
            let top = points().map(|(_, error)| *error).fold(0.0, f64::max);
            let top = if top > 0.0 { 1.1 * top } else { 1.0 };
            let mut chart = ChartBuilder::on(area)
                .caption(&panel.name, font(18.0, INK))
                .margin(10)
                .x_label_area_size(36)
                .y_label_area_size(50)
                .build_cartesian_2d(0.0..last, 0.0..top)?;
            chart
                .configure_mesh()
                .light_line_style(TRANSPARENT)
                .bold_line_style(RGBColor(232, 232, 236))
                .axis_style(DIM)
                .label_style(font(14.0, DIM))
                .axis_desc_style(font(15.0, INK))
                .x_labels(8)
                .y_labels(5)
                .x_label_formatter(&|value| format!("{value:.0}"))
                .y_label_formatter(&|value| format!("{value:.0}"))
                .x_desc("step")
                .y_desc("RMSE, % of the mean")
                .draw()?;
            for (preset, line) in &panel.lines {
                let line = line.iter().map(|(step, error)| (f64::from(*step), *error));
                chart.draw_series(LineSeries::new(line, color(preset).stroke_width(2)))?;
            }
        }
        root.present()?;
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(name: &str, lines: &[(&str, &[(u32, f64)])]) -> StepPanel {
        let lines = lines.iter().map(|(preset, line)| ((*preset).to_owned(), line.to_vec()));
        StepPanel { name: name.to_owned(), lines: lines.collect() }
    }

    #[test]
    fn every_sequence_has_a_panel_and_every_preset_a_line() {
        let panels = [
            panel(
                "orbit",
                &[("fast", &[(1, 30.0), (2, 31.0)]), ("balanced", &[(1, 10.0), (2, 9.0)])],
            ),
            panel("switch", &[("balanced", &[(1, 10.0), (2, 5.0)])]),
        ];
        let svg = error_by_step("RMSE at each step", &panels).unwrap();
        for (text, count) in [("orbit", 1), ("switch", 1), ("fast", 1), ("step", 2)] {
            assert_eq!(svg.lines().filter(|line| line.trim() == text).count(), count, "{text}");
        }
        let lines = svg.matches("<polyline").count();
        // The axes of the panels count, too.
        assert!(lines >= 3, "{lines}");
        assert_eq!(svg, error_by_step("RMSE at each step", &panels).unwrap());
    }

    #[test]
    fn what_cannot_be_drawn_is_named() {
        assert!(error_by_step("nothing", &[]).is_err());
        let bad = panel("lamp", &[("fast", &[(1, f64::NAN)])]);
        let error = error_by_step("bad", &[bad]).unwrap_err().to_string();
        assert!(error.contains("lamp"), "{error}");
    }
}
