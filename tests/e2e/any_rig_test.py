#!/usr/bin/env python3
"""simulate, benchmark, report and analyze on arms that have nothing to do with the thesis's."""

import csv
import re
import unittest

from program import ProgramTest

# One gauge a link, no encoders on the rotors, a narrow range of payloads, few degrees of rotation.
ONE_GAUGE = """
name = "one-gauge"
material = "steel"
link1 = {length_m = 0.8, width_mm = 40, thickness_mm = 4}
link2 = {length_m = 0.5, width_mm = 30, thickness_mm = 2.5}
joint1 = {torque_limit_nm = 20, encoder_counts_per_turn = 8192}
joint2 = {torque_limit_nm = 5, encoder_counts_per_turn = 8192}
elbow_mass_kg = 2.5
tip_mass_kg = 0.4
payload_min_kg = 0.2
payload_max_kg = 0.5
soft_angle_deg = 40
gauges_per_link = 1
rate_hz = 50
"""

# Three gauges a link, coarse encoders, a period that does not divide a second evenly, and no range
# of payloads: up to twice the tip's 0.4 kg.
FAST = """
name = "fast-arm"
material = "steel"
link1 = {length_m = 0.8, width_mm = 40, thickness_mm = 4}
link2 = {length_m = 0.5, width_mm = 30, thickness_mm = 2.5}
joint1 = {torque_limit_nm = 20, encoder_counts_per_turn = 2000}
joint2 = {torque_limit_nm = 5, encoder_counts_per_turn = 2000}
elbow_mass_kg = 2.5
tip_mass_kg = 0.4
gauges_per_link = 3
rate_hz = 125
"""


class AnyRig(ProgramTest):
    def rig(self, arm):
        (self.folder / "arm.toml").write_text(arm, encoding="utf-8")
        rig = self.folder / "rig.toml"
        self.flexarm("config", "new", "--from", self.folder / "arm.toml", "-o", rig)
        return rig

    def check(self, text, *said):
        """No statement about another arm and no NaN; all of `said`."""
        self.assertIsNone(re.search(r"(?<!sobel-)thesis", text, re.IGNORECASE), text)
        self.assertIsNone(re.search(r"\b-?nan\b|no finite number|\binf\b", text, re.IGNORECASE), text)
        for words in said:
            self.assertIn(words, text)

    def told(self, *arguments):
        """What the command prints, on both streams."""
        result = self.flexarm(*arguments)
        return result.stdout + result.stderr

    def benchmark(self, rig, table, *options):
        return self.told("benchmark", "-c", rig, "--table", table, "--seeds", 1, "-o",
                         self.folder / f"{table}.sqlite", *options)

    def test_one_gauge_a_link_and_a_narrow_range_of_payloads(self):
        rig = self.rig(ONE_GAUGE)
        self.check(self.told("simulate", "-c", rig), "completed                 yes",
                   "times as far")
        self.check(self.told("simulate", "-c", rig, "--controller", "sobel"), "times as far")
        self.check(self.benchmark(rig, "commands", "--laws", "sobel"), "payload-0.2",
                   "0.5 kg, 1.2 times the design's", "0.89 times as far")
        self.check(self.benchmark(rig, "moves", "--laws", "gain-scheduled"), "0.2 to 0.5 kg",
                   "receding-horizon | controller.name = receding-horizon: needs the table")
        folder = self.folder / "report"
        self.flexarm("report", "-c", rig, "-o", folder, "--laws", "gain-scheduled", "--runs", 1)
        page = (folder / "report.html").read_text(encoding="utf-8")
        self.check(re.sub(r"data:image/png;base64,[^\"]*", "", page), "one-gauge", "0.2 to 0.5 kg",
                   "within 14 mm", "Computed on ", "<h2>The arm</h2>", "<h2>Main result</h2>",
                   "<h2>Summary</h2>")
        self.assertLess(page.index("The arm</h2>"), page.index("Main result</h2>"))
        self.assertIn('name="viewport"', page)

    def test_a_period_that_is_no_divisor_and_no_range_of_payloads(self):
        rig = self.rig(FAST)
        (self.folder / "experiments").mkdir()  # without the default ones: the shipped ones serve
        self.check(self.told("simulate", "-c", rig), "completed                 yes")
        self.check(self.told("simulate", "-c", rig, "--controller", "sobel"),
                   "completed                 yes", "on samples of 8 ms")
        limits = self.benchmark(rig, "limits", "--laws", "gain-scheduled")
        self.check(limits, "| encoders-x10 |", "receding-horizon")
        refused = self.run_program("flexarm", "benchmark", "-c", rig, "--table", "moves", "--laws",
                                   "receding-horizon", "-o", self.folder / "x.sqlite")
        self.assert_refused(refused, "receding-horizon", "[controller.plan]")
        for verb in ("excite", "linearize", "torsion"):
            self.check(self.told("analyze", verb, "-c", rig))
        self.check(self.told("analyze", "reduce", "-c", rig, "--grid", "--grid-cells", 2))
        out = self.folder / "parametric"
        self.check(self.told("analyze", "parametric", "-c", rig, "-o", out), "payload, kg\n",
                   "  0.8 ")
        self.assertTrue((out / "payload_kg.png").exists())
        self.assertFalse((out / "statements.md").exists())
        with open(out / "parametric.csv", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        payloads = [float(row[1]) for row in rows if row[0] == "payload_kg"]
        self.assertEqual((payloads[0], payloads[-1]), (0.0, 0.8))
        self.assert_refused(self.run_program("flexarm", "analyze", "check", "-c", rig),
                            "link 1 has another cross section than the thesis's")


if __name__ == "__main__":
    unittest.main()
