//! Making pipelines in browsers asynchronously, while the page continues.
//!
//! wgpu only calls `createComputePipeline` and `createRenderPipeline`: the browser then compiles
//! one after the other, in the process that all GPU work waits for. Their `Async` siblings take the
//! same descriptors. So during one call our function replaces the device's method: first it takes
//! the descriptor, and once the browser has made the pipeline, another function returns it to wgpu.
//! Nothing is compiled twice.

use js_sys::{Function, Object, Promise, Reflect};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::JsFuture;

use super::lazy::Pending;

impl Pending {
    /// The device's method that makes this pipeline.
    fn method(&self) -> &'static str {
        match self {
            Self::Compute(_) => "createComputePipeline",
            Self::Draw(_) => "createRenderPipeline",
        }
    }
}

/// Makes all pipelines at once.
pub(super) async fn make(
    device: &wgpu::Device,
    pending: &[Pending],
    progress: &mut dyn FnMut(u32, u32),
) {
    let device: Option<JsValue> = device.as_webgpu().map(|device| device.clone().into());
    let started: Vec<Option<Promise>> = pending
        .iter()
        .map(|pipeline| device.as_ref().and_then(|device| start(device, pipeline)))
        .collect();
    for (done, (pipeline, promise)) in (1..).zip(pending.iter().zip(started)) {
        let made = match promise {
            Some(promise) => JsFuture::from(promise).await.ok(),
            None => None,
        };
        match (&device, made) {
            (Some(device), Some(made)) => {
                stand_in(device, pipeline.method(), |_| made.clone(), || pipeline.make());
            }
            // A pipeline that the browser refuses is refused again, and the device's error handlers
            // see it.
            _ => pipeline.make(),
        }
        progress(done, pending.len() as u32);
    }
}

/// Starts to make a pipeline; `None` if the browser has no such method.
fn start(device: &JsValue, pipeline: &Pending) -> Option<Promise> {
    let asynchronous = format!("{}Async", pipeline.method());
    let create: Function = Reflect::get(device, &asynchronous.into()).ok()?.dyn_into().ok()?;
    let mut descriptor = None;
    let take = |given| {
        descriptor = Some(given);
        Object::new().into()
    };
    stand_in(device, pipeline.method(), take, || pipeline.rehearse());
    create.call1(device, &descriptor?).ok()?.dyn_into().ok()
}

/// Calls `run` while `function` replaces the device's method `name`.
fn stand_in(
    device: &JsValue,
    name: &str,
    mut function: impl FnMut(JsValue) -> JsValue,
    run: impl FnOnce(),
) {
    let mut call: &mut dyn FnMut(JsValue) -> JsValue = &mut function;
    let own = Closure::borrow_mut(&mut call);
    let name = JsValue::from_str(name);
    // An object's own property hides its prototype's.
    let is_set = Reflect::set(device, &name, own.as_ref().unchecked_ref());
    run();
    if is_set.is_ok() {
        let _ = Reflect::delete_property(device.unchecked_ref::<Object>(), &name);
    }
}
