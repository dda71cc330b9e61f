#!/usr/bin/env python3
"""Refuses a crate dependency that points the wrong way.

The crates form a chain in which each knows only what lies below it: the scene knows no GPU, the
library knows no window and no file format, the programs know everything. Cargo would accept any
graph without a cycle, so this check holds the manifests against the tables below.

It reads what the manifests declare (`cargo metadata --no-deps`), with optional and
platform-specific dependencies; what third-party crates pull in themselves is not looked at.

    check_crate_directions.py              check this workspace
    check_crate_directions.py --self-test  show that bad graphs are refused and good ones pass
"""

import json
import os
import subprocess
import sys

# Our crates, and those of our crates that each may depend on: normally, for building or for tests.
# A crate that is missing here is refused.
MAY_DEPEND_ON = {
    "lumivox-scene": set(),
    "lumivox-wgsl": set(),
    "lumivox-reflect": {"lumivox-wgsl"},
    "lumivox": {"lumivox-reflect", "lumivox-wgsl"},
    "lumivox-classics": {"lumivox", "lumivox-reflect"},
    "lumivox-render": {"lumivox", "lumivox-reflect", "lumivox-scene", "lumivox-wgsl"},
    "lumivox-vxct": {"lumivox", "lumivox-reflect", "lumivox-render", "lumivox-scene"},
    "lumivox-explorer": {
        "lumivox",
        "lumivox-classics",
        "lumivox-render",
        "lumivox-scene",
        "lumivox-vxct",
    },
    "lumivox-console": {"lumivox", "lumivox-explorer", "lumivox-render", "lumivox-scene"},
    "lumivox-app": {
        "lumivox",
        "lumivox-classics",
        "lumivox-console",
        "lumivox-explorer",
        "lumivox-render",
        "lumivox-scene",
        "lumivox-vxct",
    },
    "lumivox-lab": {
        "lumivox",
        "lumivox-app",
        "lumivox-console",
        "lumivox-explorer",
        "lumivox-render",
        "lumivox-scene",
    },
    "lumivox-web": {
        "lumivox",
        "lumivox-console",
        "lumivox-explorer",
        "lumivox-render",
        "lumivox-scene",
    },
    "lumivox-three": {"lumivox"},
    "lumivox-python": {
        "lumivox-app",
        "lumivox-console",
        "lumivox-explorer",
        "lumivox-render",
        "lumivox-scene",
    },
    "lumivox-serve": set(),
}

ALL_KINDS = {"normal", "build", "dev"}
SHIPPED_KINDS = {"normal", "build"}

# Third-party crates that a crate must not use: the crate, the families (a family is a name and
# every name that continues it: wgpu, wgpu-core, wgpu_text), the kinds of dependency, the reason and
# the remedy.
MUST_NOT_USE = [
    (
        "lumivox-scene",
        {"wgpu", "naga"},
        ALL_KINDS,
        "a scene knows no GPU, so that it can be loaded and tested without one",
        "Move the code that needs it up, into lumivox or lumivox-render.",
    ),
    (
        "lumivox",
        {"winit", "egui", "gltf", "image", "naga", "lumivox-reflect"},
        SHIPPED_KINDS,
        "the library knows no window and no file format and parses no shader, so that any engine can embed it",
        "Move the code that needs it up, into lumivox-render or lumivox-app (or down, into "
        "lumivox-scene); only tests may use it, under [dev-dependencies].",
    ),
    (
        "lumivox-console",
        {"winit", "egui", "pollster", "rayon"},
        SHIPPED_KINDS,
        "the console waits nowhere and knows no window and no disk, so that it works in browsers",
        "Move the code that needs it up, into lumivox-app; what waits is an async fn that the "
        "caller awaits. Only tests may use it, under [dev-dependencies].",
    ),
    (
        "lumivox-explorer",
        {"winit", "egui", "clap", "anyhow", "pollster", "rayon"},
        SHIPPED_KINDS,
        "the explorer waits nowhere and knows no window and no command line, so that it works in "
        "browsers",
        "Move the code that needs it up, into lumivox-app; what waits for the GPU is an async fn "
        "that the caller awaits. Only tests may use it, under [dev-dependencies].",
    ),
]


def of_family(name, family):
    return name == family or name.startswith((family + "-", family + "_"))


def list_of(names):
    return ", ".join(sorted(names)) or "no other crate of this workspace"


def violations(packages):
    """The broken rules, as texts, in `packages` of the form that `cargo metadata` prints."""
    ours = {package["name"] for package in packages} | set(MAY_DEPEND_ON)
    found = []
    for package in sorted(packages, key=lambda package: package["name"]):
        crate = package["name"]
        if crate not in MAY_DEPEND_ON:
            found.append(
                f"{crate} is a crate of this workspace that no rule knows.\n"
                "  rule:   every crate has its place in the chain\n"
                "  remedy: Add it to MAY_DEPEND_ON in scripts/check_crate_directions.py, with the "
                "crates it may depend on."
            )
            continue
        for dependency in package["dependencies"]:
            name = dependency["name"]
            kind = dependency["kind"] or "normal"
            arrow = f"{crate} -> {name} ({kind} dependency)"
            # A crate may depend on itself, for tests with other features.
            if name in ours and name != crate and name not in MAY_DEPEND_ON[crate]:
                found.append(
                    f"{arrow} points the wrong way.\n"
                    f"  rule:   {crate} may depend on: {list_of(MAY_DEPEND_ON[crate])}\n"
                    f"  remedy: Remove {name} from {crate}'s Cargo.toml. What both need belongs "
                    "into the lower of the two; a test that needs both, into a crate above them."
                )
            for lower, families, kinds, reason, remedy in MUST_NOT_USE:
                for family in sorted(families):
                    if crate == lower and kind in kinds and of_family(name, family):
                        found.append(
                            f"{arrow} points the wrong way.\n"
                            f"  rule:   {reason}\n"
                            f"  remedy: {remedy}"
                        )
    return found


def workspace_packages():
    root = os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir)
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1"]
    try:
        done = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, check=True)
    except FileNotFoundError:
        sys.exit("error: there is no cargo on the PATH; install Rust from https://rustup.rs")
    except subprocess.CalledProcessError as failure:
        sys.exit(f"error: {' '.join(command)} failed with status {failure.returncode} (see above)")
    return json.loads(done.stdout)["packages"]


# --- the self-test ----------------------------------------------------------------------------


def graph(**crates):
    """`graph(lumivox="wgpu dev:image")`: packages as cargo prints them; `_` in a name means `-`."""
    packages = []
    for crate, words in crates.items():
        dependencies = []
        for word in words.split():
            kind, _, name = word.rpartition(":")
            dependencies.append({"name": name, "kind": kind or None})
        packages.append({"name": crate.replace("_", "-"), "dependencies": dependencies})
    return packages


def self_test_cases():
    """(what it shows, graph, what each expected violation begins with)"""
    wrong_way = "points the wrong way"
    return [
        (
            "the intended graph passes",
            graph(
                lumivox_scene="glam gltf image dev:proptest",
                lumivox="wgpu dev:image dev:pollster",
                lumivox_classics="lumivox wgpu",
                lumivox_render="lumivox lumivox-scene wgpu image",
                lumivox_vxct="lumivox lumivox-render lumivox-scene",
                lumivox_explorer="lumivox-classics lumivox-render lumivox-scene lumivox-vxct",
                lumivox_app="lumivox lumivox-explorer lumivox-render lumivox-scene winit egui",
                lumivox_web="lumivox lumivox-explorer lumivox-render lumivox-scene",
            ),
            [],
        ),
        (
            "the library may not know the scene",
            graph(lumivox_scene="", lumivox="lumivox-scene"),
            [f"lumivox -> lumivox-scene (normal dependency) {wrong_way}"],
        ),
        (
            "nor the classics, which stand on its hooks",
            graph(lumivox="lumivox-classics", lumivox_classics="lumivox lumivox-render"),
            [
                f"lumivox -> lumivox-classics (normal dependency) {wrong_way}",
                f"lumivox-classics -> lumivox-render (normal dependency) {wrong_way}",
            ],
        ),
        (
            "nor may its tests or its build script",
            graph(lumivox="dev:lumivox-scene build:lumivox-render"),
            [
                f"lumivox -> lumivox-scene (dev dependency) {wrong_way}",
                f"lumivox -> lumivox-render (build dependency) {wrong_way}",
            ],
        ),
        (
            "the scene may not know the library",
            graph(lumivox_scene="lumivox"),
            [f"lumivox-scene -> lumivox (normal dependency) {wrong_way}"],
        ),
        (
            "the renderer may not know the program",
            graph(lumivox_render="lumivox dev:lumivox-app"),
            [f"lumivox-render -> lumivox-app (dev dependency) {wrong_way}"],
        ),
        (
            "nor what stands on its hook and the library's, not even in tests",
            graph(lumivox_render="lumivox lumivox-vxct dev:lumivox-classics"),
            [
                f"lumivox-render -> lumivox-vxct (normal dependency) {wrong_way}",
                f"lumivox-render -> lumivox-classics (dev dependency) {wrong_way}",
            ],
        ),
        (
            "the explorer may not know the programs, nor wait as they do",
            graph(lumivox_explorer="lumivox-render dev:lumivox-app pollster clap"),
            [
                f"lumivox-explorer -> lumivox-app (dev dependency) {wrong_way}",
                f"lumivox-explorer -> pollster (normal dependency) {wrong_way}",
                f"lumivox-explorer -> clap (normal dependency) {wrong_way}",
            ],
        ),
        (
            "the two programs may not know each other",
            graph(lumivox_app="lumivox-web", lumivox_web="lumivox-app"),
            [
                f"lumivox-app -> lumivox-web (normal dependency) {wrong_way}",
                f"lumivox-web -> lumivox-app (normal dependency) {wrong_way}",
            ],
        ),
        (
            "the program may not know the laboratory, nor may Python",
            graph(lumivox_app="dev:lumivox-lab", lumivox_lab="lumivox-app", lumivox_python="lumivox-lab"),
            [
                f"lumivox-app -> lumivox-lab (dev dependency) {wrong_way}",
                f"lumivox-python -> lumivox-lab (normal dependency) {wrong_way}",
            ],
        ),
        (
            "the scene may not know a GPU, not even in tests, by any name of the family",
            graph(lumivox_scene="wgpu-types dev:naga naga_oil"),
            [
                f"lumivox-scene -> wgpu-types (normal dependency) {wrong_way}",
                f"lumivox-scene -> naga (dev dependency) {wrong_way}",
                f"lumivox-scene -> naga_oil (normal dependency) {wrong_way}",
            ],
        ),
        (
            "the library may not know windows or files; a family is no mere prefix",
            graph(lumivox="winit egui-wgpu gltf build:image imageless wgpu"),
            [
                f"lumivox -> winit (normal dependency) {wrong_way}",
                f"lumivox -> egui-wgpu (normal dependency) {wrong_way}",
                f"lumivox -> gltf (normal dependency) {wrong_way}",
                f"lumivox -> image (build dependency) {wrong_way}",
            ],
        ),
        (
            "an unknown crate is refused, and so is the arrow to it",
            graph(lumivox_tools="", lumivox_app="lumivox-tools"),
            [
                f"lumivox-app -> lumivox-tools (normal dependency) {wrong_way}",
                "lumivox-tools is a crate of this workspace that no rule knows",
            ],
        ),
    ]


def self_test():
    cases = self_test_cases()
    failures = 0
    for what, packages, expected in cases:
        found = violations(packages)
        as_expected = len(found) == len(expected) and all(
            text.startswith(start) and "rule:" in text and "remedy:" in text
            for text, start in zip(found, expected)
        )
        if not as_expected:
            failures += 1
            print(f"self-test failed: {what}\n  expected: {expected}\n  found:    {found}")
    if failures:
        sys.exit(f"{failures} of {len(cases)} self-tests failed")
    print(f"{len(cases)} self-tests passed")


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    if arguments:
        sys.exit(__doc__)
    packages = workspace_packages()
    found = violations(packages)
    if found:
        print("\n\n".join(found), file=sys.stderr)
        sys.exit(f"\n{len(found)} crate dependencies refused")
    print(f"{len(packages)} crates, all of their dependencies point the right way")


if __name__ == "__main__":
    main(sys.argv[1:])
