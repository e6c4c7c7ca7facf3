#!/usr/bin/env python3
"""Compares the blocks of text of a page with what its `newcomer` blocks printed.

A block of text belongs to the `newcomer` block before it: its lines must be among the output of
this block, in this order. `...` in a line stands for any characters, a line of `...` alone for any
lines. What the page leaves out without `...` is left out, too: a page shows the lines that matter.

usage: transcript.py PAGE TRANSCRIPT     TRANSCRIPT: the output of page.sh, with its marks
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import command_blocks  # noqa: E402

MARK = re.compile(r"block (\d+) \d+")


def printed(transcript):
    """The lines of each block that ran, by the line of the page at which it begins."""
    blocks, lines = {}, []
    for line in transcript.splitlines():
        mark = MARK.fullmatch(line)
        if mark:
            lines = blocks.setdefault(int(mark[1]), [])
        else:
            lines.append(line.rstrip())
    return blocks


def pattern(expected):
    return re.compile(".*".join(re.escape(part) for part in expected.rstrip().split("...")))


def missing(expected, lines):
    """The first expected line, as an index, that is not among the lines after those before it."""
    position = 0
    for index, text in enumerate(expected):
        if text.strip() in ("", "..."):
            continue
        wanted = pattern(text)
        while position < len(lines) and not wanted.fullmatch(lines[position]):
            position += 1
        if position == len(lines):
            return index
        position += 1
    return None


def problems(page, transcript):
    """Yields (line, message) of each newcomer block that did not run, and of each block of text
    that the block before it did not print."""
    blocks = printed(transcript)
    lines = None  # of the newcomer block before
    for block in command_blocks.fences(page):
        if block.language == "sh":
            lines = None
            if block.lane == "newcomer":
                lines = blocks.get(block.line)
                if lines is None:
                    yield block.line, "this block has not run"
        elif block.language == "text" and lines is not None:
            index = missing(block.body, lines)
            if index is not None:
                shown = "\n".join("  " + line for line in lines[-30:])
                yield (block.line + 1 + index,
                       f"the block before does not print '{block.body[index].strip()}' here, but:\n"
                       f"{shown}")


def main():
    page, transcript = (Path(name).read_text(encoding="utf-8", errors="replace")
                        for name in sys.argv[1:3])
    found = list(problems(page, transcript))
    for line, message in found:
        print(f"{sys.argv[1]}:{line}: {message}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
