//! A chart of the memory of volumes against their resolution.

use anyhow::ensure;
use plotters::prelude::*;

use super::{DIM, FONT, INK, SERIES};

/// The memory of one volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryPoint {
    /// The kind of volume.
    pub volume: &'static str,
    /// Voxels along the longest axis.
    pub resolution: u32,
    /// The volume's size in bytes.
    pub bytes: u64,
    /// `true` if `bytes` was measured; `false` if the volume did not fit, and `bytes` was computed.
    pub is_measured: bool,
}

const SIZE: (u32, u32) = (620, 420);
const MIB: f64 = 1_048_576.0;

/// Draws the chart as SVG. Both axes are logarithmic: a power law is a straight line, and its slope
/// the exponent.
///
/// # Errors
/// When there are no points.
pub fn memory_against_resolution(scene: &str, points: &[MemoryPoint]) -> anyhow::Result<String> {
    ensure!(!points.is_empty(), "there are no measurements to draw");
    let least = |of: &dyn Fn(&MemoryPoint) -> f64| points.iter().map(of).fold(f64::MAX, f64::min);
    let most = |of: &dyn Fn(&MemoryPoint) -> f64| points.iter().map(of).fold(0.0, f64::max);
    let x = |point: &MemoryPoint| f64::from(point.resolution);
    let y = |point: &MemoryPoint| point.bytes.max(1) as f64 / MIB;
    let mut resolutions: Vec<f64> = points.iter().map(x).collect();
    resolutions.sort_by(f64::total_cmp);
    resolutions.dedup();
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption(format!("Memory of the volume: {scene}"), (FONT, 22.0).into_font().color(&INK))
            .margin(14)
            .x_label_area_size(46)
            .y_label_area_size(70)
            .build_cartesian_2d(
                (least(&x) / 1.2..most(&x) * 1.2).log_scale().with_key_points(resolutions),
                (least(&y) / 2.0..most(&y) * 2.0).log_scale(),
            )?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(232, 232, 236))
            .axis_style(DIM)
            .label_style((FONT, 15.0).into_font().color(&DIM))
            .axis_desc_style((FONT, 16.0).into_font().color(&INK))
            .x_label_formatter(&|value| format!("{value:.0}"))
            .y_label_formatter(&|value| format!("{value}"))
            .x_desc("voxels along the longest axis")
            .y_desc("MiB")
            .draw()?;
        let mut volumes: Vec<&str> = points.iter().map(|point| point.volume).collect();
        volumes.dedup();
        volumes.sort_unstable();
        volumes.dedup();
        for (index, volume) in volumes.iter().enumerate() {
            let color = SERIES[index % SERIES.len()];
            let mut series: Vec<&MemoryPoint> =
                points.iter().filter(|point| point.volume == *volume).collect();
            series.sort_by_key(|point| point.resolution);
            let line = series.iter().map(|point| (x(point), y(point)));
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))?
                .label(*volume)
                .legend(move |(x, y)| Circle::new((x + 8, y), 5, color.filled()));
            for point in series {
                let style = if point.is_measured { color.filled() } else { color.stroke_width(2) };
                let inside = if point.is_measured { color } else { WHITE };
                let mark = EmptyElement::at((x(point), y(point)))
                    + Circle::new((0, 0), 5, inside.filled())
                    + Circle::new((0, 0), 5, style);
                chart.draw_series(std::iter::once(mark))?;
            }
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE)
            .border_style(RGBColor(210, 210, 216))
            .label_font((FONT, 16.0).into_font().color(&INK))
            .draw()?;
        root.present()?;
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_and_resolutions_are_in_the_chart() {
        let point = |volume, resolution, mib: u64, is_measured| MemoryPoint {
            volume,
            resolution,
            bytes: mib << 20,
            is_measured,
        };
        let points = [
            point("dense", 64, 20, true),
            point("octree", 64, 4, true),
            point("dense", 512, 11_000, false),
            point("octree", 512, 250, true),
        ];
        let svg = memory_against_resolution("a hall", &points).unwrap();
        for text in ["dense", "octree", "64", "512", "Memory of the volume: a hall"] {
            assert!(svg.lines().any(|line| line.trim() == text), "{text} in {svg}");
        }
        // A hollow mark for a volume that did not fit: white inside.
        let hollow = |line: &&str| line.starts_with("<circle") && line.contains("#FFFFFF");
        assert_eq!(svg.lines().filter(hollow).count(), 1, "{svg}");
        assert!(memory_against_resolution("nothing", &[]).is_err());
    }
}
