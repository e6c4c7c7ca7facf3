#!/usr/bin/env python3
"""`flexarm identify` on a config that `flexarm config new` wrote."""

import json
import re
import unittest

from config_new_test import described_arm
from program import ProgramTest

# What the arm has, in place of what the config assumes.
TRUTH = {"joint1.coulomb_friction_nm": 0.09, "joint2.coulomb_friction_nm": 0.03,
         "link1.damping_ratio": 0.03, "link2.section[0].youngs_modulus_pa": 1.8e11}


class IdentifyNewRig(ProgramTest):
    made = None  # rig and measured run, made once: the search for a rig takes seconds

    def setUp(self):
        super().setUp()
        self.rig, self.measured = self.folder / "rig.toml", self.folder / "measured.flexarm"
        if IdentifyNewRig.made is None:
            self.make()
            IdentifyNewRig.made = (self.rig.read_bytes(), self.measured.read_bytes())
        for file, content in zip((self.rig, self.measured), IdentifyNewRig.made):
            file.write_bytes(content)

    def make(self):
        arm = self.folder / "arm.toml"
        arm.write_text(described_arm(), encoding="utf-8")
        self.flexarm("config", "new", "--from", arm, "-o", self.rig)
        changes = [option for key, value in TRUTH.items() for option in ("--set", f"{key}={value}")]
        self.flexarm("simulate", "-c", self.rig, *changes, "-o", self.measured)

    def identify(self, *options):
        free = [option for key in TRUTH for option in ("--free", key)]
        return self.flexarm("identify", "-c", self.rig, "--run", self.measured, *free, *options)

    def test_prints_the_lines_that_make_the_config_that_of_the_arm(self):
        found = json.loads(self.identify("--json").stdout)
        changed = {line["key"]: line for line in found["changed"]}
        text = self.rig.read_text(encoding="utf-8").splitlines()
        for key, value in TRUTH.items():
            line = changed[key]
            self.assertAlmostEqual(float(line["after"]) / value, 1, delta=0.1, msg=key)
            self.assertEqual(line["file"], str(self.rig))
            name = key.rpartition(".")[2]
            self.assertEqual(text[line["line"] - 1].split("  #")[0], f"{name} = {line['before']}")
            self.assertIn("identified, +- ", line["how"])
        following = [line for line in found["changed"] if line["how"].startswith("derived: ")]
        self.assertIn("estimator.payload.friction_start_sigma_nm", [l["key"] for l in following])
        self.assertNotIn("controller.alpha", changed, "it was tuned")

        # As a user pastes them: each printed line in place of its old one.
        printed = self.identify().stdout
        pasted = list(text)
        pairs = [(int(number), new) for _, number, new in
                 re.findall(r"^(.*):(\d+): \[.*\n(.*)$", printed, re.M)]
        self.assertEqual(len(pairs), len(changed))
        for number, new in pairs:
            self.assertEqual(new.split(" = ")[0], pasted[number - 1].split(" = ")[0])
            self.assertIn("; was ", new)
            pasted[number - 1] = new
        self.rig.write_text("\n".join(pasted) + "\n", encoding="utf-8")
        shown = {value["key"]: value["value"]
                 for value in json.loads(self.flexarm("config", "show", self.rig,
                                                      "--json").stdout)["values"]}
        for key, line in changed.items():
            self.assertEqual(shown[key], line["after"])
        self.flexarm("design", "-c", self.rig, "-o", self.folder / "gains.json")
        again = json.loads(self.identify("--json").stdout)
        self.assertLess(again["start_misfit"], 0.1 * found["start_misfit"])

    def test_a_line_that_the_file_leaves_out_follows_by_itself(self):
        text = self.rig.read_text(encoding="utf-8")
        shorter, removed = re.subn(r"(?m)^friction_start_sigma_nm = .*\n", "", text)
        self.assertEqual(removed, 1)
        self.rig.write_text(shorter, encoding="utf-8")
        keys = [line["key"] for line in json.loads(self.identify("--json").stdout)["changed"]]
        self.assertIn("joint1.coulomb_friction_nm", keys)
        self.assertNotIn("estimator.payload.friction_start_sigma_nm", keys)

    def test_the_config_of_the_log_has_no_place(self):
        told = self.flexarm("identify", "--run", self.measured, "--free",
                            "joint1.coulomb_friction_nm").stdout
        self.assertRegex(told, r"lines to change:\n\[joint1\]\ncoulomb_friction_nm = \S+  # "
                               r"identified, \+- \S+; was 0\.09\n")


if __name__ == "__main__":
    unittest.main()
