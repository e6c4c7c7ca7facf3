#!/usr/bin/env python3
"""Names, notes and tags of runs, the list of a folder, and logs of every kind in every verb."""

import json
import shutil
import time
import unittest

from program import HIL, SQUARE, ProgramTest, doublet, in_real_time
from run_log_test import SMALL, DaemonRuns


class Runs(ProgramTest):
    def listed(self, *options):
        return self.flexarm_json("runs", "--folder", self.folder, *options)["runs"]

    def simulated(self, name, *options):
        run = self.folder / f"{name}.flexarm"
        self.flexarm("simulate", "-c", HIL, "--experiment", self.short, *options, "-o", run)
        return run

    def setUp(self):
        super().setUp()
        self.short = self.experiment(doublet("short", 1.5))

    def test_a_run_is_found_by_what_it_was_called_and_by_how_it_ended(self):
        self.simulated("first", "--name", "New gauge", "--note", "glued on", "--tag", "bench",
                       "--tag", "gauge-7", "--payload-kg", "0.05")
        self.simulated("second", "--controller", "pd", "--tag", "bench")
        found, = self.listed("--text", "new GAUGE")
        self.assertEqual(found["name"], "New gauge")
        self.assertEqual(found["note"], "glued on")
        self.assertEqual(found["tags"], ["bench", "gauge-7"])
        self.assertEqual(found["law"], "sobel")
        self.assertEqual(found["payload_kg"], 0.05)
        self.assertEqual(found["experiment"], "short")
        self.assertEqual((found["ended"], found["trip"]), ("complete", None))
        self.assertGreater(found["duration_s"], 1.5)
        self.assertEqual(len(self.listed("--tag", "bench")), 2)
        self.assertEqual(len(self.listed("--tag", "bench", "--tag", "gauge-7")), 1)
        self.assertEqual([run["law"] for run in self.listed("--law", "pd")], ["pd"])
        self.assertEqual(self.listed("--trip", "any"), [])
        self.assertEqual(len(self.listed("--last")), 1)
        self.assertEqual(len(self.listed("--last", "2")), 2)
        text = self.flexarm("runs", "--folder", self.folder).stdout
        self.assertIn("New gauge #bench #gauge-7", text)
        self.assertEqual(len(text.splitlines()), 2)

    def test_a_run_is_tagged_afterwards_and_replays_as_before(self):
        run = self.simulated("run", "--name", "n")
        before = run.read_bytes()
        self.flexarm("runs", "tag", run, "good", "keep")
        self.flexarm("runs", "untag", run, "keep")
        self.flexarm("runs", "note", run, "gauge 7 was loose")
        self.assertEqual(run.read_bytes(), before)
        self.assertIs(self.flexarm_json("replay", run)["bit_exact"], True)
        info = self.flexarm_json("info", run)
        self.assertEqual((info["name"], info["note"], info["tags"]),
                         ("n", "gauge 7 was loose", ["good"]))
        refused = self.run_program("flexarm", "runs", "tag", run, "two\nlines")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("a tag contains a control character", refused.stderr)

    def test_files_that_are_no_logs_are_listed_as_such(self):
        self.simulated("run")
        (self.folder / "notes.flexarm").write_text("a text", encoding="utf-8")
        (self.folder / "empty.flexarm").write_bytes(b"")
        (self.folder / "folder.flexarm").mkdir()
        runs = self.listed()
        self.assertEqual(len(runs), 4)
        self.assertIsNone(runs[0]["problem"])
        self.assertTrue(all(run["problem"] for run in runs[1:]))
        self.assertIn("unreadable", self.flexarm("runs", "--folder", self.folder).stdout)
        missing = self.run_program("flexarm", "runs", "--folder", self.folder / "none")
        self.assertEqual(missing.returncode, 2)
        self.assertIn("--folder", missing.stderr)

    def test_the_newest_run_is_taken_by_last(self):
        runs = self.folder / "runs"
        runs.mkdir()
        older = self.simulated("older")
        shutil.move(older, runs)
        last = ("--last", "--folder", runs)
        self.assertEqual(self.flexarm_json("info", *last)["run"], str(runs / "older.flexarm"))
        self.assertIs(self.flexarm_json("replay", *last)["bit_exact"], True)
        self.flexarm("export", *last, "-o", self.folder / "last.csv")
        self.flexarm("plot", *last, "-o", self.folder / "last.png")
        neither = self.run_program("flexarm", "info")
        self.assertEqual(neither.returncode, 2)
        self.assertIn("--last", neither.stderr)

    def test_a_label_that_is_none_is_refused_before_the_simulation(self):
        result = self.run_program("flexarm", "simulate", "-c", HIL, "--experiment", SQUARE, "--name",
                                  "x" * 81, "-o", self.folder / "run.flexarm")
        self.assertEqual(result.returncode, 2)
        self.assertIn("the name is longer than 80 bytes", result.stderr)


class RunsOfTheDaemon(DaemonRuns):
    """Logs that begin with pluck or home, and of runs that were stopped, in every verb."""

    @in_real_time
    def test_every_verb_reads_the_log_of_a_pluck_a_home_and_a_stopped_run(self):
        self.start_daemon(*SMALL, "--set", "commissioning.home_travel_deg=3")
        self.arm()
        self.operate("pluck")
        self.wait_for_state("Armed")
        self.operate("home", "1", "low", expect=1)  # no switch within the travel
        self.wait_for_state("Armed")
        self.operate("run", self.experiment(doublet("long", 20.0, 5.0)), "--name", "stopped early",
                     "--note", "a note", "--tag", "bench")
        self.wait_for_state("Running")
        time.sleep(2.5)  # past the move
        self.operate("stop")
        self.wait_for_state("Armed")
        self.operate("disarm")
        self.wait_for_state("Idle")
        runs = self.wait_for_closed_runs(3)
        ends = {}
        for number, run in enumerate(runs):
            with self.subTest(run.name):
                info = self.flexarm_json("info", run)
                ends[info["experiment"]] = info
                self.flexarm("info", run)
                self.assertIs(self.flexarm_json("replay", run)["bit_exact"], True)
                self.assertIs(self.flexarm_json("check", run)["passed"], True)
                for picture in ("png", "svg"):
                    self.flexarm("plot", run, "-o", self.folder / f"{number}.{picture}")
                self.flexarm("export", run, "-o", self.folder / f"{number}.csv")
                self.flexarm("export", run, "--decoded", "-o", self.folder / f"{number}-d.csv")
                self.assertIs(self.flexarm_json("diff", run, run)["identical"], True)
        self.flexarm("plot", *runs, "-o", self.folder / "all.png")
        self.assertEqual(set(ends), {"pluck", "home", "long"})
        self.assertIsNone(ends["pluck"]["metrics"], "it has no experiment")
        stopped = ends["long"]
        self.assertEqual((stopped["name"], stopped["note"], stopped["tags"]),
                         ("stopped early", "a note", ["bench"]))
        self.assertIs(stopped["result"]["stopped"], True)
        self.assertLess(stopped["metrics"]["ticks"], 300, "20 s were 1000")
        listed = json.loads(self.flexarm("runs", "--folder", self.folder / "runs", "--json").stdout)
        self.assertEqual({run["experiment"]: run["ended"] for run in listed["runs"]},
                         {"pluck": "complete", "home": "complete", "long": "stopped"})


if __name__ == "__main__":
    unittest.main()
