//! Scenes from where a page has them: built in, at an address, in files.

use js_sys::{Array, Uint8Array};
use lumivox_scene::{LoadOptions, MemoryBudget, Scene, builtin};
use wasm_bindgen::prelude::*;

use crate::error::{Code, WebError};
use crate::files::Files;
use crate::types::Progress;

const BUILTIN: &str = "builtin:";

/// A browser gives a page 4 GiB at most, for all that it does.
const BUDGET: MemoryBudget = MemoryBudget { texture_bytes: 512 << 20, geometry_bytes: 1 << 30 };

#[wasm_bindgen(module = "/src/fetch.js")]
extern "C" {
    #[wasm_bindgen(js_name = fetchBytes, catch)]
    async fn fetch_bytes(
        address: &str,
        tell: &Closure<dyn FnMut(f64, f64)>,
    ) -> Result<JsValue, JsValue>;

    #[wasm_bindgen(js_name = readBytes, catch)]
    async fn read_bytes(file: &web_sys::Blob) -> Result<JsValue, JsValue>;
}

/// What hears how far loading is.
#[derive(Clone, Debug)]
pub struct Listener(Option<js_sys::Function>);

impl Listener {
    /// A page's function, or nobody.
    pub fn new(function: Option<js_sys::Function>) -> Self {
        Self(function)
    }

    /// Tells it. What it throws is its own affair.
    pub fn tell(&self, stage: &str, done: f64, total: f64) {
        if let Some(function) = &self.0 {
            let progress = Progress { stage: stage.to_owned(), done, total };
            let _ = function.call1(
                &JsValue::NULL,
                &tsify::Tsify::into_js(&progress).map_or(JsValue::NULL, Into::into),
            );
        }
    }
}

/// Loads what `source` says: text, a `URL`, a `File` or several.
///
/// # Errors
/// When it is none of these, cannot be fetched, or is no scene.
pub async fn load(source: &JsValue, listener: &Listener) -> Result<Scene, WebError> {
    if let Some(file) = source.dyn_ref::<web_sys::File>() {
        return load_files(&Array::of1(file), listener).await;
    }
    if source.is_object() && !source.is_instance_of::<web_sys::Url>() {
        if let Ok(Some(files)) = js_sys::try_iter(source) {
            let files: Array = files.filter_map(Result::ok).collect();
            return load_files(&files, listener).await;
        }
    }
    let text =
        source.as_string().or_else(|| source.dyn_ref::<web_sys::Url>().map(web_sys::Url::href));
    let Some(text) = text else {
        return Err(WebError::value(
            "a scene is an address, \"builtin:NAME\", a File, or a list of Files",
        ));
    };
    match text.strip_prefix(BUILTIN) {
        Some(name) => Ok(builtin::scene(name)?),
        None => fetch(&text, listener).await,
    }
}

async fn load_files(list: &Array, listener: &Listener) -> Result<Scene, WebError> {
    let mut files = Files::default();
    let total = f64::from(list.length());
    for (number, file) in list.iter().enumerate() {
        let Ok(file) = file.dyn_into::<web_sys::File>() else {
            return Err(WebError::value("what is in a list of files must be File objects"));
        };
        listener.tell("fetching", number as f64, total);
        // Of a whole folder that was chosen; else empty.
        let path = js_sys::Reflect::get(&file, &"webkitRelativePath".into()).ok();
        let path = path.and_then(|path| path.as_string()).filter(|path| !path.is_empty());
        let path = path.unwrap_or_else(|| file.name());
        let bytes = read_bytes(&file).await.map_err(|error| unreadable(&path, &error))?;
        files.add(&path, Uint8Array::new(&bytes).to_vec());
    }
    parse(&files, listener)
}

/// Fetches a scene, and what it names: loaders ask for files, and are asked again when these are there.
async fn fetch(address: &str, listener: &Listener) -> Result<Scene, WebError> {
    let url = resolve(address, None).ok_or_else(|| {
        WebError::new(Code::Fetch, format!("{address}: is no address of the web"))
    })?;
    let path = url.pathname();
    let name = path.rsplit('/').next().unwrap_or_default();
    let name = js_sys::decode_uri_component(name).map_or_else(|_| name.to_owned(), String::from);
    let Some(bytes) = get(&url.href(), listener).await? else {
        let reason =
            format!("{}: there is no such file on the server; check the address", url.href());
        return Err(WebError::new(Code::Fetch, reason));
    };
    let mut files = Files::default();
    files.add(&name, bytes);
    let mut tried = std::collections::BTreeSet::new();
    loop {
        // What is missing in this round may be there in the next: only the last one's warnings are true.
        let nobody = tracing::subscriber::NoSubscriber::default();
        let loaded = tracing::subscriber::with_default(nobody, || parse(&files, listener));
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

fn resolve(address: &str, base: Option<&web_sys::Url>) -> Option<web_sys::Url> {
    if let Some(base) = base {
        return web_sys::Url::new_with_base(address, &base.href()).ok();
    }
    // Relative addresses are relative to the page, or to the worker's script.
    let here = js_sys::Reflect::get(&js_sys::global(), &"location".into()).ok()?;
    let here = js_sys::Reflect::get(&here, &"href".into()).ok()?.as_string()?;
    web_sys::Url::new_with_base(address, &here).ok()
}

/// A path as an address has it.
fn escape(path: &str) -> String {
    let words = path.split('/').map(|word| String::from(js_sys::encode_uri_component(word)));
    words.collect::<Vec<_>>().join("/")
}

async fn get(address: &str, listener: &Listener) -> Result<Option<Vec<u8>>, WebError> {
    let hearer = listener.clone();
    let tell = Closure::new(move |done, total| hearer.tell("fetching", done, total));
    let bytes = fetch_bytes(address, &tell).await.map_err(|error| unreadable(address, &error))?;
    Ok((!bytes.is_null()).then(|| Uint8Array::new(&bytes).to_vec()))
}

fn unreadable(what: &str, error: &JsValue) -> WebError {
    let reason = error.dyn_ref::<js_sys::Error>().map(|error| String::from(error.message()));
    let reason = reason.unwrap_or_else(|| "nobody says why".to_owned());
    WebError::new(
        Code::Fetch,
        format!(
            "{what}: cannot be read: {reason}; check the address, and that its server allows other sites to read it"
        ),
    )
}

/// Makes the scene of files that are all there, or tells which is missing.
fn parse(files: &Files, listener: &Listener) -> Result<Scene, WebError> {
    let name = files.scene()?;
    let mut tell = |step: lumivox_scene::LoadProgress| {
        listener.tell(step.stage, step.done as f64, step.total as f64);
    };
    let mut options = LoadOptions {
        files: Some(files),
        budget: BUDGET,
        // Nobody who drops a file on a page can set options; its notes say what may be wrong.
        ignore_required: true,
        progress: Some(&mut tell),
        ..LoadOptions::default()
    };
    Ok(Scene::load_with(name, &mut options)?)
}
