//! Scenes and their edits.
//!
//! Renderers share a scene: an edit copies a shared scene, and changes any other in place.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use glam::{Vec2, Vec3};
use lumivox_explorer::suggest;
use lumivox_scene::sky::{SkySettings, sky};
use lumivox_scene::{
    AnimationChoice, Bounds, Camera, Environment, EnvironmentMap, Instance, Light, LoadOptions,
    LoadProgress, Mesh, Scene as Model, UpAxis, builtin,
};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::Fault;
use crate::records::{
    CameraRecord, InstanceRecord, LightRecord, MaterialRecord, light, light_record, transform,
};
use crate::work::{Progress, detached, lock, numbers};

/// A scene.
#[pyclass(frozen, module = "lumivox._lumivox")]
pub struct Scene {
    model: Mutex<Arc<Model>>,
}

/// The names of the built-in scenes.
#[pyfunction]
pub fn builtin_names() -> Vec<&'static str> {
    builtin::names().to_vec()
}

impl Scene {
    fn of(model: Model) -> Self {
        Self { model: Mutex::new(Arc::new(model)) }
    }

    /// The present state.
    pub fn model(&self) -> Arc<Model> {
        lock(&self.model).clone()
    }

    /// Reads from the present state.
    fn read<T: Send>(&self, py: Python<'_>, read: impl FnOnce(&Model) -> T + Send) -> T {
        py.detach(|| read(&self.model()))
    }

    /// Edits the scene. `edit` must change nothing if it fails.
    fn edit<T: Send>(
        &self,
        py: Python<'_>,
        edit: impl FnOnce(&mut Model) -> Result<T, Fault> + Send,
    ) -> PyResult<T> {
        detached(py, || edit(Arc::make_mut(&mut lock(&self.model))))
    }
}

/// Checks parts of a scene without the rest of it.
fn check(name: &str, parts: Model) -> Result<(), Fault> {
    let grid_bounds = Some(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
    Ok(Model { name: name.to_owned(), grid_bounds, ..parts }.validate()?)
}

#[pymethods]
impl Scene {
    /// An empty scene.
    #[new]
    fn new(name: String) -> Self {
        Self::of(Model { name, ..Model::default() })
    }

    #[staticmethod]
    fn builtin(py: Python<'_>, name: String) -> PyResult<Self> {
        detached(py, || {
            let name = name.strip_prefix(lumivox_console::BUILTIN).unwrap_or(&name);
            Ok(Self::of(builtin::scene(name)?))
        })
    }

    #[staticmethod]
    #[pyo3(signature = (path, unit_m, up, crease_deg, scene, allow_outside, ignore_required, progress))]
    #[expect(clippy::too_many_arguments, reason = "they are those of the package's function")]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        unit_m: f32,
        up: String,
        crease_deg: Option<f32>,
        scene: Option<String>,
        allow_outside: bool,
        ignore_required: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        if let Some(name) =
            path.to_str().and_then(|path| path.strip_prefix(lumivox_console::BUILTIN))
        {
            return Self::builtin(py, name.to_owned());
        }
        let mut progress = Progress::new(progress);
        detached(py, || {
            let up = match up.as_str() {
                "y" => UpAxis::Y,
                "z" => UpAxis::Z,
                other => {
                    return Err(Fault::input(format!("up is \"{other}\", but must be y or z")));
                }
            };
            if !(unit_m > 0.0 && unit_m.is_finite()) {
                return Err(Fault::input(format!("unit_m is {unit_m}, but must be above 0")));
            }
            let mut tell = |step: LoadProgress| {
                let _ = progress.step(step.stage, step.done as f64, step.total as u32);
            };
            let crease_rad = crease_deg.map(f32::to_radians);
            let mut options = LoadOptions {
                allow_outside,
                ignore_required,
                scene,
                up,
                unit_m,
                crease_rad,
                progress: Some(&mut tell),
                ..LoadOptions::default()
            };
            let loaded = Model::load_with(&path, &mut options)?;
            drop(options);
            progress.end()?;
            Ok(Self::of(loaded))
        })
    }

    fn copy(&self, py: Python<'_>) -> Self {
        Self { model: Mutex::new(py.detach(|| self.model())) }
    }

    fn save_glb(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        detached(py, || Ok(self.model().save_glb(path)?))
    }

    #[getter]
    fn name(&self, py: Python<'_>) -> String {
        self.read(py, |model| model.name.clone())
    }

    #[getter]
    fn triangles(&self, py: Python<'_>) -> usize {
        self.read(py, Model::triangle_count)
    }

    #[getter]
    fn origin(&self, py: Python<'_>) -> [f64; 3] {
        self.read(py, |model| model.origin.to_array())
    }

    #[getter]
    fn warnings(&self, py: Python<'_>) -> Vec<String> {
        self.read(py, |model| model.notes.warnings.clone())
    }

    /// The lower and the upper corner of the scene's box, m; `None` without triangles.
    #[getter]
    fn bounds(&self, py: Python<'_>) -> Option<([f32; 3], [f32; 3])> {
        let bounds = self.read(py, Model::bounds);
        (!bounds.is_empty()).then(|| (bounds.min.into(), bounds.max.into()))
    }

    /// The animations' names and durations, s.
    #[getter]
    fn animations(&self, py: Python<'_>) -> Vec<(String, f32)> {
        self.read(py, |model| {
            let known = model.animations().into_iter();
            known.map(|animation| (animation.name, animation.duration_s)).collect()
        })
    }

    /// Poses the scene at a time of an animation, or of all at once.
    fn pose(&self, py: Python<'_>, time_s: f32, animation: Option<usize>) -> PyResult<()> {
        self.edit(py, |model| {
            *model = posed(model, time_s, animation)?;
            Ok(())
        })
    }

    #[getter]
    fn cameras(&self, py: Python<'_>) -> Vec<CameraRecord> {
        self.read(py, |model| model.cameras.iter().map(Into::into).collect())
    }

    fn set_cameras(&self, py: Python<'_>, cameras: Vec<CameraRecord>) -> PyResult<()> {
        self.edit(py, |model| {
            let cameras: Vec<Camera> = cameras.into_iter().map(Into::into).collect();
            check(&model.name, Model { cameras: cameras.clone(), ..Model::default() })?;
            model.replace_cameras(cameras);
            Ok(())
        })
    }

    #[getter]
    fn lights(&self, py: Python<'_>) -> Vec<LightRecord> {
        self.read(py, |model| model.lights.iter().map(light_record).collect())
    }

    fn set_lights(&self, py: Python<'_>, lights: Vec<LightRecord>) -> PyResult<()> {
        self.edit(py, |model| {
            let lights: Result<Vec<Light>, String> = lights.iter().map(light).collect();
            let lights =
                lights.map_err(|message| Fault::input(format!("{}: {message}", model.name)))?;
            model.replace_lights(lights);
            Ok(())
        })
    }

    #[getter]
    fn materials(&self, py: Python<'_>) -> Vec<MaterialRecord> {
        self.read(py, |model| model.materials.iter().map(Into::into).collect())
    }

    fn set_material(&self, py: Python<'_>, index: usize, material: MaterialRecord) -> PyResult<()> {
        self.edit(py, |model| {
            check_material(&model.name, &material)?;
            let count = model.materials.len();
            let changed = model.materials.get_mut(index);
            let changed = changed.ok_or_else(|| no_such("material", index, count))?;
            material.change(changed);
            Ok(())
        })
    }

    #[getter]
    fn instances(&self, py: Python<'_>) -> Vec<InstanceRecord> {
        self.read(py, |model| model.instances.iter().map(Into::into).collect())
    }

    fn set_instance(&self, py: Python<'_>, index: usize, instance: InstanceRecord) -> PyResult<()> {
        self.edit(py, |model| {
            let count = model.instances.len();
            let kept = model.instances.get(index);
            let mut changed = kept.cloned().ok_or_else(|| no_such("instance", index, count))?;
            instance.change(&mut changed)?;
            if changed.material >= model.materials.len() {
                return Err(no_such("material", changed.material, model.materials.len()));
            }
            model.instances[index] = changed;
            Ok(())
        })
    }

    /// Adds triangles with their own material, as one instance.
    #[expect(clippy::too_many_arguments, reason = "they are those of the package's function")]
    fn add(
        &self,
        py: Python<'_>,
        name: String,
        positions: &Bound<'_, PyBytes>,
        indices: &Bound<'_, PyBytes>,
        normals: Option<Bound<'_, PyBytes>>,
        uvs: Option<Bound<'_, PyBytes>>,
        crease_deg: f32,
        material: MaterialRecord,
        world_from_local: [[f32; 4]; 4],
    ) -> PyResult<()> {
        let raise = |fault: Fault| fault.raise(py);
        let positions = numbers::<Vec3>("positions", positions).map_err(raise)?;
        let indices = numbers::<u32>("indices", indices).map_err(raise)?;
        let normals = normals.map(|bytes| numbers::<Vec3>("normals", &bytes)).transpose();
        let uvs = uvs.map(|bytes| numbers::<Vec2>("uvs", &bytes)).transpose();
        let (normals, uvs) = (normals.map_err(raise)?, uvs.map_err(raise)?);
        self.edit(py, |model| {
            check_material(&model.name, &material)?;
            let crease_rad = crease_deg.to_radians();
            let mesh = Mesh::from_arrays(&name, positions, indices, normals, uvs, crease_rad);
            let mut part = Model {
                name: model.name.clone(),
                meshes: vec![mesh],
                materials: vec![material.material()],
                instances: vec![Instance {
                    name: name.clone(),
                    world_from_local: transform(&world_from_local, &name)?,
                    ..Instance::default()
                }],
                ..Model::default()
            };
            part.validate()?;
            let (mesh, material) = (model.meshes.len(), model.materials.len());
            model.notes.degenerate_triangles += part.notes.degenerate_triangles;
            model.meshes.append(&mut part.meshes);
            model.materials.append(&mut part.materials);
            model.instances.extend(part.instances.into_iter().map(|placed| Instance {
                mesh,
                material,
                ..placed
            }));
            Ok(())
        })
    }

    /// The radiance of the surroundings, and whether it is the factor of a map.
    #[getter]
    fn environment(&self, py: Python<'_>) -> ([f32; 3], bool) {
        self.read(py, |model| (model.environment.radiance.into(), model.environment.map.is_some()))
    }

    /// Sets the surroundings: a radiance, multiplied by a panorama from a file or an array if there
    /// is one.
    #[pyo3(signature = (radiance, rotation_deg, file, width, texels))]
    fn set_environment(
        &self,
        py: Python<'_>,
        radiance: [f32; 3],
        rotation_deg: f32,
        file: Option<PathBuf>,
        width: u32,
        texels: Option<Bound<'_, PyBytes>>,
    ) -> PyResult<()> {
        let texels = texels.map(|bytes| numbers::<[f32; 3]>("map", &bytes)).transpose();
        let texels = texels.map_err(|fault| fault.raise(py))?;
        self.edit(py, |model| {
            let map = match (file, texels) {
                (Some(file), _) => Some(EnvironmentMap::load(file)?),
                (None, Some(rgb)) => {
                    let height = rgb.len() as u32 / width.max(1);
                    let name = "map".to_owned();
                    Some(EnvironmentMap { name, width, height, rgb, warnings: Vec::new() })
                }
                (None, None) => None,
            };
            let rotation_rad = rotation_deg.to_radians();
            let environment =
                Environment { radiance: radiance.into(), map: map.map(Arc::new), rotation_rad };
            let parts = Model { environment: environment.clone(), ..Model::default() };
            check(&model.name, parts)?;
            model.environment = environment;
            Ok(())
        })
    }

    /// Sets the surroundings to a clear sky, whose sun takes the place of all directional lights.
    fn set_sky(&self, py: Python<'_>, towards_sun: [f32; 3], turbidity: f32) -> PyResult<()> {
        self.edit(py, |model| {
            let sun_direction = Vec3::from(towards_sun);
            if sun_direction.try_normalize().is_none() || !(1.0..=10.0).contains(&turbidity) {
                return Err(Fault::input(
                    "the sky: towards_sun must have a direction, and turbidity must be from 1 to 10",
                ));
            }
            let sky = sky(&SkySettings { sun_direction, turbidity, ..SkySettings::default() })?;
            sky.surround(&mut model.environment, &mut model.lights);
            Ok(())
        })
    }
}

/// A scene at a time of an animation, or of all at once.
///
/// # Errors
/// When there is no such animation, or nothing is left of the scene at that time.
pub fn posed(model: &Model, time_s: f32, animation: Option<usize>) -> Result<Model, Fault> {
    // A copy, since an animation that fails may leave half a pose.
    let mut posed = model.clone();
    let choice = animation.map_or(AnimationChoice::All, AnimationChoice::One);
    posed.pose(choice, time_s)?;
    Ok(posed)
}

/// Checks the numbers of a material.
fn check_material(name: &str, material: &MaterialRecord) -> Result<(), Fault> {
    check(name, Model { materials: vec![material.material()], ..Model::default() })
}

fn no_such(what: &str, index: usize, count: usize) -> Fault {
    Fault::input(format!("there is no {what} {index}; the scene has {count}, counted from 0"))
}

/// The error that there is no setting, layer or other thing of a name, with a suggestion.
pub fn unknown(what: &str, name: &str, known: &[&str], lister: &str) -> Fault {
    let remedy = suggest::remedy(name, known.iter().copied(), lister);
    Fault::input(format!("there is no {what} \"{name}\"{remedy}"))
}
