#!/usr/bin/env python3
"""What a page says that its commands print is compared with what they printed
(tests/docs/transcript.py)."""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools" / "lint"), str(ROOT / "tests" / "docs")]

import transcript  # noqa: E402

# The newcomer blocks are in the lines 3 and 13.
PAGE = """# Page

```sh newcomer
flexarm status
```

```text
state          Idle
...
joint angle    ... deg
```

```sh newcomer
flexarm arm
```
"""
PRINTED = """block 3 0
state          Idle
rig            one
joint angle    0.02, 0.00 deg
block 13 70
arm: ok, state Armed
"""


class Transcript(unittest.TestCase):
    def found(self, printed, page=PAGE):
        return list(transcript.problems(page, printed))

    def test_lines_that_the_page_leaves_out_are_no_difference(self):
        self.assertEqual(self.found(PRINTED), [])

    def test_a_line_that_differs_is_named_with_its_line_of_the_page(self):
        (line, message), = self.found(PRINTED.replace("Idle", "Tripped"))
        self.assertEqual(line, 8)
        self.assertIn("does not print 'state          Idle'", message)

    def test_the_order_of_the_lines_counts(self):
        swapped = "block 3 0\njoint angle    1 deg\nstate          Idle\nblock 13 9\n"
        self.assertEqual([line for line, _ in self.found(swapped)], [10])

    def test_a_line_of_another_block_does_not_count(self):
        moved = "block 3 0\nstate          Idle\nblock 13 9\njoint angle    1 deg\n"
        self.assertEqual([line for line, _ in self.found(moved)], [10])

    def test_a_block_that_did_not_run_is_named(self):
        self.assertEqual(self.found("\n".join(PRINTED.splitlines()[:4])),
                         [(13, "this block has not run")])

    def test_text_after_another_block_is_not_compared(self):
        page = PAGE + "\n```sh rig: needs a real arm\nflexarm arm\n```\n\n```text\nno line\n```\n"
        self.assertEqual(self.found(PRINTED, page), [])

    def test_dots_stand_for_characters_and_nothing_else_does(self):
        self.assertTrue(transcript.pattern("a... b.").fullmatch("a long b."))
        self.assertFalse(transcript.pattern("a... b.").fullmatch("a long bc"))


if __name__ == "__main__":
    unittest.main()
