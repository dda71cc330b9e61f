//! The output of commands: tables for people, structures for JSON.

use std::collections::BTreeMap;

use lumivox::gpu::StageTime;
use lumivox::{Gi, Grid};
use lumivox_render::{MemoryUse, Renderer, StreamedGeometry, describe};
use lumivox_scene::Scene;
use serde::Serialize;

use crate::shown;

/// Rows of aligned cells. The first column is left-aligned, the others right or left.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
    is_left: bool,
}

impl Table {
    /// A table with a heading; cells may be empty.
    pub fn new(heading: &[&str]) -> Self {
        let heading = heading.iter().map(|cell| (*cell).to_owned()).collect();
        Self { rows: vec![heading], is_left: false }
    }

    /// A table with a heading and all columns left-aligned, for words.
    pub fn left(heading: &[&str]) -> Self {
        Self { is_left: true, ..Self::new(heading) }
    }

    /// Rows below the heading.
    pub fn row_count(&self) -> usize {
        self.rows.len().saturating_sub(1)
    }

    /// The table, or its first rows and the number of the others.
    pub fn text_of(&self, most: usize) -> String {
        let rows = self.rows.iter().take(most + 1).cloned().collect();
        let mut text = Self { rows, is_left: self.is_left }.text();
        if self.row_count() > most {
            text += &format!("  and {} more; --json has all\n", self.row_count() - most);
        }
        text
    }

    /// Adds a row. Line feeds in names are escaped.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.map(|cell| shown::line(&cell).into_owned()).into());
    }

    /// The table, each line indented by two spaces.
    pub fn text(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::from(" ");
            for (column, cell) in row.iter().enumerate() {
                let width = widths[column];
                line += &match column {
                    0 => format!(" {cell:<width$}"),
                    _ if self.is_left => format!("  {cell:<width$}"),
                    _ => format!("  {cell:>width$}"),
                };
            }
            text += line.trim_end();
            text.push('\n');
        }
        text
    }
}

/// Bytes for people, in binary units.
pub fn bytes(count: u64) -> String {
    let value = count as f64;
    match count {
        0..1024 => format!("{count} B"),
        1024..0x10_0000 => format!("{:.1} KiB", value / 1024.0),
        0x10_0000..0x4000_0000 => format!("{:.1} MiB", value / f64::from(1 << 20)),
        _ => format!("{:.2} GiB", value / f64::from(1 << 30)),
    }
}

/// A count with its digits in groups of three.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

/// `1 face`, `2 faces`.
pub fn counted(value: usize, one: &str, many: &str) -> String {
    format!("{} {}", count(value as u64), if value == 1 { one } else { many })
}

/// The GPU in use.
#[derive(Clone, Debug, Serialize)]
pub struct AdapterReport {
    /// Its name.
    pub name: String,
    /// The kind (`discrete GPU` and so on), the API and the driver as a text.
    pub description: String,
    /// The API.
    pub backend: String,
    /// The driver's name and version.
    pub driver: String,
    /// `DiscreteGpu`, `IntegratedGpu`, `VirtualGpu`, `Cpu` or `Other`.
    pub kind: String,
}

impl AdapterReport {
    /// The report on an adapter.
    pub fn new(info: &wgpu::AdapterInfo) -> Self {
        Self {
            name: info.name.clone(),
            description: describe(info),
            backend: format!("{:?}", info.backend),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            kind: format!("{:?}", info.device_type),
        }
    }
}

/// The number of things in a scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneCounts {
    /// Its name.
    pub name: String,
    /// Triangles, each counted once per instance.
    pub triangles: usize,
    /// Meshes, each once.
    pub meshes: usize,
    /// Placed meshes that are not hidden.
    pub instances: usize,
    /// Materials.
    pub materials: usize,
    /// Textures.
    pub textures: usize,
    /// Lights.
    pub lights: usize,
    /// Cameras.
    pub cameras: usize,
}

impl SceneCounts {
    /// Counts a scene's things.
    pub fn new(scene: &Scene) -> Self {
        Self {
            name: scene.name.clone(),
            triangles: scene.triangle_count(),
            meshes: scene.meshes.len(),
            instances: scene.shown().count(),
            materials: scene.materials.len(),
            textures: scene.textures.len(),
            lights: scene.lights.len(),
            cameras: scene.cameras.len(),
        }
    }
}

/// The size of an octree, and how it was built.
#[derive(Clone, Debug, Serialize)]
pub struct OctreeReport {
    /// Slots for nodes: eight per group.
    pub nodes: u64,
    /// Groups of eight nodes, including the root's.
    pub groups: u32,
    /// Bricks of 3x3x3 texels.
    pub bricks: u32,
    /// How the nodes were built: `ranks`, or the name of another builder.
    pub builder: &'static str,
    /// The builder's counters, by its names for them.
    #[serde(flatten)]
    pub counts: BTreeMap<&'static str, u64>,
}

impl OctreeReport {
    /// The report on the octree, if there is one with voxels.
    pub fn new(gi: &Gi) -> Option<Self> {
        let stats = gi.octree_stats()?;
        let builder = gi.config().octree_builder.as_ref();
        Some(Self {
            nodes: 8 * u64::from(stats.groups),
            groups: stats.groups,
            bricks: stats.bricks,
            builder: builder.map_or("ranks", |builder| builder.name()),
            counts: stats.counts.into_iter().collect(),
        })
    }

    /// A summary in one line.
    pub fn line(&self) -> String {
        let named = |(name, n): (&&str, &u64)| format!("{} {}", name.replace('_', " "), count(*n));
        let counts: Vec<String> = self.counts.iter().map(named).collect();
        let counts =
            if counts.is_empty() { String::new() } else { format!(" ({})", counts.join(", ")) };
        format!(
            "octree   {} in {}, {}; built by {}{counts}",
            counted(self.nodes as usize, "node", "nodes"),
            counted(self.groups as usize, "group", "groups"),
            counted(self.bricks as usize, "brick", "bricks"),
            self.builder
        )
    }
}

/// The box of the grid.
#[derive(Clone, Debug, Serialize)]
pub struct GridReport {
    /// Voxels along x, y and z; with cascades, of each cascade.
    pub dimensions: [u32; 3],
    /// The corner with the smallest coordinates, in the world, m; with cascades, of the outermost.
    pub origin: [f32; 3],
    /// The edge of a voxel, m; with cascades, of the finest.
    pub voxel_size_m: f32,
    /// Levels of the pyramid.
    pub levels: u32,
    /// Number of cascades; 0 if one box is fitted to the scene.
    pub cascades: u32,
}

impl GridReport {
    /// The report on a grid.
    pub fn new(grid: &Grid) -> Self {
        Self {
            dimensions: grid.box_dimensions().to_array(),
            origin: grid.min_in_world().to_array(),
            voxel_size_m: grid.voxel_size_m,
            levels: grid.levels,
            cascades: grid.cascades.map_or(0, |cascades| cascades.count),
        }
    }

    /// The size in words.
    pub fn size(&self) -> String {
        let [x, y, z] = self.dimensions;
        match self.cascades {
            0 => format!("{x} x {y} x {z} of {:.4} m", self.voxel_size_m),
            count => format!(
                "{} of {x} x {y} x {z} from {:.4} m on",
                counted(count as usize, "cascade", "cascades"),
                self.voxel_size_m
            ),
        }
    }
}

/// How much of a scene's geometry is on the GPU, under a budget of geometry.
#[derive(Clone, Debug, Serialize)]
pub struct GeometryReport {
    /// Bytes of all vertices and indices.
    pub bytes: u64,
    /// Bytes of vertices and indices on the GPU.
    pub resident_bytes: u64,
    /// Triangles of all meshes, each counted once.
    pub triangles: u64,
    /// Triangles on the GPU, the nearest to the camera; each counted once.
    pub resident_triangles: u64,
}

impl GeometryReport {
    /// The report on a renderer; `None` without a budget of geometry.
    pub fn new(renderer: &Renderer) -> Option<Self> {
        let StreamedGeometry { bytes, resident_bytes, triangles, resident_triangles, .. } =
            renderer.streamed()?;
        Some(Self { bytes, resident_bytes, triangles, resident_triangles })
    }

    /// In words.
    pub fn line(&self) -> String {
        let lacking = self.triangles - self.resident_triangles;
        format!(
            "{} of {} on the GPU: {} of {} triangles of meshes are too far away, and left out",
            bytes(self.resident_bytes),
            bytes(self.bytes),
            count(lacking),
            count(self.triangles)
        )
    }
}

/// GPU memory of one item.
#[derive(Clone, Debug, Serialize)]
pub struct MemoryReport {
    /// Its name.
    pub name: String,
    /// Bytes.
    pub bytes: u64,
}

impl From<MemoryUse> for MemoryReport {
    fn from(memory: MemoryUse) -> Self {
        Self { name: memory.name, bytes: memory.bytes }
    }
}

/// The sum.
pub fn total_bytes(memory: &[MemoryReport]) -> u64 {
    memory.iter().map(|part| part.bytes).sum()
}

/// A table of GPU memory with its total; rows of zero bytes are left out.
pub fn memory_table(memory: &[MemoryReport]) -> String {
    let mut table = Table::new(&["GPU memory", "bytes", ""]);
    for part in memory.iter().filter(|part| part.bytes > 0) {
        table.row([part.name.clone(), count(part.bytes), bytes(part.bytes)]);
    }
    let total = total_bytes(memory);
    table.row(["total".to_owned(), count(total), bytes(total)]);
    table.text()
}

/// The GPU time of one pass, or of a stage: the sum of its passes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeReport {
    /// The stage.
    pub stage: String,
    /// The pass; absent for the stage as a whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pass: Option<String>,
    /// Milliseconds.
    pub ms: f64,
}

/// The times of stages and passes, in order.
#[derive(Clone, Debug, Serialize)]
pub struct TimesReport {
    /// Sums by stage.
    pub stages: Vec<TimeReport>,
    /// Each pass by itself.
    pub passes: Vec<TimeReport>,
}

impl TimesReport {
    /// Sums by stage and by pass, each in the order in which they first ran.
    pub fn new(times: &[StageTime]) -> Self {
        let mut sums = Self { stages: Vec::new(), passes: Vec::new() };
        for time in times {
            let ms = time.duration.as_secs_f64() * 1e3;
            add(&mut sums.stages, time.stage, None, ms);
            add(&mut sums.passes, time.stage, Some(&time.pass), ms);
        }
        sums
    }

    /// A table of stages, each followed by its passes.
    pub fn table(&self, heading: &str) -> String {
        let mut table = Table::new(&[heading, "ms"]);
        for stage in &self.stages {
            table.row([stage.stage.clone(), format!("{:.3}", stage.ms)]);
            for pass in self.passes.iter().filter(|pass| pass.stage == stage.stage) {
                let name = pass.pass.as_deref().unwrap_or_default();
                table.row([format!("    {name}"), format!("{:.3}", pass.ms)]);
            }
        }
        table.text()
    }
}

fn add(sums: &mut Vec<TimeReport>, stage: &str, pass: Option<&str>, ms: f64) {
    match sums.iter_mut().find(|sum| sum.stage == stage && sum.pass.as_deref() == pass) {
        Some(sum) => sum.ms += ms,
        None => {
            sums.push(TimeReport { stage: stage.to_owned(), pass: pass.map(str::to_owned), ms });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn tables_are_aligned() {
        let mut table = Table::new(&["thing", "size"]);
        table.row(["a wall".to_owned(), "5".to_owned()]);
        table.row(["é".to_owned(), "12345".to_owned()]);
        assert_eq!(table.text(), "  thing    size\n  a wall      5\n  é       12345\n");
    }

    #[test]
    fn byte_sizes_and_counts_are_formatted_for_reading() {
        assert_eq!(bytes(1023), "1023 B");
        assert_eq!(bytes(1536), "1.5 KiB");
        assert_eq!(bytes(115 << 20), "115.0 MiB");
        assert_eq!(bytes(3 << 29), "1.50 GiB");
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(1_234_567), "1 234 567");
        assert_eq!(counted(1, "face", "faces"), "1 face");
        assert_eq!(counted(2000, "face", "faces"), "2 000 faces");
    }

    #[test]
    fn stages_are_sums_of_passes() {
        let time = |stage, pass: &str, ms| StageTime {
            stage,
            pass: pass.to_owned(),
            duration: Duration::from_millis(ms),
        };
        let times = [time("a", "x", 1), time("b", "y", 2), time("a", "z", 4), time("a", "x", 8)];
        let times = TimesReport::new(&times);
        let stages: Vec<_> = times.stages.iter().map(|s| (s.stage.as_str(), s.ms)).collect();
        assert_eq!(stages, [("a", 13.0), ("b", 2.0)]);
        assert_eq!(times.passes.len(), 3);
        assert_eq!(times.passes[0].ms, 9.0);
        let text = times.table("stage");
        assert!(text.contains("\n  a      13.000\n      x   9.000\n"), "{text}");
    }
}
