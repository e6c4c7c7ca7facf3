#!/usr/bin/env python3
"""Checks that comments, messages and pages use plain words. Exit 1 if one does not.

BANNED has the phrases, each with what to write instead. They are looked for in README.md, docs/,
model/symbols.md, C++ comments and string literals, names of C++ tests, Python comments and
strings, and in scripts, CMake files and TOML files; not in quotations of docs/theory.

tests/lint/check_words_test.py has one sentence that breaks each rule.
"""

import argparse
import re
import sys
from pathlib import Path

import prose

# One space in a pattern is any white space.
BANNED = (
    (r"nobody(?:'s)?", "the part that does not: 'no task reads it', 'undeclared', 'unused'"),
    (r"somebody(?:'s)?|someone", "who or what: 'the operator', 'another process'"),
    (r"everybody(?:'s)?|everyone", "the parts: 'every task', 'all nodes'"),
    (r"whoever", "the role: 'the caller', 'the owner', 'a thread that'"),
    (r"(?:take|takes|taken|taking|took)(?: it| them| this| that)? for(?! each\b| every\b| all\b)",
     "'assumed to be', 'mistaken for'"),
    (r"anew", "'again', 'from the start'"),
    (r"(?:that|which) (?:is|are) none\b(?! of\b)",
     "what is wrong: 'malformed', 'missing', 'not a'"),
    (r"word of (?:rest|an? (?:step|task)|the (?:loop|step|task|drive|plant))",
     "'report of', 'the flag at_rest'"),
    (r"lets? go|letting go", "'release', 'ramp to zero', 'drop'"),
    (r"(?:give|gives|given|gave|giving) way", "'switch to', 'is replaced by', 'follows'"),
    (r"less and less|more and more", "over which time or range: 'faded out over 2 s'"),
    (r"reckon(?:s|ed|ing)?", "'compute', 'compensate', 'expect'"),
    (r"upon (?:him|her|it|them)sel(?:f|ves)", "what was done: 'overridden with --force'"),
    (r"doubt(?:s|ed|ful)?", "'warning', 'uncertain', 'variance', 'ambiguous'"),
    (r"rivals?", "'hypothesis', 'other'"),
    (r"sure of", "'certain of', 'has a small variance of'"),
    (r"of late(?! (?:frame|repl|answer|reading|torque|step|plan|wake|one|task))", "'recently'"),
    (r"(?:know|knows|knew|known) of", "'declared', 'has', 'known to'"),
    (r"no more than a guess", "what it rests on: 'assumed', 'estimated from'"),
)
PATTERNS = [(re.compile(r"\b(?:" + phrase.replace(" ", r"\s+") + r")\b", re.I), instead)
            for phrase, instead in BANNED]

SELF = {"tools/lint/check_words.py", "tests/lint/check_words_test.py"}
TEST_NAME = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)")
CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
QUOTATION = re.compile(r'"[^"\n]*(?:\n[^"\n]+)?"')


def phrases(text):
    """Yields (position, the phrase, what to write) of each banned phrase."""
    for pattern, instead in PATTERNS:
        for match in pattern.finditer(text):
            yield match.start(), " ".join(match.group(0).split()), instead


def test_names(text):
    """The same of the names of C++ tests, taken apart into words."""
    for match in TEST_NAME.finditer(text):
        words = re.sub(CAMEL, " ", " ".join(match.groups()))
        for _, phrase, instead in phrases(words):
            yield match.start(), phrase, instead


def check_file(path, name):
    text = prose.read(path)
    said = prose.of_file(path, text)
    if said is None:
        return
    if name.startswith("docs/theory/"):
        said = prose.same_length(QUOTATION, said)
    found = list(phrases(said))
    if path.suffix == ".cpp":
        found += test_names(text)
    for position, phrase, instead in sorted(found):
        yield f"{name}:{prose.line_of(text, position)}: words: '{phrase}': write {instead}"


def check_tree(root):
    """All findings in the tree under `root`, as FILE:LINE: text."""
    for path in [*prose.pages(root), *prose.files(root)]:
        name = path.relative_to(root).as_posix()
        if name not in SELF:
            yield from check_file(path, name)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[2],
                        help="the tree to check (default: this one)")
    findings = list(check_tree(parser.parse_args().root))
    for finding in findings:
        print(finding)
    print(f"check_words: {len(findings)} errors")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
