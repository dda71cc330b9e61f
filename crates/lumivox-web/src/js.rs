//! Conversion of values between JavaScript and Rust.

use tsify::{Ts, Tsify};
use wasm_bindgen::prelude::*;

use crate::error::WebError;

/// Converts a value for the page.
pub fn to_js<T: Tsify + serde::Serialize>(value: &T) -> Result<Ts<T>, JsValue> {
    value.into_ts().map_err(|error| WebError::value(error.to_string()).into())
}

/// The names of an object's properties.
pub fn keys(object: &JsValue) -> String {
    let object: Option<&js_sys::Object> = object.dyn_ref();
    object.map_or_else(String::new, |object| js_sys::Object::keys(object).join(" ").into())
}

/// Converts an object of the page.
pub fn from_js<T: Tsify + serde::de::DeserializeOwned>(
    value: &Ts<T>,
    what: &str,
) -> Result<T, WebError> {
    of_text_of(&value.js_value(), what)
}

/// Converts an object through its JSON text, which makes serde refuse unknown properties;
/// `undefined` becomes null.
pub fn of_text_of<T: serde::de::DeserializeOwned>(
    value: &JsValue,
    what: &str,
) -> Result<T, WebError> {
    let text = js_sys::JSON::stringify(value).ok().and_then(|text| text.as_string());
    serde_json::from_str(text.as_deref().unwrap_or("null"))
        .map_err(|error| WebError::value(format!("this is not {what}: {error}")))
}
