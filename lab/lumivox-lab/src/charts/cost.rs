//! Charts of error against cost: which presets and resolutions are worth their cost.
//!
//! Each scene has a row, each cost a column. Settings that no other beats (the Pareto front) have
//! filled marks, joined by steps. Beaten settings have hollow marks above the steps.

use anyhow::ensure;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::{DIM, FONT, INK, SERIES};

/// One setting of the renderer in one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The scene's name.
    pub scene: String,
    /// The preset's name.
    pub preset: String,
    /// Voxels along the longest axis.
    pub resolution: u32,
    /// Milliseconds per frame.
    pub ms: f64,
    /// Cone samples per pixel.
    pub samples: f64,
    /// The error, in percent of the reference's mean.
    pub error_percent: f64,
}

/// The quantity on the horizontal axis.
#[derive(Clone, Copy)]
struct Cost {
    name: &'static str,
    of: fn(&Point) -> f64,
}

const COSTS: [Cost; 2] = [
    Cost { name: "ms per frame", of: |point| point.ms },
    Cost { name: "cone samples per pixel", of: |point| point.samples },
];

/// Width and height of a panel, in pixels.
const PANEL: (u32, u32) = (460, 320);
/// Height of the heading with the legend.
const HEAD: u32 = 66;
const FRONT: RGBColor = RGBColor(170, 170, 176);

/// Draws error against cost as an SVG, one row of panels for each scene.
///
/// # Errors
/// When there are no points, a cost is not positive, or an error is negative.
pub fn error_against_cost(points: &[Point]) -> anyhow::Result<String> {
    ensure!(!points.is_empty(), "there are no measurements to draw");
    for point in points {
        let Point { scene, preset, resolution, error_percent, .. } = point;
        let is_sound =
            COSTS.iter().all(|cost| (cost.of)(point).is_finite() && (cost.of)(point) > 0.0);
        ensure!(
            is_sound && error_percent.is_finite() && *error_percent >= 0.0,
            "{scene}, {preset} at {resolution} voxels: costs must be above 0 and the error at least \
             0, but it has {} ms, {} samples and {error_percent} %; measure it again",
            point.ms,
            point.samples
        );
    }
    let scenes = distinct(points.iter().map(|point| point.scene.as_str()));
    let presets = distinct(points.iter().map(|point| point.preset.as_str()));
    let size = (PANEL.0 * COSTS.len() as u32, HEAD + PANEL.1 * scenes.len() as u32);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, body) = root.split_vertically(HEAD);
        draw_legend(&head, &presets)?;
        let panels = body.split_evenly((scenes.len(), COSTS.len()));
        for (scene, row) in scenes.iter().zip(panels.chunks_exact(COSTS.len())) {
            let points: Vec<&Point> = points.iter().filter(|point| point.scene == *scene).collect();
            for (panel, cost) in row.iter().zip(COSTS) {
                draw_panel(panel, scene, cost, &points, &presets)?;
            }
        }
        root.present()?;
    }
    Ok(svg)
}

/// The distinct names, in the order in which they first occur.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut distinct = Vec::new();
    for name in names {
        if !distinct.contains(&name) {
            distinct.push(name);
        }
    }
    distinct
}

/// The points on the Pareto front, in the order of their cost: no other point has less error or
/// cost without more of the other.
fn front<'a>(points: &[&'a Point], cost: Cost) -> Vec<&'a Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| {
        let by_cost = (cost.of)(a).total_cmp(&(cost.of)(b));
        by_cost.then(a.error_percent.total_cmp(&b.error_percent))
    });
    let mut front: Vec<&Point> = Vec::new();
    for point in sorted {
        let is_beaten = front.last().is_some_and(|last| {
            let is_equal = at(last, cost) == at(point, cost);
            last.error_percent <= point.error_percent && !is_equal
        });
        if !is_beaten {
            front.push(point);
        }
    }
    front
}

/// The position of a point in a panel.
fn at(point: &Point, cost: Cost) -> (f64, f64) {
    ((cost.of)(point), point.error_percent)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

fn font(size: f64, color: RGBColor) -> TextStyle<'static> {
    (FONT, size).into_font().color(&color)
}

fn color_of(preset: &str, presets: &[&str]) -> RGBColor {
    let index = presets.iter().position(|name| *name == preset).unwrap_or(0);
    SERIES[index % SERIES.len()]
}

fn draw_legend(head: &Area<'_>, presets: &[&str]) -> anyhow::Result<()> {
    head.draw(&Text::new("Error against cost", (16, 12), font(24.0, INK)))?;
    let mut x = 16;
    let mut entry = |text: &str, mark: &dyn Fn(i32) -> anyhow::Result<()>| {
        mark(x)?;
        head.draw(&Text::new(text.to_owned(), (x + 12, 42), font(17.0, INK)))?;
        x += 34 + 7 * text.chars().count() as i32;
        anyhow::Ok(())
    };
    for preset in presets {
        let color = color_of(preset, presets);
        entry(preset, &|x| Ok(head.draw(&Circle::new((x + 3, 48), 5, color.filled()))?))?;
    }
    entry("beaten by another", &|x| {
        Ok(head.draw(&Circle::new((x + 3, 48), 5, DIM.stroke_width(2)))?)
    })?;
    entry("best at its cost (numbers: voxels along the longest axis)", &|x| {
        let line = vec![(x - 6, 52), (x + 2, 52), (x + 2, 44), (x + 8, 44)];
        Ok(head.draw(&PathElement::new(line, FRONT.stroke_width(3)))?)
    })
}

fn draw_panel(
    area: &Area<'_>,
    scene: &str,
    cost: Cost,
    points: &[&Point],
    presets: &[&str],
) -> anyhow::Result<()> {
    let costs = || points.iter().map(|point| (cost.of)(point));
    let (least, most) = (costs().fold(f64::MAX, f64::min), costs().fold(0.0, f64::max));
    // The margin has room for marks and labels, and for a tick or two if all costs are equal.
    let (left, right) = (least / 1.5, most * 1.9);
    let top = points.iter().map(|point| point.error_percent).fold(0.0, f64::max);
    let top = if top > 0.0 { 1.15 * top } else { 1.0 };

    let mut chart = ChartBuilder::on(area)
        .caption(scene, font(19.0, INK))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(52)
        .build_cartesian_2d(
            (left..right).log_scale().with_key_points(ticks(left, right)),
            0.0..top,
        )?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(232, 232, 236))
        .axis_style(DIM)
        .label_style(font(15.0, DIM))
        .axis_desc_style(font(16.0, INK))
        .x_label_formatter(&|value| short(*value))
        .y_label_formatter(&|value| short(*value))
        .x_desc(cost.name)
        .y_desc("error, % of the mean")
        .draw()?;

    let front = front(points, cost);
    let steps = steps(&front.iter().map(|point| at(point, cost)).collect::<Vec<_>>(), top, right);
    chart.draw_series(LineSeries::new(steps, FRONT.stroke_width(3)))?;
    for preset in presets {
        let color = color_of(preset, presets);
        let mut series: Vec<&Point> =
            points.iter().copied().filter(|point| point.preset == *preset).collect();
        series.sort_by_key(|point| point.resolution);
        let line = series.iter().map(|point| at(point, cost));
        chart.draw_series(LineSeries::new(line, color.mix(0.5)))?;
        for point in series {
            let is_best = front.contains(&point);
            let style = if is_best { color.filled() } else { color.stroke_width(2) };
            let inside = if is_best { color } else { WHITE };
            let label = Text::new(point.resolution.to_string(), (8, -14), font(14.0, color));
            let mark = EmptyElement::at(at(point, cost))
                + Circle::new((0, 0), 5, inside.filled())
                + Circle::new((0, 0), 5, style)
                + label;
            chart.draw_series(std::iter::once(mark))?;
        }
    }
    Ok(())
}

/// The numbers 1, 2 and 5 times powers of ten between two numbers.
fn ticks(left: f64, right: f64) -> Vec<f64> {
    let decades = left.log10().floor() as i32..=right.log10().floor() as i32;
    let ticks = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(decade)));
    ticks.filter(|tick| (left..right).contains(tick)).collect()
}

/// A number, rounded to three decimals.
fn short(value: f64) -> String {
    format!("{}", (value * 1e3).round() / 1e3)
}

/// The lower left edge of the area that the front beats, from the panel's top edge to its right
/// edge.
fn steps(front: &[(f64, f64)], top: f64, right: f64) -> Vec<(f64, f64)> {
    let mut steps = Vec::new();
    let mut height = top;
    for &(cost, error) in front {
        steps.extend([(cost, height), (cost, error)]);
        height = error;
    }
    steps.push((right, height));
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(preset: &str, resolution: u32, ms: f64, error_percent: f64) -> Point {
        let [scene, preset] = ["cornell", preset].map(str::to_owned);
        Point { scene, preset, resolution, ms, samples: 10.0 * ms, error_percent }
    }

    fn resolutions(points: &[Point]) -> Vec<u32> {
        let points: Vec<&Point> = points.iter().collect();
        front(&points, COSTS[0]).iter().map(|point| point.resolution).collect()
    }

    #[test]
    fn the_front_keeps_points_that_no_other_dominates() {
        let points = [
            point("a", 4, 8.0, 1.0),
            point("a", 1, 1.0, 9.0),
            point("b", 2, 2.0, 9.0), // costs more than 1 for the same
            point("b", 3, 4.0, 3.0),
            point("b", 5, 5.0, 4.0), // worse than 3 in both
            point("b", 6, 8.0, 2.0), // worse than 4 for the same
        ];
        assert_eq!(resolutions(&points), [1, 3, 4]);
        // Neither of two equal points beats the other.
        assert_eq!(resolutions(&[point("a", 1, 1.0, 2.0), point("b", 2, 1.0, 2.0)]), [1, 2]);
        assert_eq!(resolutions(&points[..1]), [4]);
    }

    #[test]
    fn steps_outline_the_region_of_dominated_points() {
        let steps = steps(&[(1.0, 9.0), (4.0, 3.0)], 10.0, 20.0);
        assert_eq!(steps, [(1.0, 10.0), (1.0, 9.0), (4.0, 9.0), (4.0, 3.0), (20.0, 3.0)]);
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(18.0, 53.0), [20.0, 50.0]);
        assert_eq!(ticks(0.9, 10.5), [1.0, 2.0, 5.0, 10.0]);
        assert_eq!(short(0.300_000_000_04), "0.3");
        assert_eq!(short(1000.0), "1000");
    }

    #[test]
    fn scenes_presets_and_resolutions_are_in_the_chart() {
        let mut points: Vec<Point> = vec![
            point("fast", 64, 2.0, 8.0),
            point("fast", 128, 3.0, 6.0),
            point("balanced", 64, 4.0, 7.0),
        ];
        points.push(Point { scene: "atrium <1>".to_owned(), ..point("high", 256, 20.0, 2.0) });
        let svg = error_against_cost(&points).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        let texts: Vec<&str> = svg.lines().map(str::trim).collect();
        let count = |text: &str| texts.iter().filter(|line| **line == text).count();
        for (text, expected) in [
            ("cornell", 2),
            ("atrium &lt;1&gt;", 2),
            ("fast", 1),
            ("balanced", 1),
            ("high", 1),
            ("128", 2),
            ("256", 2),
            ("ms per frame", 2),
            ("cone samples per pixel", 2),
        ] {
            assert_eq!(count(text), expected, "{text} in {svg}");
        }
        // The legend and two panels; the third preset has the third colour.
        let marks = |color: &str| {
            let is = |line: &&&str| line.starts_with("<circle") && line.contains(color);
            texts.iter().filter(is).count()
        };
        assert!(marks("#009E73") >= 3, "{svg}");
        assert_eq!(error_against_cost(&points).unwrap(), svg);
    }

    #[test]
    fn what_cannot_be_drawn_is_named() {
        assert!(error_against_cost(&[]).is_err());
        for bad in [
            point("fast", 64, 0.0, 1.0),
            point("fast", 64, f64::NAN, 1.0),
            point("fast", 64, 1.0, -1.0),
            point("fast", 64, 1.0, f64::INFINITY),
        ] {
            let error = error_against_cost(&[bad]).unwrap_err().to_string();
            assert!(error.contains("cornell, fast at 64 voxels"), "{error}");
        }
        // A single point with an error of 0 is valid.
        error_against_cost(&[point("fast", 64, 1.0, 0.0)]).unwrap();
    }
}
