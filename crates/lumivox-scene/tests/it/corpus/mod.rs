//! Runs the fuzz targets' committed inputs (`fuzz/corpus`), as a fuzzer would: seeds, and inputs
//! that once made a loader fail. `fuzz/README.md` says how to fuzz.

mod seeds;
mod shapes;
#[path = "../../../../../fuzz/targets.rs"]
mod targets;

use std::path::PathBuf;

fn folder(target: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", "..", "fuzz", "corpus", target].iter().collect()
}

/// Each input in a line of its own, so that the last line is the input that failed.
#[test]
fn no_input_of_the_corpus_makes_a_loader_fail() {
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

/// `LUMIVOX_BLESS=1` writes the seeds. Their bytes are not compared: other versions of the image
/// encoders pack the same pictures differently.
#[test]
fn seeds_are_in_the_corpus() {
    for (target, name, bytes) in seeds::all() {
        let path = folder(target).join(name);
        if std::env::var_os("LUMIVOX_BLESS").is_some() {
            std::fs::create_dir_all(folder(target)).unwrap();
            std::fs::write(&path, &bytes).unwrap();
        }
        assert!(path.is_file(), "{} is missing; LUMIVOX_BLESS=1 writes it", path.display());
    }
}

/// Seeds that are refused at once would teach a fuzzer nothing.
#[test]
fn seeds_load() {
    for (target, name, bytes) in seeds::all() {
        let file = match target {
            "glb" => "seed.glb",
            "gltf" => "seed.gltf",
            "obj" => "seed.obj",
            "ply" => "seed.ply",
            "stl" => "seed.stl",
            "vxct" => "seed.scene",
            _ => continue,
        };
        let mut options = lumivox_scene::LoadOptions::default();
        let loaded = lumivox_scene::Scene::from_memory(file, &bytes, &mut options);
        assert!(loaded.is_ok(), "{target}/{name}: {}", loaded.unwrap_err());
    }
}

#[test]
fn the_corpus_is_small() {
    let mut bytes = 0;
    for target in targets::TARGETS {
        for entry in std::fs::read_dir(folder(target)).unwrap() {
            bytes += entry.unwrap().metadata().unwrap().len();
        }
    }
    assert!(bytes < 300_000, "{bytes} bytes");
}
