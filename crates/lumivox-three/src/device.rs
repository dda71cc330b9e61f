//! The page's device as a device of wgpu.
//!
//! wgpu only accepts devices that it has requested itself. So for one call, `requestDevice` of all
//! adapters is replaced by a function that returns the page's device. The call is synchronous, so
//! no other code can call the replacement.

use js_sys::{Function, Object, Promise, Reflect};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};

use crate::error::PageError;

/// Turns the page's `GPUDevice` into a device of wgpu.
///
/// # Errors
/// When the browser has no WebGPU, or no adapter.
pub async fn adopt(device: &JsValue) -> Result<(wgpu::Device, wgpu::Queue), PageError> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = instance
        .request_adapter(&wgpu::RequestAdapterOptions::default())
        .await
        .map_err(|error| PageError::device(format!("the browser has no GPU adapter: {error}")))?;
    let prototype = Reflect::get(&js_sys::global(), &"GPUAdapter".into())
        .and_then(|class| Reflect::get(&class, &"prototype".into()))
        .ok()
        .filter(JsValue::is_object)
        .ok_or_else(|| PageError::device("the browser has no WebGPU: there is no GPUAdapter"))?;
    let name = JsValue::from_str("requestDevice");
    let own = Reflect::get(&prototype, &name).map_err(|_| refused())?;
    let given = device.clone();
    let stand_in =
        Closure::<dyn FnMut(JsValue) -> Promise>::new(move |_: JsValue| Promise::resolve(&given));
    let is_set = Reflect::set(&prototype, &name, stand_in.as_ref().unchecked_ref::<Function>());
    if is_set != Ok(true) {
        return Err(refused());
    }
    let requested = adapter.request_device(&wgpu::DeviceDescriptor::default());
    let is_restored = Reflect::set(prototype.unchecked_ref::<Object>(), &name, &own);
    if is_restored != Ok(true) {
        return Err(refused());
    }
    requested.await.map_err(|error| PageError::device(format!("the device is of no use: {error}")))
}

fn refused() -> PageError {
    PageError::device(
        "the browser's class GPUAdapter cannot be changed, so the renderer's device cannot be shared; \
         let no other code freeze it",
    )
}
