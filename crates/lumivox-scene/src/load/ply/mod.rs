//! Reads PLY (Turk 1994, "The PLY Polygon File Format"), as text or binary of both byte orders.
//!
//! A file is a header that declares elements and their properties, followed by the elements.
//! `vertex` (position, normal, colour, texture coordinates), `face` (polygons by vertex number) and
//! `tristrips` are read; every other element and property is skipped by its declared size. The
//! result is one mesh.
//!
//! If the file has no normals, surfaces are smooth: triangles share vertices in PLY, and scans
//! mostly sample smooth surfaces. [`LoadOptions::crease_rad`] overrides this. Integer colours count
//! as sRGB, as scanners and their programs write them, floats as linear.
//!
//! `ply-rs-bw` 4.0 was considered: it first collects an object for each element and a vector for
//! each face, several times the memory of the mesh.

mod body;
mod header;
mod source;

use std::path::Path;

use super::geometry::GeometryBudget;
use super::{LoadOptions, Notes, normals, repair, stand_in, stream};
use crate::{Instance, Mesh, Scene, SceneError};
use header::{Encoding, Header};

pub(super) fn load(file: &Path, options: &mut LoadOptions<'_>) -> Result<Scene, SceneError> {
    let crease_rad = options.crease_rad;
    let geometry_bytes = options.budget.geometry_bytes;
    let (mut reader, length) = stream::open(file, options)?;
    let (header, head_bytes) = Header::read(file, &mut reader)?;
    let new_body = || {
        let budget = GeometryBudget::new(file, geometry_bytes);
        body::Body::new(file, &header, budget, length.saturating_sub(head_bytes))
    };
    let mut body = new_body();
    match header.encoding {
        Encoding::Ascii => {
            let lines = body.read(&mut source::Text::new(file, reader, header.lines, true));
            if let Err(error) = lines {
                // Entries may share lines: reads again, with line breaks as spaces.
                body = new_body();
                let (mut reader, _) = stream::open(file, options)?;
                Header::read(file, &mut reader)?;
                let mut words = source::Text::new(file, reader, header.lines, false);
                body.read(&mut words).map_err(|_| error)?;
            }
        }
        Encoding::LittleEndian => body.read(&mut source::Binary::<_, false>::new(file, reader))?,
        Encoding::BigEndian => body.read(&mut source::Binary::<_, true>::new(file, reader))?,
    }
    let body::Done { mesh, origin, budget, mut notes } = body.finish()?;
    if let Some(texture) = &header.texture {
        notes.warn(format!(
            "its image \"{texture}\" is not shown, because PLY has no materials; save as OBJ or glTF"
        ));
    }
    let mesh = with_normals(mesh, budget, crease_rad, &mut notes)?;

    let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let material = if mesh.colors.is_empty() {
        stand_in::no_material(&mut notes)
    } else {
        stand_in::only_colors(&mut notes)
    };
    let mut scene = Scene {
        name: name.unwrap_or_default(),
        instances: vec![Instance {
            name: mesh.name.clone(),
            mesh: 0,
            material: 0,
            ..Instance::default()
        }],
        meshes: vec![mesh],
        materials: vec![material],
        origin,
        ..Scene::default()
    };
    scene.notes.warnings = notes.warnings;
    crate::validate::validate(&mut scene, file)?;
    Ok(scene)
}

fn with_normals(
    mut mesh: Mesh,
    mut budget: GeometryBudget<'_>,
    crease_rad: Option<f32>,
    notes: &mut Notes,
) -> Result<Mesh, SceneError> {
    if !mesh.normals.is_empty() {
        repair::directions(&mut mesh, notes);
    } else if let Some(crease_rad) = crease_rad {
        budget.spend_split(&mesh)?;
        let corners = normals::creased(&mesh.positions, &mesh.indices, crease_rad);
        normals::set_corner_normals(&mut mesh, &corners);
    } else {
        mesh.normals = normals::smooth(&mesh.positions, &mesh.indices);
    }
    normals::set_any_tangents(&mut mesh);
    Ok(mesh)
}
