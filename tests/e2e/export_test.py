#!/usr/bin/env python3
"""Files of `flexarm export`, and the first plots that docs/run-logs.md shows."""

import csv
import math
import re
import shutil
import subprocess
import sys
import time
import unittest

from program import HIL, ROOT, ProgramTest, in_real_time, rows

# As a log has it: keys in the order of the alphabet.
HUB_ENCODER = re.compile(
    r'counter_bits = (\d+)\ncounts_per_turn = ([\d.]+)\njoint = "hub1"\nsign = ([+-]?1)')


def has_module(name):
    return subprocess.run([sys.executable, "-c", f"import {name}"], capture_output=True,
                          check=False).returncode == 0


def block(language):
    """The lines of the page in that language."""
    page = (ROOT / "docs/run-logs.md").read_text(encoding="utf-8")
    return re.search(rf"```{language}\n(.*?)```", page, re.S).group(1)


class Decoded(ProgramTest):
    def setUp(self):
        super().setUp()
        self.run_file, _ = self.simulate("run.flexarm")
        self.table = self.folder / "run.csv"

    def export(self, *options):
        self.flexarm("export", self.run_file, "--decoded", "-o", self.table, *options)
        with open(self.table, encoding="utf-8", newline="") as file:
            names, units, *values = csv.reader(file)
        self.assertEqual(len(names), len(units))
        self.assertEqual(len(set(names)), len(names))
        return dict(zip(names, units)), [dict(zip(names, row, strict=True)) for row in values]

    def test_has_a_row_of_units_and_a_row_a_sample(self):
        units, values = self.export()
        self.assertEqual(units["time_s"], "s")
        self.assertEqual(units["hub_1_deg"], "deg")
        self.assertEqual(units["strain_1_01_microstrain"], "microstrain")
        self.assertEqual([(int(row["tick"]), row["state"]) for row in values],
                         rows(self.run_file, "SELECT tick, state FROM tick ORDER BY tick"))
        self.assertNotIn("counter_1", units)
        self.assertTrue(all(math.isfinite(float(value)) or value == "NaN"
                            for row in values for name, value in row.items() if name != "state"))

    def test_an_angle_is_its_counts_times_the_resolution(self):
        config, = rows(self.run_file, "SELECT value FROM run WHERE key = 'config'")[0]
        bits, counts_per_turn, sign = HUB_ENCODER.search(config).groups()
        deg_per_count = int(sign) * 360 / float(counts_per_turn)
        _, values = self.export("--with-raw")
        first = values[0]
        self.assertGreater(max(abs(float(row["hub_1_deg"])) for row in values), 20)
        for row in values:
            turned = float(row["hub_1_deg"]) - float(first["hub_1_deg"])
            counts = int(row["counter_1"]) - int(first["counter_1"])
            counts += 2**int(bits) * round((turned / deg_per_count - counts) / 2**int(bits))
            self.assertAlmostEqual(turned, deg_per_count * counts, places=9)

    def test_torques_and_counts_are_those_of_the_raw_file(self):
        _, values = self.export("--with-raw")
        raw = self.folder / "raw.csv"
        self.flexarm("export", self.run_file, "-o", raw)
        with open(raw, encoding="utf-8", newline="") as file:
            raw_rows = list(csv.DictReader(file))
        self.assertEqual(len(values), len(raw_rows))
        for decoded, counts in zip(values, raw_rows):
            for joint in "12":
                self.assertEqual(decoded[f"torque_applied_{joint}_nm"], counts[f"torque_{joint}_nm"])
            for name in ("time_s", "counter_2", "strain_1_01", "strain_2_03"):
                self.assertEqual(decoded[name], counts[name])

    def test_a_simulated_run_has_its_true_tip_near_the_estimated_one(self):
        _, values = self.export()
        running = [row for row in values if row["state"] == "Running"]
        for axis in "xy":
            worst = max(abs(float(row[f"truth_tip_{axis}_m"]) - float(row[f"estimated_tip_{axis}_m"]))
                        for row in running)
            self.assertLess(worst, 0.05)

    def test_replay_refuses_it_and_names_the_raw_export(self):
        self.export()
        for rig in (HIL, ROOT / "config/quanser-2dsfl.toml"):
            result = self.run_program("flexarm", "replay", self.table, "-c", rig)
            self.assert_refused(result, "run.csv:1: found decoded columns", "without --decoded")

    def test_replaces_its_own_file_and_no_raw_one(self):
        self.export()
        self.export("--with-raw")
        raw = self.folder / "raw.csv"
        self.flexarm("export", self.run_file, "-o", raw)
        self.flexarm("export", self.run_file, "--decoded", "-o", raw, expect=2)
        self.flexarm("export", self.run_file, "--with-raw", "-o", self.folder / "x.csv", expect=2)

    def test_a_mat_file_is_decided_by_its_name(self):
        mat = self.folder / "run.mat"
        said = self.run_program("flexarm", "export", self.run_file, "-o", mat)
        self.assert_refused(said, "run.mat", "add --decoded")
        self.flexarm("export", self.run_file, "--decoded", "-o", mat)
        self.assertTrue(mat.read_bytes().startswith(b"MATLAB 5.0 MAT-file, decoded samples of"))
        self.flexarm("export", self.run_file, "--decoded", "-o", mat)  # its own file: replaced
        mat.write_bytes(b"MATLAB 5.0 MAT-file, of another program" + bytes(200))
        self.flexarm("export", self.run_file, "--decoded", "-o", mat, expect=2)

    @unittest.skipUnless(has_module("scipy"), "no SciPy")
    def test_scipy_reads_a_mat_file(self):
        _, values = self.export()
        self.flexarm("export", self.run_file, "--decoded", "-o", self.folder / "run.mat")
        told = self.run_lines(sys.executable, "-c", "import scipy.io\n"
                              "run = scipy.io.loadmat('run.mat')\n"
                              "print(len(run['time_s']), repr(float(run['hub_1_deg'][-1, 0])))\n"
                              "print(run['units']['hub_1_deg'][0, 0][0], run['state'][-1])")
        self.assertEqual(told.split(), [str(len(values)), repr(float(values[-1]["hub_1_deg"])),
                                        "deg", values[-1]["state"]])

    def run_lines(self, *command):
        result = subprocess.run(command, cwd=self.folder, capture_output=True, text=True,
                                timeout=120, check=False)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    @unittest.skipUnless(has_module("pandas") and has_module("matplotlib"), "no pandas, Matplotlib")
    def test_the_page_plots_it_in_python(self):
        self.export()
        self.run_lines("env", "MPLBACKEND=Agg", sys.executable, "-c", block("python"))
        self.assertGreater((self.folder / "first.png").stat().st_size, 5000)

    @unittest.skipUnless(has_module("numpy"), "no NumPy")
    def test_numpy_reads_it(self):
        _, values = self.export()
        told = self.run_lines(sys.executable, "-c", "import numpy\n"
                              "run = numpy.genfromtxt('run.csv', delimiter=',', names=True)[1:]\n"
                              "print(len(run), repr(float(run['hub_1_deg'][-1])))")
        self.assertEqual(told.split(), [str(len(values)), repr(float(values[-1]["hub_1_deg"]))])

    @unittest.skipUnless(shutil.which("octave-cli"), "no Octave")
    def test_the_page_reads_it_in_octave(self):
        _, values = self.export()
        lines = block("octave").partition("plot(")[0]  # a plot needs a screen
        told = self.run_lines("octave-cli", "--eval", lines + "angle = column('hub_1_deg');"
                              "printf('%d %.17g', numel(angle), angle(end))").split()
        self.assertEqual(int(told[0]), len(values))
        self.assertEqual(float(told[1]), float(values[-1]["hub_1_deg"]))


class Calibrated(ProgramTest):
    """A run of a rig that was calibrated: raw counts mean nothing without its calibration."""

    @in_real_time
    def test_the_calibration_comes_with_the_raw_file_and_replay_needs_it(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        self.operate("tare")
        time.sleep(0.8)  # at rest means half a second of rest
        self.operate("arm")
        self.operate("move", "--to", "5", "-5", "--duration", "1", "--wait")
        self.operate("disarm")
        self.wait_for_state("Idle")
        time.sleep(0.5)
        run, = (self.folder / "runs").glob("*.flexarm")
        table = self.folder / "run.csv"
        self.assertIn("--calibration", self.flexarm("export", run, "-o", table).stderr)
        brought = self.folder / "run.calibration.json"
        replay = self.flexarm_json("replay", table, "-c", HIL, "--calibration", brought)
        self.assertEqual(replay["faulty_ticks"], 0)
        self.assert_refused(self.run_program("flexarm", "replay", table, "-c", HIL,
                                             "--calibration", self.folder / "none.json"), "none.json")
        self.assert_refused(self.run_program("flexarm", "replay", run, "--calibration", brought),
                            "--calibration")


class OfATrip(ProgramTest):
    @in_real_time
    def test_a_trip_outside_a_run_is_a_table_of_the_time_before_it(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        time.sleep(0.8)  # at rest means half a second of rest
        self.operate("arm")
        self.operate("sim", "emergency-stop", "0")
        self.wait_for_state("Tripped")
        run, = self.wait_for_closed_runs(1)
        table = self.folder / "trip.csv"
        self.flexarm("export", run, "--decoded", "-o", table)
        with open(table, encoding="utf-8", newline="") as file:
            _, *states = [row["state"] for row in csv.DictReader(file)]  # after the units
        self.assertLessEqual({"Idle", "Armed", "Tripped"}, set(states))
        self.assertEqual(states[-1], "Tripped")


if __name__ == "__main__":
    unittest.main()
