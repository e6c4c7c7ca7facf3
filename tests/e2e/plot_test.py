#!/usr/bin/env python3
"""Pictures and pages of runs."""

import csv
import html.parser
import json
import math
import re
import shlex
import shutil
import subprocess
import unittest
from pathlib import Path

from program import HIL, ProgramTest

VOID = {"meta", "input", "br", "img", "link"}
# Column of the page: column of the decoded export, factor.
SAME = {"torque_asked_1_nm": ("torque_asked_1_nm", 1), "torque_asked_2_nm": ("torque_asked_2_nm", 1),
        "torque_applied_1_nm": ("torque_applied_1_nm", 1), "payload_kg": ("payload_kg", 1),
        "payload_sigma_kg": ("payload_sigma_kg", 1),
        "angle_1_deg": ("truth_hub_1_rad", 180 / math.pi),
        "angle_2_deg": ("truth_hub_2_rad", 180 / math.pi),
        "deflection_2_mm": ("truth_deflection_2_m", 1000)}
LONG = """name = "long"
duration_s = 100.0
[[move]]
start_s = 50.0
duration_s = 2.0
to_deg = [20.0, 20.0]
"""


class Parsed(html.parser.HTMLParser):
    """Reads a page, and fails where an element is not closed or loads something."""

    def __init__(self, page):
        super().__init__()
        self.open = []
        self.feed(page)
        self.close()
        if self.open:
            raise AssertionError(f"not closed: {self.open}")

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("src", "href", "srcset"):
                raise AssertionError(f"{tag} loads {value}")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        last = self.open.pop()
        if last != tag:
            raise AssertionError(f"</{tag}> closes <{last}>")


class Plot(ProgramTest):
    def page_of(self, *runs):
        file = self.folder / "page.html"
        self.flexarm("plot", *runs, "--html", file)
        text = file.read_text(encoding="utf-8")
        Parsed(text)
        self.assertNotIn("http", text)
        data = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)
        return file, json.loads(data.group(1))["runs"]

    def exported(self, run):
        table = self.folder / "run.csv"
        self.flexarm("export", run, "--decoded", "-o", table)
        with open(table, encoding="utf-8", newline="") as file:
            names, _, *values = csv.reader(file)
        return [dict(zip(names, row, strict=True)) for row in values]

    def long_run(self):
        experiment = self.folder / "long.toml"
        experiment.write_text(LONG, encoding="utf-8")
        run = self.folder / "long.flexarm"
        self.flexarm("simulate", "-c", HIL, "--experiment", experiment, "-o", run)
        return run

    def test_a_page_has_the_values_of_the_export(self):
        run, _ = self.simulate("run.flexarm")
        _, (shown,) = self.page_of(run)
        exported = self.exported(run)
        self.assertEqual(shown["samples"], len(exported))
        for name, (column, factor) in SAME.items():
            values = shown["columns"][name]
            self.assertEqual(len(values), len(exported), name)
            for here, row in zip(values, exported):
                there = factor * float(row[column])
                if math.isnan(there):
                    self.assertIsNone(here, name)
                else:
                    self.assertAlmostEqual(here, there, delta=1e-6 * max(1, abs(there)), msg=name)
        running = [row["state"] == "Running" for row in exported]
        self.assertEqual([value is not None for value in shown["columns"]["reference_1_deg"]], running)

    def test_a_page_of_a_long_run_is_bounded_and_loses_no_peak(self):
        run = self.long_run()
        file, (shown,) = self.page_of(run)
        exported = self.exported(run)
        self.assertGreater(shown["samples"], 4000)
        self.assertEqual(len(shown["columns"]["time_s"]), 4000)
        self.assertLessEqual(len(shown["poses"]["mm"]), 600)
        self.assertLess(file.stat().st_size, 2_000_000)
        for name in ("torque_applied_1_nm", "angle_2_deg"):
            column, factor = SAME[name]
            there = [factor * float(row[column]) for row in exported]
            for extreme in (min, max):
                self.assertAlmostEqual(extreme(shown["columns"][name]), extreme(there), delta=1e-5)

    def test_the_command_on_the_page_replays_the_run(self):
        run, _ = self.simulate("run.flexarm")
        _, (shown,) = self.page_of(run)
        program, *arguments = shlex.split(shown["command"])
        self.assertEqual(program, "flexarm")
        self.flexarm(*arguments)

    @unittest.skipUnless(shutil.which("node"), "no node")
    def test_the_script_draws_two_runs_and_obeys_the_user(self):
        first, _ = self.simulate("run.flexarm")
        second, _ = self.simulate("other.flexarm", "--controller", "pd")
        file, _ = self.page_of(first, second)
        world = Path(__file__).parent / "page_world.js"
        result = subprocess.run(["node", world, file], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        drawn = json.loads(result.stdout)
        self.assertGreater(drawn["points"], 10_000)
        self.assertEqual(drawn["invalid"], 0, "a coordinate that is no number")
        self.assertRegex(drawn["pointed"], r"Joint 1, deg\n-?[\d.]+\n")
        self.assertIn("pd on thesis-rig", drawn["runs"])
        self.assertIn("Figures of run 2", drawn["figures"])
        self.assertNotEqual(drawn["now"], "0.00 s")

    def test_a_page_of_flexarm_is_replaced_and_no_other_file(self):
        run, _ = self.simulate("run.flexarm")
        self.page_of(run)
        self.page_of(run)
        other = self.folder / "mine.html"
        other.write_text("<p>mine</p>", encoding="utf-8")
        self.flexarm("plot", run, "--html", other, expect=2)
        self.assertEqual(other.read_text(encoding="utf-8"), "<p>mine</p>")

    def test_without_a_file_to_write_it_says_what_is_expected(self):
        run, _ = self.simulate("run.flexarm")
        result = self.run_program("flexarm", "plot", run)
        self.assertEqual(result.returncode, 2)
        self.assertIn("--html FILE.html", result.stderr)

    def test_a_long_run_is_drawn(self):
        picture = self.folder / "long.svg"
        self.flexarm("plot", self.long_run(), "-o", picture)
        text = picture.read_text(encoding="utf-8")
        self.assertIn("long, sobel on thesis-rig", text)
        self.assertNotRegex(text, r"\bnan\b")


if __name__ == "__main__":
    unittest.main()
