#!/usr/bin/env python3
"""flexarm check: a recorded log obeys its rules, and a violation is named."""

import contextlib
import json
import sqlite3
import unittest

from program import HIL, ProgramTest, doublet, rows

# Bytes of a record BLOB: version (4), due_ns (8), present (8), all_reported, at_rest, ..
AT_REST = 4 + 8 + 8 + 1


class Check(ProgramTest):
    def check(self, run):
        """Exit code, and of each rule its name and what was found."""
        result = self.run_program("flexarm", "check", run, "--json")
        checks = json.loads(result.stdout)
        self.assertEqual(checks["passed"], result.returncode == 0)
        return result.returncode, {check["name"]: check for check in checks["checks"]}

    def test_a_recorded_run_obeys_every_rule(self):
        run, _ = self.simulate("run.flexarm")
        code, checks = self.check(run)
        self.assertEqual(code, 0)
        for rule in ("safety-table", "safety-chain", "trip-latched", "running-was-granted",
                     "state-from-safety", "torque-only-where-allowed"):
            self.assertTrue(checks[rule]["passed"], rule)
            self.assertIsNone(checks[rule]["time_s"])

    def test_a_run_that_tripped_obeys_every_rule(self):
        run = self.folder / "run.flexarm"
        experiment = self.experiment(doublet("trip", 3.0) + """
[[sim_event]]
at_s = 0.5
line = "limit-1-high"
level = 0
""")
        result = self.run_program("flexarm", "simulate", "-c", HIL, "--experiment", experiment,
                                  "-o", run)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn(("Tripped",), rows(run, "SELECT state_after FROM safety"))
        self.assertEqual(self.check(run)[0], 0)

    def test_a_transition_that_the_table_does_not_allow_is_named(self):
        run, _ = self.simulate("run.flexarm")
        with contextlib.closing(sqlite3.connect(run)) as log:
            number, time_s, record = log.execute(
                "SELECT number, time_s, record FROM safety WHERE state_before = 'Stopping' AND"
                " state_after = 'Armed'").fetchone()
            changed = bytearray(record)
            self.assertEqual(changed[AT_REST], 1)
            changed[AT_REST] = 0
            log.execute("UPDATE safety SET record = ? WHERE number = ?", (changed, number))
            log.commit()
        code, checks = self.check(run)
        self.assertEqual(code, 1)
        broken = checks["safety-table"]
        self.assertEqual(broken["record"], number)
        self.assertAlmostEqual(broken["time_s"], time_s)
        self.assertIn("Stopping to Armed", broken["detail"])
        self.assertEqual({name for name, check in checks.items() if not check["passed"]},
                         {"safety-table", "digest"})  # the digest tells every change
        said = self.run_program("flexarm", "check", run)
        self.assertEqual(said.returncode, 1)
        self.assertIn(f"record {number}: Stopping to Armed", said.stdout)


if __name__ == "__main__":
    unittest.main()
