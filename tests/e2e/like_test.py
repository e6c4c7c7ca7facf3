#!/usr/bin/env python3
"""`flexarm simulate --like RUN`: the same run with another law."""

import contextlib
import shutil
import sqlite3
import unittest

from program import HIL, ROOT, ProgramTest, rows, ticks

WAYPOINTS = ROOT / "config/experiments/waypoints.toml"


def setting(run, key):
    (value,), = rows(run, f"SELECT value FROM run WHERE key = '{key}'")
    return value


class Like(ProgramTest):
    def setUp(self):
        super().setUp()
        self.original, self.told = self.simulate("first.flexarm", "--payload-kg", 0.2, "--seed", 5,
                                                 "--set", "sim.transport_delay_ms=3",
                                                 experiment=WAYPOINTS)

    def test_without_other_options_it_is_the_same_run_to_the_bit(self):
        again = self.folder / "again.flexarm"
        told = self.flexarm_json("simulate", "--like", self.original, "-o", again)
        self.assertEqual(ticks(again), ticks(self.original))
        self.assertEqual(told["tip_target_error_mm"], self.told["tip_target_error_mm"])

    def test_another_law_has_the_same_rig_experiment_payload_and_seed(self):
        other = self.folder / "other.flexarm"
        told = self.flexarm_json("simulate", "--like", self.original, "--controller",
                                 "gain-scheduled", "-o", other)
        self.assertTrue(told["completed"])
        info, first = (self.flexarm_json("info", run) for run in (other, self.original))
        self.assertEqual(info["law"], "gain-scheduled")
        for key in ("rig", "experiment", "payload_kg", "seed"):
            self.assertEqual(info[key], first[key], key)
        self.assertEqual(setting(other, "config").replace("gain-scheduled", "sobel"),
                         setting(self.original, "config"))
        own = self.folder / "own.flexarm"
        self.flexarm("simulate", "-c", HIL, "--experiment", WAYPOINTS, "--payload-kg", 0.2,
                     "--seed", 5, "--set", "sim.transport_delay_ms=3", "--controller",
                     "gain-scheduled", "-o", own)
        self.assertEqual(ticks(other), ticks(own))

    def test_draws_both_runs_in_one_picture(self):
        picture, page = self.folder / "both.svg", self.folder / "both.html"
        told = self.flexarm("simulate", "--like", self.original, "--controller", "lqr-cgt",
                            "--plot", picture)
        self.assertIn("both.svg", told.stderr)
        text = picture.read_text(encoding="utf-8")
        self.assertIn("first", text)
        self.assertIn("lqr-cgt", text)
        self.flexarm("simulate", "--like", self.original, "--controller", "lqr-cgt", "-o",
                     self.folder / "kept.flexarm", "--plot", page)
        text = page.read_text(encoding="utf-8")
        self.assertIn("first.flexarm", text)
        self.assertIn("kept.flexarm", text)

    def test_last_is_the_newest_run_of_the_folder(self):
        runs = self.folder / "runs"
        runs.mkdir()
        shutil.copy(self.original, runs / "only.flexarm")
        told = self.flexarm_json("simulate", "--last", "--controller", "pd")
        self.assertTrue(told["completed"])
        other = self.flexarm_json("simulate", "--last", "--folder", runs, "--controller", "pd")
        self.assertEqual({**told, "realtime_factor": 0}, {**other, "realtime_factor": 0})

    def test_what_the_run_has_already_is_refused(self):
        for options in (("-c", HIL), ("--experiment", WAYPOINTS)):
            self.assert_refused(self.run_program("flexarm", "simulate", "--like", self.original,
                                                 *options), "--like", "excludes")
        self.assert_refused(self.run_program("flexarm", "simulate", "--like", "none.flexarm"),
                            "none.flexarm")
        self.assert_refused(self.run_program("flexarm", "simulate"), "--config, or --like RUN")
        self.assert_refused(self.run_program("flexarm", "simulate", "--like", self.original,
                                             "--plot", self.folder / "x.pdf"), ".pdf")
        self.assert_refused(self.run_program("flexarm", "simulate", "--like", self.original,
                                             "--set", "nonsense.key=1"), "nonsense")

    def test_the_run_of_a_rig_needs_its_payload(self):
        rig = self.folder / "rig.flexarm"
        self.flexarm("simulate", "--like", self.original, "--controller", "gain-scheduled", "-o",
                     rig)
        with contextlib.closing(sqlite3.connect(rig)) as log, log:
            log.execute("UPDATE run SET value = 'wired' WHERE key = 'backend'")
            log.execute("DELETE FROM run WHERE key = 'payload_kg'")
        self.assert_refused(self.run_program("flexarm", "simulate", "--like", rig),
                            "rig.flexarm: the run of a rig, whose payload is not known (0.",
                            "by its own estimate): give it with --payload-kg")
        told = self.flexarm_json("simulate", "--like", rig, "--payload-kg", 0.2)
        self.assertTrue(told["completed"])


if __name__ == "__main__":
    unittest.main()
