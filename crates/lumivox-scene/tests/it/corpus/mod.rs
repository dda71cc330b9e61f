//! Runs the fuzz targets' committed inputs (`fuzz/corpus`), as a fuzzer would: seeds, and inputs
//! that once made a loader fail. See `fuzz/README.md`.

#[path = "../../../../../fuzz/targets.rs"]
mod targets;

use std::path::PathBuf;

fn folder(target: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", "..", "fuzz", "corpus", target].iter().collect()
}

/// Prints each input on a separate line, so that the last line is the input that failed.
#[test]
fn no_corpus_input_makes_a_loader_panic() {
    for target in targets::TARGETS {
        let mut files: Vec<_> =
            std::fs::read_dir(folder(target)).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        assert!(!files.is_empty(), "{target} has no inputs");
        for file in files {
            println!("{}", file.display());
            targets::run(target, &std::fs::read(&file).unwrap());
        }
    }
}
