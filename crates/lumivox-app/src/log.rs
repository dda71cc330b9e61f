//! The log on stderr, in the form of the program's other messages, above the progress bar.

use std::fmt;
use std::io::{self, Write};

use tracing::subscriber::DefaultGuard;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt as _;

use crate::host::Host;

/// Starts the log of the process, or of this thread until the guard is dropped. The environment
/// variable `RUST_LOG` of the process overrides `verbosity`. `tells_warnings`: `true` if the
/// command's own output includes the scene's warnings.
#[must_use]
pub fn start(verbosity: u8, tells_warnings: bool, host: &Host) -> Option<DefaultGuard> {
    // wgpu's crates log quirks of drivers that the user cannot change. The command's own error
    // reports the first GPU error; -v adds later ones.
    let default = match verbosity {
        0 if tells_warnings => "error,lumivox_render::gpu=off",
        0 => "warn,lumivox_render::gpu=off,wgpu_core=error,wgpu_hal=error,naga=error",
        1 => "info,wgpu_core=warn,wgpu_hal=warn,naga=warn",
        2 => "debug,wgpu_core=info,wgpu_hal=info,naga=info",
        _ => "trace",
    };
    let asked = if host.is_embedded() { None } else { std::env::var(EnvFilter::DEFAULT_ENV).ok() };
    let asked = asked.filter(|text| !text.is_empty());
    let filter = asked.map_or_else(|| Ok(EnvFilter::new(default)), EnvFilter::try_new);
    let filter = filter.unwrap_or_else(|error| {
        host.complain(&format!("warning: RUST_LOG cannot be understood: {error}\n"));
        EnvFilter::new(default)
    });
    let writer = host.clone();
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(move || BesideBars(writer.clone()))
        .event_format(OneLine)
        .finish();
    if host.is_embedded() {
        return Some(log.set_default());
    }
    if let Err(error) = log.try_init() {
        host.complain(&format!("warning: the log cannot be started: {error}\n"));
    }
    None
}

/// Formats events as `warning: message` on one line, even if a name contains line breaks; debug and
/// trace events include the module.
struct OneLine;

impl<S, N> FormatEvent<S, N> for OneLine
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        context: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> fmt::Result {
        let metadata = event.metadata();
        match *metadata.level() {
            Level::ERROR => write!(writer, "error: ")?,
            Level::WARN => write!(writer, "warning: ")?,
            Level::INFO => write!(writer, "info: ")?,
            level => write!(writer, "{} ({}): ", level.as_str().to_lowercase(), metadata.target())?,
        }
        let mut text = String::new();
        context.field_format().format_fields(Writer::new(&mut text), event)?;
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        writeln!(writer, "{}", lines.join(" "))
    }
}

/// Writes to stderr above the progress bars.
struct BesideBars(Host);

impl Write for BesideBars {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.complain_above_bars(&String::from_utf8_lossy(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
