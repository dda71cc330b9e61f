//! `lumivox-lab kernels`: registers, waves and instructions of every kernel on AMD's GPUs, by the
//! compiler of Mesa's driver, without such a GPU.
//!
//! The driver is opened in a process of its own for each chip (`chip.rs`), since environment
//! variables select the chip.

mod chip;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context as _, bail, ensure};
use glam::UVec2;
use lumivox_app::Host;
use lumivox_app::parts::ProgressDisplay;
use lumivox_render::{Gpu, PresetChoice, RenderSettings, Renderer};
use serde::{Deserialize, Serialize};

use crate::cli::KernelsArgs;
use chip::{Chip, Compiled};

/// The chips: the first one's figures are in the table, of the other only the spills.
const CHIPS: [&str; 2] = ["navi21", "vega10"];

/// Growth of a figure above the published one, in percent, that is an error.
const MOST_GROWTH: u64 = 10;

/// A kernel: its label, entry point and WGSL.
#[derive(Debug, Serialize, Deserialize)]
struct Source {
    label: String,
    entry: String,
    wgsl: String,
}

/// The kernels of a chip, in the order of the sources.
#[derive(Debug, Serialize, Deserialize)]
struct OfChip {
    driver: String,
    compiled: Vec<Compiled>,
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    label: String,
    compiled: Compiled,
    /// Spilled registers on the second chip.
    spilled: u64,
}

/// Compiles the sources on standard input for the chip of the environment, and prints the result.
///
/// # Errors
/// When a kernel does not compile.
pub fn compile(host: &Host) -> anyhow::Result<()> {
    let sources: Vec<Source> = serde_json::from_reader(std::io::stdin().lock())?;
    let chip = Chip::open()?;
    let compile = |source: &Source| {
        let compiled = chip.compile(&source.wgsl, &source.entry);
        compiled.with_context(|| format!("{} does not compile", source.label))
    };
    let compiled = sources.iter().map(compile).collect::<anyhow::Result<_>>()?;
    host.print_json(&OfChip { driver: chip.name, compiled })
}

/// Compiles, and prints, writes or compares the table.
///
/// # Errors
/// When the driver is missing, or a kernel has grown.
pub fn run(args: &KernelsArgs, host: &Host) -> anyhow::Result<()> {
    let progress = ProgressDisplay::start(host, "linking kernels");
    let gpu = host.open_gpu(&args.gpu.options())?;
    let sources = sources(&gpu)?;
    progress.set("compiling kernels", 0, CHIPS.len() as u32);
    let mut of_chips = Vec::new();
    for chip in CHIPS {
        of_chips.push(compile_for(chip, &sources)?);
        progress.set("compiling kernels", of_chips.len() as u32, CHIPS.len() as u32);
    }
    drop(progress);
    let rows = rows(&sources, [&of_chips[0], &of_chips[1]]);
    let page = page(&of_chips[0].driver, &rows);
    if let Some(file) = &args.against {
        let published = std::fs::read_to_string(file)
            .with_context(|| format!("{}: cannot be read", file.display()))?;
        if published.contains(&of_chips[0].driver) {
            compare(&rows, &published, file)?;
            return host.print(&format!("No kernel has grown since {}.", file.display()));
        }
        let driver = &of_chips[0].driver;
        return host.print(&format!("{} is of another driver than {driver}.", file.display()));
    }
    if let Some(file) = &args.output {
        std::fs::write(file, page)
            .with_context(|| format!("{}: cannot be written", file.display()))?;
        return Ok(());
    }
    host.print(&page)
}

/// All kernels that pictures of the Cornell box request: with and without light of earlier frames.
fn sources(gpu: &Gpu) -> anyhow::Result<Vec<Source>> {
    let scene = lumivox_scene::builtin::scene("cornell")?;
    for preset in [lumivox::Preset::Balanced, lumivox::Preset::Realtime] {
        let preset = PresetChoice::Cones(preset);
        let settings = RenderSettings::default().with_preset(preset, Some(&scene));
        let size = UVec2::new(32, 18);
        let settings = RenderSettings { size, resolution: 32, frames: 2, ..settings };
        let mut ignore = |_| {};
        pollster::block_on(Renderer::new(gpu, &scene, None, settings, &mut ignore))?;
    }
    let kernels = gpu.pipelines.kernels().into_iter();
    let mut sources: Vec<_> =
        kernels.map(|(label, entry, wgsl)| Source { label, entry, wgsl }).collect();
    sources.sort_by(|a, b| (&a.label, &a.wgsl).cmp(&(&b.label, &b.wgsl)));
    Ok(sources)
}

fn compile_for(chip: &str, sources: &[Source]) -> anyhow::Result<OfChip> {
    let mut child = Command::new(std::env::current_exe()?)
        .arg("compile-kernels")
        .env("RADV_FORCE_FAMILY", chip)
        .env("NODEVICE_SELECT", "1")
        .env("VK_LOADER_DRIVERS_SELECT", "*radeon*")
        .env_remove("VK_DRIVER_FILES")
        .env_remove("VK_ICD_FILENAMES")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let mut input = child.stdin.take().context("a pipe")?;
    input.write_all(&serde_json::to_vec(sources)?)?;
    drop(input);
    let output = child.wait_with_output()?;
    let error = String::from_utf8_lossy(&output.stderr);
    ensure!(
        output.status.success(),
        "Mesa's driver for AMD (Debian: mesa-vulkan-drivers) did not compile for {chip}: {error}"
    );
    serde_json::from_slice(&output.stdout).context("the compiler's answer")
}

/// The table's rows, fewest waves first. Of two variants of a kernel, the one without what most
/// scenes do not need is marked "short".
fn rows(sources: &[Source], [first, second]: [&OfChip; 2]) -> Vec<Row> {
    let mut of_label: BTreeMap<&str, Vec<(Compiled, u64)>> = BTreeMap::new();
    for (source, (compiled, other)) in
        sources.iter().zip(first.compiled.iter().zip(&second.compiled))
    {
        of_label.entry(&source.label).or_default().push((*compiled, other.spilled));
    }
    let mut rows = Vec::new();
    for (label, mut variants) in of_label {
        variants.sort_by_key(|(compiled, _)| std::cmp::Reverse(compiled.instructions));
        for (number, (compiled, spilled)) in variants.into_iter().enumerate() {
            let label = match number {
                0 => label.to_owned(),
                1 => format!("{label}, short"),
                _ => format!("{label}, variant {number}"),
            };
            rows.push(Row { label, compiled, spilled });
        }
    }
    rows.sort_by_key(|row| (row.compiled.waves, std::cmp::Reverse(row.compiled.registers)));
    rows
}

fn page(driver: &str, rows: &[Row]) -> String {
    let mut page = format!(
        "# Kernels on AMD's GPUs\n\nMade by `lumivox-lab kernels`: what the compiler of Mesa's driver makes of \
         every kernel ({driver}), without such a GPU. Of 32 waves, a kernel that waits for memory wants 12 or more. \
         *Spilled* registers, of navi21 and vega10, are in memory. *Short* is the variant without what most scenes do \
         not need (emitters, rays for shadows).\n\n| kernel | registers | waves | spilled | instructions |\n| --- | ---: \
         | ---: | ---: | ---: |\n"
    );
    for Row { label, compiled, spilled } in rows {
        let Compiled { registers, waves, instructions, .. } = compiled;
        let spilled = compiled.spilled + spilled;
        page.push_str(&format!(
            "| `{label}` | {registers} | {waves} | {spilled} | {instructions} |\n"
        ));
    }
    page
}

/// # Errors
/// Every kernel that has grown, with both figures.
fn compare(rows: &[Row], published: &str, file: &Path) -> anyhow::Result<()> {
    let mut grown = Vec::new();
    for Row { label, compiled, spilled } in rows {
        if compiled.spilled + spilled > 0 {
            grown.push(format!("{label}: {} registers are spilled", compiled.spilled + spilled));
        }
        let start = format!("| `{label}` |");
        let Some(line) = published.lines().find(|line| line.starts_with(&start)) else { continue };
        let figures: Vec<u64> =
            line[start.len()..].split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
        let &[registers, _, _, instructions] = figures.as_slice() else {
            bail!("{}: the row of {label} has not four figures", file.display());
        };
        let figures = [
            ("registers", compiled.registers, registers),
            ("instructions", compiled.instructions, instructions),
        ];
        for (figure, now, before) in figures {
            if 100 * now > (100 + MOST_GROWTH) * before {
                grown.push(format!("{label}: {now} {figure}, published {before}"));
            }
        }
    }
    ensure!(
        grown.is_empty(),
        "kernels have grown since {}; if they must, publish them with -o:\n{}",
        file.display(),
        grown.join("\n")
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(label: &str, registers: u64, instructions: u64, spilled: u64) -> Row {
        let compiled = Compiled { registers, waves: 8, spilled: 0, instructions };
        Row { label: label.to_owned(), compiled, spilled }
    }

    #[test]
    fn a_kernel_that_has_grown_is_named_with_both_figures() {
        let published = page("RADV", &[row("a::main", 64, 1000, 0), row("b::main", 40, 100, 0)]);
        let compared = |rows: &[Row]| {
            compare(rows, &published, Path::new("kernels.md")).map_err(|error| error.to_string())
        };
        assert_eq!(compared(&[row("a::main", 64, 1099, 0), row("new::main", 256, 9, 0)]), Ok(()));
        let error = compared(&[row("a::main", 72, 1000, 0), row("b::main", 40, 111, 2)]);
        let error = error.unwrap_err();
        for part in [
            "a::main: 72 registers, published 64",
            "b::main: 111 instructions, published 100",
            "b::main: 2 registers are spilled",
        ] {
            assert!(error.contains(part), "{error}");
        }
    }
}
