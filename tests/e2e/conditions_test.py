#!/usr/bin/env python3
"""An experiment that states laws and payloads refuses what it is not for, before anything moves."""

import json
import re
import subprocess
import unittest

from program import BIN, HIL, ROOT, ProgramTest, rows

# `sobel` trips in this one with 0 and with 1 kg; `gain-scheduled` completes it with each payload.
TIP_POSITIONS = (ROOT / "config/experiments/tip-positions.toml").read_text(encoding="utf-8")
STATED = re.compile(r"^(laws|payload_kg) = .*\n", re.M)


def tip_positions(*lines):
    return "\n".join(lines) + "\n" + STATED.sub("", TIP_POSITIONS)


class Simulate(ProgramTest):
    def simulated(self, *lines, options=()):
        return self.run_program("flexarm", "simulate", "-c", HIL, "--experiment",
                                self.experiment(tip_positions(*lines)), *options)

    def test_a_predicted_trip_is_refused_and_the_law_that_it_names_completes(self):
        refused = self.simulated("payload_kg = [0, 1]")
        self.assert_refused(refused, "experiment.toml: ", '"sobel"', "trips by", "limit",
                            "--unchecked")
        law, = re.findall(r'controller\.name = "(\S+)" completes it', refused.stderr)
        for kg in (0, 0.5, 1):
            done = self.simulated("payload_kg = [0, 1]",
                                  options=("--controller", law, "--payload-kg", kg))
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_unchecked_simulates_it_nevertheless(self):
        result = self.simulated("payload_kg = [0, 1]", options=("--unchecked", "--payload-kg", 1))
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("trip ", result.stdout)

    def test_another_law_is_refused(self):
        refused = self.simulated('laws = ["gain-scheduled"]')
        self.assert_refused(refused, 'not for controller.name = "sobel"', '"gain-scheduled"')
        self.assert_refused(self.simulated('laws = ["gain-sheduled"]'),
                            'did you mean "gain-scheduled"?')

    def test_another_payload_is_refused(self):
        lines = ("payload_kg = [0.1, 0.2]",)
        self.assert_refused(self.simulated(*lines, options=("--payload-kg", 0.3)),
                            "a payload of 0.3 kg", "0.1 to 0.2 kg (payload_kg)")
        done = self.simulated(*lines, options=("--payload-kg", 0.3, "--unchecked", "--controller",
                                               "gain-scheduled"))
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_rig_for_other_payloads_is_named(self):
        refused = self.simulated("payload_kg = [2, 3]")
        self.assert_refused(refused, "controller.payload_range_kg", "0 to 1 kg")

    def test_the_daemon_does_not_start_an_unattended_run_that_is_refused(self):
        self.assert_refused(
            self.run_program("flexarmd", "--config", HIL, "--without-realtime", "--log-dir",
                             self.folder / "runs", "--socket", self.folder / "socket",
                             "--experiment", self.experiment(tip_positions("payload_kg = [0, 1]"))),
            "trips by", '"gain-scheduled"')


class Daemon(ProgramTest):
    def setUp(self):
        super().setUp()
        self.daemon = self.start_armed_daemon()

    def test_refuses_names_a_law_and_goes_on_answering(self):
        experiment = self.experiment(tip_positions("payload_kg = [0, 1]"))
        with subprocess.Popen([BIN / "flexarm", "run", experiment, "--json", "--socket",
                               self.folder / "socket"], cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as run:
            statuses = 0
            while run.poll() is None:
                self.assertEqual(self.verb("status").returncode, 0)
                statuses += 1
            answer = json.loads(run.stdout.read())
            self.assertEqual(run.returncode, 1)
        self.assertGreater(statuses, 0)
        self.assertEqual(answer["refusal"], "predicted-trip")
        self.assertIn('"sobel"', answer["error"])
        self.assertIn('"gain-scheduled" completes it', answer["remedy"])
        self.assertIn("--override-experiment REASON", answer["remedy"])
        self.assertEqual(answer["state"], "Armed")

    def test_a_stop_cancels_the_prediction(self):
        slow = 'payload_kg = [0, 1]\nname = "slow"\nduration_s = 3000.0\n' + "".join(
            f"[[doublet]]\nstart_s = {4 * k}.0\nduration_s = 1.0\nshape = \"sine\"\n"
            f"move_deg = [{5 - 10 * (k % 2)}.0, 0.0]\n" for k in range(749))
        with subprocess.Popen([BIN / "flexarm", "run", self.experiment(slow), "--json", "--socket",
                               self.folder / "socket"], cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as run:
            while run.poll() is None:  # it takes much longer than this
                self.verb("stop")  # refused, since nothing moves, and it cancels
            answer = json.loads(run.stdout.read())
        self.assertEqual(answer["refusal"], "cancelled")
        self.assertEqual(json.loads(self.verb("status", "--json").stdout)["state"], "Armed")

    def test_an_override_runs_it_and_stands_in_the_log(self):
        experiment = self.experiment(tip_positions('laws = ["gain-scheduled"]'))
        refused = self.verb("run", experiment)
        self.assertEqual(refused.returncode, 1)
        self.assertIn('not for controller.name = "sobel"', refused.stderr)
        started = self.verb("run", experiment, "--override-experiment", "0.1 kg is on it")
        self.assertEqual(started.returncode, 0, started.stderr)
        self.wait_for_state("Running")
        self.assertEqual(self.verb("stop").returncode, 0)
        self.wait_for_state("Armed")
        self.assertEqual(self.verb("disarm").returncode, 0)
        self.wait_for_state("Idle")
        self.daemon.terminate()
        self.daemon.wait(timeout=60)  # its logs are SQLite then
        events = rows(self.only_run(), "SELECT * FROM event WHERE kind = 'override'")
        self.assertIn("0.1 kg is on it", str(events))


if __name__ == "__main__":
    unittest.main()
