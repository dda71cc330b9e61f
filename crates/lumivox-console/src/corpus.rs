//! Runs the corpus of the fuzz target for lines and values as a test.

// The fuzz target includes files of this crate by path, so that it does not depend on the crate.
#[allow(clippy::duplicate_mod)]
#[path = "../../../fuzz/command.rs"]
mod command;

#[test]
fn no_line_of_the_fuzz_corpus_panics() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus/command");
    let files = std::fs::read_dir(folder).unwrap();
    let count =
        files.map(|file| command::run(&std::fs::read(file.unwrap().path()).unwrap())).count();
    assert!(count >= 3, "{count} files");
    command::run(b"grid_offset nan,0,0");
}
