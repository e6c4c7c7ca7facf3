#!/usr/bin/env python3
"""`flexarm bench-host`: every row is measured or says why not. No time is judged."""

import json
import unittest

from program import ProgramTest

ROWS = ["step-sobel", "step-receding-horizon", "plan", "right-hand-side", "integrator-step",
        "experiment", "plant-cvode", "plant-ode45", "replay", "export", "sweep-two-cores",
        "wake-up", "wake-up-under-load"]
NUMBERS = ("median_s", "lower_quartile_s", "upper_quartile_s", "repetitions")
# Rows that need nothing but the product. The others need programs or permissions of the machine.
ALWAYS = {"step-sobel", "step-receding-horizon", "plan", "right-hand-side", "integrator-step",
          "experiment", "replay", "export"}


class BenchHost(ProgramTest):
    def test_quick_measures_every_row_or_says_why_not(self):
        page = self.folder / "performance.md"
        answer = self.run_program("flexarm", "bench-host", "--quick", "--json", "-o", page)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        table = json.loads(answer.stdout)
        self.assertEqual([row["name"] for row in table["rows"]], ROWS)
        self.assertTrue(table["quick"])
        for row in table["rows"]:
            with self.subTest(row=row["name"]):
                if row["not_measured"] is None:
                    self.assertTrue(all(row[key] > 0 for key in NUMBERS), row)
                    self.assertLessEqual(row["lower_quartile_s"], row["upper_quartile_s"])
                    if row["name"].startswith("wake-up"):
                        self.assertRegex(row["result"], r"percentile.*; cyclictest.*percentile")
                else:
                    self.assertNotIn(row["name"], ALWAYS, row["not_measured"])
                    self.assertIsNone(row["median_s"])
                    self.assertGreater(len(row["not_measured"]), 20)
        self.check_counts({row["name"]: row for row in table["rows"]}, table["bounds"])
        text = page.read_text(encoding="utf-8")
        self.assertTrue(text.startswith("<!-- flexarm bench-host -->"))
        for row in table["rows"]:
            self.assertIn(f"| {row['what']} |", text)

    def check_counts(self, row, bounds):
        """Counts are exact, and no code is faster than the bound."""
        bound = max(bound["flops_per_s"] for bound in bounds)
        for name in ("step-sobel", "right-hand-side", "integrator-step"):
            if row[name]["flops"] is None:  # no permission, or another processor
                self.assertIn("not counted: ", row[name]["counted"])
                continue
            self.assertGreater(row[name]["flops"], 100, name)
            self.assertLess(row[name]["flops_per_s"], bound, name)
        # A step of the integrator evaluates the equations twice or more; a part of it once.
        if row["integrator-step"]["flops"] is not None:
            self.assertGreater(row["integrator-step"]["flops"], row["right-hand-side"]["flops"])
        self.assertIn("bit-exact", row["replay"]["result"])

    def test_another_file_is_not_overwritten_and_nothing_is_measured_before(self):
        page = self.folder / "mine.md"
        page.write_text("my notes\n", encoding="utf-8")
        self.assert_refused(self.run_program("flexarm", "bench-host", "-o", page), "mine.md")
        self.assertEqual(page.read_text(encoding="utf-8"), "my notes\n")

    def test_set_changes_the_shipped_config(self):
        self.assert_refused(
            self.run_program("flexarm", "bench-host", "--quick", "--set", "sim.plant_modes=7"),
            "sim.plant_modes")


if __name__ == "__main__":
    unittest.main()
