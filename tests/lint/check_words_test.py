#!/usr/bin/env python3
"""Breaks each rule of tools/lint/check_words.py once, and in each place where it looks."""

import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import check_words  # noqa: E402

# One sentence a rule, in the order of BANNED, and the phrase in it.
SENTENCES = (
    ("A queue that nobody reads.", "nobody"),
    ("Somebody's file.", "Somebody's"),
    ("After everybody has answered.", "everybody"),
    ("For whoever owns it.", "whoever"),
    ("What the loop takes for a reading.", "takes for"),
    ("The scan starts anew.", "anew"),
    ("An answer that is none.", "that is none"),
    ("Must not end on the word of a step.", "word of a step"),
    ("The arm has been let go.", "let go"),
    ("A goal that gives way.", "gives way"),
    ("Helped less and less.", "less and less"),
    ("The loop reckons with it.", "reckons"),
    ("He took that upon himself.", "upon himself"),
    ("An angle in doubt.", "doubt"),
    ("The rival's torques.", "rival"),
    ("Is sure of 0.5 kg.", "sure of"),
    ("Files that changed of late.", "of late"),
    ("A delay that it knows of.", "knows of"),
    ("No more than a guess.", "No more than a guess"),
)

ALLOWED = ("The time that it takes for each sample. None of them. Outlets, going. "
           "A number of late frames. Every word of a value. The words of CiA 301. "
           "Arrivals. Give the way. Be sure that it fits.")

# name -> (file, text, line of the finding)
PLACES = {
    "the front page": ("README.md", "# Arm\nWhoever reads.\n", 2),
    "a page": ("docs/page.md", "# Page\n\nWhoever reads.\n", 3),
    "a page of the theory": ("docs/theory/plant.md", "whoever", 1),
    "the symbols": ("model/symbols.md", "whoever", 1),
    "a comment": ("model/a.h", "int a;\n/// For whoever asks.\n", 2),
    "a comment beside code": ("model/a.h", "int a;  ///< whoever\n", 1),
    "a block comment": ("model/a.h", "/* a\n * for whoever asks */\n", 2),
    "a message": ("tools/a.cpp", 'Print("for whoever asks");\n', 1),
    "a message after a line break": ("tools/a.cpp", 'Print("a\\nwhoever");\n', 1),
    "the name of a test": ("tests/a_test.cpp", "\nTEST(Arm, WaitsForWhoeverAsks) {}\n", 2),
    "the suite of a test": ("tests/a_test.cpp", "TEST_F(WhoeverTest, Waits) {}\n", 1),
    "a config": ("config/rig.toml", "a = 1  # whoever\n", 1),
    "a script": ("tests/a.sh", 'echo "whoever"\n', 1),
    "a script without a suffix": ("tools/run", "#!/usr/bin/env bash\n# whoever\n", 2),
    "a comment of Python": ("tools/a.py", "a = 1  # whoever\n", 1),
    "a message of Python": ("tools/a.py", 'print("whoever")\n', 1),
    "a docstring": ("tools/a.py", '"""For\nwhoever."""\n', 2),
    "a CMake file": ("tests/CMakeLists.txt", "# whoever\n", 1),
}

# What stands there is not looked at, or is no phrase.
ELSEWHERE = {
    "the past": ("CHANGELOG.md", "whoever"),
    "a quotation of the thesis": ("docs/theory/thesis.md", 'It says "for whoever\nreads it".\n'),
    "code": ("model/a.cpp", "int whoever = 1; doubt(rival);\n"),
    "code of Python": ("tools/a.py", "whoever = 1\n"),
    "two comments with code between": ("model/a.cpp", "f();  // to let\ngo();  // go\n"),
}


class CheckWords(unittest.TestCase):
    def findings(self, name, text):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            return list(check_words.check_tree(Path(folder)))

    def test_finds_each_phrase_and_says_what_to_write(self):
        self.assertEqual(len(SENTENCES), len(check_words.BANNED))
        for (sentence, phrase), (_, instead) in zip(SENTENCES, check_words.BANNED):
            with self.subTest(phrase):
                self.assertEqual(self.findings("docs/page.md", sentence),
                                 [f"docs/page.md:1: words: '{phrase}': write {instead}"])

    def test_finds_a_phrase_across_lines_and_literals(self):
        for name, text in (("docs/page.md", "less and\nless"),
                           ("model/a.h", "/// less\n/// and less\n"),
                           ("model/a.h", "  /* less\n   * and less */\n"),
                           ("tools/a.cpp", 'Print("less "\n      "and less");\n'),
                           ("tests/a.sh", "# less and\n# less\n")):
            with self.subTest(text):
                self.assertEqual(len(self.findings(name, text)), 1)

    def test_takes_what_only_looks_like_one(self):
        self.assertEqual(self.findings("docs/page.md", ALLOWED), [])

    def test_looks_into_pages_comments_messages_and_names_of_tests(self):
        for place, (name, text, line) in PLACES.items():
            with self.subTest(place):
                findings = self.findings(name, text)
                self.assertEqual(len(findings), 1, findings)
                found = findings[0].partition(": write")[0]
                self.assertEqual(found.lower(), f"{name}:{line}: words: 'whoever'".lower())

    def test_looks_nowhere_else(self):
        for place, (name, text) in ELSEWHERE.items():
            with self.subTest(place):
                self.assertEqual(self.findings(name, text), [])

    def test_the_pages_of_this_tree_use_plain_words(self):
        self.assertEqual([finding for finding in check_words.check_tree(ROOT)
                          if finding.split(":")[0].endswith(".md")], [])


if __name__ == "__main__":
    unittest.main()
