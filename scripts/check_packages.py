#!/usr/bin/env python3
"""Looks at packed crates, as `cargo publish --dry-run` leaves them, before anybody gets them.

    check_packages.py FOLDER       check the .crate files in a folder
    check_packages.py --self-test  show that bad packages are refused

A crate compiles in the workspace, where all files are at hand; a package has only its own. So each
package must have its README, both licences, every file that its sources include, and the metadata
that a registry shows. Packages with the same version are made of the same sources, so the npm
package and the crates must agree as well.
"""

import io
import json
import os
import re
import sys
import tarfile
import tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
NEEDED = ("README.md", "LICENSE-MIT", "LICENSE-APACHE")
METADATA = ("description", "license", "readme", "keywords", "categories", "rust-version")
INCLUDED = re.compile(r'include(?:_str|_bytes|_wgsl)?!\(\s*"([^"]+)"\s*,?\s*\)')
# A registry takes 10 MiB; what is larger than this has something in it that nobody needs.
LARGEST = 2 << 20


def problems(name, data):
    """What is wrong with a package, as texts."""
    found = []
    if len(data) > LARGEST:
        found.append(f"{name} has {len(data) >> 10} KiB; leave test data out (`exclude`)")
    files = {}
    with tarfile.open(fileobj=io.BytesIO(data), mode="r:gz") as archive:
        for member in archive.getmembers():
            if member.isfile():
                path = member.name.partition("/")[2]
                files[path] = archive.extractfile(member).read()
            elif not member.isdir():
                found.append(f"{name}: {member.name} is a link, which nobody can follow")
    found += [f"{name} has no {file}; link it into the crate" for file in NEEDED if file not in files]
    manifest = tomllib.loads(files.get("Cargo.toml", b"").decode())
    package = manifest.get("package", {})
    found += [f"{name}: its Cargo.toml has no {key}" for key in METADATA if not package.get(key)]
    if "docs" not in package.get("metadata", {}):
        found.append(f"{name}: its Cargo.toml does not tell docs.rs what to build")
    for path, content in files.items():
        if not path.endswith(".rs"):
            continue
        for included in INCLUDED.findall(content.decode()):
            target = os.path.normpath(os.path.join(os.path.dirname(path), included))
            # A doc comment may show one that is the reader's own.
            if target not in files and f'"{included}"' in without_comments(content.decode()):
                found.append(f"{name}: {path} includes {included}, which is not in the package")
    return found


def without_comments(source):
    return "\n".join(line for line in source.split("\n") if not line.lstrip().startswith("//"))


def check(folder):
    paths = {}
    for place, _, names in os.walk(folder):
        paths |= {name: os.path.join(place, name) for name in names if name.endswith(".crate")}
    if not paths:
        return [f"{folder} has no packages: run `cargo publish --workspace --dry-run` first"]
    found = []
    versions = set()
    for name, path in sorted(paths.items()):
        with open(path, "rb") as file:
            found += problems(name, file.read())
        versions.add(name[: -len(".crate")].rpartition("-")[2])
    with open(os.path.join(ROOT, "crates/lumivox-web/npm/package.json"), encoding="utf-8") as file:
        versions.add(json.load(file)["version"])
    if len(versions) != 1:
        found.append(f"crates and npm package have several versions: {', '.join(sorted(versions))}")
    print(f"{len(paths)} packages: {', '.join(sorted(paths))}")
    return found


def packed(files):
    """A package of files, for the self-test."""
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w:gz") as archive:
        for path, text in files.items():
            member = tarfile.TarInfo(f"good-0.1.0/{path}")
            member.size = len(text.encode())
            archive.addfile(member, io.BytesIO(text.encode()))
    return data.getvalue()


def self_test():
    manifest = "\n".join(
        ["[package]", 'name = "good"']
        + [f'{key} = "x"' for key in METADATA]
        + ["[package.metadata.docs.rs]", "all-features = true"]
    )
    good = {file: "x" for file in NEEDED} | {
        "Cargo.toml": manifest,
        "src/lib.rs": '/// include_str!("reader.txt")\nconst A: &str = include_str!("a.wgsl");',
        "src/a.wgsl": "",
    }
    assert problems("good", packed(good)) == [], problems("good", packed(good))
    bad = {
        "no README.md": {k: v for k, v in good.items() if k != "README.md"},
        "no description": good | {"Cargo.toml": manifest.replace("description", "about")},
        "docs.rs": good | {"Cargo.toml": manifest.replace("metadata.docs", "metadata.books")},
        "includes a.wgsl": {k: v for k, v in good.items() if k != "src/a.wgsl"},
        "includes ../../x": good | {"src/lib.rs": 'include_bytes!("../../x");'},
    }
    for text, files in bad.items():
        said = problems("bad", packed(files))
        assert len(said) == 1 and text in said[0], (text, said)
    print("bad packages are refused")


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) != 1:
        sys.exit(__doc__)
    found = check(arguments[0])
    for problem in found:
        print(problem, file=sys.stderr)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
