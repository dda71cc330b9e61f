//! The console's file access in a browser: reads from addresses, and writes files that the page
//! offers to its user.

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;

use lumivox_console::{BUILTIN, Failure, Outside, Reading, SceneRequest, SceneSource, suggest};
use lumivox_scene::{SceneError, builtin, extensions_in_words};

use crate::listener::Listener;
use crate::load::bytes_at;

/// Written files with their names, until the page takes them.
pub type Written = Rc<RefCell<Vec<(String, Vec<u8>)>>>;

/// A browser's substitute for a disk.
#[derive(Debug)]
pub struct Browser {
    written: Written,
}

impl Browser {
    /// Collects written files in `written`.
    pub fn new(written: Written) -> Self {
        Self { written }
    }
}

impl Outside for Browser {
    fn scenes(&self, _: Option<&SceneRequest>) -> Vec<String> {
        builtin::names().iter().map(|name| format!("{BUILTIN}{name}")).collect()
    }

    fn find(&self, name: &str, _: Option<&SceneRequest>) -> anyhow::Result<SceneSource> {
        let source = SceneSource::named(name);
        if let SceneSource::File(path) = &source
            && path.extension().is_none()
        {
            let known = builtin::names().iter().copied();
            let remedy = match suggest::like(name, known) {
                Some(like) => format!("did you mean \"{BUILTIN}{like}\"?"),
                None => format!("give an address ({}), or {BUILTIN}NAME", extensions_in_words()),
            };
            return Err(Failure::input(format!("there is no scene \"{name}\"; {remedy}")).into());
        }
        Ok(source)
    }

    fn check(&self, opening: &SceneRequest) -> anyhow::Result<()> {
        match &opening.source {
            SceneSource::Builtin(name) if builtin::about(name).is_none() => {
                let known = builtin::names().to_vec();
                Err(SceneError::UnknownBuiltin { name: name.clone(), known }.into())
            }
            SceneSource::Builtin(_) | SceneSource::File(_) => Ok(()),
        }
    }

    fn read<'a>(&'a self, file: &'a str) -> Reading<'a> {
        Box::pin(async { Ok(bytes_at(file, &Listener::new(None)).await?) })
    }

    fn check_output(&self, file: &str) -> anyhow::Result<()> {
        match PathBuf::from(file).file_name() {
            Some(_) => Ok(()),
            None => Err(Failure::output(format!("\"{file}\" is not the name of a file")).into()),
        }
    }

    fn write(&mut self, file: &str, bytes: &[u8]) -> anyhow::Result<()> {
        self.written.borrow_mut().push((file.to_owned(), bytes.to_vec()));
        Ok(())
    }
}
