//! Errors for a page: exceptions with a message that names the remedy, and a code for each kind.

use lumivox::GiError;

/// An error for a page.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct PageError {
    /// The kind, the property `code` of the exception: `value`, `limit` or `device`.
    pub code: &'static str,
    /// The obstacle and the remedy.
    pub message: String,
}

impl PageError {
    /// An error about a value that is not allowed.
    pub fn value(message: impl Into<String>) -> Self {
        Self { code: "value", message: message.into() }
    }

    /// An error of the device.
    pub fn device(message: impl Into<String>) -> Self {
        Self { code: "device", message: message.into() }
    }
}

impl From<GiError> for PageError {
    fn from(error: GiError) -> Self {
        let code = match error {
            GiError::Limit { .. } | GiError::Budget { .. } => "limit",
            GiError::Setting { .. } | GiError::Geometry { .. } => "value",
            _ => "device",
        };
        Self { code, message: error.to_string() }
    }
}

#[cfg(target_arch = "wasm32")]
impl From<PageError> for wasm_bindgen::JsValue {
    fn from(error: PageError) -> Self {
        let exception = js_sys::Error::new(&error.message);
        // Cannot fail: a new object accepts any property.
        let _ = js_sys::Reflect::set(&exception, &"code".into(), &error.code.into());
        exception.into()
    }
}
