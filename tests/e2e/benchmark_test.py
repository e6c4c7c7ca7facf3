#!/usr/bin/env python3
"""The benchmark's table, its shards, and what it refuses."""

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

    def test_a_law_that_does_not_exist_is_refused(self):
        self.assert_refused(
            self.run_program("flexarm", "benchmark", "-c", HIL, "--laws", "pid", "-o",
                             self.folder / "x.sqlite"), "controller.name")


if __name__ == "__main__":
    unittest.main()
