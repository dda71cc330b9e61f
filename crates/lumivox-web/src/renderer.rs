//! The API for JavaScript: a class and functions.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use async_lock::{Mutex, MutexGuard};
use glam::{UVec2, Vec2};
use lumivox_explorer::ChangeQueue;
use lumivox_explorer::parameters::PRESETS;
use lumivox_render::PresetChoice;
use tsify::Ts;
use wasm_bindgen::prelude::*;

use crate::console::ran;
use crate::error::{Code, WebError};
use crate::js::{from_js, keys, of_text_of, to_js};
use crate::listener::Listener;
use crate::load::{load, load_panorama};
use crate::present::Canvas;
use crate::session::Session;
use crate::settings::Settings;
use crate::types::{
    Camera, EnvironmentChange, EnvironmentInfo, FrameReport, HistogramInfo, Light, LightHere,
    LightKindInfo, LoadingOptions, Material, MaterialChange, MemoryInfo, Named, ParameterInfo,
    Picked, SceneInfo, SceneOptions, Split,
};

#[wasm_bindgen(typescript_custom_section)]
const SETTINGS: &'static str = include_str!("settings.d.ts");

#[wasm_bindgen(typescript_custom_section)]
const OTHERS: &'static str = r#"
/** Gets reports of the progress of a call. */
export type OnProgress = (progress: Progress) => void;
/** The result of console lines: the text they print, the files they write, and the scene they opened last. */
export interface Ran { text: string; files: File[]; opened?: string }
/** Completions of the last word of a line, and the index where the word begins. */
export interface Completion { start: number; candidates: string[] }
/** Errors of this package: `message` names the problem and the remedy, `code` the kind of error. */
export interface LumivoxError extends Error {
  /** The text that the lines of a script had printed before. */
  printed?: string;
  code: "no-webgpu" | "no-adapter" | "device" | "limit" | "scene" | "fetch" | "value";
}
"#;

#[wasm_bindgen(module = "/src/fetch.js")]
extern "C" {
    #[wasm_bindgen(js_name = hasWebGpu)]
    fn has_web_gpu() -> bool;

    #[wasm_bindgen(js_name = fileOf)]
    fn file_of(name: &str, bytes: &[u8]) -> JsValue;
}

/// Runs once, when the module is loaded.
#[wasm_bindgen(start)]
fn start() {
    use tracing_subscriber::prelude::*;
    console_error_panic_hook::set_once();
    let console = tracing_subscriber::fmt::layer()
        .with_ansi(false)
        .without_time()
        .with_writer(tracing_web::MakeWebConsoleWriter::new().with_pretty_level());
    let filter = tracing_subscriber::filter::LevelFilter::WARN;
    // Another subscriber may already be set.
    let _ = tracing_subscriber::registry().with(console.with_filter(filter)).try_init();
}

/// The built-in scenes, for `loadScene("builtin:NAME")`.
#[wasm_bindgen(js_name = builtinScenes)]
pub fn builtin_scenes() -> Result<Vec<Ts<Named>>, JsValue> {
    let scenes = lumivox_scene::builtin::names().iter();
    scenes
        .map(|name| {
            let title = name.replace('-', " ");
            let summary = lumivox_scene::builtin::about(name).unwrap_or_default().to_owned();
            to_js(&Named { name: (*name).to_owned(), title, summary })
        })
        .collect()
}

/// All settings: their names, ranges and defaults.
#[wasm_bindgen]
pub fn parameters() -> Result<Vec<Ts<ParameterInfo>>, JsValue> {
    ParameterInfo::all().iter().map(to_js).collect()
}

/// The kinds of light and their fields.
#[wasm_bindgen(js_name = lightKinds)]
pub fn light_kinds() -> Result<Vec<Ts<LightKindInfo>>, JsValue> {
    LightKindInfo::all().iter().map(to_js).collect()
}

/// The presets, for `setPreset`.
#[wasm_bindgen]
pub fn presets() -> Result<Vec<Ts<Named>>, JsValue> {
    let named = |preset: &PresetChoice| {
        let (title, summary) = (preset.name().to_owned(), preset.summary().to_owned());
        to_js(&Named { name: title.clone(), title, summary })
    };
    PRESETS.iter().map(named).collect()
}

/// Makes a renderer that draws on a canvas: an element, or an `OffscreenCanvas` for workers.
///
/// Throws an error with the code `no-webgpu` if the browser has no WebGPU, and `no-adapter` if it
/// has no GPU for it.
#[wasm_bindgen(js_name = createRenderer)]
pub async fn create_renderer(
    #[wasm_bindgen(unchecked_param_type = "HTMLCanvasElement | OffscreenCanvas")] canvas: JsValue,
) -> Result<Renderer, JsValue> {
    if !has_web_gpu() {
        return Err(WebError::new(
            Code::NoWebGpu,
            "this browser has no WebGPU here: Chrome and Edge have it since version 113, Safari since 26, Firefox since 141 \
             (Windows) and 145 (macOS), and all of them only at addresses with https, or at localhost",
        )
        .into());
    }
    let canvas = match canvas.dyn_into::<web_sys::HtmlCanvasElement>() {
        Ok(element) => Canvas::Element(element),
        Err(other) => Canvas::Offscreen(other.dyn_into().map_err(|_| {
            WebError::value("a renderer draws on an HTMLCanvasElement or an OffscreenCanvas")
        })?),
    };
    let session = Session::new(canvas).await?;
    Ok(Renderer { session: Rc::new(Mutex::new(session)), changes: RefCell::default() })
}

/// Shows a scene with global illumination on a canvas. Calls may overlap: each waits for the ones
/// before it, and one that only sets something is skipped if a later waiting call sets the same.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Renderer {
    session: Rc<Mutex<Session>>,
    /// Waiting calls that only set something.
    changes: RefCell<ChangeQueue<()>>,
}

#[wasm_bindgen]
impl Renderer {
    /// Loads a scene and shows it in place of the last one: `"builtin:NAME"`, an address, a `File`,
    /// or several files that belong together (a .gltf or .obj with the files that it names, and a
    /// .hdr or .exr panorama). If loading fails or is cancelled, the last scene stays, except after
    /// errors of the device. A view and light are chosen for a file that lacks them;
    /// `scene().notes` names the choice, and `options` override it.
    #[wasm_bindgen(js_name = loadScene)]
    pub async fn load_scene(
        &self,
        #[wasm_bindgen(unchecked_param_type = "string | URL | File | Iterable<File>")]
        source: JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "OnProgress | null", js_name = onProgress)]
        on_progress: Option<js_sys::Function>,
        #[wasm_bindgen(unchecked_optional_param_type = "SceneOptions | null")] options: JsValue,
    ) -> Result<Ts<SceneInfo>, JsValue> {
        let listener = Listener::new(on_progress).with_signal(&options)?;
        let panorama = js_sys::Reflect::get(&options, &"panorama".into()).unwrap_or_default();
        let options: Option<SceneOptions> = of_text_of(&options, "options of a scene")?;
        let open = async {
            let loaded = load(&source, &panorama, &listener).await?;
            let mut session = self.session().await;
            session.open(loaded, options.unwrap_or_default(), &listener).await
        };
        to_js(&open.await.map_err(|error| listener.exception(error))?)
    }

    /// Puts a panorama of 360 by 180 degrees around the scene, in place of its surroundings: an
    /// address or a `File` (.hdr or .exr; also .png and .jpg).
    #[wasm_bindgen(js_name = loadPanorama)]
    pub async fn load_panorama(
        &self,
        #[wasm_bindgen(unchecked_param_type = "string | URL | File")] source: JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "OnProgress | null", js_name = onProgress)]
        on_progress: Option<js_sys::Function>,
        #[wasm_bindgen(unchecked_optional_param_type = "LoadingOptions | null")] options: JsValue,
    ) -> Result<Ts<EnvironmentInfo>, JsValue> {
        let listener = Listener::new(on_progress).with_signal(&options)?;
        of_text_of::<Option<LoadingOptions>>(&options, "options of loading")?;
        let surround = async {
            let map = load_panorama(&source, &listener).await?;
            let mut session = self.session().await;
            listener.check().await?;
            session.surround(Arc::new(map))
        };
        to_js(&surround.await.map_err(|error| listener.exception(error))?)
    }

    /// The surroundings of the scene.
    pub async fn environment(&self) -> Result<Ts<EnvironmentInfo>, JsValue> {
        to_js(&self.session().await.environment()?)
    }

    /// Changes the surroundings: strength and rotation of a panorama, or uniform light.
    #[wasm_bindgen(js_name = setEnvironment)]
    pub async fn set_environment(&self, change: Ts<EnvironmentChange>) -> Result<(), JsValue> {
        let target = format!("environment {}", keys(&change.js_value()));
        let change = from_js(&change, "a change of surroundings")?;
        let Some(mut session) = self.change(target).await else { return Ok(()) };
        Ok(session.set_environment(&change)?)
    }

    /// Runs a line of the console, or a script of several. Scenes that it loads are open when it
    /// ends; the result is its output and the files that it writes, such as pictures. An error ends
    /// it, and has the output of the lines before in its property `printed`.
    #[wasm_bindgen(unchecked_return_type = "Ran")]
    pub async fn run(
        &self,
        line: String,
        #[wasm_bindgen(unchecked_optional_param_type = "OnProgress | null", js_name = onProgress)]
        on_progress: Option<js_sys::Function>,
        #[wasm_bindgen(unchecked_optional_param_type = "LoadingOptions | null")] options: JsValue,
    ) -> Result<JsValue, JsValue> {
        let listener = Listener::new(on_progress).with_signal(&options)?;
        of_text_of::<Option<LoadingOptions>>(&options, "options of a line")?;
        let mut printed = Vec::new();
        let done = self.run_lines(&line, &mut printed, &listener).await;
        let files = self.session().await.written.take();
        let files: js_sys::Array = files.iter().map(|(name, bytes)| file_of(name, bytes)).collect();
        let printed = printed.join("\n");
        match done {
            Ok(opened) => Ok(ran(&printed, &files, opened)),
            Err(error) => {
                let error = listener.exception(error);
                // A value that is not an object has no properties.
                let _ = js_sys::Reflect::set(&error, &"printed".into(), &printed.into());
                Err(error)
            }
        }
    }

    /// The possible completions of the last word of a line of the console.
    #[wasm_bindgen(unchecked_return_type = "Completion")]
    pub async fn complete(&self, line: String) -> Result<JsValue, JsValue> {
        let (start, candidates) = self.session().await.complete(&line);
        let candidates: js_sys::Array = candidates.iter().map(JsValue::from).collect();
        let completion = js_sys::Object::new();
        js_sys::Reflect::set(&completion, &"start".into(), &(start as f64).into())?;
        js_sys::Reflect::set(&completion, &"candidates".into(), &candidates)?;
        Ok(completion.into())
    }

    /// The properties of the scene; undefined before one is loaded.
    pub async fn scene(&self) -> Result<Option<Ts<SceneInfo>>, JsValue> {
        self.session().await.info().as_ref().map(to_js).transpose()
    }

    /// All settings by name.
    #[wasm_bindgen(unchecked_return_type = "Required<Settings>")]
    pub async fn settings(&self) -> Result<JsValue, JsValue> {
        let serializer = tsify::serde_wasm_bindgen::Serializer::json_compatible();
        let settings = self.session().await.settings();
        Ok(serde::Serialize::serialize(&settings, &serializer)?)
    }

    /// Changes settings; those that are not named stay. If one is wrong or the device refuses,
    /// nothing changes.
    pub async fn set(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Settings")] changes: JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "OnProgress | null", js_name = onProgress)]
        on_progress: Option<js_sys::Function>,
    ) -> Result<(), JsValue> {
        let changes: Settings =
            tsify::serde_wasm_bindgen::from_value(changes).map_err(|error| {
                WebError::value(format!("settings are an object of names and values: {error}"))
            })?;
        let names: Vec<&str> = changes.keys().map(String::as_str).collect();
        let target = format!("settings {}", names.join(" "));
        let Some(mut session) = self.change(target).await else { return Ok(()) };
        Ok(session.set(&changes, &Listener::new(on_progress)).await?)
    }

    /// The preset that the settings started from.
    pub async fn preset(&self) -> String {
        self.session().await.console.explorer.preset().name().to_owned()
    }

    /// Applies the settings of a preset (`presets()` lists them); picture, view and resolution
    /// stay.
    #[wasm_bindgen(js_name = setPreset)]
    pub async fn set_preset(
        &self,
        name: String,
        #[wasm_bindgen(unchecked_optional_param_type = "OnProgress | null", js_name = onProgress)]
        on_progress: Option<js_sys::Function>,
    ) -> Result<(), JsValue> {
        Ok(self.session().await.set_preset(&name, &Listener::new(on_progress)).await?)
    }

    /// The camera of the picture.
    pub async fn camera(&self) -> Result<Ts<Camera>, JsValue> {
        to_js(&self.session().await.camera())
    }

    /// Moves the camera; the picture starts again. With `moving`, pictures have fewer pixels for a
    /// moment if frames take longer than their budget, so that dragging stays responsive.
    #[wasm_bindgen(js_name = setCamera)]
    pub async fn set_camera(
        &self,
        camera: Ts<Camera>,
        #[wasm_bindgen(unchecked_optional_param_type = "boolean")] moving: Option<bool>,
    ) -> Result<(), JsValue> {
        let camera = from_js(&camera, "a camera")?;
        let Some(mut session) = self.change("camera".to_owned()).await else { return Ok(()) };
        Ok(session.set_camera(&camera, moving.unwrap_or(false))?)
    }

    /// Sets the milliseconds that a frame may take while something moves, from 0 to 10 000. If frames
    /// take longer, pictures have fewer pixels until the scene has been at rest for a moment; at 0
    /// never. Default: 33.
    #[wasm_bindgen(js_name = setFrameBudget)]
    pub async fn set_frame_budget(&self, milliseconds: f32) -> Result<(), JsValue> {
        Ok(self.session().await.set_frame_budget(milliseconds)?)
    }

    /// Changes the light of this number in `scene().lights`.
    #[wasm_bindgen(js_name = setLight)]
    pub async fn set_light(
        &self,
        number: usize,
        #[wasm_bindgen(unchecked_param_type = "Light")] light: JsValue,
    ) -> Result<(), JsValue> {
        let light = of_text_of(&light, "a light")?;
        let Some(mut session) = self.change(format!("light {number}")).await else { return Ok(()) };
        Ok(session.set_light(number, &light)?)
    }

    /// Adds a light and returns its number.
    #[wasm_bindgen(js_name = addLight)]
    pub async fn add_light(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Light")] light: JsValue,
    ) -> Result<usize, JsValue> {
        let light: Light = of_text_of(&light, "a light")?;
        let number = self.session().await.edit_lights(|lights| {
            lights.push(light.to_scene()?);
            Ok(lights.len() - 1)
        })?;
        Ok(number)
    }

    /// Removes the light of this number; those after it move up.
    #[wasm_bindgen(js_name = removeLight)]
    pub async fn remove_light(&self, number: usize) -> Result<(), JsValue> {
        Ok(self.session().await.remove_light(number)?)
    }

    /// The present materials.
    pub async fn materials(&self) -> Result<Vec<Ts<Material>>, JsValue> {
        self.session().await.materials()?.iter().map(to_js).collect()
    }

    /// Changes the material of this number in `materials()`; properties that are not named stay.
    #[wasm_bindgen(js_name = setMaterial)]
    pub async fn set_material(
        &self,
        number: usize,
        change: Ts<MaterialChange>,
    ) -> Result<(), JsValue> {
        let target = format!("material {number} {}", keys(&change.js_value()));
        let change = from_js(&change, "a change of a material")?;
        let Some(mut session) = self.change(target).await else { return Ok(()) };
        Ok(session.set_material(number, &change)?)
    }

    /// The surface at a place of the picture; x is from 0 (left) to 1, y from 0 (top) to 1.
    /// Undefined where there is none.
    pub async fn pick(&self, x: f32, y: f32) -> Result<Option<Ts<Picked>>, JsValue> {
        self.session().await.pick(Vec2::new(x, y))?.as_ref().map(to_js).transpose()
    }

    /// The light at a place of the picture as in `pick`, from its frames so far; undefined before
    /// the first one, beside another picture, and in views without light.
    pub async fn probe(&self, x: f32, y: f32) -> Result<Option<Ts<LightHere>>, JsValue> {
        self.session().await.probe(Vec2::new(x, y)).await?.as_ref().map(to_js).transpose()
    }

    /// The histogram of the picture's luminance; undefined before the first frame.
    pub async fn histogram(&self) -> Result<Option<Ts<HistogramInfo>>, JsValue> {
        self.session().await.histogram().as_ref().map(to_js).transpose()
    }

    /// Undoes the last change of settings, lights, materials, surroundings or objects, and returns
    /// its description. The reports of frames say whether there is one.
    pub async fn undo(&self) -> Result<String, JsValue> {
        Ok(self.session().await.step(true).await?)
    }

    /// Redoes the change that was undone last.
    pub async fn redo(&self) -> Result<String, JsValue> {
        Ok(self.session().await.step(false).await?)
    }

    /// Ends a drag: until then, changes of the same thing are one step for `undo`.
    #[wasm_bindgen(js_name = endGesture)]
    pub async fn end_gesture(&self) {
        self.session().await.end_gesture();
    }

    /// Hides the object of this number in `scene().objects`, or shows it.
    #[wasm_bindgen(js_name = setHidden)]
    pub async fn set_hidden(&self, object: usize, hidden: bool) -> Result<(), JsValue> {
        Ok(self.session().await.set_hidden(object, hidden)?)
    }

    /// Plays the animation of this number in `scene().animations`; null stops.
    pub async fn play(&self, animation: Option<usize>) -> Result<(), JsValue> {
        Ok(self.session().await.play(animation)?)
    }

    /// Shows a time of the animation, in seconds.
    #[wasm_bindgen(js_name = setTime)]
    pub async fn set_time(&self, seconds: f32) -> Result<(), JsValue> {
        Ok(self.session().await.seek(seconds)?)
    }

    /// Shows another view or the reference on the right; null shows one picture again.
    #[wasm_bindgen(js_name = setSplit)]
    pub async fn set_split(&self, split: Option<Ts<Split>>) -> Result<(), JsValue> {
        let split = split.map(|split| from_js(&split, "a split")).transpose()?;
        let Some(mut session) = self.change("split".to_owned()).await else { return Ok(()) };
        Ok(session.set_split(split.as_ref())?)
    }

    /// Sets whether reports of frames contain the times of stages; measuring them takes some time
    /// itself. Default: no.
    #[wasm_bindgen(js_name = setTimed)]
    pub async fn set_timed(&self, timed: bool) {
        self.session().await.console.explorer.set_timed(timed);
    }

    /// Sets the size of canvas and picture, in device pixels.
    pub async fn resize(&self, width: u32, height: u32) -> Result<(), JsValue> {
        let size = UVec2::new(width, height);
        let Some(mut session) = self.change("size".to_owned()).await else { return Ok(()) };
        Ok(session.resize(size, &Listener::new(None)).await?)
    }

    /// Renders one more frame and shows it. Once its report says `complete`, nothing is left to do
    /// until something changes.
    pub async fn render(&self) -> Result<Ts<FrameReport>, JsValue> {
        to_js(&self.session().await.render().await?)
    }

    /// The pixels of the canvas, four bytes each: red, green, blue, 255; row by row from the top.
    #[wasm_bindgen(js_name = readPixels, unchecked_return_type = "ImageData")]
    pub async fn read_pixels(&self) -> Result<JsValue, JsValue> {
        let (size, pixels) = self.session().await.pixels().await?;
        let opaque: Vec<u8> = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b, 255]).collect();
        // A copy: `ImageData` keeps its buffer, and this vector is dropped.
        let own = js_sys::Uint8ClampedArray::from(opaque.as_slice());
        let image = web_sys::ImageData::new_with_js_u8_clamped_array_and_sh(&own, size.x, size.y)?;
        Ok(image.into())
    }

    /// GPU memory by use.
    pub async fn memory(&self) -> Result<Vec<Ts<MemoryInfo>>, JsValue> {
        self.session().await.memory().iter().map(to_js).collect()
    }

    /// The WebGPU device, to be shared with other WebGPU code.
    #[wasm_bindgen(unchecked_return_type = "GPUDevice")]
    pub async fn device(&self) -> JsValue {
        let session = self.session().await;
        session.gpu().device.as_webgpu().map_or(JsValue::UNDEFINED, |device| device.into())
    }

    /// Whether the device is lost; `restore` continues with another one.
    #[wasm_bindgen(js_name = isLost)]
    pub async fn is_lost(&self) -> bool {
        self.session().await.gpu().is_lost()
    }

    /// Resolves with the reason when the present device is lost, and never before. Call it again
    /// after `restore`.
    pub async fn lost(&self) -> Result<String, JsValue> {
        let device = self.device().await;
        let lost: js_sys::Promise = js_sys::Reflect::get(&device, &"lost".into())?.unchecked_into();
        let info = wasm_bindgen_futures::JsFuture::from(lost).await?;
        let text = |name: &str| js_sys::Reflect::get(&info, &name.into()).ok()?.as_string();
        let message = text("message").filter(|message| !message.is_empty());
        Ok(message.or_else(|| text("reason")).unwrap_or_else(|| "no reason given".to_owned()))
    }

    /// Continues after the device was lost: everything is uploaded to another one.
    pub async fn restore(
        &self,
        #[wasm_bindgen(unchecked_optional_param_type = "OnProgress | null", js_name = onProgress)]
        on_progress: Option<js_sys::Function>,
    ) -> Result<(), JsValue> {
        Ok(self.session().await.restore(&Listener::new(on_progress)).await?)
    }
}

impl Renderer {
    /// Waits until no other call uses the session.
    pub(crate) async fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().await
    }

    /// The session for a call that only sets a target; `None` if a later call supersedes it.
    async fn change(&self, target: String) -> Option<MutexGuard<'_, Session>> {
        let ticket = self.changes.borrow_mut().push(Some(target), ());
        let session = self.session().await;
        self.changes.borrow_mut().take(ticket).map(|()| session)
    }
}
