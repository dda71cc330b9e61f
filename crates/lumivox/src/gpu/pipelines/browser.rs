//! Asynchronous creation of pipelines in browsers, without blocking the page.
//!
//! wgpu only calls `createComputePipeline` and `createRenderPipeline`; the browser then compiles
//! one pipeline after the other, in the process that does all GPU work. Their `Async` variants take
//! the same descriptors. So our function replaces the device's method during two calls of wgpu: in
//! the first it captures the descriptor, and in the second, once the browser has created the
//! pipeline, it returns that. Nothing is compiled twice.

use js_sys::{Function, Object, Promise, Reflect};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::JsFuture;

use super::lazy::Pending;

impl Pending {
    /// The device's method that creates this pipeline.
    fn method(&self) -> &'static str {
        match self {
            Self::Compute(_) => "createComputePipeline",
            Self::Draw(_) => "createRenderPipeline",
        }
    }
}

/// Creates all pipelines in parallel.
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
            // If the browser has rejected a pipeline, it rejects it again here, so that the
            // device's error handlers are called.
            _ => pipeline.make(),
        }
        progress(done, pending.len() as u32);
    }
}

/// Starts to create a pipeline; `None` if the browser has no such method.
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
    // An own property hides that of the prototype.
    let is_set = Reflect::set(device, &name, own.as_ref().unchecked_ref());
    run();
    if is_set.is_ok() {
        let _ = Reflect::delete_property(device.unchecked_ref::<Object>(), &name);
    }
}
