//! A scene on the device: pictures from any number of cameras, with layers, and irradiance at
//! points.

use std::sync::{Arc, Mutex, MutexGuard};

use glam::{UVec2, Vec2, Vec3};
use lumivox_render::{Gpu, RenderProgress, Renderer as Engine, VoxelFace};
use lumivox_scene::{Bounds, Camera, Picker, Places, Scene as Model};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

use crate::error::Fault;
use crate::gpu::{check_process, open};
use crate::motion::{Shot, motion};
use crate::records::CameraRecord;
use crate::scene::{Scene, posed};
use crate::settings::{Given, Layer, layer, of, texts};
use crate::stage::{CameraArgument, Staged, camera, stage};
use crate::work::{Progress, array, detached, lock, numbers};

/// The most points at which irradiance is gathered in one call.
const POINTS_AT_ONCE: usize = 1 << 18;

/// The bytes of a picture's arrays by name, each with its number of channels; the type is `f4` or
/// `i4`.
type Arrays<'py> = Vec<(String, Bound<'py, PyByteArray>, usize, &'static str)>;

/// A scene on the device.
#[pyclass(frozen, module = "lumivox._lumivox")]
pub struct Renderer {
    process: u32,
    gpu: Gpu,
    layers: Vec<(String, Layer, usize)>,
    surroundings: String,
    state: Mutex<State>,
}

struct State {
    engine: Engine,
    /// The settings that the caller has given.
    given: Given,
    staged: Staged,
    /// Places of the scene's parts as the device has them.
    places: Places,
    /// The scene and the camera from which the next picture's `motion` is measured, if any.
    before: Option<(Arc<Model>, Camera)>,
    /// The scene's triangles, for the layers `instance`, `material` and `motion`; made when needed.
    picker: Option<Arc<Picker>>,
}

/// A picture's arrays by name, each with its number of channels.
type Made = Vec<(String, Values, usize)>;

/// The values of one array.
enum Values {
    Floats(Vec<f32>),
    Numbers(Vec<i32>),
}

#[pymethods]
impl Renderer {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "they are those of the package's class")]
    fn new(
        py: Python<'_>,
        scene: &Scene,
        camera: Option<CameraArgument>,
        size: (u32, u32),
        given: Given,
        layers: Vec<String>,
        surroundings: String,
        bounds: Option<[[f32; 3]; 2]>,
        time: Option<(f32, Option<usize>)>,
        adapter: Option<String>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let mut progress = Progress::new(progress);
        detached(py, || {
            let size = UVec2::from(size);
            if size.min_element() == 0 {
                return Err(Fault::input(format!(
                    "size is {} x {}, but must be at least 1 x 1",
                    size.x, size.y
                )));
            }
            let model = scene.model();
            let mut settings = of(&model, size, &given)?;
            settings.grid_bounds =
                bounds.map(|[min, max]| Bounds { min: min.into(), max: max.into() });
            let mut named = Vec::with_capacity(layers.len());
            for name in layers {
                let (layer, channels) = layer(&name)?;
                if let Layer::View(view) = layer {
                    settings.beside.push(view);
                }
                named.push((name, layer, channels));
            }
            let gpu = open(adapter.as_deref())?;
            settings.validate(&gpu.device.limits())?;
            let aspect = size.x as f32 / size.y as f32;
            let _ = progress.step("looking at the scene", 0.0, 1);
            let mut staged = stage(&model, camera, aspect, &surroundings)?;
            if let Some((time_s, animation)) = time {
                staged.scene = Arc::new(posed(&staged.scene, time_s, animation)?);
            }
            progress.end()?;
            let mut tell = |step: RenderProgress| {
                let _ = progress.step(step.stage, step.done.into(), step.total);
            };
            let engine =
                Engine::new(&gpu, &staged.scene, Some(&staged.camera), settings, &mut tell);
            let engine = pollster::block_on(engine)?;
            progress.end()?;
            let places = Places::of(&staged.scene);
            let (before, picker) = (None, None);
            let state = Mutex::new(State { engine, given, staged, places, before, picker });
            Ok(Self { process: std::process::id(), gpu, layers: named, surroundings, state })
        })
    }

    /// Renders from a camera, or from the last one.
    fn render<'py>(
        &self,
        py: Python<'py>,
        camera: Option<CameraArgument>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Arrays<'py>> {
        let mut progress = Progress::new(progress);
        let made = detached(py, || {
            let mut state = self.begin(camera)?;
            let frames = state.engine.settings().frames;
            self.picture(&mut state, frames, &mut progress)
        })?;
        arrays(py, made)
    }

    /// Renders more frames into the mean of the last picture. A camera, or a change since then,
    /// begins a new mean.
    fn refine<'py>(
        &self,
        py: Python<'py>,
        frames: u32,
        camera: Option<CameraArgument>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Arrays<'py>> {
        let mut progress = Progress::new(progress);
        let made = detached(py, || {
            let mut state = if camera.is_some() { self.begin(camera)? } else { lock(&self.state) };
            check_process(self.process)?;
            let frames = state.engine.frame_count().saturating_add(frames);
            self.picture(&mut state, frames, &mut progress)
        })?;
        arrays(py, made)
    }

    /// Changes the size of pictures and settings; what does not depend on them stays.
    fn set_settings(
        &self,
        py: Python<'_>,
        size: (u32, u32),
        given: Given,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let mut progress = Progress::new(progress);
        detached(py, || {
            check_process(self.process)?;
            let mut state = lock(&self.state);
            let mut all = state.given.clone();
            all.retain(|(name, _)| given.iter().all(|(other, _)| other != name));
            all.extend(given);
            let old = state.engine.settings();
            let mut settings = of(&state.staged.scene, UVec2::from(size), &all)?;
            settings.grid_bounds = old.grid_bounds;
            settings.beside.clone_from(&old.beside);
            let mut tell = |step: RenderProgress| {
                let _ = progress.step(step.stage, step.done.into(), step.total);
            };
            pollster::block_on(state.engine.set_settings(settings, &mut tell))?;
            state.given = all;
            progress.end()
        })
    }

    /// Shows another state of the same scene: lights, materials and places of instances change,
    /// triangles stay.
    fn update(&self, py: Python<'_>, scene: &Scene, progress: Option<Py<PyAny>>) -> PyResult<()> {
        let mut progress = Progress::new(progress);
        detached(py, || {
            check_process(self.process)?;
            let mut state = lock(&self.state);
            let given = CameraArgument::Given((&state.staged.camera).into());
            let staged = stage(&scene.model(), Some(given), state.aspect(), &self.surroundings)?;
            let mut tell = |step: RenderProgress| {
                let _ = progress.step(step.stage, step.done.into(), step.total);
            };
            let (was, now) = (&state.staged.scene, &staged.scene);
            let moved = state.places.moved(now);
            let is_relit = moved.lights || was.environment != now.environment;
            if moved.shapes
                || !are_same_surfaces(was, now)
                || is_relit && !moved.instances.is_empty()
            {
                pollster::block_on(state.engine.set_materials(now, &mut tell))?;
            } else if is_relit {
                pollster::block_on(state.engine.set_lights(now, &mut tell))?;
            } else if !moved.instances.is_empty() {
                pollster::block_on(state.engine.move_instances(now, &moved.instances, &mut tell))?;
            }
            state.places = Places::of(&staged.scene);
            (state.staged, state.picker) = (staged, None);
            progress.end()
        })
    }

    /// Shows the scene at a time of an animation, or of all at once.
    fn pose(&self, py: Python<'_>, time_s: f32, animation: Option<usize>) -> PyResult<()> {
        detached(py, || {
            check_process(self.process)?;
            let mut state = lock(&self.state);
            let scene = posed(&state.staged.scene, time_s, animation)?;
            let moved = state.places.moved(&scene);
            let tell = &mut |_| {};
            if moved.shapes {
                pollster::block_on(state.engine.set_scene(&scene, tell))?;
            } else if moved.lights || !moved.instances.is_empty() {
                let instances = &moved.instances;
                pollster::block_on(state.engine.move_instances(&scene, instances, tell))?;
            }
            state.places = Places::of(&scene);
            (state.staged.scene, state.picker) = (Arc::new(scene), None);
            Ok(())
        })
    }

    /// Makes the next picture's `motion` relative to this camera and the present scene, or zero
    /// without a camera.
    fn start_motion(&self, py: Python<'_>, camera: Option<CameraArgument>) -> PyResult<()> {
        detached(py, || {
            let mut state = lock(&self.state);
            let camera = camera.map(|argument| state.resolve(argument)).transpose()?;
            state.before = camera.map(|camera| (state.staged.scene.clone(), camera));
            Ok(())
        })
    }

    /// For each point the direct and the indirect irradiance in lux, RGB, and the open share of the
    /// hemisphere.
    fn irradiance<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyBytes>,
        normals: &Bound<'py, PyBytes>,
        frames: u32,
    ) -> PyResult<Bound<'py, PyByteArray>> {
        let points = numbers::<Vec3>("points", points).map_err(|fault| fault.raise(py))?;
        let normals = numbers::<Vec3>("normals", normals).map_err(|fault| fault.raise(py))?;
        let mut progress = Progress::new(None);
        let gathered = detached(py, || {
            check_process(self.process)?;
            let state = lock(&self.state);
            let mut gathered = Vec::with_capacity(points.len());
            // In several calls, so that Ctrl-C can stop the work between two of them.
            for (at, towards) in points.chunks(POINTS_AT_ONCE).zip(normals.chunks(POINTS_AT_ONCE)) {
                gathered.extend(pollster::block_on(state.engine.irradiance(at, towards, frames))?);
                let _ = progress.step("points", gathered.len() as f64, points.len() as u32);
                progress.end()?;
            }
            Ok(gathered)
        })?;
        let flat: Vec<[f32; 7]> = gathered
            .iter()
            .map(|point| {
                let ([a, b, c], [d, e, f]) = (point.direct.to_array(), point.indirect.to_array());
                [a, b, c, d, e, f, point.openness]
            })
            .collect();
        array(py, &flat)
    }

    /// The faces of the voxels as arrays, with the package's names.
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Arrays<'py>> {
        let faces = detached(py, || {
            check_process(self.process)?;
            Ok(pollster::block_on(lock(&self.state).engine.faces())?)
        })?;
        let vectors = |of: fn(&VoxelFace) -> Vec3| -> PyResult<_> {
            array(py, &faces.iter().map(|face| of(face).to_array()).collect::<Vec<_>>())
        };
        let cells: Vec<[u32; 3]> = faces.iter().map(|face| face.cell.to_array()).collect();
        let axes: Vec<u32> = faces.iter().map(|face| face.axis).collect();
        Ok(vec![
            ("position".to_owned(), vectors(|face| face.position)?, 3, "f4"),
            ("vector_area".to_owned(), vectors(|face| face.vector_area)?, 3, "f4"),
            ("reflectance".to_owned(), vectors(|face| face.reflectance)?, 3, "f4"),
            ("emission".to_owned(), vectors(|face| face.emission)?, 3, "f4"),
            ("radiance".to_owned(), vectors(|face| face.radiance)?, 3, "f4"),
            ("cell".to_owned(), array(py, &cells)?, 3, "i4"),
            ("axis".to_owned(), array(py, &axes)?, 1, "i4"),
        ])
    }

    #[getter]
    fn camera(&self, py: Python<'_>) -> CameraRecord {
        self.read(py, |state| state.engine.camera().into())
    }

    #[getter]
    fn size(&self, py: Python<'_>) -> (u32, u32) {
        self.read(py, |state| state.engine.settings().size.into())
    }

    /// All settings that have an effect.
    #[getter]
    fn settings(&self, py: Python<'_>) -> Vec<(&'static str, String)> {
        self.read(py, |state| texts(state.engine.settings()))
    }

    /// Sentences on the chosen camera and light.
    #[getter]
    fn notes(&self, py: Python<'_>) -> Vec<String> {
        self.read(py, |state| state.staged.notes.clone())
    }

    #[getter]
    fn voxels(&self, py: Python<'_>) -> u32 {
        self.read(py, |state| state.engine.voxel_stats().voxels)
    }

    #[getter]
    fn voxel_size_m(&self, py: Python<'_>) -> f32 {
        self.read(py, |state| state.engine.gi().grid().voxel_size_m)
    }

    #[getter]
    fn adapter(&self) -> String {
        lumivox_render::describe(&self.gpu.adapter_info)
    }
}

impl Renderer {
    fn read<T: Send>(&self, py: Python<'_>, read: impl FnOnce(&State) -> T + Send) -> T {
        py.detach(|| read(&lock(&self.state)))
    }

    /// Makes the next frame the first of a picture from a camera, or from the last one, without the
    /// light of earlier pictures.
    fn begin(&self, argument: Option<CameraArgument>) -> Result<MutexGuard<'_, State>, Fault> {
        check_process(self.process)?;
        let mut state = lock(&self.state);
        let camera = match argument {
            Some(argument) => state.resolve(argument)?,
            None => state.engine.camera().clone(),
        };
        state.engine.set_camera(camera);
        pollster::block_on(state.engine.cut(&mut |_| {}))?;
        Ok(state)
    }

    /// Renders until the mean has this number of frames. If these are all frames of the settings,
    /// it also waits for late voxels and geometry.
    fn picture(
        &self,
        state: &mut State,
        frames: u32,
        progress: &mut Progress,
    ) -> Result<Made, Fault> {
        let is_whole = frames >= state.engine.settings().frames;
        while state.engine.frame_count() < frames || is_whole && !state.engine.is_complete() {
            pollster::block_on(state.engine.render_frame())?;
            self.gpu.wait("rendering a frame")?;
            let _ = progress.step("render", state.engine.frame_count().into(), frames);
            progress.end()?;
        }
        let camera = state.engine.camera().clone();
        let mean = pollster::block_on(state.engine.read_mean())?;
        let coverage = mean.iter().map(|pixel| pixel[3]).collect();
        let mut arrays = vec![
            ("radiance".to_owned(), Values::Floats(channels(&mean, 3, 1.0)), 3),
            ("coverage".to_owned(), Values::Floats(coverage), 1),
        ];
        for (name, layer, count) in &self.layers {
            let values = match layer {
                Layer::View(view) => {
                    let read = pollster::block_on(state.engine.read_beside(*view))?;
                    let pixels = read.unwrap_or_default();
                    // The view shows the radiance of a white surface: irradiance over pi.
                    let is_irradiance = *view == lumivox_render::View::Diffuse;
                    let factor = if is_irradiance { std::f32::consts::PI } else { 1.0 };
                    Values::Floats(channels(&pixels, *count, factor))
                }
                Layer::Instance | Layer::Material => {
                    Values::Numbers(state.seen(&camera, *layer == Layer::Material))
                }
                Layer::Motion => Values::Floats(state.motion(&camera)),
            };
            arrays.push((name.clone(), values, *count));
        }
        if self.layers.iter().any(|(_, layer, _)| *layer == Layer::Motion) {
            state.before = Some((state.staged.scene.clone(), camera));
        }
        Ok(arrays)
    }
}

impl State {
    /// Width over height.
    fn aspect(&self) -> f32 {
        let size = self.engine.settings().size.as_vec2();
        size.x / size.y
    }

    /// Finds the camera that an argument names.
    fn resolve(&self, argument: CameraArgument) -> Result<Camera, Fault> {
        camera(argument, &self.staged.scene, self.aspect())
    }

    /// The triangles of the present scene.
    fn picker(&mut self) -> Arc<Picker> {
        let scene = &self.staged.scene;
        self.picker.get_or_insert_with(|| Arc::new(Picker::new(scene))).clone()
    }

    /// The motion of visible points since the previous picture; 0 if there is none.
    fn motion(&mut self, camera: &Camera) -> Vec<f32> {
        let size = self.engine.settings().size;
        let picker = self.picker();
        let now = Shot { scene: &self.staged.scene, camera };
        let before = self.before.as_ref();
        let before = before.map_or(now, |(scene, camera)| Shot { scene, camera });
        motion(now, before, &picker, size)
    }

    /// The number of the instance, or of its material, at the middle of each pixel; -1 in the
    /// background.
    fn seen(&mut self, camera: &Camera, is_of_materials: bool) -> Vec<i32> {
        let picker = self.picker();
        let scene = &self.staged.scene;
        let size = self.engine.settings().size;
        let pixels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)));
        let number = |pixel: UVec2| {
            let (eye, direction) = camera.ray(pixel.as_vec2() + Vec2::splat(0.5), size);
            picker.pick(eye, direction).map_or(-1, |pick| {
                let placed = pick.instance;
                let number =
                    if is_of_materials { scene.instances[placed].material } else { placed };
                number as i32
            })
        };
        pixels.map(number).collect()
    }
}

/// Whether scenes differ in nothing but lights, surroundings and places of instances.
fn are_same_surfaces(was: &Model, now: &Model) -> bool {
    let uses = |scene: &Model| -> Vec<_> {
        scene.instances.iter().map(|placed| (placed.material, placed.is_voxelized)).collect()
    };
    uses(was) == uses(now)
        && was.materials == now.materials
        && was.textures == now.textures
        && was.meshes == now.meshes
}

/// The arrays for Python.
fn arrays(py: Python<'_>, made: Made) -> PyResult<Arrays<'_>> {
    let arrays = made.into_iter().map(|(name, values, channels)| match values {
        Values::Floats(values) => Ok((name, array(py, &values)?, channels, "f4")),
        Values::Numbers(values) => Ok((name, array(py, &values)?, channels, "i4")),
    });
    arrays.collect()
}

/// The first channels of pixels, times a factor.
fn channels(pixels: &[[f32; 4]], count: usize, factor: f32) -> Vec<f32> {
    pixels.iter().flat_map(|pixel| pixel[..count].iter().map(|value| value * factor)).collect()
}
