//! The system's file dialogs, each on its own thread.

use lumivox_console::quote;
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, TryRecvError};

/// The open dialog, if any.
#[derive(Debug, Default)]
pub struct Dialogs {
    /// The command to run on the chosen file, and the receiver of the file's path.
    waiting: Option<(&'static str, Receiver<Option<PathBuf>>)>,
}

impl Dialogs {
    /// Asks for a scene to open.
    pub fn open(&mut self) {
        let mut extensions = lumivox_scene::EXTENSIONS.to_vec();
        extensions.sort_unstable();
        self.ask("load", move || {
            rfd::FileDialog::new()
                .add_filter("Scenes", &extensions)
                .set_title("Open a scene")
                .pick_file()
        });
    }

    /// Asks for a file to write the picture to.
    pub fn save(&mut self) {
        self.ask("screenshot", || {
            rfd::FileDialog::new()
                .add_filter("PNG, as on the screen", &["png"])
                .add_filter("OpenEXR, in cd/m\u{b2}", &["exr"])
                .set_file_name("picture.png")
                .set_title("Save the picture")
                .save_file()
        });
    }

    fn ask(
        &mut self,
        command: &'static str,
        ask: impl FnOnce() -> Option<PathBuf> + Send + 'static,
    ) {
        if self.waiting.is_some() {
            return;
        }
        let (sender, receiver) = mpsc::channel();
        std::thread::spawn(move || {
            // The receiver is gone if the window was closed.
            let _ = sender.send(ask());
        });
        self.waiting = Some((command, receiver));
    }

    /// Whether a dialog is open.
    pub fn are_open(&self) -> bool {
        self.waiting.is_some()
    }

    /// The line for the chosen file; `None` until one is chosen.
    pub fn chosen(&mut self) -> Option<String> {
        let (command, receiver) = self.waiting.as_ref()?;
        let answer = match receiver.try_recv() {
            Ok(file) => {
                file.map(|file| format!("{command} {}", quote(&file.display().to_string())))
            }
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
        };
        self.waiting = None;
        answer
    }
}
