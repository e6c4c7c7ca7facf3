#!/usr/bin/env python3
"""Spin proves the interlock, and finds every error that is built into it: docs/safety.md, "Model".

FLEXARM_SPIN_PRODUCT is the library with the product's state machine (CMakeLists.txt).
"""

import concurrent.futures
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TABLE = ROOT / "controller/safety/transition_table.def"
PRODUCT = os.environ.get("FLEXARM_SPIN_PRODUCT", "")

SEQUENCES = ("-DSEQUENCES=100000", "-DTICKS=50")
DEPTH = 1_000_000  # steps of the longest path; reached: 200 003

# The errors of interlock.pml, in the order of their numbers: whether arming tests the power path,
# and what the rule says that must find them.
BROKEN = {
    "BREAK_GATE": (0, "unpermitted<=2"),
    "BREAK_PERMIT_AGE": (0, "unpermitted<=2"),
    "BREAK_COMMAND_AGE": (0, "ask_age<=2"),
    "BREAK_PUMP": (0, "unpermitted<=2|ask_age<=2"),
    "BREAK_DRIVE": (0, "unpermitted<=2|ask_age<=2"),
    "BREAK_RELAY": (0, r"state!=5.*relay"),
    "BREAK_BUTTON": (0, "must_press"),
    "BREAK_LATCH": (0, "must_press"),
    "BREAK_FILE": (0, "must_press"),
    "BREAK_NUMBER": (0, "torque_run!=2"),
    "BREAK_REST": (0, "stepped"),
    "BREAK_LIMIT": (0, "since<="),
    "BREAK_AWAIT": (0, "invalid end state"),
    "BREAK_TABLE": (0, "product_agrees"),
    "BREAK_WITNESS": (1, "broken!=1"),
}


def rows():
    """The conditions of the table of transitions, in its order."""
    text = TABLE.read_text(encoding="utf-8")
    return re.findall(r"^TRANSITION\((.*?)\)$", text, re.M | re.S)


def run(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True,
                          **options).stdout


def build(folder, model, *options):
    """Makes the verifier of a model."""
    (folder / model).mkdir()
    run("spin", "-a", f"-Pgcc -E -x c -I{ROOT}", *options, HERE / f"{model}.pml",
        cwd=folder / model)
    run("gcc", "-O2", "-w", "-DSAFETY", "-DCOLLAPSE", f"-I{ROOT}", "-o", "pan", "pan.c", PRODUCT,
        "-lstdc++", cwd=folder / model)


def verify(folder, model, error=0, witness=0):
    """What a verifier says."""
    environment = {**os.environ, "FLEXARM_ERROR": str(error), "FLEXARM_WITNESS": str(witness)}
    with tempfile.TemporaryDirectory() as trails:
        return run(folder / model / "pan", f"-m{DEPTH}", cwd=trails, env=environment)


class Report:
    def __init__(self, text):
        self.text = text
        self.errors = int(re.search(r"errors: (\d+)", text).group(1))
        self.states = int(re.search(r"(\d+) states, stored", text).group(1))
        self.found = re.findall(r"^pan:1: (.*?)(?: \(at depth \d+\))?$", text, re.M)
        self.rows = {int(row) for row in re.search(r"rows that held:(.*)", text).group(1).split()}

    @property
    def whole(self):
        """Nothing cut the search short."""
        return "max search depth too small" not in self.text and \
            "Search not completed" not in self.text


class Spin(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if shutil.which("spin") is None:
            raise AssertionError("the program spin is missing: tools/install-deps test")
        wanted = {"correct": ("interlock",), "with a witness": ("interlock", 0, 1),
                  "sequences": ("sequences",), "other table": ("sequences", 1)}
        for number, (error, (witness, _)) in enumerate(BROKEN.items(), 1):
            wanted[error] = "interlock", number, witness
        with tempfile.TemporaryDirectory() as path, \
                concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            folder = Path(path)
            list(pool.map(lambda arguments: build(folder, *arguments),
                          (("interlock",), ("sequences", *SEQUENCES))))
            texts = list(pool.map(lambda arguments: verify(folder, *arguments), wanted.values()))
        cls.reports = {name: Report(text) for name, text in zip(wanted, texts)}

    def assert_proved(self, name, states):
        report = self.reports[name]
        self.assertEqual(report.errors, 0, report.text)
        self.assertTrue(report.whole, report.text)
        self.assertGreater(report.states, states, "the search is smaller than it was")
        return report

    def test_the_interlock_obeys_its_rules_and_never_stands_still(self):
        # Reached: 520 140 and 298 036 states. Much fewer: a part of the model does nothing.
        self.assert_proved("correct", 400_000)
        self.assert_proved("with a witness", 200_000)

    def test_every_row_of_the_table_is_used(self):
        table = rows()
        held = self.reports["correct"].rows | self.reports["with a witness"].rows
        self.assertLess(max(held), len(table))
        unused = {row for number, row in enumerate(table) if number not in held}
        # A byte that is no state or no cause comes from a defect of the memory: not of the model.
        self.assertEqual({row for row in unused
                          if "!cause_known" not in row and not row.startswith("Corrupted")}, set())

    def test_every_error_that_is_built_in_is_found_by_its_rule(self):
        for error, (_, rule) in BROKEN.items():
            with self.subTest(error):
                report = self.reports[error]
                self.assertEqual(report.errors, 1, report.text)
                self.assertRegex("\n".join(report.found), rule)

    def test_the_model_numbers_its_errors_as_this_test_does(self):
        text = (HERE / "interlock.pml").read_text(encoding="utf-8")
        numbers = re.findall(r"^#define (BREAK_\w+) c_expr \{ built_in == (\d+) \}", text, re.M)
        self.assertEqual(numbers, [(error, str(number)) for number, error in enumerate(BROKEN, 1)])

    def test_machine_and_product_go_the_same_way_in_100000_random_sequences(self):
        self.assert_proved("sequences", 100_000)
        found = self.reports["other table"]
        self.assertEqual(found.errors, 1)
        self.assertRegex("\n".join(found.found), "state==product_state")


if __name__ == "__main__":
    unittest.main()
