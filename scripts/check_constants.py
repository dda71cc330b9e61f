#!/usr/bin/env python3
"""Fails where a constant of Rust is written again in WGSL.

A constant that both need is defined in Rust and injected by `add_constants` of its stage
(`ShaderLibrary::constant_u32`, `constant_f32`); WGSL imports it from `package::constants`.

    check_constants.py              check all tracked files
    check_constants.py --self-test  show that copies are found, and nothing else
"""

import operator
import re
import subprocess
import sys
from collections import namedtuple
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
Constant = namedtuple("Constant", "name file line value")

WGSL = re.compile(r"^const\s+(\w+)[^=\n]*=\s*([^;\n]+)", re.M)
# Only numbers have a twin in WGSL.
RUST = re.compile(
    r"\b(?:const|static)\s+(\w+):\s*\[?(?:[iu](?:8|16|32|64|size)|f32|f64|bool)\b[^=\n]*=\s*([^;\n]+)"
)
INJECTED = re.compile(r"\bconstant_[uf]32\(\s*\"([A-Z]\w+)\"")
# A comment that marks a copy.
ADMITTED = re.compile(
    r"`[A-Z][A-Z0-9_]+(?:\.\.\.)?` (?:of|in) `[\w/]+\.wgsl`|///[^\n]*\b[Aa]s in `[\w/]+\.wgsl`\.?\n\s*(?:pub\S* )?const "
)
VALUE = re.compile(r"0x[0-9a-f]+|\d+\.?\d*(?:e[+-]?\d+)?|[A-Z]\w*|[*+/()-]|<<")
OPERATORS = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "<<": operator.lshift}


def number(text, known):
    """The value of `a` or `a OPERATOR b`, of numbers and known names; None for anything else."""
    text = re.sub(r"\b[iu](?:8|16|32|64|size)::MAX\b", lambda m: str(2 ** int(re.search(r"\d+", m[0] + "64")[0]) - 1), text)
    text = re.sub(r"(?<=[0-9a-f])_?(?:[iu](?:8|16|32|64|size)?|f32|f64)\b|(?<=\d)_(?=\d)| as \w+", "", text)
    parts = VALUE.findall(text)
    if "".join(parts) != re.sub(r"\s", "", text):
        return None

    def term(part):
        if part in known or not part[0].isdigit():
            return known.get(part)
        return int(part, 0) if re.fullmatch(r"0x\w+|0|[1-9]\d*", part) else float(part)

    values = [term(part) for part in parts[::2]]
    if None in values or len(parts) not in (1, 3):
        return None
    try:
        return values[0] if len(parts) == 1 else OPERATORS[parts[1]](*values)
    except (KeyError, TypeError, ZeroDivisionError):
        return None


def constants(pattern, file, text):
    known = {}
    for match in pattern.finditer(text):
        known[match[1]] = number(match[2], known)
        yield Constant(match[1], file, text.count("\n", 0, match.start()) + 1, known[match[1]])


def crate(file):
    return file.split("/src/")[0].split("/tests/")[0].split("/examples/")[0]


def is_copy(wgsl, rust):
    """Whether a WGSL constant has the name of a Rust constant of its crate, the name up to a prefix and the value, or
    in another crate the name and the value."""
    is_equal = wgsl.value is not None and wgsl.value == rust.value and type(wgsl.value) is type(rust.value)
    if crate(wgsl.file) != crate(rust.file):
        return wgsl.name == rust.name and is_equal
    # Zero and one mean too many things.
    is_suffix = f"_{wgsl.name}".endswith(f"_{rust.name}") or f"_{rust.name}".endswith(f"_{wgsl.name}")
    return wgsl.name == rust.name or (is_suffix and is_equal and wgsl.value not in (0, 1))


def copies(files):
    """The findings in files, given as their texts by name."""
    found, wgsl, rust, injected = [], [], [], {}
    for file, text in files.items():
        if file.endswith(".wgsl"):
            wgsl += constants(WGSL, file, text)
            continue
        rust += constants(RUST, file, text)
        injected |= {match[1]: file for match in INJECTED.finditer(text)}
        for match in ADMITTED.finditer(text):
            line = text.count("\n", 0, match.start()) + 1
            found.append(f"{file}:{line} says that it copies a constant: {match[0].splitlines()[0]}")
    for own in wgsl:
        where = f"{own.file}:{own.line} defines {own.name}, "
        if own.name in injected:
            found.append(f"{where}which {injected[own.name]} injects")
        twins = [twin for twin in rust if is_copy(own, twin)]
        found += [f"{where}like {twin.name} of {twin.file}:{twin.line}" for twin in twins]
    return found


def self_test():
    wgsl, rust = "crates/a/src/x/x.wgsl", "crates/a/src/x/mod.rs"
    cases = [
        ("the same name", "const WIDTH = 3u;", rust, "const WIDTH: u64 = 4;", 1),
        ("the same name in a test", "const WIDTH = 3u;", "crates/a/tests/it/x.rs", "    const WIDTH: [u32; 2] = [3, 4];", 1),
        ("a longer name with the same value", "const TEXELS: u32 = 27u;", rust, "pub(crate) const BRICK_TEXELS: u64 = 27;", 1),
        ("a computed value", "const T = 256u;\nconst BLOCK = 2u * T;", rust, "const SORT_BLOCK: u32 = 1 << 9;", 1),
        ("another crate's value", "const NO_HIT = 0xffffffffu;", "crates/b/src/y.rs", "const NO_HIT: u32 = u32::MAX;", 1),
        ("an injected name", "const SIDES = 6u;", rust, 'library.constant_u32("SIDES", 6);', 1),
        ("an admitted copy", "", rust, "/// `SIDES` of `x.wgsl`.\nconst FACES: u32 = 6;", 1),
        ("a comparison with a shader", "", rust, "/// As in `x.wgsl`.\nconst SIDES: u32 = 6;", 1),
        ("an import", "import package::constants::SIDES;", rust, 'const SIDES: u32 = 6;\nlibrary.constant_u32("SIDES", SIDES);', 0),
        ("another value", "const TEXELS = 8u;", rust, "const BRICK_TEXELS: u64 = 27;", 0),
        ("a name of another crate", "const REACH = 2u;", "crates/b/src/y.rs", "const REACH: f32 = 2.0;", 0),
        ("no number", "const NONE = 0u;", rust, "const NONE: Self = Self { x: 0 };", 0),
        ("zero", "const NONE = 0u;", rust, "const SHADOW_NONE: u32 = 0;", 0),
        ("a twin of a function", "", rust, "/// As in `x.wgsl`.\nfn is_spent() {}", 0),
    ]
    for what, shader, file, source, count in cases:
        found = copies({wgsl: shader, file: source})
        if len(found) != count:
            sys.exit(f"self-test failed: {what}\n  expected {count}, found: {found}")
    print(f"{len(cases)} self-tests passed")


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    if arguments:
        sys.exit(__doc__)
    names = subprocess.run(["git", "ls-files", "-z", "*.rs", "*.wgsl"], cwd=ROOT, check=True, capture_output=True, text=True)
    found = copies({name: (ROOT / name).read_text(encoding="utf-8") for name in names.stdout.split("\0") if name})
    if found:
        print("\n".join(found), file=sys.stderr)
        sys.exit(f"\n{len(found)} constants are written twice: inject Rust's (add_constants), or rename one that means something else")
    print("No shader repeats a constant of Rust")


if __name__ == "__main__":
    main(sys.argv[1:])
