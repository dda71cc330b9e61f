#!/usr/bin/env python3
"""Prints the slowest tests of a run of ./test.

    slowest_tests.py FOLDER [COUNT]   print so many, forty if not said, of the tests whose times are in a folder
    slowest_tests.py --self-test      show that the times are read

The folder has what test runners have printed: .libtest of Rust's (scripts/timed_test.sh), .tap of Node.js's, and .xml (JUnit)
of pytest's. A test with tests of its own counts for what it takes beside them.
"""

import os
import re
import sys
import tempfile
import xml.etree.ElementTree

ESCAPE = re.compile(r"\x1b\[[0-9;]*m")
RUST = re.compile(r"^test (.+?)(?: - should panic)? \.\.\. .*<([0-9.]+)s>\s*$")
TAP = re.compile(r"^( *)(?:not )?ok \d+ - (.*?)(?: # (?:SKIP|TODO).*)?$")
TAP_TIME = re.compile(r"^ *duration_ms: ([0-9.]+)$")


def of_rust(text):
    """Seconds and names. The first line has the crate and the program."""
    first, _, rest = text.partition("\n")
    where = first.removeprefix("# ")
    met = (RUST.match(ESCAPE.sub("", line)) for line in rest.split("\n"))
    return [(float(found[2]), f"{where}: {found[1]}") for found in met if found]


def of_tap(text):
    """Seconds and names. Tests within a test come before it, and farther to the right."""
    tests = []
    within = {}
    test = None
    for line in text.split("\n"):
        if found := TAP.match(line):
            test = (len(found[1]), found[2].replace("\\#", "#"))
        elif test and (found := TAP_TIME.match(line)):
            indent, name = test
            test = None
            seconds = float(found[1]) / 1000
            own = seconds - sum(within.pop(other) for other in list(within) if other > indent)
            within[indent] = within.get(indent, 0.0) + seconds
            tests.append((own, f"page: {name}"))
    return tests


def of_junit(text):
    """Seconds and names."""
    cases = xml.etree.ElementTree.fromstring(text).iter("testcase")
    name = "python: {0[classname]}::{0[name]}".format
    return [(float(case.get("time", 0)), name(case.attrib)) for case in cases]


KINDS = {".libtest": of_rust, ".tap": of_tap, ".xml": of_junit}


def tests_in(folder):
    """Seconds and names of all tests, the slowest first."""
    tests = []
    for file in sorted(os.listdir(folder)):
        kind = KINDS.get(os.path.splitext(file)[1])
        with open(os.path.join(folder, file), encoding="utf-8", errors="replace") as opened:
            text = opened.read()
        try:
            tests += kind(text) if kind else []
        except xml.etree.ElementTree.ParseError as error:
            # The runner was stopped.
            print(f"{file}: {error}", file=sys.stderr)
    return sorted(tests, reverse=True)


def table(tests, count):
    """Lines to print."""
    if not tests:
        return []
    title = f"The slowest {min(count, len(tests))} of {len(tests)} tests"
    return [title] + [f"  {seconds:7.1f} s  {name}" for seconds, name in tests[:count]]


def self_test():
    """Reads what each of the runners prints."""
    with tempfile.TemporaryDirectory() as folder:

        def write(name, text):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)

        write(
            "a.libtest",
            "# lumivox it\n\nrunning 4 tests\n"
            "test a::quick ... \x1b[32mok\x1b[m <0.012s>\ntest a::slow ... FAILED <20.500s>\n"
            "test a::left_out ... ignored, slow: why\ntest panics - should panic ... ok <3.000s>\n"
            "test result: ok. 3 passed; 0 failed; finished in 20.51s\n",
        )
        write(
            "b.tap",
            "TAP version 13\n# Subtest: outer\n    # Subtest: inner\n    ok 1 - inner\n      ---\n"
            "      duration_ms: 7000.5\n      ...\n    1..1\nnot ok 1 - outer\n  ---\n"
            "  duration_ms: 8000.5\n  ...\nok 2 - beside \\#1 # SKIP\n  ---\n  duration_ms: 4\n  ...\n1..2\n",
        )
        write(
            "c.xml",
            '<testsuites><testsuite><testcase classname="tests.test_light" name="test_a[b]" time="5.0"/>'
            "</testsuite></testsuites>",
        )
        found = [(round(seconds, 3), name) for seconds, name in tests_in(folder)]
    assert found == [
        (20.5, "lumivox it: a::slow"),
        (7.0, "page: inner"),
        (5.0, "python: tests.test_light::test_a[b]"),
        (3.0, "lumivox it: panics"),
        (1.0, "page: outer"),
        (0.012, "lumivox it: a::quick"),
        (0.004, "page: beside #1"),
    ], found
    assert table(found, 1) == ["The slowest 1 of 7 tests", "     20.5 s  lumivox it: a::slow"]
    assert table([], 40) == []
    print("times are read")


def main(arguments):
    """The command line."""
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) not in (1, 2):
        sys.exit(__doc__)
    print("\n".join(table(tests_in(arguments[0]), int(arguments[1]) if arguments[1:] else 40)))


if __name__ == "__main__":
    main(sys.argv[1:])
