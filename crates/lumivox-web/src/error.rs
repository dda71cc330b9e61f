//! Errors for a page: exceptions with the renderer's own messages, and a code for each kind.

use lumivox::GiError;
use lumivox_console::Failure;
use lumivox_explorer::ExplorerError;
use lumivox_explorer::parameters::SettingError;
use lumivox_render::RenderError;
use lumivox_scene::SceneError;

/// The kind of an error: the property `code` of the exception.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// The browser has no WebGPU at all.
    NoWebGpu,
    /// The browser has WebGPU, but no GPU for it, or none with WebGPU's default limits.
    NoAdapter,
    /// The device was lost, or refused a command.
    Device,
    /// Something is larger than the browser or the GPU allows.
    Limit,
    /// A scene cannot be read.
    Scene,
    /// A file or an address cannot be fetched.
    Fetch,
    /// The page has cancelled the work; the exception is the signal's reason.
    Aborted,
    /// A value, a name or a number is not allowed.
    Value,
}

impl Code {
    /// The code in JavaScript.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoWebGpu => "no-webgpu",
            Self::NoAdapter => "no-adapter",
            Self::Device => "device",
            Self::Limit => "limit",
            Self::Scene => "scene",
            Self::Fetch => "fetch",
            Self::Aborted => "aborted",
            Self::Value => "value",
        }
    }
}

/// An error for a page.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct WebError {
    /// The kind.
    pub code: Code,
    /// The obstacle and the remedy.
    pub message: String,
}

impl WebError {
    /// An error of that message.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, message: in_words_of_a_page(&message.into()) }
    }

    /// Adds the place in a script to the message; the place is empty for typed lines.
    #[must_use]
    pub fn at(self, place: &str) -> Self {
        if place.is_empty() {
            return self;
        }
        Self { message: format!("{place}: {}", self.message), ..self }
    }

    /// An error about a value that is not allowed.
    pub fn value(message: impl Into<String>) -> Self {
        Self::new(Code::Value, message)
    }
}

impl From<RenderError> for WebError {
    fn from(error: RenderError) -> Self {
        let code = match &error {
            RenderError::Adapter { .. } | RenderError::NoDevice { .. } => Code::NoAdapter,
            RenderError::Limit { .. }
            | RenderError::OutOfMemory { .. }
            | RenderError::Gi(GiError::Limit { .. } | GiError::Budget { .. }) => Code::Limit,
            RenderError::Setting { .. } => Code::Value,
            RenderError::NothingToVoxelize { .. } => Code::Scene,
            _ => Code::Device,
        };
        Self::new(code, error.to_string())
    }
}

impl From<ExplorerError> for WebError {
    fn from(error: ExplorerError) -> Self {
        match error {
            ExplorerError::Render(error) => error.into(),
            ExplorerError::Scene(error) => error.into(),
            other => Self::value(other.to_string()),
        }
    }
}

impl From<Failure> for WebError {
    fn from(failure: Failure) -> Self {
        // Console lines have options, so their names are not replaced.
        Self { code: Code::Value, message: failure.to_string() }
    }
}

/// Converts an error of a line of the console.
impl From<anyhow::Error> for WebError {
    fn from(error: anyhow::Error) -> Self {
        let error = match error.downcast::<ExplorerError>() {
            Ok(error) => return error.into(),
            Err(error) => error,
        };
        let error = match error.downcast::<RenderError>() {
            Ok(error) => return error.into(),
            Err(error) => error,
        };
        let error = match error.downcast::<SceneError>() {
            Ok(error) => return error.into(),
            Err(error) => error,
        };
        match error.downcast::<Self>() {
            Ok(error) => error,
            Err(error) => Self { code: Code::Value, message: format!("{error:#}") },
        }
    }
}

impl From<SceneError> for WebError {
    fn from(error: SceneError) -> Self {
        Self::new(Code::Scene, error.to_string())
    }
}

impl From<SettingError> for WebError {
    fn from(error: SettingError) -> Self {
        Self::value(error.to_string())
    }
}

/// Replaces options of the command line in a message by the settings of the page, which have the
/// same names with `_` for `-`.
fn in_words_of_a_page(message: &str) -> String {
    // A page has no such options: it does not read the disk, and always ignores unsupported
    // extensions.
    let message = [" (--allow-outside)", " (--ignore-required)"]
        .iter()
        .fold(message.to_owned(), |message, option| message.replace(option, ""));
    let mut words = String::with_capacity(message.len());
    let mut rest = message.as_str();
    while let Some(at) = rest.find("--") {
        let (before, option) = rest.split_at(at);
        words.push_str(before);
        let option = &option[2..];
        let end = option.find(|c: char| c != '-' && !c.is_ascii_lowercase());
        let (name, after) = option.split_at(end.unwrap_or(option.len()));
        let starts_word = before.is_empty() || before.ends_with([' ', '(', '"']);
        if name.is_empty() || !starts_word {
            words.push_str("--");
        }
        words.push_str(&if starts_word { name.replace('-', "_") } else { name.to_owned() });
        rest = after;
    }
    words + rest
}

#[cfg(target_arch = "wasm32")]
impl From<WebError> for wasm_bindgen::JsValue {
    fn from(error: WebError) -> Self {
        let exception = js_sys::Error::new(&error.message);
        // This cannot fail on a new object.
        let _ = js_sys::Reflect::set(&exception, &"code".into(), &error.code.name().into());
        exception.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn option_names_in_messages_become_setting_names() {
        for (message, expected) in [
            (
                "store them in an octree (--volume octree)",
                "store them in an octree (volume octree)",
            ),
            ("raise --shadow-resolution, or --x", "raise shadow_resolution, or x"),
            ("a -- b, c--d and 2--3", "a -- b, c--d and 2--3"),
            ("--frames", "frames"),
            ("allow others (--allow-outside)", "allow others"),
            ("", ""),
        ] {
            assert_eq!(in_words_of_a_page(message), expected);
        }
    }

    #[test]
    fn limit_errors_have_the_code_limit() {
        let error = RenderError::Limit {
            what: "a picture".to_owned(),
            needed: 9000,
            unit: "pixels",
            limit: "maxTextureDimension2D",
            available: 8192,
            remedy: "ask for a smaller picture".to_owned(),
        };
        let error = WebError::from(error);
        assert_eq!(error.code.name(), "limit");
        assert!(error.message.ends_with("ask for a smaller picture"), "{error}");
    }
}
