#!/usr/bin/env python3
"""Looks at packed crates, and at packages for npm and Python, before anybody gets them.

    check_packages.py FOLDER       check the packages in a folder: .crate, .tgz, .tar.gz, .whl
    check_packages.py --self-test  show that bad packages are refused

A crate compiles in the workspace, where all files are at hand; a package has only its own. So each
package must have its README, both licences, every file that its sources include, and the metadata
that a registry shows. The npm package must have what its `exports` name, a source distribution for
Python every crate that it needs, and a wheel the extension. Packages with the same version are made
of the same sources, so all of them must agree.
"""

import io
import json
import os
import re
import sys
import tarfile
import tomllib
import zipfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
NEEDED = ("README.md", "LICENSE-MIT", "LICENSE-APACHE")
METADATA = ("description", "license", "readme", "keywords", "categories", "rust-version")
INCLUDED = re.compile(r'include(?:_str|_bytes|_wgsl)?!\(\s*"([^"]+)"\s*,?\s*\)')
# Registries accept 10 MiB; a package larger than this contains something unneeded.
LARGEST = 2 << 20


def unpacked(name, data):
    """The files of an archive without its one folder, and the problems of unpacking it."""
    files = {}
    found = []
    with tarfile.open(fileobj=io.BytesIO(data), mode="r:gz") as archive:
        for member in archive.getmembers():
            if member.isfile():
                path = member.name.partition("/")[2]
                files[path] = archive.extractfile(member).read()
            elif not member.isdir():
                found.append(f"{name}: {member.name} is a link, which nobody can follow")
    return files, found + [f"{name} has no {file}" for file in NEEDED if file not in files]


def problems(name, data):
    """What is wrong with a packed crate, as texts."""
    files, found = unpacked(name, data)
    if len(data) > LARGEST:
        found.append(f"{name} has {len(data) >> 10} KiB; leave test data out (`exclude`)")
    manifest = tomllib.loads(files.get("Cargo.toml", b"").decode())
    package = manifest.get("package", {})
    found += [f"{name}: its Cargo.toml has no {key}" for key in METADATA if not package.get(key)]
    if "docs" not in package.get("metadata", {}):
        found.append(f"{name}: its Cargo.toml does not tell docs.rs what to build")
    return found + missing_includes(name, files)


def missing_includes(name, files):
    """Files that sources include, and that are not in the package."""
    found = []
    for path, content in files.items():
        if not path.endswith(".rs"):
            continue
        for included in INCLUDED.findall(content.decode()):
            target = os.path.normpath(os.path.join(os.path.dirname(path), included))
            # An example in a doc comment may include any file.
            if target not in files and f'"{included}"' in without_comments(content.decode()):
                found.append(f"{name}: {path} includes {included}, which is not in the package")
    return found


def npm_problems(name, data):
    """What is wrong with a package for npm: it packs without a word what is not there."""
    files, found = unpacked(name, data)
    manifest = json.loads(files.get("package.json", b"{}"))
    named = [manifest.get("main", ""), manifest.get("types", "")]
    for target in manifest.get("exports", {}).values():
        named += target.values() if isinstance(target, dict) else [target]
    named = {os.path.normpath(path) for path in named}
    return found + [f"{name} has no {path}, which it names" for path in sorted(named - set(files))]


def sdist_problems(name, data):
    """What is wrong with a source distribution for Python."""
    files, found = unpacked(name, data)
    own = ("PKG-INFO", "pyproject.toml", "Cargo.lock")
    found += [f"{name} has no {file}" for file in own if file not in files]
    crates = {}
    for path in [path for path in files if path.endswith("Cargo.toml")]:
        manifest = tomllib.loads(files[path].decode())
        shared = manifest.get("workspace", {}).get("dependencies", {})
        for crate, needed in (shared | manifest.get("dependencies", {})).items():
            folder = needed.get("path") if isinstance(needed, dict) else None
            if folder:
                place = os.path.join(os.path.dirname(path), folder, "Cargo.toml")
                crates[os.path.normpath(place)] = crate
    lacking = sorted(crates[path] for path in crates.keys() - files.keys())
    found += [f"{name} has no crate {crate}, which another one needs" for crate in lacking]
    return found + missing_includes(name, files)


def wheel_problems(name, data):
    """What is wrong with a wheel for Python."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        files = archive.namelist()
    needed = [f"dist-info/licenses/{licence}" for licence in NEEDED[1:]]
    needed += ["dist-info/METADATA", "lumivox/py.typed"]
    found = [
        f"{name} has no {end}" for end in needed if not any(file.endswith(end) for file in files)
    ]
    if not any(re.search(r"/_lumivox\.(.*\.)?(so|pyd)$", file) for file in files):
        found.append(f"{name} has no extension")
    return found


# The check for each kind of file.
KINDS = {
    ".crate": problems,
    ".tgz": npm_problems,
    ".tar.gz": sdist_problems,
    ".whl": wheel_problems,
}


def without_comments(source):
    return "\n".join(line for line in source.split("\n") if not line.lstrip().startswith("//"))


def check(folder):
    paths = {}
    for place, _, names in os.walk(folder):
        paths |= {name: os.path.join(place, name) for name in names if name.endswith(tuple(KINDS))}
    if not paths:
        return [f"{folder} has no packages: run `cargo publish --workspace --dry-run` first"]
    found = []
    versions = set()
    for name, path in sorted(paths.items()):
        with open(path, "rb") as file:
            kind = next(kind for kind in KINDS if name.endswith(kind))
            found += KINDS[kind](name, file.read())
        versions.add(re.search(r"-(\d+\.\d+\.\d+)", name).group(1))
    with open(os.path.join(ROOT, "crates/lumivox-web/npm/package.json"), encoding="utf-8") as file:
        versions.add(json.load(file)["version"])
    if len(versions) != 1:
        found.append(f"the packages have several versions: {', '.join(sorted(versions))}")
    print(f"{len(paths)} packages: {', '.join(sorted(paths))}")
    return found


def packed(files):
    """A package of these files, for the self-test."""
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

    licensed = {file: "x" for file in NEEDED}
    exports = {".": {"types": "./a.d.ts", "default": "./a.js"}}
    manifest = {"main": "a.js", "types": "a.d.ts", "exports": exports}
    npm = licensed | {"package.json": json.dumps(manifest), "a.js": "", "a.d.ts": ""}
    assert npm_problems("good", packed(npm)) == []
    del npm["a.d.ts"]
    assert npm_problems("bad", packed(npm)) == ["bad has no a.d.ts, which it names"]

    shared = '[workspace.dependencies]\nb = { path = "crates/b" }'
    sdist = licensed | {file: "" for file in ("PKG-INFO", "pyproject.toml", "Cargo.lock")}
    sdist["Cargo.toml"] = shared
    assert sdist_problems("good", packed(sdist | {"crates/b/Cargo.toml": ""})) == []
    said = sdist_problems("bad", packed(sdist))
    assert said == ["bad has no crate b, which another one needs"], said

    wheel = io.BytesIO()
    with zipfile.ZipFile(wheel, "w") as archive:
        for file in ("lumivox/_lumivox.abi3.so", "lumivox/py.typed", "x.dist-info/METADATA"):
            archive.writestr(file, "")
        archive.writestr("x.dist-info/licenses/LICENSE-MIT", "")
    said = wheel_problems("bad", wheel.getvalue())
    assert said == ["bad has no dist-info/licenses/LICENSE-APACHE"], said
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
