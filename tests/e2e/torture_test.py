#!/usr/bin/env python3
"""`flexarm torture`: sessions of the whole daemon under faults, and the same in shards."""

import json
import subprocess
import sys
import unittest

from program import BIN, HIL, ROOT, ProgramTest

SHARDS = ROOT / "tests/torture/shards.py"


class Torture(ProgramTest):
    def torture(self, *options):
        return self.flexarm_json("torture", "-c", HIL, *options)

    def test_sessions_break_no_rule_and_shards_make_the_whole(self):
        whole = self.torture("--seeds", "1..12")
        self.assertEqual(whole["scenarios"], 12)
        self.assertEqual(whole["failures"], [])
        parts = [self.torture("--seeds", "1..12", "--shard", f"{i}/3") for i in (1, 2, 3)]
        for key in ("scenarios", "without_fault", "observable", "tripped", "replayed_steps"):
            self.assertEqual(sum(part[key] for part in parts), whole[key], key)
        self.assertEqual(max(part["peak_strain_share"] for part in parts),
                         whole["peak_strain_share"])

    def test_results_do_not_depend_on_the_number_of_jobs(self):
        one, two = (self.torture("--seeds", "20..27", "--jobs", jobs) for jobs in ("1", "2"))
        self.assertEqual(one, two)

    def test_a_scenario_of_a_file_runs_alone(self):
        file = self.folder / "small.json"
        file.write_text('{"seed": 1}')
        refused = self.run_program("flexarm", "torture", "-c", HIL, "--scenario", file)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("small.json: wake_ups is missing; expected a scenario", refused.stderr)
        scenario = {"seed": 7, "law": "lqg", "payload_kg": 0.1, "plant": [], "move_to_deg": [30, -40], "move_s": 2.0,
                    "situation": "Running", "after_ms": 400, "faults": [
                        {"place": "counter", "index": 0, "kind": "off", "from_ms": 0, "to_ms": None, "seed": 1}],
                    "commands": [{"at_ms": 20, "line": {"command": "status"}}], "recovers": True,
                    "wake_ups": {"seed": 1, "latest_ms": 0.4, "latest_slow_ms": 3, "order_changes": 2}}
        file.write_text(json.dumps(scenario))
        told = self.torture("--scenario", file)
        self.assertEqual((told["scenarios"], told["failures"]), (1, []))
        self.assertEqual((told["laws"], told["causes"]), (["lqg"], {"no-counter-reading": 1}))

    def test_a_campaign_goes_on_where_it_stopped_and_is_of_one_build(self):
        lines = self.folder / "lines.jsonl"

        def shards(*options):
            return subprocess.run([sys.executable, SHARDS, lines, "--program", BIN / "flexarm",
                                   "--size", "6", *options], capture_output=True, text=True)

        self.assertEqual(shards("--shards", "1").returncode, 0)
        first = lines.read_text()
        self.assertEqual(json.loads(first)["scenarios"], 6)
        whole = shards("--shards", "2")
        self.assertEqual(whole.returncode, 0, whole.stderr)
        self.assertTrue(lines.read_text().startswith(first), "the first shard ran again")
        self.assertIn("12 sessions", whole.stdout)
        lines.write_text(first.replace('"build": "', '"build": "another '))
        refused = shards("--shards", "2")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("begin another file", refused.stderr)

    def test_every_shipped_arm_is_tortured_with_the_laws_that_it_allows(self):
        for config in sorted((ROOT / "config").glob("*.toml")):
            with self.subTest(config.name):
                run = self.run_program("flexarm", "torture", "-c", config, "--seeds", "1..10", "--json")
                self.assertEqual(run.returncode, 0, run.stderr + run.stdout)
                told = json.loads(run.stdout)
                self.assertEqual(told["failures"], [])
                self.assertGreater(told["peak_torque_share"], 0.0, "no arm moved")
                refused = "without gain-scheduled, which this config does not allow" in run.stderr
                self.assertEqual(refused, config.name == "quanser-2dsfl.toml")
                self.assertNotIn("does not suit", run.stderr)
                self.assertIn("sobel", told["laws"])

    def test_a_law_that_trips_without_a_fault_is_left_out_unless_it_is_asked_for(self):
        strict = ("--set", "estimator.innovation_limit_rad=0.004", "--set", "controller.name=pd")
        run = self.run_program("flexarm", "torture", "-c", HIL, *strict, "--seeds", "1..3", "--json")
        self.assertIn("without sobel, which does not suit this arm: estimator-residual", run.stderr)
        self.assertNotIn("sobel", json.loads(run.stdout)["laws"])
        self.assertIn("pd", json.loads(run.stdout)["laws"], "the config's own")
        run = self.run_program("flexarm", "torture", "-c", HIL, *strict, "--seeds", "1..3", "--json",
                               "--laws", "sobel")
        self.assertEqual(json.loads(run.stdout)["laws"], ["sobel"])

    def test_wrong_seeds_and_laws_are_refused(self):
        for options, text in ((("--seeds", "x"), "x"), (("--laws", "fastest"), "fastest")):
            self.assert_refused(self.run_program("flexarm", "torture", "-c", HIL, *options), text)


if __name__ == "__main__":
    unittest.main()
