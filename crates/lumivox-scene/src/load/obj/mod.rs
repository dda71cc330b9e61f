//! Reads OBJ with MTL (Wavefront, "Advanced Visualizer manual", appendix B1 and B2, 1995; `Pr`,
//! `Pm` and the like by Exocortex, "Extension to Wavefront MTL to support physically-based
//! rendering", 2014).
//!
//! Vertices (with colours), polygons, objects, groups, smoothing groups and materials are read;
//! free-form surfaces, lines and points are skipped with a warning. The faces of one object and
//! group with one material become a mesh and an instance of that name.
//!
//! Corners without a normal are smooth among the faces of their smoothing group, across meshes.
//! Outside groups they are flat: that is the format's initial state ("the default is off"), and
//! programs that mean smooth surfaces write normals or groups. [`LoadOptions::crease_rad`]
//! overrides this; edges between two materials then stay sharp.
//!
//! MTL does not say whether materials are two-sided, and many files have arbitrary winding: all
//! materials are visible from both sides.
//!
//! The file is read line by line ([`read`]) into shared lists of positions, texture coordinates and
//! normals, a table of the distinct corners, and the corners of each submesh's triangles, which
//! become the mesh's indices in place ([`mesh`]).
//!
//! `tobj` 4.0 was considered: it drops smoothing groups, requires UTF-8, does not join lines, fans
//! concave polygons, stores all faces in addition to the meshes, and supports neither texture
//! options nor the keys of physically-based materials.

mod corners;
mod fault;
mod map;
mod material;
mod mesh;
mod mtl;
mod read;
mod texture;

use std::path::Path;

use super::files::folder_of;
use super::geometry::GeometryBudget;
use super::{LoadOptions, Notes, stream, tangents};
use crate::{Instance, Scene, SceneError};

/// The first mesh of a file, without its materials, and the number of other meshes; `None` if there
/// are no triangles. Warnings go to `notes`.
#[cfg(feature = "vxct")]
pub(super) fn first_mesh(
    file: &Path,
    options: &mut LoadOptions<'_>,
    budget: &mut GeometryBudget<'_>,
    notes: &mut Notes,
) -> Result<Option<(crate::Mesh, usize)>, SceneError> {
    let crease_rad = options.crease_rad;
    let (reader, _) = stream::open(file, options)?;
    let mut model = read::read(file, reader, notes, budget)?;
    // VXCT has no vertex colours.
    model.colors = Vec::new();
    let normals = model.group_normals();
    let mut submeshes = std::mem::take(&mut model.submeshes);
    submeshes.retain(|submesh| !submesh.indices.is_empty());
    let others = submeshes.len().saturating_sub(1);
    let mut builder = mesh::Builder::new(&model, &normals, crease_rad);
    let Some(first) = submeshes.into_iter().next() else { return Ok(None) };
    let built = builder.build(first, budget, notes)?;
    Ok(built.map(|built| (built.mesh, others)))
}

pub(super) fn load(file: &Path, options: &mut LoadOptions<'_>) -> Result<Scene, SceneError> {
    let folders = [folder_of(file)];
    let reach = options.reach(&folders);
    let (crease_rad, memory) = (options.crease_rad, options.budget);
    let mut notes = Notes::default();
    let mut budget = GeometryBudget::new(file, memory.geometry_bytes);
    let (reader, _) = stream::open(file, options)?;
    let mut model = read::read(file, reader, &mut notes, &budget)?;
    let origin = model.rest.take_origin([model.positions.as_mut_slice()]);
    let normals = model.group_normals();
    let submeshes = std::mem::take(&mut model.submeshes);

    let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let mut scene = Scene { name: name.unwrap_or_default(), origin, ..Scene::default() };
    let library = mtl::Library::load(file, reach, &model.libraries, &mut notes);
    let mut materials = material::Materials::new(file, reach, library, options);
    let mut builder = mesh::Builder::new(&model, &normals, crease_rad);
    for submesh in submeshes {
        let Some(built) = builder.build(submesh, &mut budget, &mut notes)? else { continue };
        let colored = !built.mesh.colors.is_empty();
        let name = built.material.map(|i| model.materials[i].as_slice());
        let material = materials.get(name, colored, &mut scene, &mut notes);
        let mut mesh = built.mesh;
        if scene.materials[material].normal_texture.is_some() {
            tangents::generate(&mut mesh);
        }
        scene.instances.push(Instance {
            name: built.name,
            mesh: scene.meshes.len(),
            material,
            ..Instance::default()
        });
        scene.meshes.push(mesh);
    }
    drop(model);
    materials.finish(&mut notes);
    if scene.meshes.is_empty() {
        let reason = "it has no faces".to_owned();
        return Err(SceneError::NoTriangles { file: file.to_owned(), reason });
    }
    scene.notes.warnings = notes.warnings;
    crate::validate::validate(&mut scene, file)?;
    Ok(scene)
}
