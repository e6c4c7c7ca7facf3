#!/usr/bin/env python3
"""Pages that the programs write of themselves, and what a user may ask them: keys, trips and
refusals."""

import json
import re
import unittest

from program import ROOT, ProgramTest

CONFIG_PAGE = ROOT / "docs/config-reference.md"
TRIPS_PAGE = ROOT / "docs/trips.md"
# Where a name of a refusal stands in the code.
NAMED = re.compile(r'(?:"refusal", |\.refusal = |NamedRejection\(\s*|Refused\(\s*|Dismiss\(\s*)'
                   r'"([a-z-]+)"')
OF_THE_SAFETY_TASK = re.compile(r'case Refusal::k\w+:\s+return "([a-z-]+)";')


class Pages(ProgramTest):
    maxDiff = None

    def compare(self, page, written, command):
        self.assertTrue(page.read_text(encoding="utf-8") == written,
                        f"{page.relative_to(ROOT)} is not what the program writes. Write it again: "
                        f"build/release/bin/{command} > {page.relative_to(ROOT)}")

    def test_the_page_of_the_keys_is_that_of_the_program(self):
        self.compare(CONFIG_PAGE, self.flexarm("config", "reference").stdout,
                     "flexarm config reference")

    def test_the_page_of_trips_and_refusals_is_that_of_the_program(self):
        self.compare(TRIPS_PAGE, self.flexarm("explain").stdout, "flexarm explain")


class ConfigReference(ProgramTest):
    def test_explains_a_key_as_a_message_names_it(self):
        for name in ("limits.torque_limit_nm", "limits.torque_limit_nm[1]", "torque_limit_nm"):
            told = self.flexarm("config", "reference", name).stdout
            self.assertIn("limits.torque_limit_nm\n", told)
            self.assertIn("N m", told)
            self.assertIn("must be above 0 and at most 1000", told)

    def test_explains_the_keys_of_a_table_and_of_a_row(self):
        told = self.flexarm("config", "reference", "sensors.strain[3]").stdout
        self.assertIn("sensors.strain[].position_m", told)
        self.assertNotIn("sensors.encoder", told)
        self.assertIn("In an experiment:", self.flexarm("config", "reference", "move").stdout)

    def test_explains_a_key_of_a_description_of_an_arm(self):
        told = self.flexarm("config", "reference", "gauges_per_link").stdout
        self.assertIn("In a description of an arm:\ngauges_per_link\n", told)
        self.assertIn("must lie in 1 .. 10", told)

    def test_guesses_a_misspelt_key(self):
        refused = self.flexarm("config", "reference", "limits.torque_limit", expect=2)
        self.assertIn("did you mean limits.torque_limit_nm?", refused.stderr)
        refused = self.flexarm("config", "reference", "%s%n\x1b[31m", expect=2)
        self.assertNotIn("\x1b", refused.stderr)

    def test_prints_all_as_json(self):
        told = json.loads(self.flexarm("config", "reference", "--json").stdout)
        keys = {row["key"]: row for row in told["rig"]["keys"]}
        self.assertGreater(len(keys), 250)
        self.assertEqual(keys["log.keep_days"]["without"], "0")
        self.assertEqual(keys["loop.period_ms"]["unit"], "ms")
        self.assertTrue(keys["loop.period_ms"]["required"])
        self.assertTrue(all(row["meaning"] for row in keys.values()))
        self.assertTrue(any(row["key"] == "move[].to_deg" for row in told["experiment"]["keys"]))
        arm = {row["key"]: row for row in told["arm"]["keys"]}
        self.assertEqual(len(arm), 42)  # 38 numbers, a name, three materials
        self.assertEqual(arm["link1.width_mm"]["unit"], "mm")
        self.assertTrue(arm["link1.width_mm"]["required"])
        self.assertEqual(arm["payload_max_kg"]["without"], "twice tip_mass_kg")
        one = json.loads(self.flexarm("config", "reference", "alpha", "--json").stdout)
        self.assertEqual([row["key"] for row in one["rig"]["keys"]],
                         ["controller.alpha", "controller.settling.alpha"])


class Explain(ProgramTest):
    def test_explains_a_trip_by_name_and_number(self):
        by_name = self.flexarm("explain", "soft-limit-1").stdout
        self.assertEqual(by_name, self.flexarm("explain", "6").stdout)
        for part in ("what:", "check:", "remedy:", "flexarm reset", "not possible"):
            self.assertIn(part, by_name)

    def test_explains_all_that_begin_so(self):
        told = self.flexarm("explain", "limit-switch").stdout
        self.assertEqual(told.count("trip "), 4)

    def test_explains_a_refusal_with_its_override(self):
        self.assertIn("--override-host REASON", self.flexarm("explain", "host-not-ready").stdout)
        self.assertIn("override: not possible", self.flexarm("explain", "no-log").stdout)

    def test_guesses_a_misspelt_name(self):
        refused = self.flexarm("explain", "soft-limt-1", expect=2)
        self.assertIn("did you mean soft-limit-1?", refused.stderr)
        self.assertIn("flexarm explain", self.flexarm("explain", "gremlins", expect=2).stderr)
        self.assertIn("flexarm config reference limits.x",
                      self.flexarm("explain", "limits.x", expect=2).stderr)

    def test_prints_all_as_json(self):
        told = json.loads(self.flexarm("explain", "--json").stdout)
        self.assertEqual([trip["number"] for trip in told["trips"]],
                         list(range(1, len(told["trips"]) + 1)))
        for row in told["trips"] + told["refusals"]:
            for part in ("name", "happened", "check", "remedy"):
                self.assertTrue(row[part], row)
        overrides = {row["name"]: row["override"] for row in told["refusals"]}
        self.assertEqual(overrides["switches-not-proved"], "--override-switches REASON")
        self.assertIsNone(overrides["design-rejected"])

    def test_every_name_that_the_daemon_answers_is_explained_and_no_other(self):
        answered = set()
        for source in (ROOT / "controller").rglob("*.cpp"):
            if source.name == "refusal_list.cpp":
                continue
            text = source.read_text(encoding="utf-8")
            if source.parent.name in ("operator", "commissioning"):
                answered.update(NAMED.findall(text))
            answered.update(OF_THE_SAFETY_TASK.findall(text))
        answered.discard("none")
        told = json.loads(self.flexarm("explain", "--json").stdout)
        explained = {row["name"] for row in told["refusals"]}
        self.assertEqual(answered, explained)


if __name__ == "__main__":
    unittest.main()
