#!/usr/bin/env python3
"""Checks that the pages of docs/ speak of what is there. Exit 1 if one does not.

test    `Suite.Name` is a C++ test under tests/, `tests/x.sh: text` a script that holds this text
link    a relative link leads to a file
lane    docs/testing.md has a row for each lane of tools/lanes.sh, with the sets that it runs in
"""

import argparse
import re
import sys
from pathlib import Path

CPP_TEST = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)")
NAMED_TEST = re.compile(r"`([A-Z]\w+)\.([A-Z]\w+)`")
NAMED_SCRIPT = re.compile(r"`(tests/[\w/.-]+)(?:: ([^`]+))?`")
LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)[^)]*\)")
LANES = Path("tools/lanes.sh")
LANES_PAGE = Path("docs/testing.md")
LANE_SET = re.compile(r"\b(quick|ci|only_all)_lanes=\(([^)]*)\)")
LANE_FUNCTION = re.compile(r"^lane_([\w-]+)\(\)", re.M)
LANE_ROW = re.compile(r"^\| `([\w-]+)` \|(?:[^|]*\|){2}([^|]*)\|")


def cpp_tests(root):
    names = set()
    for path in (root / "tests").rglob("*.cpp"):
        names.update(CPP_TEST.findall(path.read_text(encoding="utf-8")))
    return names


def check_line(line, page, root, tests):
    """Yields what is wrong with a line of `page`."""
    for suite, name in NAMED_TEST.findall(line):
        if (suite, name) not in tests:
            yield f"test: there is no test {suite}.{name}"
    for script, text in NAMED_SCRIPT.findall(line):
        path = root / script
        if not path.exists():
            yield f"test: there is no {script}"
        elif text and text not in path.read_text(encoding="utf-8"):
            yield f"test: {script} does not say '{text}'"
    for target in LINK.findall(line):
        if not (page.parent / target).exists():
            yield f"link: there is no {target}"


def lane_sets(script):
    """The sets that each lane runs in, as the page writes them."""
    of = {name: lanes.split() for name, lanes in LANE_SET.findall(script)}
    quick, ci, only_all = (of.get(name, []) for name in ("quick", "ci", "only_all"))
    return {lane: ", ".join(["quick"] * (lane in quick) + ["CI"] * (lane in ci) + ["all"])
            for lane in (*ci, *only_all)}


def check_lanes(root):
    """Yields where the lanes of run-tests and the page about them differ."""
    script, page = root / LANES, root / LANES_PAGE
    if not script.exists() and not page.exists():
        return
    script, page = (path.read_text(encoding="utf-8") if path.exists() else ""
                    for path in (script, page))
    sets = lane_sets(script)
    for lane in sorted(set(LANE_FUNCTION.findall(script)) ^ set(sets)):
        yield f"{LANES}:1: lane: {lane} is either a function or in a set, and not both"
    rows = {}
    for number, line in enumerate(page.splitlines(), 1):
        for lane, shown in LANE_ROW.findall(line):
            rows[lane] = shown.strip()
            if lane not in sets:
                yield f"{LANES_PAGE}:{number}: lane: run-tests has no lane {lane}"
            elif rows[lane] != sets[lane]:
                yield f"{LANES_PAGE}:{number}: lane: {lane} runs in '{sets[lane]}'"
    for lane in sorted(set(sets) - set(rows)):
        yield f"{LANES_PAGE}:1: lane: there is no row for {lane}"


def check_tree(root):
    """All findings in the pages under `root`, as FILE:LINE: text."""
    yield from check_lanes(root)
    tests = cpp_tests(root)
    pages = sorted([*(root / "docs").glob("*.md"), *root.glob("*.md")])
    for page in pages:
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            for finding in check_line(line, page, root, tests):
                yield f"{page.relative_to(root).as_posix()}:{number}: {finding}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[2],
                        help="the tree to check (default: this one)")
    findings = list(check_tree(parser.parse_args().root))
    for finding in findings:
        print(finding)
    print(f"check_docs: {len(findings)} errors")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
