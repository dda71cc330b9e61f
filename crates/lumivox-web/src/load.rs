//! Loading scenes and panoramas: built-in ones, addresses, files.

use std::sync::Arc;

use js_sys::{Array, Uint8Array};
use lumivox_console::{LoadArgs, SceneRequest, SceneSource};
use lumivox_scene::{EnvironmentMap, LoadOptions, MemoryBudget, Scene, builtin};
use wasm_bindgen::prelude::*;

use crate::error::{Code, WebError};
use crate::files::Files;
use crate::listener::Listener;

const BUILTIN: &str = "builtin:";

/// The memory budget of a scene: a browser gives a page at most 4 GiB in all.
const BUDGET: MemoryBudget = MemoryBudget { texture_bytes: 512 << 20, geometry_bytes: 1 << 30 };

#[wasm_bindgen(module = "/src/fetch.js")]
extern "C" {
    #[wasm_bindgen(js_name = fetchBytes, catch)]
    async fn fetch_bytes(
        address: &str,
        tell: &Closure<dyn FnMut(f64, f64)>,
        signal: &JsValue,
    ) -> Result<JsValue, JsValue>;

    #[wasm_bindgen(js_name = readBytes, catch)]
    async fn read_bytes(file: &web_sys::Blob) -> Result<JsValue, JsValue>;
}

/// A scene with everything that was loaded for it.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// Its address, or the name of its file.
    pub name: String,
    /// Its new surroundings.
    pub panorama: Option<Arc<EnvironmentMap>>,
    /// Sentences on ignored files.
    pub notes: Vec<String>,
}

/// The source of a scene or a panorama.
enum Source {
    Files(Array),
    Address(String),
}

impl Source {
    fn of(source: &JsValue, what: &str) -> Result<Self, WebError> {
        if let Some(file) = source.dyn_ref::<web_sys::File>() {
            return Ok(Self::Files(Array::of1(file)));
        }
        if let Some(url) = source.dyn_ref::<web_sys::Url>() {
            return Ok(Self::Address(url.href()));
        }
        if source.is_object()
            && let Ok(Some(files)) = js_sys::try_iter(source)
        {
            return Ok(Self::Files(files.filter_map(Result::ok).collect()));
        }
        source.as_string().map(Self::Address).ok_or_else(|| WebError::value(what))
    }
}

/// Loads the scene of `source`: text, a `URL`, a `File` or several; optionally with a panorama from
/// another source.
///
/// # Errors
/// When the source is none of these, cannot be fetched, is not a scene, or loading was cancelled.
pub async fn load(
    source: &JsValue,
    panorama: &JsValue,
    listener: &Listener,
) -> Result<Loaded, WebError> {
    listener.check().await?;
    let what = "a scene is an address, \"builtin:NAME\", a File, or a list of Files";
    let mut loaded = match Source::of(source, what)? {
        Source::Files(files) => load_files(&files, listener).await?,
        Source::Address(text) => {
            let scene = match text.strip_prefix(BUILTIN) {
                Some(name) => builtin::scene(name)?,
                None => fetch(&text, None, listener).await?,
            };
            Loaded { scene, name: text, panorama: None, notes: Vec::new() }
        }
    };
    if !panorama.is_undefined() && !panorama.is_null() {
        loaded.panorama = Some(Arc::new(load_panorama(panorama, listener).await?));
    }
    for warning in loaded.panorama.iter().flat_map(|map| &map.warnings) {
        loaded.notes.push(warning.clone());
    }
    listener.check().await?;
    Ok(loaded)
}

/// Loads and lights the scene of a console's request.
///
/// # Errors
/// As [`load`].
pub async fn load_as(opening: &SceneRequest, listener: &Listener) -> Result<Scene, WebError> {
    opening.load.check(&opening.source)?;
    let mut scene = match &opening.source {
        SceneSource::Builtin(name) => builtin::scene(name)?,
        SceneSource::File(address) => {
            fetch(&address.to_string_lossy(), Some(&opening.load), listener).await?
        }
    };
    opening.load.turn(&mut scene);
    let panorama = match opening.light.panorama().map(|file| file.to_string_lossy()) {
        None => None,
        Some(file) => Some(EnvironmentMap::from_memory(&file, &bytes_at(&file, listener).await?)?),
    };
    opening.light.light(&mut scene, panorama)?;
    Ok(scene)
}

/// Fetches the file at an address.
///
/// # Errors
/// When it is not an address, or nothing is there.
pub async fn bytes_at(address: &str, listener: &Listener) -> Result<Vec<u8>, WebError> {
    fetch_there(&address_of(address)?, listener).await
}

/// Loads a panorama.
///
/// # Errors
/// As [`load`].
pub async fn load_panorama(
    source: &JsValue,
    listener: &Listener,
) -> Result<EnvironmentMap, WebError> {
    let what = "a panorama is an address or a File";
    let (name, bytes) = match Source::of(source, what)? {
        Source::Files(list) => {
            let files = read_files(&list, listener).await?;
            let name = files.panorama()?.ok_or_else(|| files.no_panorama())?.to_owned();
            let bytes = files.get(&name).unwrap_or_default().to_vec();
            (name, bytes)
        }
        Source::Address(address) => {
            let url = address_of(&address)?;
            (name_in(&url), fetch_there(&url, listener).await?)
        }
    };
    listener.check().await?;
    listener.tell("reading", 0.0, 0.0);
    Ok(EnvironmentMap::from_memory(&name, &bytes)?)
}

async fn load_files(list: &Array, listener: &Listener) -> Result<Loaded, WebError> {
    let files = read_files(list, listener).await?;
    let file = files.scene()?.to_owned();
    let scene = parse(&files, &file, None, listener)?;
    // With several panoramas none is chosen: the scene does not say which, and needs none.
    let (name, notes) = match files.panorama() {
        Ok(name) => (name, Vec::new()),
        Err(error) => (None, vec![error.message]),
    };
    let read = |name: &str| {
        EnvironmentMap::from_memory(name, files.get(name).unwrap_or_default()).map(Arc::new)
    };
    let panorama = name.map(read).transpose()?;
    Ok(Loaded { scene, name: file, panorama, notes })
}

async fn read_files(list: &Array, listener: &Listener) -> Result<Files, WebError> {
    let mut files = Files::default();
    let total = f64::from(list.length());
    for (number, file) in list.iter().enumerate() {
        let Ok(file) = file.dyn_into::<web_sys::File>() else {
            return Err(WebError::value("a list of files must contain only File objects"));
        };
        listener.check().await?;
        listener.tell("fetching", number as f64, total);
        // The path within a chosen folder; otherwise empty.
        let path = js_sys::Reflect::get(&file, &"webkitRelativePath".into()).ok();
        let path = path.and_then(|path| path.as_string()).filter(|path| !path.is_empty());
        let path = path.unwrap_or_else(|| file.name());
        let bytes = read_bytes(&file).await;
        let bytes = bytes.map_err(|error| unreadable(&path, &error, listener))?;
        files.add(&path, Uint8Array::new(&bytes).to_vec());
    }
    listener.check().await?;
    Ok(files)
}

/// Fetches a scene with the files that it names: loaders record missing files, and run again once
/// these are there.
async fn fetch(
    address: &str,
    asked: Option<&LoadArgs>,
    listener: &Listener,
) -> Result<Scene, WebError> {
    let address = address_of(address)?;
    let (name, url) = place_of(&address);
    let mut files = Files::default();
    files.add(&name, fetch_there(&address, listener).await?);
    let mut tried = std::collections::BTreeSet::new();
    loop {
        listener.check().await?;
        // Drop warnings: missing files may be there in the next round. The last round's warnings
        // are logged below.
        let nobody = tracing::subscriber::NoSubscriber::default();
        let loaded =
            tracing::subscriber::with_default(nobody, || parse(&files, &name, asked, listener));
        let mut has_more = false;
        for missing in files.take_missing() {
            if !tried.insert(missing.clone()) {
                continue;
            }
            let Some(url) = resolve(&escape(&missing), Some(&url)) else { continue };
            if let Some(bytes) = get(&url.href(), listener).await? {
                files.add(&missing, bytes);
                has_more = true;
            }
        }
        if !has_more {
            for warning in loaded.iter().flat_map(|scene| &scene.notes.warnings) {
                tracing::warn!("{name}: {warning}");
            }
            return loaded;
        }
    }
}

fn address_of(address: &str) -> Result<web_sys::Url, WebError> {
    resolve(address, None)
        .ok_or_else(|| WebError::new(Code::Fetch, format!("{address}: is not a web address")))
}

/// The name of the file at an address.
fn name_in(url: &web_sys::Url) -> String {
    let path = url.pathname();
    let name = path.rsplit('/').next().unwrap_or_default();
    js_sys::decode_uri_component(name).map_or_else(|_| name.to_owned(), String::from)
}

/// The path of the file at an address, and the address that its relative paths start at. A folder
/// `scenes` belongs to the path, since VXCT's models are in the folder above it.
fn place_of(address: &web_sys::Url) -> (String, web_sys::Url) {
    let name = name_in(address);
    let folder = address.pathname().rsplit('/').nth(1).unwrap_or_default().to_owned();
    let above = || resolve("..", Some(address)).or_else(|| resolve(".", Some(address)));
    match above().filter(|_| folder.eq_ignore_ascii_case("scenes")) {
        Some(above) => (format!("{folder}/{name}"), above),
        None => (name, address.clone()),
    }
}

/// Fetches the file at an address; a missing file is an error.
async fn fetch_there(url: &web_sys::Url, listener: &Listener) -> Result<Vec<u8>, WebError> {
    get(&url.href(), listener).await?.ok_or_else(|| {
        let reason =
            format!("{}: there is no such file on the server; check the address", url.href());
        WebError::new(Code::Fetch, reason)
    })
}

fn resolve(address: &str, base: Option<&web_sys::Url>) -> Option<web_sys::Url> {
    if let Some(base) = base {
        return web_sys::Url::new_with_base(address, &base.href()).ok();
    }
    // Relative addresses start at the page, or at the worker's script.
    let here = js_sys::Reflect::get(&js_sys::global(), &"location".into()).ok()?;
    let here = js_sys::Reflect::get(&here, &"href".into()).ok()?.as_string()?;
    web_sys::Url::new_with_base(address, &here).ok()
}

/// Percent-encodes a path.
fn escape(path: &str) -> String {
    let words = path.split('/').map(|word| String::from(js_sys::encode_uri_component(word)));
    words.collect::<Vec<_>>().join("/")
}

async fn get(address: &str, listener: &Listener) -> Result<Option<Vec<u8>>, WebError> {
    let hearer = listener.clone();
    let tell = Closure::new(move |done, total| hearer.tell("fetching", done, total));
    let bytes = fetch_bytes(address, &tell, listener.signal()).await;
    let bytes = bytes.map_err(|error| unreadable(address, &error, listener))?;
    Ok((!bytes.is_null()).then(|| Uint8Array::new(&bytes).to_vec()))
}

fn unreadable(what: &str, error: &JsValue, listener: &Listener) -> WebError {
    if listener.is_cancelled() {
        return WebError::new(Code::Aborted, "loading was cancelled");
    }
    let reason = error.dyn_ref::<js_sys::Error>().map(|error| String::from(error.message()));
    let reason = reason.unwrap_or_else(|| "no reason given".to_owned());
    WebError::new(
        Code::Fetch,
        format!(
            "{what}: cannot be read: {reason}; check the address, and that its server allows other sites to read it"
        ),
    )
}

/// Reads the scene; `files` records missing files.
fn parse(
    files: &Files,
    name: &str,
    asked: Option<&LoadArgs>,
    listener: &Listener,
) -> Result<Scene, WebError> {
    let mut tell = |step: lumivox_scene::LoadProgress| {
        listener.tell(step.stage, step.done as f64, step.total as f64);
    };
    // A page has no options for dropped files; the scene's notes name possible errors.
    let of_page =
        || LoadOptions { ignore_required: true, budget: BUDGET, ..LoadOptions::default() };
    let mut options = LoadOptions {
        files: Some(files),
        progress: Some(&mut tell),
        ..asked.map_or_else(of_page, LoadArgs::options)
    };
    options.budget = MemoryBudget {
        texture_bytes: options.budget.texture_bytes.min(BUDGET.texture_bytes),
        geometry_bytes: options.budget.geometry_bytes.min(BUDGET.geometry_bytes),
    };
    Ok(Scene::load_with(name, &mut options)?)
}
