//! The caller's lines, and the grid's box.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lumivox::Grid;
use lumivox::gpu::pipelines::DrawPipeline;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, LayoutBuilder, Pipelines, RenderPass, ShaderError, ShaderLibrary,
    upload,
};
use lumivox_scene::Bounds;

use super::{GRID_BOX_COLOR, HIDDEN_SHARE, LINE_WIDTH, Overlay, OverlayLine, segment};
use crate::scene::corners;

/// `Line` of `lines.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LineRecord {
    pub(crate) from_in_world: [f32; 3],
    pub(crate) is_tested: u32,
    pub(crate) to_in_world: [f32; 3],
    pub(crate) width: f32,
    pub(crate) color: [f32; 4],
}

/// Draws lines.
#[derive(Debug)]
pub(super) struct Lines {
    pipeline: DrawPipeline,
    layout: wgpu::BindGroupLayout,
    group: BindGroup,
    count: u32,
}

impl Lines {
    /// # Errors
    /// When the shader does not link.
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        view: &wgpu::BindGroupLayout,
        lines: &[OverlayLine],
    ) -> Result<Self, ShaderError> {
        let shader = device.shader(shaders, "render::passes::overlay::lines")?;
        let layout =
            LayoutBuilder::new(wgpu::ShaderStages::VERTEX).storage().build(device, "lines");
        let entries = ("line_vertex", "line_fragment");
        let pipeline = segment::pipeline(device, &shader, entries, [view, &layout])?;
        let group = group(device, &layout, lines);
        Ok(Self { pipeline, layout, group, count: lines.len() as u32 })
    }

    /// Replaces the lines.
    pub(super) fn set(&mut self, device: &wgpu::Device, lines: &[OverlayLine]) {
        self.group = group(device, &self.layout, lines);
        self.count = lines.len() as u32;
    }

    /// Draws the lines, within a pass whose group 0 is bound.
    pub(super) fn draw(&self, pass: &mut RenderPass<'_>) {
        if self.count == 0 {
            // The buffer is shorter than one line if there are no lines.
            return;
        }
        pass.set_pipeline(&self.pipeline);
        pass.bind(1, &self.group);
        pass.draw(0..6 * self.count, 0..1);
    }
}

fn group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    lines: &[OverlayLine],
) -> BindGroup {
    let record = |line: &OverlayLine| LineRecord {
        from_in_world: line.from.to_array(),
        is_tested: u32::from(line.is_hidden_by_surfaces),
        to_in_world: line.to.to_array(),
        width: LINE_WIDTH,
        color: line.color,
    };
    let records: Vec<LineRecord> = lines.iter().map(record).collect();
    BindGroupBuilder::new(layout).buffer(&upload(device, "lines", &records)).build(device, "lines")
}

/// All lines of an overlay, in drawing order.
pub(super) fn all(overlay: &Overlay, grid: &Grid) -> Vec<OverlayLine> {
    let edges = if overlay.grid_box { box_edges(grid) } else { Vec::new() };
    let edge = |(from, to), share: f32, is_hidden_by_surfaces| {
        let [r, g, b, a] = GRID_BOX_COLOR;
        OverlayLine { from, to, color: [r, g, b, a * share], is_hidden_by_surfaces }
    };
    let faint = edges.iter().map(|&ends| edge(ends, HIDDEN_SHARE, false));
    let full = edges.iter().map(|&ends| edge(ends, 1.0, true));
    faint.chain(full).chain(overlay.lines.iter().copied()).collect()
}

/// The twelve edges of the grid's bounds, or of each cascade's bounds.
fn box_edges(grid: &Grid) -> Vec<(Vec3, Vec3)> {
    let edges = |(min, max)| {
        let corners = corners(Bounds { min, max });
        let pairs = (0..8_usize).flat_map(|from| [1, 2, 4].map(|axis| (from, from | axis)));
        let pairs = pairs.filter(|(from, to)| from != to);
        pairs.map(move |(from, to)| (corners[from], corners[to]))
    };
    grid.boxes_in_world().into_iter().flat_map(edges).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_along_the_axes() {
        let grid = Grid::fit(Vec3::ZERO, Vec3::new(2.0, 1.0, 1.0), 32, Vec3::ZERO).expect("a grid");
        let edges = box_edges(&grid);
        assert_eq!(edges.len(), 12);
        let size = grid.dimensions.as_vec3() * grid.voxel_size_m;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let along =
                edges.iter().filter(|(from, to)| (*to - *from).abs_diff_eq(axis * size, 1e-5));
            assert_eq!(along.count(), 4);
        }
    }

    #[test]
    fn the_callers_lines_come_last() {
        let line = OverlayLine {
            from: Vec3::ZERO,
            to: Vec3::X,
            color: [1.0; 4],
            is_hidden_by_surfaces: false,
        };
        let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 32, Vec3::ZERO).expect("a grid");
        let overlay = Overlay { grid_box: true, lines: vec![line], ..Overlay::default() };
        let lines = all(&overlay, &grid);
        assert_eq!((lines.len(), lines[24]), (25, line));
        assert_eq!(all(&Overlay::default(), &grid), []);
    }
}
