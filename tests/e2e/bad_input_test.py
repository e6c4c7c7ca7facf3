#!/usr/bin/env python3
"""Each wrong input of a user gives one clear message and exit code 2."""

import contextlib
import random
import re
import shutil
import sqlite3
import unittest

from program import HIL, ROOT, SQUARE, ProgramTest, rows

RIG = ROOT / "config/thesis-rig.toml"

# What is wrong -> (text of thesis-rig.toml, its replacement, text that the message must contain).
# Texts must occur; the first occurrence is replaced.
BROKEN_CONFIGS = {
    "a typing error in a key": ("payload_mass_kg = 0.1", "payload_mas_kg = 0.1", "payload_mas_kg"),
    "a key missing": ("motor2_mass_kg = 3.03", "", "motor2_mass_kg"),
    "a section missing": ("[safety]", "[safty]", "safty"),
    "a key twice": ("alpha = 3.0", "alpha = 3.0\nalpha = 2.0", "alpha"),
    "text for a number": ("alpha = 3.0", 'alpha = "three"', "controller.alpha"),
    "a number for text": ('name = "sobel"', "name = 3", "controller.name"),
    "a number for a truth": ("prediction = true", "prediction = 1", "controller.prediction"),
    "one number for two": ("torque_limit_nm = [30.0, 6.0]", "torque_limit_nm = 30.0",
                           "limits.torque_limit_nm"),
    "three numbers for two": ("torque_limit_nm = [30.0, 6.0]", "torque_limit_nm = [30.0, 6.0, 1.0]",
                              "limits.torque_limit_nm"),
    "not a number": ("alpha = 3.0", "alpha = nan", "controller.alpha"),
    "infinite": ("payload_mass_kg = 0.1", "payload_mass_kg = inf", "arm.payload_mass_kg"),
    "a negative mass": ("payload_mass_kg = 0.1", "payload_mass_kg = -0.1", "arm.payload_mass_kg"),
    "a period of zero": ("period_ms = 20.0", "period_ms = 0.0", "loop.period_ms"),
    "a deadline after the period": ("step_deadline_ms = 5.0", "step_deadline_ms = 50.0",
                                    "loop.step_deadline_ms"),
    "an unknown name": ('name = "kalman"', 'name = "kalmann"', "estimator.name"),
    "a counter of zero bits": ("counter_bits = 8", "counter_bits = 0", "counter_bits"),
    "an encoder too many": ("[sensors.strain_input]",
                            '[[sensors.encoder]]\njoint = "hub1"\ncounts_per_turn = 1.0\n'
                            "counter_bits = 8\nsign = 1\n\n[sensors.strain_input]", "encoder"),
    "a gauge beside the link": ("position_m = 0.04", "position_m = 4.0", "position_m"),
    "a gauge on no face": ("face = 1", "face = 0", "face"),
    "a negative limit": ("soft_angle_deg = [90.0, 90.0]", "soft_angle_deg = [-90.0, 90.0]",
                         "limits.soft_angle_deg"),
    "no TOML": ("[rig]", "[rig", "thesis-rig.toml:"),
    "no modes": ("plant_modes = 4", "plant_modes = 0", "sim.plant_modes"),
    "a section of no length": ("length_m = 0.8 ", "length_m = 0.0 ", "length_m"),
}

BROKEN_EXPERIMENTS = {
    "a key missing": ("start_s = 0.0", "", "start_s"),
    "an unknown shape": ('"square"', '"triangle"', "shape"),
    "moves that overlap": ("start_s = 3.0", "start_s = 0.5", "doublet"),
    "an unknown line": ('[[doublet]]', '[[sim_event]]\nat_s = 1.0\nline = "limit-9"\nlevel = 0\n\n'
                        "[[doublet]]", "line"),
}


class BadConfig(ProgramTest):
    def broken(self, text, old, new, name):
        self.assertIn(old, text, "the shipped file has changed: adapt this test")
        file = self.folder / name
        file.write_text(text.replace(old, new, 1), encoding="utf-8")
        return file

    def test_each_broken_config_is_refused_with_file_line_and_key(self):
        text = RIG.read_text(encoding="utf-8")
        self.assertGreaterEqual(len(BROKEN_CONFIGS), 20)
        for what, (old, new, named) in BROKEN_CONFIGS.items():
            with self.subTest(what):
                file = self.broken(text, old, new, "thesis-rig.toml")
                result = self.run_program("flexarm", "config", "check", file)
                self.assert_refused(result, named)
                self.assertRegex(result.stderr, r"thesis-rig\.toml:\d+")

    def test_all_problems_are_reported_at_once(self):
        text = RIG.read_text(encoding="utf-8")
        text = text.replace("alpha = 3.0", 'alpha = "x"').replace("period_ms = 20.0", "period_ms = 0.0")
        file = self.folder / "rig.toml"
        file.write_text(text, encoding="utf-8")
        self.assert_refused(self.run_program("flexarm", "config", "check", file),
                            "controller.alpha", "loop.period_ms")

    def test_the_daemon_and_the_verbs_refuse_it_as_well(self):
        file = self.broken(RIG.read_text(encoding="utf-8"), "alpha = 3.0", "alpha = nan", "rig.toml")
        self.assert_refused(self.run_program("flexarmd", "--config", file), "controller.alpha")
        for verb in ("simulate", "modes"):
            self.assert_refused(self.run_program("flexarm", verb, "-c", file), "controller.alpha")

    def test_each_broken_experiment_is_refused(self):
        text = SQUARE.read_text(encoding="utf-8")
        for what, (old, new, named) in BROKEN_EXPERIMENTS.items():
            with self.subTest(what):
                file = self.broken(text, old, new, "experiment.toml")
                self.assert_refused(self.run_program("flexarm", "simulate", "-c", HIL,
                                                     "--experiment", file), named)

    def test_bad_usage_is_refused(self):
        for arguments in ((), ("simulat",), ("simulate",), ("simulate", "-c", "missing.toml"),
                          ("simulate", "-c", HIL, "--set", "controller.alfa=3"),
                          ("simulate", "-c", HIL, "--set", "controller.alpha"),
                          ("simulate", "-c", HIL, "--seed", "one"),
                          ("simulate", "-c", HIL, "--controller", "pid"),
                          ("replay", "missing.flexarm"), ("info",), ("plot", "missing.flexarm")):
            with self.subTest(arguments):
                self.assert_refused(self.run_program("flexarm", *arguments))

    def test_the_daemon_refuses_a_rig_without_hardware(self):
        self.assert_refused(self.run_program("flexarmd", "--config", RIG), "hal")


def dump(run):
    """Everything that a log holds."""
    return [rows(run, f"SELECT * FROM {table} ORDER BY 1")
            for table in ("run", "tick", "timing", "safety", "event")]


class BadLog(ProgramTest):
    def test_a_log_cut_anywhere_is_refused(self):
        run, _ = self.simulate("run.flexarm")
        whole = run.read_bytes()
        chosen = random.Random(20)  # fixed: a failure can be repeated
        cut = self.folder / "cut.flexarm"
        for length in sorted(chosen.randrange(len(whole)) for _ in range(100)):
            with self.subTest(length=length):
                cut.write_bytes(whole[:length])
                self.assert_refused(self.run_program("flexarm", "replay", cut), "cut.flexarm")

    def test_a_log_with_random_bytes_overwritten_never_crashes_a_program(self):
        run, _ = self.simulate("run.flexarm")
        whole = run.read_bytes()
        chosen = random.Random(21)
        damaged = self.folder / "damaged.flexarm"
        for case in range(30):
            content = bytearray(whole)
            for _ in range(20):
                content[chosen.randrange(len(content))] = chosen.randrange(256)
            damaged.write_bytes(content)
            with self.subTest(case=case):
                result = self.run_program("flexarm", "replay", damaged)
                self.assertIn(result.returncode, (0, 1, 2), result.stderr)

    def test_no_flipped_bit_that_changes_a_log_passes_replay_or_check(self):
        run, _ = self.simulate("run.flexarm")
        whole = run.read_bytes()
        contents = dump(run)
        chosen = random.Random(33)
        flipped = self.folder / "flipped.flexarm"
        told = 0
        for _ in range(60):
            content = bytearray(whole)
            at = chosen.randrange(len(content))
            content[at] ^= 1 << chosen.randrange(8)
            flipped.write_bytes(content)
            codes = [self.run_program("flexarm", verb, flipped).returncode
                     for verb in ("replay", "check")]
            with self.subTest(byte=at):
                if codes == [0, 0]:
                    self.assertEqual(dump(flipped), contents)
                else:
                    self.assertNotIn(0, codes, "both verbs tell it")
                    told += 1
        self.assertGreater(told, 30)

    def test_a_log_with_a_view_in_place_of_a_table_is_refused_at_once(self):
        run, _ = self.simulate("run.flexarm")
        with contextlib.closing(sqlite3.connect(run)) as log:
            log.executescript(
                "DROP VIEW timing; CREATE VIEW timing AS WITH RECURSIVE n(i) AS (SELECT 1 UNION"
                " ALL SELECT i + 1 FROM n) SELECT i AS tick, i AS due_ns, i AS woke_ns, i AS"
                " finished_ns, 0.0 AS late_us, 0.0 AS took_us FROM n")
        for verb in ("info", "replay", "check", "export"):
            output = ("-o", self.folder / "run.csv") if verb == "export" else ()
            with self.subTest(verb):
                result = self.run_program("flexarm", verb, run, *output, timeout_s=30)
                self.assert_refused(result, "not those of a run log")

    def test_a_file_that_is_not_a_log_is_refused(self):
        text = self.folder / "notes.flexarm"
        text.write_text("This is a text.\n" * 100, encoding="utf-8")
        empty = self.folder / "empty.flexarm"
        empty.write_bytes(b"")
        other = self.folder / "other.flexarm"
        shutil.copy(HIL, other)
        for file in (text, empty, other, self.folder):
            with self.subTest(file.name):
                for verb in ("replay", "info", "check"):
                    self.assert_refused(self.run_program("flexarm", verb, file), file.name)


class BadCsv(ProgramTest):
    def setUp(self):
        super().setUp()
        run, _ = self.simulate("run.flexarm")
        self.table = self.folder / "run.csv"
        self.flexarm("export", run, "-o", self.table)
        self.lines = self.table.read_text(encoding="utf-8").splitlines()

    def refused(self, lines, *said):
        bad = self.folder / "bad.csv"
        bad.write_text("\n".join(lines) + "\n", encoding="utf-8")
        self.assert_refused(self.run_program("flexarm", "replay", bad, "-c", HIL), "bad.csv", *said)

    def test_a_missing_column_is_named(self):
        self.assertIn("strain_1_01", self.lines[0])
        names = self.lines[0].split(",")
        gone = names.index("strain_1_01")
        self.refused([",".join(v for i, v in enumerate(line.split(",")) if i != gone)
                      for line in self.lines], "strain_1_01")

    def test_a_row_that_is_not_numbers_is_named_by_its_line(self):
        row = self.lines[9].split(",")
        row[1] = "many"
        self.refused(self.lines[:9] + [",".join(row)] + self.lines[10:], ":10")

    def test_a_short_row_is_named_by_its_line(self):
        self.refused(self.lines[:9] + ["1,2,3"] + self.lines[10:], ":10")

    def test_a_file_without_rows_is_refused(self):
        self.refused(self.lines[:1])
        self.refused([])

    def test_a_file_without_a_config_is_refused(self):
        result = self.run_program("flexarm", "replay", self.table)
        self.assert_refused(result)
        self.assertTrue(re.search(r"-c|--config", result.stderr), result.stderr)


if __name__ == "__main__":
    unittest.main()
