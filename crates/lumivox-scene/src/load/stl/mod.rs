//! Reads STL (3D Systems, "Stereolithography Interface Specification", 1989): only triangles,
//! binary or as text.
//!
//! A file is binary if its length matches its count of triangles (many binary files begin with
//! `solid`, as text does), and otherwise if it has a zero byte where text would not. Each solid
//! becomes a mesh. The winding decides a triangle's front; the file's normals, which are equal to
//! its normal or zero, are ignored. STL has no shared corners, so surfaces are flat; with
//! [`LoadOptions::crease_rad`] equal corners are joined and flat edges smoothed.
//!
//! `stl_io` 0.11 was considered: it is too strict for real files (it refuses several solids, other
//! spellings of `solid`, text that is not UTF-8, and binary files with `solid` in their header),
//! and its text reader makes a string of every word.

mod ascii;
mod binary;

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::geometry::GeometryBudget;
use super::origin::{self, Rest};
use super::text::without_mark;
use super::{LoadOptions, Notes, normals, repair, stand_in, stream};
use crate::{Instance, Mesh, Scene, SceneError};

/// Bytes before a binary file's triangles: a header of any content, and their count.
const BINARY_HEAD: usize = 84;
/// Bytes of a binary file's triangle: a normal, three corners, and 16 bits without a standard
/// meaning.
const BINARY_TRIANGLE: usize = 50;
/// All solids beyond this number become one: a file could name millions.
const MOST_SOLIDS: usize = 1 << 16;

/// One solid: three positions for each triangle.
struct Solid {
    name: String,
    corners: Vec<Vec3>,
}

/// The state of reading text or binary.
struct Reading<'f> {
    file: &'f Path,
    notes: Notes,
    budget: GeometryBudget<'f>,
    /// The rounding errors of the corners.
    rest: Rest,
    /// `true` if the file stores corners as f32.
    is_f32: bool,
}

pub(super) fn load(file: &Path, options: &mut LoadOptions<'_>) -> Result<Scene, SceneError> {
    let crease_rad = options.crease_rad;
    let budget = GeometryBudget::new(file, options.budget.geometry_bytes);
    let (notes, rest) = (Notes::default(), Rest::default());
    let mut reading = Reading { file, notes, budget, rest, is_f32: false };
    let (reader, length) = stream::open(file, options)?;
    let mut solids = reading.solids(reader, length)?;
    let all = solids.iter_mut().map(|solid| solid.corners.as_mut_slice());
    let origin = reading.rest.take_origin(all);
    if reading.is_f32 {
        origin::tell_lost(&mut reading.notes, origin);
    }
    reading.scene(solids, origin, crease_rad)
}

impl Reading<'_> {
    fn solids(
        &mut self,
        mut reader: BufReader<impl Read>,
        length: u64,
    ) -> Result<Vec<Solid>, SceneError> {
        let read = |source| SceneError::Read { file: self.file.to_owned(), source };
        let head = reader.fill_buf().map_err(read)?;
        if head.is_empty() {
            let reason = "it is empty".to_owned();
            return Err(SceneError::NoTriangles { file: self.file.to_owned(), reason });
        }
        if is_binary(head, length) {
            return self.binary(reader, length);
        }
        self.ascii(reader)
    }

    fn scene(
        mut self,
        solids: Vec<Solid>,
        origin: DVec3,
        crease_rad: Option<f32>,
    ) -> Result<Scene, SceneError> {
        let name = self.file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let mut scene = Scene { name: name.unwrap_or_default(), origin, ..Scene::default() };
        scene.materials.push(stand_in::no_material(&mut self.notes));
        for (i, mut solid) in solids.into_iter().filter(|s| !s.corners.is_empty()).enumerate() {
            if solid.name.is_empty() {
                solid.name = format!("solid {i}");
            }
            scene.instances.push(Instance {
                name: solid.name.clone(),
                mesh: i,
                material: 0,
                ..Instance::default()
            });
            scene.meshes.push(solid.mesh(crease_rad, &mut self.notes));
        }
        if scene.meshes.is_empty() {
            let reason = "it has no facets".to_owned();
            return Err(SceneError::NoTriangles { file: self.file.to_owned(), reason });
        }
        scene.notes.warnings = self.notes.warnings;
        crate::validate::validate(&mut scene, self.file)?;
        Ok(scene)
    }
}

impl Solid {
    fn mesh(self, crease_rad: Option<f32>, notes: &mut Notes) -> Mesh {
        let mut mesh = Mesh { name: self.name, ..Mesh::default() };
        match crease_rad {
            Some(crease_rad) if crease_rad > 0.0 => {
                (mesh.positions, mesh.indices) = weld(&self.corners);
                drop(self.corners);
                repair::attributes(&mut mesh, notes);
                mesh.uvs = vec![Vec2::ZERO; mesh.positions.len()];
                let normals = normals::creased(&mesh.positions, &mesh.indices, crease_rad);
                normals::set_corner_normals(&mut mesh, &normals);
            }
            _ => {
                mesh.positions = self.corners;
                mesh.indices = (0..mesh.positions.len() as u32).collect();
                repair::attributes(&mut mesh, notes);
                mesh.uvs = vec![Vec2::ZERO; mesh.positions.len()];
                mesh.normals = normals::flat(&mesh.positions);
            }
        }
        normals::set_any_tangents(&mut mesh);
        mesh
    }
}

/// Joins corners at the same position to one vertex.
fn weld(corners: &[Vec3]) -> (Vec<Vec3>, Vec<u32>) {
    let mut positions = Vec::new();
    let mut known = HashMap::new();
    let indices = corners.iter().map(|&corner| {
        // Adding zero converts -0 to 0.
        let key = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
        *known.entry(key).or_insert_with(|| {
            positions.push(corner);
            (positions.len() - 1) as u32
        })
    });
    let indices = indices.collect();
    (positions, indices)
}

/// The length of a binary file with this number of triangles.
fn length_of(count: u32) -> u64 {
    BINARY_HEAD as u64 + u64::from(count) * BINARY_TRIANGLE as u64
}

fn is_binary(head: &[u8], length: u64) -> bool {
    let counted = head.get(80..BINARY_HEAD).and_then(|count| count.try_into().ok());
    if let Some(count) = counted
        && [u32::from_le_bytes(count), u32::from_be_bytes(count)].map(length_of).contains(&length)
    {
        return true;
    }
    let (start, is_wide) = without_mark(&head[..head.len().min(1024)]);
    let words = ["solid", "facet"];
    let mut places = start.windows(5);
    let is_text =
        places.any(|at| words.iter().any(|word| at.eq_ignore_ascii_case(word.as_bytes())));
    !is_wide && (start.contains(&0) || !is_text)
}
