#!/usr/bin/env python3
"""Asks tools/lint/changed_files.py for the changes of small repositories made for it."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import changed_files  # noqa: E402

DAY = 24 * 3600
NOON = 1_700_000_000


class ChangedFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name) / "origin"
        self.root.mkdir()
        self.git("init", "--quiet")

    def git(self, *command, time=NOON):
        identity = {f"GIT_{who}_{what}": value for who in ("AUTHOR", "COMMITTER")
                    for what, value in (("NAME", "x"), ("EMAIL", "x@y"), ("DATE", f"{time} +0000"))}
        subprocess.run(["git", "-C", str(self.root), *command], check=True, capture_output=True,
                       env={**os.environ, **identity})

    def commit(self, name, time=NOON):
        (self.root / name).write_text(str(time), encoding="utf-8")
        self.git("add", "-A")
        self.git("commit", "--quiet", "--allow-empty", "-m", name, time=time)

    def changed(self, **limits):
        return changed_files.changed_files(self.root, **limits)

    def test_the_newest_comes_first_and_what_is_not_committed_before_it(self):
        for day, name in enumerate(("a", "b", "c")):
            self.commit(name, NOON + day)
        (self.root / "a").write_text("now", encoding="utf-8")
        (self.root / "new").write_text("now", encoding="utf-8")
        self.assertEqual(self.changed(), ["a", "new", "c", "b"])

    def test_a_quiet_week_still_has_its_last_commits(self):
        for day, name in enumerate(("a", "b", "c")):
            self.commit(name, NOON + 7 * day * DAY)
        self.assertEqual(self.changed(commits=2), ["c", "b"])

    def test_a_busy_day_has_all_of_its_commits(self):
        for number, name in enumerate(("a", "b", "c", "d")):
            self.commit(name, NOON + number * DAY)
        self.assertEqual(self.changed(commits=1, seconds=2 * DAY), ["d", "c", "b"])

    def test_files_that_are_gone_are_not_named(self):
        self.commit("a")
        (self.root / "a").unlink()
        self.commit("b")
        self.assertEqual(self.changed(), ["b"])

    def test_a_merge_names_what_it_brought(self):
        self.commit("a")
        self.git("checkout", "--quiet", "-b", "side")
        self.commit("b")
        self.git("checkout", "--quiet", "-")
        self.commit("c")
        self.git("merge", "--quiet", "--no-ff", "-m", "merge", "side")
        self.assertEqual(self.changed(commits=1, seconds=-1), ["b"])

    def test_a_shallow_clone_and_a_plain_folder_have_no_answer(self):
        self.commit("a")
        self.commit("b")
        shallow = self.root.parent / "shallow"
        subprocess.run(["git", "clone", "--quiet", "--depth=1", f"file://{self.root}", str(shallow)],
                       check=True, capture_output=True)
        self.assertIsNone(changed_files.changed_files(shallow))
        plain = self.root.parent / "plain"
        plain.mkdir()
        self.assertIsNone(changed_files.changed_files(plain))


if __name__ == "__main__":
    unittest.main()
