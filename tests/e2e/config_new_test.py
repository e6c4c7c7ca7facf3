#!/usr/bin/env python3
"""A config for another arm, by the commands of docs/own-arm.md."""

import json
import re
import unittest

from program import HIL, ROOT, ProgramTest


def described_arm():
    """The arm that docs/own-arm.md describes."""
    page = (ROOT / "docs/own-arm.md").read_text(encoding="utf-8")
    return re.search(r"<<'END'\n(.*?)END\n", page, re.S).group(1)


class ConfigNew(ProgramTest):
    def setUp(self):
        super().setUp()
        self.arm = self.folder / "arm.toml"
        self.arm.write_text(described_arm(), encoding="utf-8")
        self.rig = self.folder / "rig.toml"

    def test_writes_a_rig_that_is_sound_and_runs(self):
        told = json.loads(self.flexarm("config", "new", "--from", self.arm, "-o", self.rig,
                                       "--json").stdout)
        self.assertTrue(told["passed"])
        self.assertLessEqual(told["largest_error_mm"], told["permitted_error_mm"])
        design = json.loads(self.flexarm("design", "-c", self.rig, "-o", self.folder / "gains.json",
                                         "--json").stdout)
        self.assertTrue(design["sound"])
        run = json.loads(self.flexarm("simulate", "-c", self.rig, "--json").stdout)
        self.assertTrue(run["completed"])
        self.assertEqual(len(run["move_duration_s"]), 4, "the default of a law that follows moves")
        first = self.folder / "first-motion.toml"
        self.assertEqual(told["first_motion"], str(first))
        for payload_kg in ("0", "0.3"):
            for reduced in ("true", "false"):
                run = json.loads(self.flexarm("simulate", "-c", self.rig, "--experiment", first,
                                              "--payload-kg", payload_kg, "--set",
                                              f"safety.reduced={reduced}", "--json").stdout)
                self.assertTrue(run["completed"], (payload_kg, reduced))

    def test_a_removed_line_follows_the_arm(self):
        self.flexarm("config", "new", "--from", self.arm, "-o", self.rig)
        text = self.rig.read_text(encoding="utf-8")
        shorter, removed = re.subn(r"(?m)^slew_limit_nm_per_s = .*\n", "", text)
        self.assertEqual(removed, 1)
        self.rig.write_text(shorter.replace("[10.0, 3.0]", "[20.0, 3.0]"), encoding="utf-8")
        shown = json.loads(self.flexarm("config", "show", self.rig, "--only", "limits.slew",
                                        "--json").stdout)
        value, = shown["values"]
        self.assertEqual(value["value"], "[400.0, 60.0]")
        self.assertTrue(value["derived"])
        self.assertIn("two and a half periods", value["origin"])

    def test_names_what_is_missing_and_writes_nothing(self):
        self.arm.write_text(described_arm().replace("tip_mass_kg = 0.3\n", ""), encoding="utf-8")
        refused = self.flexarm("config", "new", "--from", self.arm, "-o", self.rig, expect=2)
        self.assertIn("tip_mass_kg: missing", refused.stderr)
        self.assertFalse(self.rig.exists())

    def test_an_option_replaces_the_value_of_the_file(self):
        self.flexarm("config", "new", "--from", self.arm, "--tip_mass_kg", "0.25", "--name", "other",
                     "-o", self.rig)
        text = self.rig.read_text(encoding="utf-8")
        self.assertIn("payload_mass_kg = 0.25  # given", text)
        self.assertIn('name = "other"', text)

    def test_does_not_replace_a_file_unasked(self):
        self.rig.write_text("mine = 1\n", encoding="utf-8")
        self.flexarm("config", "new", "--from", self.arm, "-o", self.rig, expect=2)
        self.assertEqual(self.rig.read_text(encoding="utf-8"), "mine = 1\n")


class DesignTune(ProgramTest):
    def test_prints_the_lines_that_make_a_design_sound(self):
        noisy = "estimator.process_force=[3, 0.5, 500, 500, 150, 150]"
        told = json.loads(self.flexarm("design", "-c", HIL, "--set", noisy, "--tune",
                                       "--json").stdout)
        self.assertEqual(told["before"]["verdict"], "rejected")
        self.assertEqual(told["after"]["verdict"], "sound")
        changes = [option for change in told["changed"]
                   for option in ("--set", f"{change['key']}={change['after']}")]
        self.flexarm("design", "-c", HIL, "--set", noisy, *changes, "-o", self.folder / "gains.json")

    def test_needs_an_output_or_tune(self):
        refused = self.flexarm("design", "-c", HIL, expect=2)
        self.assertIn("--tune", refused.stderr)


if __name__ == "__main__":
    unittest.main()
