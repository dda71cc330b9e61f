//! Console lines of a page.

use std::ops::ControlFlow;

use lumivox_console::complete::complete;
use lumivox_console::{Effect, LineInfo, ProgressListener, Queue, Reply, script};
use lumivox_render::RenderProgress;
use wasm_bindgen::prelude::*;

use crate::error::WebError;
use crate::listener::Listener;
use crate::load::load_as;
use crate::renderer::Renderer;
use crate::session::Session;

/// Reports a command's progress to a page, which may cancel it.
fn listener_of(listener: &Listener) -> Box<dyn ProgressListener> {
    let listener = listener.clone();
    Box::new(move |step: RenderProgress| {
        listener.tell(step.stage, step.done.into(), step.total.into());
        if listener.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}

impl Session {
    /// Runs a line, and waits for its frames.
    ///
    /// # Errors
    /// The errors of the command.
    pub async fn run_line(&mut self, line: &str, listener: &Listener) -> Result<Reply, WebError> {
        self.show_view_of_left()?;
        self.fit(self.full_size(), listener).await?;
        let size = self.full_size();
        self.console.on_progress(listener_of(listener));
        let reply = self.console.run(line).await;
        self.console.on_progress(Box::new(|_| ControlFlow::Continue(())));
        self.view = self.console.explorer.settings().view;
        self.follow_size(size);
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

    /// The possible completions of a line's last word: the word's start in UTF-16 units, as
    /// JavaScript counts, and the completions.
    pub fn complete(&self, line: &str) -> (usize, Vec<String>) {
        let found = complete(&self.console.names(), &|_| Vec::new(), line, line.len());
        let before = line.get(..found.start).unwrap_or_default();
        (before.encode_utf16().count(), found.candidates)
    }
}

impl Renderer {
    /// Runs lines, and lines that they add; returns the scene that they opened last, if any.
    pub(crate) async fn run_lines(
        &self,
        lines: &str,
        printed: &mut Vec<String>,
        listener: &Listener,
    ) -> Result<Option<String>, WebError> {
        let mut queue = Queue::default();
        if lines.trim().lines().count() > 1 {
            queue.extend(script(lines, "script")?);
        } else {
            queue.add(lines, "");
        }
        let mut opened = None;
        while let Some(line) = queue.take() {
            listener.check().await?;
            if LineInfo::of(&line.text).window_command.is_some() {
                continue;
            }
            let reply = self.session().await.run_line(&line.text, listener).await;
            let reply = reply.map_err(|error| error.at(&line.place))?;
            if !reply.text.is_empty() {
                printed.push(reply.text);
            }
            match reply.effect {
                Effect::Nothing | Effect::Wait(_) => {}
                Effect::Run(lines) => queue.interpose(lines)?,
                Effect::Open(opening) => {
                    let source = opening.source.to_string();
                    let open = async {
                        let scene = load_as(&opening, listener).await?;
                        let mut session = self.session().await;
                        session.show_as(scene, *opening, Vec::new(), None, listener).await
                    };
                    open.await.map_err(|error| error.at(&line.place))?;
                    opened = Some(source);
                }
                Effect::Quit => {
                    return Err(WebError::value("a page is ended by closing its tab"));
                }
            }
        }
        Ok(opened)
    }
}

/// The result of lines as an object for the page.
pub(crate) fn ran(text: &str, files: &js_sys::Array, opened: Option<String>) -> JsValue {
    let ran = js_sys::Object::new();
    let parts: [(&str, JsValue); 3] =
        [("text", text.into()), ("files", files.into()), ("opened", opened.into())];
    for (name, value) in parts {
        // This cannot fail on a new object.
        let _ = js_sys::Reflect::set(&ran, &name.into(), &value);
    }
    ran.into()
}
