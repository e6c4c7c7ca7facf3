#!/usr/bin/env python3
"""The tags of the command blocks (tools/lint/command_blocks.py), each rule broken once, and how
their runner (tests/docs/run_blocks.py) reports what fails, in pages made for it."""

import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools" / "lint"), str(ROOT / "tests" / "docs")]

import command_blocks  # noqa: E402
import run_blocks  # noqa: E402


def fence(info, *body):
    return "\n".join([f"```{info}", *(body or ("ls",)), "```"])


TAKEN = (
    fence("sh ci"), fence("sh ci clone"), fence("sh all installed"), fence("sh all unbuilt"),
    fence("sh guest"), fence("sh guest clone"), fence("sh newcomer"),
    fence("sh rig: needs a real arm"),
    fence("sh rig: needs a real arm", "a && b"), fence("sh ci", "a  # b && c"),
    fence("text", "counts -> flexarmd"), fence("toml", "flexarm = 1"),
    fence("python", "# cd to where flexarm is", "import flexarm"),
    "1. In a list:\n\n   ```sh ci\n   ls\n   ```", "````text\n```sh\n````",
    "    y = C x", "text\n    flexarm arm of a paragraph", "`flexarm arm`",
)

REFUSED = {
    "no tag": (fence("sh"), 1, "has no tag"),
    "an unknown tag": (fence("sh nightly"), 1, "found the tag 'nightly'"),
    "an unknown place": (fence("sh ci here"), 1, "found 'here' after ci"),
    "two places": (fence("sh ci clone installed"), 1, "has no tag"),
    "rig without a reason": (fence("sh rig"), 1, "says why"),
    "rig with an empty reason": (fence("sh rig: "), 1, "says why"),
    "rig with a word": (fence("sh rig: no"), 1, "says why"),
    "rig in a place": (fence("sh rig clone: needs a real arm"), 1, "says why"),
    "a reason of a lane": (fence("sh ci: needs a real arm"), 1, "only rig has a reason"),
    "a guest that builds": (fence("sh guest unbuilt"), 1, "nothing is built in the guest"),
    "a newcomer with a clone": (fence("sh newcomer clone"), 1, "has the package alone"),
    "no command": (fence("sh ci", "# later"), 1, "has no command"),
    "another shell": (fence("bash ci"), 1, "found the language bash"),
    "a console": (fence("console"), 1, "found the language console"),
    "no language": (fence("", "a"), 1, "has no language"),
    "an unknown language": (fence("shh ci"), 1, "found the language shh"),
    "a prompt": (fence("sh ci", "$ ls"), 2, "no prompt"),
    "a hidden failure": (fence("sh ci", "ls", "a && b"), 3, "two lines"),
    "commands as text": (fence("text", "so:", "flexarm arm"), 3, "belong into a block"),
    "a prompt in text": (fence("text", "$ ls"), 2, "belong into a block"),
    "commands without a fence": ("so:\n\n    cmake --preset release\n", 3, "belong into a block"),
    "more of them": ("so:\n\n    y = 1\n    ./tools/run-hil --help\n", 4, "belong into a block"),
    "another fence": ("~~~sh ci\nls\n~~~", 1, "begins with ```"),
    "a fence in a quotation": ("> ```sh\n> ls\n> ```", 1, "begins with ```"),
    "a fence beside a number": ("1. ```sh\n   ls\n   ```", 1, "begins with ```"),
    "a fence of HTML": ("<pre>\nls\n</pre>", 1, "begins with ```"),
    "no end": ("```sh ci\nls", 1, "has no end"),
}


class Tags(unittest.TestCase):
    def test_takes_each_tag(self):
        for text in TAKEN:
            with self.subTest(text):
                self.assertEqual(list(command_blocks.problems(text)), [])

    def test_finds_each_mistake_at_its_line(self):
        for name, (text, line, said) in REFUSED.items():
            with self.subTest(name):
                found = list(command_blocks.problems("\n\n" + text))
                self.assertIn(line + 2, [number for number, _ in found], found)
                self.assertIn(said, "\n".join(message for number, message in found
                                              if number == line + 2))

    def test_every_page_of_this_tree_has_its_tags(self):
        pages = command_blocks.pages(ROOT)
        for page in pages:
            text = page.read_text(encoding="utf-8")
            self.assertEqual(list(command_blocks.problems(text)), [], page)
        blocks = [block for page in pages
                  for block in command_blocks.commands(page.read_text(encoding="utf-8"))]
        for lane in command_blocks.LANES:
            self.assertTrue([block for block in blocks if block.lane == lane], lane)


PAGE = "\n".join(("# Page", fence("sh ci", "one"), fence("sh all", "two"),
                  fence("sh ci clone", "three"), fence("sh guest", "four"),
                  fence("sh all unbuilt", "five"), fence("sh rig: needs a real arm", "six")))


class Selection(unittest.TestCase):
    def bodies(self, lane, place, text=PAGE):
        return [block.body[0] for block in run_blocks.selected(text, lane, place)]

    def test_a_lane_runs_its_blocks_where_they_belong(self):
        self.assertEqual(self.bodies("ci", "clone"), ["one", "three"])
        self.assertEqual(self.bodies("ci", "installed"), ["one"])
        self.assertEqual(self.bodies("ci", "unbuilt"), [])
        self.assertEqual(self.bodies("guest", "installed"), ["four"])
        self.assertEqual(self.bodies("newcomer", "installed"), [])

    def test_what_takes_long_runs_after_the_quick_blocks_before_it(self):
        self.assertEqual(self.bodies("all", "clone"), ["one", "two", "three"])
        self.assertEqual(self.bodies("all", "unbuilt"), ["five"])
        self.assertEqual(self.bodies("all", "clone", fence("sh ci")), [])

    def test_lines_of_the_script_are_those_of_the_page(self):
        blocks = run_blocks.selected(PAGE, "ci", "clone")
        lines = run_blocks.script(PAGE, blocks).splitlines()
        self.assertEqual({number: line for number, line in enumerate(lines, 1) if line},
                         {2: "block 2", 3: "one", 8: "block 8", 9: "three"})


class Running(unittest.TestCase):
    def run_text(self, *bodies, limit_s=60):
        """Runs blocks from line 3 on; returns (lines of the blocks run, failure, output)."""
        text = "# Page\n\n" + "\n".join(fence("sh ci", *body) for body in bodies)
        home = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, home)
        self.folder = home / "flexarm"
        self.folder.mkdir()
        file = home / "page.md"
        file.write_text(run_blocks.script(text, run_blocks.selected(text, "ci", "clone")),
                        encoding="utf-8")
        variables = run_blocks.environment(self.folder)
        seconds, failure, said = run_blocks.run_script(file, self.folder, variables, limit_s)
        return list(seconds), failure, said

    def test_blocks_share_shell_and_folder(self):
        lines, failure, said = self.run_text(("x=7", "f() { echo $x; }", "mkdir d", "cd d"),
                                             ("cat > file <<'END'", "  $x", "END", "f", "pwd"))
        self.assertIsNone(failure)
        self.assertEqual(lines, [3, 9])
        self.assertEqual(said.splitlines(), ["7", str(self.folder / "d")])
        self.assertEqual((self.folder / "d/file").read_text(encoding="utf-8"), "  $x\n")

    def test_the_first_failure_ends_the_page_at_its_line(self):
        for body, status in ((("ls .", "cat missing", "touch later"), 1),
                             (("ls .", "(exit 4) | cat", "touch later"), 4),
                             (("x=1", "(exit 3)", "touch later"), 3),
                             (("for i in 1; do", "(exit 2); done", "touch later"), 2)):
            with self.subTest(body):
                lines, failure, _ = self.run_text(("echo before",), body, ("touch later",))
                self.assertEqual(lines, [3, 6])
                self.assertEqual(failure[:2], (8, status))
                self.assertFalse((self.folder / "later").exists())

    def test_says_what_the_failed_block_printed(self):
        _, _, said = self.run_text(("echo before",), ("echo here", "ls missing",))
        self.assertIn("missing", said)
        self.assertIn("here", said)
        self.assertNotIn("before", said)

    def test_a_block_that_ends_the_shell_is_a_failure(self):
        for status in (0, 5):
            _, failure, _ = self.run_text((f"exit {status}",), ("touch later",))
            self.assertEqual(failure[:2], (3, status))

    def test_an_expected_refusal_is_none(self):
        _, failure, said = self.run_text(('false || echo "refused, as wanted"',))
        self.assertIsNone(failure)
        self.assertIn("refused, as wanted", said)

    def test_a_block_that_hangs_ends_with_all_its_programs(self):
        since = time.monotonic()
        _, failure, _ = self.run_text(("sleep 1000 &", "echo $! > process", "sleep 1000"), limit_s=1)
        self.assertLess(time.monotonic() - since, 50)
        self.assertEqual(failure[:2], (3, 124))
        self.assert_ended((self.folder / "process").read_text(encoding="utf-8"))

    def test_what_runs_in_the_background_is_stopped_at_the_end(self):
        _, failure, _ = self.run_text(("sleep 1000 &", "echo $! > process"), ("ls",))
        self.assertIsNone(failure)
        self.assert_ended((self.folder / "process").read_text(encoding="utf-8"))

    def test_what_failed_in_the_background_is_a_failure(self):
        _, failure, _ = self.run_text(("(exit 4) &", "sleep 0.5"),)
        self.assertEqual(failure[:2], (3, 4))
        _, failure, _ = self.run_text(("true &", "sleep 0.5"),)
        self.assertIsNone(failure)

    def assert_ended(self, process):
        state = subprocess.run(["ps", "-o", "stat=", "-p", process.strip()], capture_output=True,
                               text=True, check=False).stdout
        self.assertIn(state.strip()[:1], ("", "Z"))


if __name__ == "__main__":
    unittest.main()
