//! What was kept for the fuzz target of lines and values runs with the tests.

// The target stands by itself, and so do the files that it takes in.
#[allow(clippy::duplicate_mod)]
#[path = "../../../fuzz/command.rs"]
mod command;

#[test]
fn the_corpus_of_lines_passes() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus/command");
    let files = std::fs::read_dir(folder).unwrap();
    let count =
        files.map(|file| command::run(&std::fs::read(file.unwrap().path()).unwrap())).count();
    assert!(count >= 3, "{count} files");
    command::run(b"grid_offset nan,0,0");
}
