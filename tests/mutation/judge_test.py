#!/usr/bin/env python3
"""The judge of the mutation test notices each fault, in programs that have nothing but that fault."""

import random
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import judge
import mutate


class Judge(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def said(self, program, **judged):
        return " ".join(judge.problems(judge.run(["/bin/sh", "-c", program], self.folder), **judged))

    def test_a_good_program_has_no_fault(self):
        self.assertEqual(self.said("echo Größe; echo 'a.toml: wrong' >&2; exit 2", names=["a.toml"]), "")

    def test_a_signal_and_a_code_outside_the_contract(self):
        self.assertIn("killed by SIGSEGV", self.said("kill -SEGV $$"))
        self.assertIn("exit code 3", self.said("exit 3"))
        self.assertIn("exit code 1", self.said("exit 1", codes=(0, 2)))

    def test_a_hang_with_and_without_the_processor(self):
        with mock.patch.object(judge, "HANG_S", 1.0):
            self.assertIn("hung", self.said("sleep 60"))
            self.assertIn("hung", self.said("while true; do :; done"))

    def test_a_program_on_a_busy_machine_is_no_hang(self):
        works = "import time\nfor _ in range(8): sum(range(10**6)); time.sleep(0.3)"
        with mock.patch.object(judge, "HANG_S", 1.0):
            self.assertEqual(self.said(f"exec {sys.executable} -c '{works}'"), "")

    def test_texts_of_libraries_and_bytes_that_are_no_text(self):
        self.assertIn("raw text '[json.exception'", self.said("echo '[json.exception.parse_error.101]' >&2"))
        self.assertIn("raw text 'std::'", self.said("echo std::bad_alloc"))
        self.assertIn("control character 0x1b", self.said(r"printf '\033[31m'"))
        self.assertIn("not UTF-8", self.said(r"printf '\377' >&2"))
        self.assertIn("control character 0x9b", self.said(r"printf '\302\233'"))

    def test_messages_that_say_nothing_or_name_no_file(self):
        self.assertIn("without a message", self.said("exit 2"))
        self.assertIn("names none of a.toml", self.said("echo wrong >&2; exit 2", names=["a.toml"]))

    def test_memory_and_output_without_limit(self):
        eats = f"{sys.executable} -c 'x = bytearray(2 << 30)'"
        self.assertIn("exit code 1", self.said(eats, codes=(0,)))
        self.assertIn("wrote more than", self.said("exec cat /dev/zero"))

    def test_a_changed_input(self):
        file = self.folder / "input"
        file.write_text("a")
        before = judge.digest(file)
        file.write_text("b")
        self.assertNotEqual(judge.digest(file), before)
        file.unlink()
        self.assertEqual(judge.digest(file), "gone")


class Changes(unittest.TestCase):
    DATA = {"in_bytes": b"a = 1\n" * 9, "in_lines": b"a = 1\nb = 2\n", "in_numbers": b"a = 1.5\nb = -2e3\n",
            "in_json": b'{"a": [1, 2, {"b": "x"}], "c": 1.5}', "in_cells": b"a,b\n1,2\n3,4\n"}

    def test_the_same_seed_gives_the_same_input_and_most_are_changed(self):
        for name, data in self.DATA.items():
            change = getattr(mutate, name)
            results = [change(random.Random(seed), data) for seed in range(200)]
            self.assertEqual(results, [change(random.Random(seed), data) for seed in range(200)], name)
            self.assertGreater(sum(result != data for result in results), 150, name)


if __name__ == "__main__":
    unittest.main()
