#!/usr/bin/env python3
"""Checks that the pages of docs/ speak of what is there. Exit 1 if one does not.

test    `Suite.Name` is a C++ test under tests/, `tests/x.sh: text` a script that holds this text
link    a relative link leads to a file
"""

import argparse
import re
import sys
from pathlib import Path

CPP_TEST = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)")
NAMED_TEST = re.compile(r"`([A-Z]\w+)\.([A-Z]\w+)`")
NAMED_SCRIPT = re.compile(r"`(tests/[\w/.-]+)(?:: ([^`]+))?`")
LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)[^)]*\)")


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


def check_tree(root):
    """All findings in the pages under `root`, as FILE:LINE: text."""
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
