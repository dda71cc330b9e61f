#!/usr/bin/env python3
"""Counts what makes comments and documents hard to read, and fails where a count has risen.

    check_english.py             compare with LIMITS below; lower a limit when its count has fallen
    check_english.py NAME        print the lines that a pattern matches, or `columns`

The patterns are habits of a dialect: noun clauses before the noun, verbs of speech for machines, `where` for `if`.
A match may be good English; only their number counts.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FILES = ("*.rs", "*.wgsl", "*.js", "*.mjs", "*.ts", "*.py", "*.sh", "*.md")
COLUMNS = 100

# Each pattern, its limit, and a line that it finds.
PATTERNS = {
    "noun clause first": (r"^\W*(What|Of|Those|That of|The same)\b", 20, "What is on its way gets there."),
    "told": (r"\b(told|tells?|hears?)\b", 8, "the GPU has told"),
    "where for if": (r"(^|[.:;] )Where\b", 11, "Where it lacks memory, it grows."),
    "is no": (r"\b(is|are) no [a-z]", 107, "it is no surface"),
    "stands for": (r"\b(stands?|stood)\b", 26, "the answer stands there"),
    "alone": (r"\balone\b", 2, "the lamp alone"),
    "as it is": (r"\bas (it|they) (is|are|was|were)\b", 4, "left as it was"),
    "goes on": (r"\b(goes on|comes with|on its way)\b", 0, "it goes on"),
    "nobody": (r"\b(nobody|somebody)\b", 1, "nobody waits"),
    "anew": (r"\banew\b", 1, "made anew"),
    "another one": (r"\banother one\b", 3, "another one"),
    "so many": (r"\bso many\b", 0, "so many frames"),
    "lets": (r"^\W*Lets\b", 0, "Lets nothing be drawn."),
    "but for": (r"\bbut for\b", 0, "all but for one"),
    "lacks": (r"\black(s|ed)?\b", 7, "the room that lacked"),
}
# Comments wider than COLUMNS.
WIDE = 74


def comment(line, suffix):
    """The text of a line of prose, or of a line that is a comment; else nothing."""
    text = line.strip()
    if suffix == ".md":
        return "" if text.startswith(("|", "`", "<")) else text
    if suffix in (".py", ".sh"):
        return text[1:].strip() if text.startswith("#") and not text.startswith("#!") else ""
    return re.sub(r"^(//[/!]?|/?\*+)\s?", "", text) if text.startswith(("//", "/*", "* ")) else ""


def lines():
    """Each line with text: its file, number, width and text."""
    names = subprocess.run(["git", "ls-files", "-z", *FILES], cwd=ROOT, check=True, capture_output=True, text=True)
    for name in filter(None, names.stdout.split("\0")):
        is_code = False
        for number, line in enumerate((ROOT / name).read_text(encoding="utf-8").splitlines(), 1):
            is_code ^= name.endswith(".md") and line.lstrip().startswith("```")
            text = "" if is_code else comment(line, Path(name).suffix)
            if text:
                yield name, number, 0 if name.endswith(".md") else len(line), text


def self_test():
    """Shows that each pattern finds its example, and nothing in a plain sentence."""
    for name, (pattern, _, example) in PATTERNS.items():
        if not re.search(pattern, example) or re.search(pattern, "The pipeline cache; dereferences to the device."):
            sys.exit(f"the pattern '{name}' does not find what it should")


def main(arguments):
    self_test()
    found = {name: [] for name in (*PATTERNS, "columns")}
    for file, number, width, text in lines():
        place = f"{file}:{number}: {text}"
        for name, (pattern, _, _) in PATTERNS.items():
            if re.search(pattern, text):
                found[name].append(place)
        if width > COLUMNS:
            found["columns"].append(place)
    if arguments:
        print("\n".join(found[arguments[0]]))
        return
    limits = {name: limit for name, (_, limit, _) in PATTERNS.items()} | {"columns": WIDE}
    risen = []
    for name, limit in limits.items():
        print(f"{len(found[name]):5} of {limit:5}  {name}")
        if len(found[name]) > limit:
            risen.append(name)
    if risen:
        sys.exit(f"more than before: {', '.join(risen)}. `scripts/check_english.py NAME` prints the lines; say it plainly.")


if __name__ == "__main__":
    main(sys.argv[1:])
