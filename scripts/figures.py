#!/usr/bin/env python3
"""Keeps measured numbers true: the pages of measurements, and what other documents copy from them.

    figures.py --check            fail where a copied number differs from its page; needs no history
    figures.py --fill             write the copied numbers, and which pages are old
    figures.py --old [PAGE]       print which pages are older than what they measure; fail if any is
    figures.py --key              print a name for the state of the sources, for a folder of results
    figures.py --take PAGE FILE   put a page, or a table, that a command has just made into docs/
    figures.py --self-test        show that each mistake is found

Each page says of which commit it is, in one line: "Made of commit abc1234 on 2026-11-26." A copied number stands
between two comments of Markdown, <!-- figure NAME --> and <!-- end -->. FIGURES below says where it comes from.
"""

import datetime
import hashlib
import re
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = ("*.md", "docs/*.md", "docs/generated/*.md", "crates/*/README.md", "looks/*/README.md", "integrations/*/README.md")
# The sources that a page measures: light and the scenes, without tests.
LIGHT = ("crates/lumivox/src", "crates/lumivox-render/src", "crates/lumivox-scene/src/builtin", ":(exclude,glob)**/tests.rs")
PAGES = {"bench": LIGHT, "quality": (*LIGHT, "lab/lumivox-lab/src/rooms/random"), "motion": LIGHT, "three": (*LIGHT, "crates/lumivox-three"), "gallery": LIGHT}
# The sources of the program, without files that the pages' commands write.
SOURCES = ("crates", "lab", "looks", "Cargo.lock", ":(exclude)*/published.json", ":(exclude)*/gallery.html")

# The pages without text written by hand; the others are beside them in docs/.
GENERATED = ("bench", "gallery", "motion", "quality")


def path_of(page):
    return f"docs/generated/{page}.md" if page in GENERATED else f"docs/{page}.md"


STAMP = re.compile(r"^Made of commit ([0-9a-f]{7,40})( with local changes)? on \d{4}-\d\d-\d\d\.$", re.M)
COPY = re.compile(r"(<!-- figure ([\w-]+) -->)([^<]*)(<!-- end -->)")
OPENING = re.compile(r"<!--\s*[Ff]igure\b")
# A generated table, with its stamp, in a page written by hand.
TABLE = re.compile(r"(?<=<!-- made by scripts/figures.sh -->\n).*?(?=<!-- end -->)", re.S)

# --- where figures come from; `read` returns the text of a file -----------------------------------


def rows(read, page, heading):
    """The rows below a heading of a page, each as its cells by the heading of their columns. Where two columns
    have the same heading, the first counts."""
    found, columns, is_below = [], None, False
    for line in read(path_of(page)).splitlines():
        if line.startswith("#"):
            is_below = line.lstrip("# ") == heading
        if not line.startswith("|"):
            columns = None
        elif is_below:
            cells = [cell.strip() for cell in line.strip("| ").split("|")]
            columns = columns or cells
            # Reversed, so that the first of two columns with one heading wins.
            found.append(dict(reversed(list(zip(columns, cells)))))
    return found


def cell(page, heading, first, column, digits=None):
    """A cell by its row's first cell; its number, which may have a unit, with so many digits."""

    def of(read):
        for row in rows(read, page, heading):
            if first in row.values():
                number, *unit = row[column].split()
                return " ".join([number if digits is None else f"{float(number):.{digits}f}", *unit])
        raise LookupError(f"{path_of(page)} has no row {first} below '{heading}'")

    return of


def bench(scene, preset, of_row):
    """A figure of the still picture of 640x360 with a dense volume and the most voxels that were measured."""

    def of(read):
        case = re.compile(rf"`{scene}/dense/(\d+)/{preset}/640x360`")
        found = [(int(match[1]), row) for row in rows(read, "bench", "Still") if (match := case.match(row["case"]))]
        return of_row(*max(found, key=lambda item: item[0]))

    return of


def bias(preset, of_scenes):
    """A figure of all scenes' absolute biases after all bounces, each with its scene."""

    def of(read):
        found = [row for row in rows(read, "quality", "Goals") if row["preset"] == preset]
        return of_scenes([(abs(float(row["all bounces: bias"])), row["scene"]) for row in found])

    return of


def leak(is_turned):
    """The most light through the closed wall, in per cent of the lit room's."""

    def of(read):
        found = [row for row in rows(read, "quality", "Light through walls")
                 if (row["scene"], row["preset"], row["voxels"]) == ("two-rooms-closed", "high", "128")]
        return f"{max(float(row['all bounces']) for row in found if (row['turned by'] != '0, 0, 0') == is_turned):.1f}"

    return of


def median(scenes):
    return f"{statistics.median(error for error, _ in scenes):.1f}"


FIGURES = {
    "bench-voxels": bench("cornell", "balanced", lambda voxels, _: str(voxels)),
    "cornell-frame-ms": bench("cornell", "balanced", lambda _, row: row["frame"]),
    "cornell-fast-ms": bench("cornell", "fast", lambda _, row: row["frame"]),
    "cornell-voxelize-ms": bench("cornell", "balanced", lambda _, row: row["voxelize"]),
    "atrium-frame-ms": bench("atrium", "balanced", lambda _, row: row["frame"]),
    "scenes": bias("high", lambda scenes: str(len(scenes))),
    "balanced-bias": bias("balanced", median),
    "balanced-worst": bias("balanced", lambda scenes: f"{max(scenes)[0]:.1f}"),
    "rooms-median": cell("quality", "Rooms at random", "all, 128", "error: median"),
    "rooms-worst": cell("quality", "Rooms at random", "all, 128", "worst"),
    "rooms-noise": cell("quality", "Rooms at random", "all, 128", "truth's noise: median"),
    "leak": leak(False),
    "leak-turned": leak(True),
    "dense-512": cell("octree", "What it costs", "cornell, 512", "memory: dense", 1),
    "octree-512": cell("octree", "What it costs", "cornell, 512", "octree", 0),
    "cascades": cell("cascades", "What they cost", "8", "volume"),
}

# --- copies ---------------------------------------------------------------------------------------


def read_file(name):
    return (ROOT / name).read_text(encoding="utf-8")


def documents():
    return sorted(str(path.relative_to(ROOT)) for pattern in DOCUMENTS for path in ROOT.glob(pattern))


def problems(names, read=read_file):
    """Every copied number that is not that of its page, and every page without a commit."""
    found = [f"{path_of(page)} does not say of which commit it is" for page in PAGES
             if path_of(page) in names and not STAMP.search(read(path_of(page)))]
    for name in names:
        text = read(name)
        copies = list(COPY.finditer(text))
        whole = {match.start() for match in copies}
        for opening in (match.start() for match in OPENING.finditer(text)):
            if opening not in whole:
                line = text.count(chr(10), 0, opening) + 1
                found.append(f"{name}:{line}: a figure has no <!-- end --> after its number; write <!-- figure NAME -->1<!-- end -->")
        for match in (match for match in copies if match[2] != "old"):
            place = f"{name}:{text.count(chr(10), 0, match.start()) + 1}: '{match[2]}'"
            try:
                now = FIGURES[match[2]](read)
            except (LookupError, ValueError) as error:
                found.append(f"{place} is no figure of scripts/figures.py, or its page has changed: {error!r}")
                continue
            if match[3] != now:
                found.append(f"{place} is {now}, not {match[3]}. To write it: scripts/figures.py --fill")
    return found


def fill():
    lost = [problem for problem in problems(documents()) if "has no <!-- end -->" in problem]
    if lost:
        sys.exit("\n".join(lost))
    for name in documents():
        text = read_file(name)
        new = COPY.sub(lambda match: match[1] + (old_in_words() if match[2] == "old" else FIGURES[match[2]](read_file)) + match[4], text)
        if new != text:
            (ROOT / name).write_text(new, encoding="utf-8")
            print(name)


# --- commits --------------------------------------------------------------------------------------


def git(*arguments):
    return subprocess.run(["git", "-C", ROOT, *arguments], check=True, capture_output=True, text=True).stdout.strip()


def commit():
    """The commit of the sources, and a name for their changes since."""
    changes = git("diff", "HEAD", "--", *SOURCES)
    return git("rev-parse", "--short", "HEAD"), hashlib.sha1(changes.encode()).hexdigest()[:8] if changes else ""


def why_old(page):
    """Why a page is older than what it measures; `None` if it is not."""
    made = STAMP.search(read_file(path_of(page)))
    try:
        if made and not made[2]:
            count = int(git("rev-list", "--count", f"{made[1]}..HEAD", "--", *PAGES[page]))
            reason = f"is older than {count} changes of what it measures" if count else None
        else:
            reason = "was made with local changes"
    except subprocess.CalledProcessError:
        reason = f"is of commit {made[1]}, which is not in this history"
    return reason and f"{path_of(page)} {reason}: scripts/figures.sh {page}"


def old_in_words():
    """The sentence of README about old pages; empty if there are none."""
    names = [f"[{page}]({path_of(page)})" for page in PAGES if why_old(page)]
    return f"These pages are older than the light of this version: {', '.join(names)}." if names else ""


def stamped(text, made):
    """A page with its stamp below its heading, or a table with its stamp above it."""
    heading, rest = re.match(r"(#[^\n]*\n\n)?(.*)", STAMP.sub("", text), re.S).groups()
    return f"{heading or ''}{made}\n\n{rest.lstrip()}"


def take(page, file):
    """Puts what a command has made into docs/, stamped."""
    now, changes = commit()
    made = f"Made of commit {now}{' with local changes' if changes else ''} on {datetime.date.today()}."
    new = stamped(Path(file).read_text(encoding="utf-8"), made)
    target = ROOT / path_of(page)
    before = read_file(target)
    target.write_text(TABLE.sub(lambda _: new + "\n", before) if TABLE.search(before) else new, encoding="utf-8")


# --- trying it ------------------------------------------------------------------------------------


def self_test():
    quality = "# Q\n\nMade of commit 0123abc on 2026-11-26.\n\n## Goals\n\n| scene | preset | all bounces: bias | goal | goal |\n" \
              "| --- | --: | --- | --- | --- |\n| a | high | -4.0 | 1 | 2 |\n| b | high | +1.0 | 1 | 2 |\n"
    speed = "## Still\n\n| case | frame | published |\n| --- | --: | --: |\n| `cornell/dense/64/balanced/640x360` | 423 | 1 |\n" \
            "| `cornell/dense/128/balanced/640x360` | 615 | 2 |\n"
    copy = "A frame:\n<!-- figure cornell-frame-ms -->615<!-- end --> ms, <!-- figure scenes -->2<!-- end --> scenes\n"

    def found(text, speed=speed):
        return " ".join(problems(["a.md"], {"a.md": text, "docs/generated/quality.md": quality, "docs/generated/bench.md": speed}.__getitem__))

    assert found(copy) == "", found(copy)
    assert rows(lambda _: quality, "quality", "Goals")[-1] == {"scene": "b", "preset": "high", "all bounces: bias": "+1.0", "goal": "1"}
    for told, words in [
        (found(copy.replace("615", "423")), ["a.md:2", "is 615, not 423", "--fill"]),
        (found(copy, speed.replace("615", "600")), ["is 600, not 615"]),
        (found(copy, speed.replace("cornell", "glow")), ["a.md:2", "its page has changed"]),
        (found(copy.replace("figure corn", "figure korn")), ["a.md:2", "kornell-frame-ms"]),
        (found(copy.replace("<!-- end -->", "")), ["a.md", "no <!-- end -->"]),
        (" ".join(problems(["docs/generated/quality.md"], lambda _: STAMP.sub("", quality))), ["of which commit"]),
    ]:
        assert all(word in told for word in words), (told, words)
    made = "Made of commit fedcba9 with local changes on 2026-11-27."
    assert STAMP.findall(stamped(quality, made)) == [("fedcba9", " with local changes")]
    assert stamped("| a |\n", made) == f"{made}\n\n| a |\n"
    assert TABLE.sub("new\n", "<!-- made by scripts/figures.sh -->\nold\n<!-- end -->").split("\n")[1:] == ["new", "<!-- end -->"]
    print("Each mistake is found.")


def main():
    match sys.argv[1:]:
        case ["--check"]:
            if found := problems(documents()):
                sys.exit("\n".join(found))
            print("Copied numbers are those of their pages.")
        case ["--fill"]:
            fill()
        case ["--old", *pages] if set(pages) <= set(PAGES):
            reasons = [reason for page in pages or PAGES if (reason := why_old(page))]
            print("\n".join(reasons))
            sys.exit(bool(reasons))
        case ["--key"]:
            print("-".join(filter(None, commit())))
        case ["--take", page, file] if page in PAGES:
            take(page, file)
        case ["--self-test"]:
            self_test()
        case _:
            sys.exit(__doc__)


main()
