//! Lines of the console, as a page has them.

use std::ops::ControlFlow;

use lumivox_console::complete::complete;
use lumivox_console::{Effect, Hear, Reply};
use lumivox_render::Progress;

use crate::error::WebError;
use crate::listener::Listener;
use crate::session::Session;

/// Tells a page how far a command is, which may break it off.
fn hearer(listener: &Listener) -> Box<dyn Hear> {
    let listener = listener.clone();
    Box::new(move |step: Progress| {
        listener.tell(step.stage, step.done.into(), step.total.into());
        if listener.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}

impl Session {
    /// Does what a line says, and waits for its frames.
    ///
    /// # Errors
    /// As the command has it.
    pub async fn run_line(&mut self, line: &str, listener: &Listener) -> Result<Reply, WebError> {
        self.show_view_of_left()?;
        let size = self.explorer().size();
        self.console.on_progress(hearer(listener));
        let reply = self.console.run(line).await;
        self.console.on_progress(Box::new(|_| ControlFlow::Continue(())));
        self.view = self.explorer().settings().view;
        if self.explorer().size() != size {
            let size = self.explorer().size();
            self.presenter.resize(self.console.explorer.gpu(), size);
        }
        self.picker = None;
        self.follow_light();
        self.change();
        let reply = reply?;
        if let Effect::Wait(frames) = reply.effect {
            for _ in 0..frames {
                listener.check().await?;
                self.render().await?;
            }
        }
        Ok(reply)
    }

    /// What the last word of a line may become: where it begins, in UTF-16 as JavaScript counts, and the words.
    pub fn complete(&self, line: &str) -> (usize, Vec<String>) {
        let found = complete(&self.console.names(), &|_| Vec::new(), line, line.len());
        let before = line.get(..found.start).unwrap_or_default();
        (before.encode_utf16().count(), found.candidates)
    }
}
