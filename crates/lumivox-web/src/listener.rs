//! Progress reports to a page, which may cancel the work.

use wasm_bindgen::prelude::*;

use crate::error::{Code, WebError};
use crate::types::Progress;

#[wasm_bindgen(module = "/src/fetch.js")]
extern "C" {
    #[wasm_bindgen(js_name = isSignal)]
    fn is_signal(signal: &JsValue) -> bool;

    #[wasm_bindgen(js_name = isAborted)]
    fn is_aborted(signal: &JsValue) -> bool;

    #[wasm_bindgen(js_name = breathe, catch)]
    async fn breathe() -> Result<JsValue, JsValue>;
}

/// A page's function for progress, and the signal that cancels the work.
#[derive(Clone, Debug)]
pub struct Listener {
    function: Option<js_sys::Function>,
    signal: JsValue,
}

impl Listener {
    /// A listener with a page's function, if there is one.
    pub fn new(function: Option<js_sys::Function>) -> Self {
        Self { function, signal: JsValue::UNDEFINED }
    }

    /// Adds the signal of `options` to the listener.
    ///
    /// # Errors
    /// When `signal` is not an AbortSignal.
    pub fn with_signal(mut self, options: &JsValue) -> Result<Self, WebError> {
        let signal = js_sys::Reflect::get(options, &"signal".into()).unwrap_or_default();
        if !signal.is_undefined() && !signal.is_null() {
            if !is_signal(&signal) {
                return Err(WebError::value("signal must be an AbortSignal"));
            }
            self.signal = signal;
        }
        Ok(self)
    }

    /// Reports progress. Exceptions of the page's function are ignored.
    pub fn tell(&self, stage: &str, done: f64, total: f64) {
        if let Some(function) = &self.function {
            let progress = Progress { stage: stage.to_owned(), done, total };
            let _ = function.call1(
                &JsValue::NULL,
                &tsify::Tsify::into_js(&progress).map_or(JsValue::NULL, Into::into),
            );
        }
    }

    /// The signal, for code that checks it itself.
    pub fn signal(&self) -> &JsValue {
        &self.signal
    }

    /// Whether the signal has cancelled the work.
    pub fn is_cancelled(&self) -> bool {
        is_aborted(&self.signal)
    }

    /// Yields to the browser's messages; one of them may cancel the work.
    ///
    /// # Errors
    /// When the work was cancelled.
    pub async fn check(&self) -> Result<(), WebError> {
        if self.signal.is_undefined() {
            return Ok(());
        }
        // It never fails.
        let _ = breathe().await;
        if self.is_cancelled() {
            return Err(WebError::new(Code::Aborted, "loading was cancelled"));
        }
        Ok(())
    }

    /// The exception for the page: cancelled work fails with the signal's own reason, as `fetch`
    /// does.
    pub fn exception(&self, error: WebError) -> JsValue {
        if error.code == Code::Aborted {
            return js_sys::Reflect::get(&self.signal, &"reason".into())
                .unwrap_or_else(|_| error.into());
        }
        error.into()
    }
}
