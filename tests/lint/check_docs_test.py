#!/usr/bin/env python3
"""Breaks each rule of tools/lint/check_docs.py once, in a tree made for it; and checks this one."""

import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import check_docs  # noqa: E402


class CheckDocs(unittest.TestCase):
    def findings(self, page):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "docs").mkdir()
            (root / "tests").mkdir()
            (root / "tests" / "arm_test.cpp").write_text(
                "TEST(Arm, Moves) {}\nTEST_P(\n    ArmOver,\n    Stops) {}\n")
            (root / "tests" / "run.sh").write_text('check "it stops" true\n')
            (root / "docs" / "page.md").write_text(page)
            return list(check_docs.check_tree(root))

    def test_takes_what_is_there(self):
        self.assertEqual(self.findings("`Arm.Moves` `ArmOver.Stops` `tests/run.sh: it stops`\n"
                                       "[page](page.md) [web](https://example.org/x)\n"), [])

    def test_finds_a_test_that_is_not_there(self):
        self.assertEqual(self.findings("# Page\n`Arm.Flies`\n"),
                         ["docs/page.md:2: test: there is no test Arm.Flies"])

    def test_finds_a_script_that_is_not_there_or_says_something_else(self):
        self.assertEqual(self.findings("`tests/walk.sh: it stops`"),
                         ["docs/page.md:1: test: there is no tests/walk.sh"])
        self.assertEqual(self.findings("`tests/run.sh: it flies`"),
                         ["docs/page.md:1: test: tests/run.sh does not say 'it flies'"])

    def test_finds_a_link_that_leads_nowhere(self):
        self.assertEqual(self.findings("[page](other.md)"),
                         ["docs/page.md:1: link: there is no other.md"])

    def lane_findings(self, *rows, script="""
ci_lanes=(format
          asan)
only_all_lanes=(unit)
quick_lanes=(format unit)
lane_format() {
lane_asan() {
lane_unit() {
"""):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in (("tools/lanes.sh", script), ("docs/testing.md", "\n".join(rows))):
                (root / name).parent.mkdir()
                (root / name).write_text(text)
            return list(check_docs.check_tree(root))

    ROWS = ("| `format` | layout | 5 s | quick, CI, all | cheap |",
            "| `asan` | memory | | CI, all | input |",
            "| `unit` | tests | | quick, all | part |")

    def test_takes_a_row_for_each_lane(self):
        self.assertEqual(self.lane_findings(*self.ROWS), [])

    def test_finds_a_lane_without_a_row(self):
        self.assertEqual(self.lane_findings(*self.ROWS[:2]),
                         ["docs/testing.md:1: lane: there is no row for unit"])

    def test_finds_a_row_without_a_lane(self):
        self.assertEqual(self.lane_findings(*self.ROWS, "| `fuzz` | input | | all | slow |"),
                         ["docs/testing.md:4: lane: run-tests has no lane fuzz"])

    def test_finds_a_row_with_other_sets(self):
        self.assertEqual(
            self.lane_findings(*self.ROWS[:2], "| `unit` | tests | | quick, CI, all | part |"),
            ["docs/testing.md:3: lane: unit runs in 'quick, all'"])

    def test_finds_a_lane_that_no_set_runs(self):
        self.assertEqual(
            self.lane_findings(self.ROWS[0], script="ci_lanes=(format)\nquick_lanes=(format)\n"
                               "lane_format() {\nlane_fuzz() {\n"),
            ["tools/lanes.sh:1: lane: fuzz is either a function or in a set, and not both"])

    def test_this_tree_speaks_of_what_is_there(self):
        self.assertEqual(list(check_docs.check_tree(ROOT)), [])

    def test_every_pitfall_of_the_buses_has_its_row(self):
        page = (ROOT / "docs" / "hardware.md").read_text(encoding="utf-8")
        rows = [line for line in page.splitlines() if line.startswith("| ") and line[2].isdigit()]
        numbers = [int(row.split("|")[1]) for row in rows]
        self.assertEqual(numbers, list(range(1, 19)))
        for row in rows:
            self.assertRegex(row.split("|")[4], r"`\w+\.\w+`|`tests/", row)


if __name__ == "__main__":
    unittest.main()
