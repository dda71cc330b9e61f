//! Models: an OBJ's first mesh or the cube, with a transform and one flat colour.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, Mat4, Vec3};

use super::keys::{MODEL, Values, XYZ};
use super::surface;
use super::token::{Place, Token};
use super::tree::{Block, quote};
use crate::builtin::shapes::{Faces, cuboid};
use crate::load::files::{Reach, shorten};
use crate::load::find::find;
use crate::load::geometry::GeometryBudget;
use crate::load::{LoadOptions, Notes, obj};
use crate::{Instance, Mesh, Scene, SceneError};

/// The most models of a scene; each takes a kibibyte.
const MOST_MODELS: usize = 100_000;

/// The source of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Source {
    Cube,
    File(PathBuf),
}

/// The models of a scene.
pub(super) struct Models<'m, 'o> {
    options: &'m mut LoadOptions<'o>,
    budget: GeometryBudget<'m>,
    /// Files in whose folders models are searched.
    beside: Vec<PathBuf>,
    reach: Reach<'m>,
    /// The scene's mesh for transforms that do not mirror, and for those that do; or the reason why
    /// there is none.
    meshes: HashMap<Source, Result<(usize, Option<usize>), String>>,
    count: usize,
}

impl<'m, 'o> Models<'m, 'o> {
    pub(super) fn new(
        file: &Path,
        folders: &'m [PathBuf],
        budget: GeometryBudget<'m>,
        options: &'m mut LoadOptions<'o>,
    ) -> Self {
        let reach = options.reach(folders);
        let mut beside = Vec::new();
        // VXCT's paths begin in its own folder, above `scenes` and `models`.
        match program_folder(file, options) {
            Some((program, is_sure)) => {
                beside.push(program.join("program"));
                beside.insert(usize::from(is_sure), file.to_owned());
                beside.push(program.join("models").join("model"));
            }
            None => beside.push(file.to_owned()),
        }
        Self { options, budget, beside, reach, meshes: HashMap::new(), count: 0 }
    }

    /// Adds a model to the scene; a model without anything to show is only noted.
    pub(super) fn put(
        &mut self,
        scene: &mut Scene,
        block: &Block<'_>,
        at: Place,
        values: &mut Values<'_>,
    ) -> Result<(), SceneError> {
        values.check(block, &MODEL);
        self.count += 1;
        if self.count > MOST_MODELS {
            let expected = format!("at most {MOST_MODELS} of them, split the scene");
            return Err(super::fault(values.file, at, format!("model {}", self.count), expected));
        }
        let name = match values.word(block, "name", "box")? {
            Some(word) => shorten(word.text),
            None => format!("model {}", self.count),
        };
        // All entries are read, so that errors do not depend on which files exist.
        let is_active = values.flag(block, "active", true)?;
        let is_voxelized = !values.flag(block, "static", false)?;
        let world_from_local = transform(block, values)?;
        let source = self.source(block, &name, at, values)?;
        let material = surface::material(block, &name, source == Some(Source::Cube), values)?;
        let Some(source) = source else { return Ok(()) };
        if !world_from_local.is_finite() {
            let part = format!("model \"{name}\" at {at}, its transform");
            return Err(SceneError::NotFinite { file: values.file.to_owned(), part });
        }
        let mirrors = world_from_local.as_dmat4().determinant() < 0.0;
        let Some(mesh) = self.mesh(scene, source, mirrors, (&name, at), values)? else {
            return Ok(());
        };
        scene.instances.push(Instance {
            name,
            mesh,
            material: scene.materials.len(),
            world_from_local,
            is_voxelized,
            is_hidden: !is_active,
            ..Instance::default()
        });
        scene.materials.push(material);
        Ok(())
    }

    /// The source of a model's mesh; `path` takes precedence over `primitive`.
    fn source(
        &self,
        block: &Block<'_>,
        name: &str,
        at: Place,
        values: &mut Values<'_>,
    ) -> Result<Option<Source>, SceneError> {
        let path = values.word(block, "path", "models/box.obj")?;
        let primitive = values.word(block, "primitive", "cube")?;
        if let Some(path) = path {
            return Ok(self.find(&path, name, values).map(Source::File));
        }
        match primitive {
            Some(word) if word.text == "cube" => return Ok(Some(Source::Cube)),
            Some(word) => {
                let text = format!("there is no primitive {}, only \"cube\"", quote(&word));
                values.warn(word.at, format!("model \"{name}\" is not shown: {text}"));
            }
            None => values.warn(
                at,
                format!("model \"{name}\" is not shown: it has neither \"path\" nor \"primitive\""),
            ),
        }
        Ok(None)
    }

    fn find(&self, path: &Token<'_>, name: &str, values: &mut Values<'_>) -> Option<PathBuf> {
        let beside: Vec<&Path> = self.beside.iter().map(PathBuf::as_path).collect();
        let reason = match find(&beside, path.text.as_bytes(), self.reach) {
            Ok(found) if is_obj(&found) => return Some(found),
            Ok(_) => format!("{} is not an OBJ file (.obj)", quote(path)),
            Err(reason) if self.beside.len() > 1 => {
                format!("{reason}, or into the folder `models` beside the folder `scenes`")
            }
            Err(reason) => reason,
        };
        values.warn(path.at, format!("model \"{name}\" is not shown: {reason}"));
        None
    }

    /// The scene's mesh of a source, with reversed winding if `mirrors`.
    fn mesh(
        &mut self,
        scene: &mut Scene,
        source: Source,
        mirrors: bool,
        (name, at): (&str, Place),
        values: &mut Values<'_>,
    ) -> Result<Option<usize>, SceneError> {
        let sides = if let Some(known) = self.meshes.get(&source) {
            known.clone()
        } else {
            let sides = self.read(&source, values)?.map(|mesh| {
                scene.meshes.push(mesh);
                (scene.meshes.len() - 1, None)
            });
            self.meshes.insert(source.clone(), sides.clone());
            sides
        };
        let (upright, mirrored) = match sides {
            Ok(sides) => sides,
            Err(reason) => {
                values.warn(at, format!("model \"{name}\" is not shown: {reason}"));
                return Ok(None);
            }
        };
        if !mirrors {
            return Ok(Some(upright));
        }
        if mirrored.is_some() {
            return Ok(mirrored);
        }
        let mut turned = scene.meshes[upright].clone();
        let part = || format!("mesh \"{}\", mirrored,", turned.name);
        self.budget.spend(part, turned.positions.len(), turned.indices.len(), false)?;
        turned.flip_winding();
        scene.meshes.push(turned);
        let mirrored = scene.meshes.len() - 1;
        self.meshes.insert(source, Ok((upright, Some(mirrored))));
        Ok(Some(mirrored))
    }

    /// Reads a source. An unusable file is not an error of the scene, unless it is too large.
    fn read(
        &mut self,
        source: &Source,
        values: &mut Values<'_>,
    ) -> Result<Result<Mesh, String>, SceneError> {
        let file = match source {
            Source::Cube => {
                let mut cube = cuboid(Vec3::splat(-0.5), Vec3::splat(0.5), Faces::ALL);
                "cube".clone_into(&mut cube.name);
                return Ok(Ok(cube));
            }
            Source::File(file) => file,
        };
        let mut notes = Notes::default();
        let read = obj::first_mesh(file, self.options, &mut self.budget, &mut notes);
        for warning in notes.warnings {
            values.notes.warn(format!("{}: {warning}", file.display()));
        }
        match read {
            Ok(Some((mut mesh, others))) => {
                if others > 0 {
                    let were = if others == 1 { "was" } else { "were" };
                    values.notes.warn(format!(
                        "{}: the first mesh counts, \"{}\", and {others} more {were} ignored",
                        file.display(),
                        mesh.name
                    ));
                }
                let stem = file.file_stem().map(OsStr::to_string_lossy).unwrap_or_default();
                mesh.name = shorten(&stem);
                // A model has one flat colour.
                mesh.colors = Vec::new();
                Ok(Ok(mesh))
            }
            Ok(None) => Ok(Err(format!("{} has no faces", file.display()))),
            Err(error @ SceneError::TooLarge { .. }) => Err(error),
            Err(error) => Ok(Err(error.to_string())),
        }
    }
}

fn is_obj(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"))
}

/// VXCT's folder: the parent of the scene's folder. `true` if that is certain, since the scene's
/// folder is called `scenes`; otherwise only if all folders may be read.
pub(super) fn program_folder(file: &Path, options: &LoadOptions<'_>) -> Option<(PathBuf, bool)> {
    let folder = file.parent()?;
    let is_scenes = |name: &OsStr| name.eq_ignore_ascii_case("scenes");
    if folder.file_name().is_some_and(is_scenes) {
        return Some((folder.parent()?.to_owned(), true));
    }
    // A bare file name is in the working folder.
    let here = || std::path::absolute(file).ok()?.parent()?.file_name().map(is_scenes);
    let is_here = folder.as_os_str().is_empty() && options.files.is_none() && here() == Some(true);
    (is_here || options.allow_outside).then(|| (folder.join(".."), is_here))
}

/// Reads a transform: scale, then rotations about z, y and x, then translation: T Rx Ry Rz S Sxyz.
fn transform(block: &Block<'_>, values: &mut Values<'_>) -> Result<Mat4, SceneError> {
    let position = values.vector(block, "position", &XYZ, Vec3::ZERO)?;
    let rotation_deg = values.vector(block, "rotation", &XYZ, Vec3::ZERO)?;
    let scale = f64::from(values.number(block, "scale", 1.0)?);
    let scale_xyz = Vec3::new(
        values.number(block, "scale_x", 1.0)?,
        values.number(block, "scale_y", 1.0)?,
        values.number(block, "scale_z", 1.0)?,
    );
    // In f64, so that the cosine of 90 degrees rounds to zero in f32.
    let angle = |degrees: f32| f64::from(degrees % 360.0).to_radians();
    let world_from_local = DMat4::from_translation(position.as_dvec3())
        * DMat4::from_rotation_x(angle(rotation_deg.x))
        * DMat4::from_rotation_y(angle(rotation_deg.y))
        * DMat4::from_rotation_z(angle(rotation_deg.z))
        * DMat4::from_scale(DVec3::splat(scale) * scale_xyz.as_dvec3());
    Ok(world_from_local.as_mat4())
}
