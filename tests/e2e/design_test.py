#!/usr/bin/env python3
"""Design of gains: checks, refusal, --force, and runs with the gains."""

import json
import sys
import unittest

from program import HIL, ProgramTest


class Design(ProgramTest):
    def design(self, *arguments, expect=0):
        gains = self.folder / "gains.json"
        return gains, self.flexarm_json("design", "-c", HIL, "-o", gains, *arguments, expect=expect)

    def test_shipped_gains_pass_are_written_and_give_the_same_run(self):
        gains, result = self.design()
        self.assertIs(result["sound"], True)
        self.assertTrue(all(check["passed"] for check in result["checks"]))
        self.assertEqual(len(result["robustness"]["cases"]), 54)
        self.assertGreater(result["robustness"]["gain_margin_up"], 1.4)
        self.assertGreater(result["robustness"]["delay_margin_ms"], 4)
        # Ranks and zeros by a program of its own, from the matrices of golden.json.
        features = result["features"]
        self.assertEqual(features["model_following"], {
            "satisfied": False, "continuous": {"rank_b": 2, "rank_b_a_am": 6, "rank_b_bm": 2},
            "discrete": {"rank_b": 2, "rank_b_a_am": 10, "rank_b_bm": 4}})
        self.assertEqual(features["poles_at_origin"], {"count": 4, "chains": 2})
        self.assertEqual(features["output_zeros_outside_unit_circle"], 5)
        self.assertAlmostEqual(features["output_zero_largest"], 2.33664707, delta=1e-5)
        designed, _ = self.simulate("designed.flexarm")
        read, _ = self.simulate("read.flexarm", "--set", f'controller.gains="{gains}"')
        self.assertIs(self.flexarm_json("diff", designed, read)["identical"], True)

    def test_gains_that_fail_the_robustness_analysis_are_written_only_with_force_and_marked(self):
        bad = ("--set", "controller.prediction=false")  # diverges with 0.01 kg
        gains, result = self.design(*bad, expect=1)
        self.assertIs(result["sound"], False)
        self.assertIsNone(result["gains"])
        self.assertFalse(gains.exists())
        for check in result["checks"]:
            self.assertEqual("explanation" in check, not check["passed"], check)
        radius = next(c for c in result["checks"] if c["name"] == "robustness-spectral-radius")
        self.assertIn("controller.prediction = true", radius["explanation"])
        printed = self.flexarm("design", "-c", HIL, "-o", gains, *bad, expect=1).stdout
        self.assertIn("\nrobustness-spectral-radius = 1.", printed)
        self.assertIn("some arm within controller.payload_range_kg", " ".join(printed.split()))
        told = self.flexarm("design", "-c", HIL, "-o", gains, *bad, expect=1).stderr
        for text in ("robustness-spectral-radius", "unstable with", "--force"):
            self.assertIn(text, told)
        gains, result = self.design(*bad, "--force")
        self.assertEqual(result["gains"], str(gains))
        waived = [check["name"] for check in json.loads(gains.read_text())["checks"]
                  if check["waived"]]
        self.assertIn("robustness-spectral-radius", waived)

    def test_bad_options_are_refused(self):
        nowhere = self.folder / "nowhere" / "gains.json"
        gains = self.folder / "gains.json"
        for options, said in ((("-o", gains, "--payload-kg", -1), "--payload-kg"),
                              (("-o", gains, "--payload-kg"), "--payload-kg"),
                              (("-o", nowhere), str(nowhere))):
            with self.subTest(options=options):
                self.assert_refused(self.run_program("flexarm", "design", "-c", HIL, *options), said)


if __name__ == "__main__":
    sys.exit(unittest.main())
