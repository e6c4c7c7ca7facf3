#!/usr/bin/env python3
"""Checks that each relative link of each page below a folder leads to a file there, and each anchor
to a heading. usage: installed_links.py FOLDER"""

import re
import sys
from pathlib import Path

LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)(?:#([^)\s]*))?\)")
HEADING = re.compile(r"^#+ +(.*?) *$", re.MULTILINE)


def anchors(page):
    """As the usual viewers make them."""
    for heading in HEADING.findall(page.read_text(encoding="utf-8")):
        yield re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def broken(root):
    for page in sorted(root.rglob("*.md")):
        for target, anchor in LINK.findall(page.read_text(encoding="utf-8")):
            file = page.parent / target if target else page
            name = f"{page.relative_to(root)}: {target}" + (f"#{anchor}" if anchor else "")
            if not file.exists():
                yield f"{name}: no such file"
            elif root.resolve() not in file.resolve().parents:
                yield f"{name}: outside the installation"
            elif anchor and anchor not in anchors(file):
                yield f"{name}: no such heading"


def main():
    root = Path(sys.argv[1])
    pages = list(root.rglob("*.md"))
    problems = list(broken(root))
    print("\n".join(problems), end="\n" if problems else "")
    print(f"{len(pages)} pages, {len(problems)} broken links")
    return 1 if problems or len(pages) < 20 else 0


if __name__ == "__main__":
    sys.exit(main())
