//! `lumivox-lab kernels`: what AMD's compiler makes of the kernels.

use std::fs;

use crate::common::{folder, process};

/// Published figures.
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/generated/kernels.md");

#[test]
#[ignore = "slow: over three seconds"]
fn no_kernel_needs_a_tenth_more_than_published() {
    let folder = folder();
    let text = process(folder.path(), &["kernels", "--against", PAGE], "").expect_ok().stdout;
    assert!(text.contains("No kernel has grown") || text.contains("another driver"), "{text}");
}

#[test]
#[ignore = "slow: over three seconds"]
fn kernels_that_have_grown_are_named_with_both_figures() {
    let folder = folder();
    let page = folder.path().join("kernels.md");
    process(folder.path(), &["kernels", "-o", "kernels.md"], "").expect_ok();
    let published = fs::read_to_string(&page).unwrap();
    let start = "| `light::bounce::main` | ";
    let row = published.lines().find(|line| line.starts_with(start)).expect("a row");
    let registers = row[start.len()..].split(' ').next().unwrap();
    let halved = row.replace(&format!("{start}{registers} "), &format!("{start}8 "));
    fs::write(&page, published.replace(row, &halved)).unwrap();
    let run = process(folder.path(), &["kernels", "--against", "kernels.md"], "");
    assert_ne!(run.code, 0, "{}", run.stdout);
    let expected = format!("light::bounce::main: {registers} registers, published 8");
    assert!(run.stderr.contains(&expected), "{}", run.stderr);
}
