#!/usr/bin/env python3
"""The benchmark's table, its shards, and its refusals."""

import unittest

from program import HIL, ProgramTest

LAWS = ("-c", HIL, "--laws", "sobel,pd", "--seeds", "1")


class Benchmark(ProgramTest):
    def test_shards_merge_to_the_whole_and_the_table_is_the_same(self):
        whole = self.flexarm_json("benchmark", *LAWS, "-o", self.folder / "whole.sqlite")
        parts = [self.folder / f"part-{i}.sqlite" for i in (1, 2)]
        for i, part in enumerate(parts, 1):
            shard = self.flexarm_json("benchmark", *LAWS, "--shard", f"{i}/2", "-o", part)
            self.assertGreater(shard["missing"], 0)
        merged = self.folder / "merged.sqlite"
        self.flexarm_json("sweep", "merge", *parts, "-o", merged)
        page = self.folder / "page.md"
        again = self.flexarm_json("benchmark", *LAWS, "-o", merged, "--page", page)
        self.assertEqual(again["missing"], 0)
        self.assertEqual(again["laws"], whole["laws"])
        text = page.read_text()
        sobel, pd = whole["laws"]
        self.assertEqual((sobel["name"], pd["name"]), ("sobel", "pd"))
        self.assertGreater(sobel["score"], pd["score"])
        for law in (sobel, pd):
            self.assertEqual(law["runs"], len(law["scenarios"]))
            self.assertIn(f"| {law['name']} | {law['score']:.1f} |", text)
        for name in sobel["scenarios"]:
            self.assertIn(f"| {name} |", text)

    def test_moves_continue_after_an_interruption_and_ideal_limits_reduce_the_motion(self):
        moves = ("-c", HIL, "--table", "limits", "--seeds", "4001")
        results = self.folder / "limits.sqlite"
        half = self.flexarm_json("benchmark", *moves, "--shard", "1/2", "-o", results)
        self.assertEqual(half["table"], "limits")
        self.assertGreater(half["missing"], 0)
        page = self.folder / "page.md"
        whole = self.flexarm_json("benchmark", *moves, "-o", results, "--page", page)
        self.assertEqual(whole["missing"], 0)
        law = next(law for law in whole["laws"] if law["name"] == "gain-scheduled")
        as_it_is, ideal = law["scenarios"]["nominal"], law["scenarios"]["all"]
        self.assertEqual((as_it_is["completed"], as_it_is["settled_in_time"]), (1, 1))
        self.assertLessEqual(as_it_is["latest_settling_s"], 0.3)
        self.assertLess(ideal["motion_mean_mm"], as_it_is["motion_mean_mm"])
        self.assertEqual(as_it_is["motion_mean_mm"], as_it_is["motion_max_mm"])  # of one run
        for name in law["scenarios"]:
            self.assertIn(f"| {name} |", page.read_text())
        self.assert_refused(
            self.run_program("flexarm", "benchmark", "-c", HIL, "--table", "pictures", "-o",
                             self.folder / "x.sqlite"), "commands, moves, limits, fast")
        self.assert_refused(
            self.run_program("flexarm", "benchmark", "-c", HIL, "-o", results), "another sweep")

    def test_a_law_that_does_not_exist_is_refused(self):
        self.assert_refused(
            self.run_program("flexarm", "benchmark", "-c", HIL, "--laws", "pid", "-o",
                             self.folder / "x.sqlite"), "controller.name")


if __name__ == "__main__":
    unittest.main()
