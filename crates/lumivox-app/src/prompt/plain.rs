//! A prompt for a build without line editing: plain lines, without history or completion.

use lumivox_console::Names;

use crate::host::Host;

/// The text of the prompt.
const PROMPT: &str = "lumivox> ";

/// A prompt that reads lines.
#[derive(Debug)]
pub struct Prompt {
    host: Host,
}

impl Prompt {
    /// A prompt that reads stdin.
    ///
    /// # Errors
    /// Never; a prompt with line editing needs a terminal.
    #[allow(clippy::unnecessary_wraps, reason = "as of a prompt with line editing")]
    pub fn new(host: &Host) -> anyhow::Result<Self> {
        tracing::info!(
            "this build of lumivox has no line editing; build it with `--features prompt` for history and completion"
        );
        Ok(Self { host: host.clone() })
    }

    /// Ignores the names: this prompt completes nothing.
    #[allow(
        clippy::needless_pass_by_value,
        clippy::unused_self,
        reason = "as of a prompt with line editing"
    )]
    pub fn set_names(&self, _: Names) {}

    /// The next line; `None` at the end (Ctrl-D).
    ///
    /// # Errors
    /// When stdin cannot be read.
    pub fn read(&mut self) -> anyhow::Result<Option<String>> {
        self.host.print(PROMPT)?;
        let line = self.host.read_line()?;
        if line.is_empty() {
            // The shell's prompt starts on a new line.
            self.host.print("\n")?;
            return Ok(None);
        }
        let line = line.strip_suffix('\n').unwrap_or(&line);
        Ok(Some(line.strip_suffix('\r').unwrap_or(line).to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::sync::{Arc, Mutex};

    use super::*;
    use crate::host::Embedded;

    #[derive(Clone, Default)]
    struct Kept(Arc<Mutex<Vec<u8>>>);

    impl std::io::Write for Kept {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn the_prompt_reads_lines_until_end_of_input() {
        let output = Kept::default();
        let host = Host::embedded(Embedded {
            input: Box::new(Cursor::new("one\r\n\ntwo")),
            output: Box::new(output.clone()),
            errors: Box::new(std::io::sink()),
            open_gpu: Box::new(|_| unreachable!("a prompt needs no GPU")),
        });
        let mut prompt = Prompt::new(&host).unwrap();
        let mut read = || prompt.read().unwrap();
        assert_eq!([read(), read(), read()], ["one", "", "two"].map(|line| Some(line.to_owned())));
        assert_eq!(read(), None);
        let asked = String::from_utf8(output.0.lock().unwrap().clone()).unwrap();
        assert_eq!(asked, PROMPT.repeat(4) + "\n");
    }
}
