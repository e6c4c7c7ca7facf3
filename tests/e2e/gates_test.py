#!/usr/bin/env python3
"""What must hold before the arm is armed: the design, and the reasons of those who override it."""

import json
import socket
import sys
import time
import unittest

from program import HIL, ROOT, SQUARE, ProgramTest, despite_stalls

# The one sample of delay is not compensated: `flexarm design` rejects it.
UNSTABLE = ("--set", "controller.prediction=false")

RIGS = sorted((ROOT / "config").glob("*.toml"))


class Gates(ProgramTest):
    def start_idle(self, *arguments):
        self.start_daemon(*arguments)
        status = self.wait_for_state("Idle")
        time.sleep(0.8)  # at rest means half a second of rest
        return status

    def ask(self, line):
        """What a client other than the program may send."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
            client.connect(str(self.folder / "socket"))
            client.settimeout(10)
            client.sendall(line + b"\n")
            answer = b""
            while not answer.endswith(b"\n"):
                answer += client.recv(65536)
        self.assertEqual(answer.count(b"\n"), 1)
        return json.loads(answer)

    def status(self):
        return json.loads(self.operate("status", "--json").stdout)

    def forced_gains(self):
        gains = self.folder / "forced.json"
        self.flexarm("design", "-c", HIL, "-o", gains, *UNSTABLE, "--force")
        return gains

    def test_every_shipped_rig_passes_its_design(self):
        for rig in RIGS:
            with self.subTest(rig=rig.name):
                told = self.flexarm_json("design", "-c", rig, "-o", self.folder / "gains.json")
                self.assertIs(told["sound"], True)

    @despite_stalls
    def test_every_shipped_rig_arms_on_the_simulated_backend(self):
        # The wired rigs differ from thesis-rig by their devices, which are not here.
        rigs = [rig for rig in RIGS if 'backend = "wired"' not in rig.read_text(encoding="utf-8")]
        self.assertGreaterEqual(len(rigs), 5)
        for rig in rigs:
            with self.subTest(rig=rig.name):
                simulated = self.folder / rig.name
                simulated.write_text(f'extends = "{rig}"\n[hal]\nbackend = "sim"\n',
                                     encoding="utf-8")
                # It is killed while armed, so the next one has a state folder of its own.
                self.start_daemon("--state-dir", self.folder / f"state of {rig.name}",
                                  config=simulated)
                status = self.wait_for_state("Idle")
                self.assertEqual(status["design"]["verdict"], "sound")
                self.assertIsNone(status["host"], "no machine is too bad for a simulated arm")
                time.sleep(0.8)
                self.operate("arm")
                self.wait_for_state("Armed")
                self.assertEqual(self.status()["overrides"], [])
                self.end_daemons()

    @despite_stalls
    def test_a_design_that_is_rejected_is_not_armed(self):
        status = self.start_idle(*UNSTABLE)
        self.assertEqual(status["design"]["verdict"], "rejected")
        rejected = self.run_program("flexarm", "design", "-c", HIL, *UNSTABLE, "-o", "gains.json")
        self.assertEqual(rejected.returncode, 1)
        found = status["design"]["findings"][0]["text"]
        self.assertIn(found, rejected.stderr, "one verdict")
        for arguments in ((), ("--override-design", "I want it"), ("--override-host", "no")):
            refused = self.operate("arm", *arguments, expect=1)
            for said in ("rejected", "robustness-spectral-radius = 1.", "must be below 1",
                         "unstable with", "flexarm design"):
                self.assertIn(said, refused.stderr)
        answer = json.loads(self.operate("arm", "--json", expect=1).stdout)
        self.assertEqual(answer["refusal"], "design-rejected")
        self.assertEqual(self.status()["state"], "Idle")
        self.assertFalse(list(self.folder.glob("runs/*.flexarm")))
        self.assertIn("design: rejected: ", self.daemon_log())
        self.assertIn("refused: the design of the controller was rejected", self.daemon_log())

    @despite_stalls
    def test_an_unattended_run_with_a_rejected_design_is_refused(self):
        daemon = self.start_daemon("--experiment", SQUARE, *UNSTABLE)
        self.assertEqual(daemon.wait(timeout=60), 2, self.daemon_log())
        self.assertIn("robustness-spectral-radius", self.daemon_log())
        self.assertFalse(list(self.folder.glob("runs/*.flexarm")))

    @despite_stalls
    def test_gains_that_were_forced_arm_on_the_simulated_backend(self):
        status = self.start_idle(*UNSTABLE, "--set", f'controller.gains="{self.forced_gains()}"')
        self.assertEqual(status["design"]["verdict"], "forced")
        self.operate("arm", "--override-design", "not needed here")
        self.wait_for_state("Armed")
        self.assertEqual(self.status()["overrides"], [], "nothing had to be overridden")
        self.assertIn("waived with --force", self.daemon_log())

    def test_simulate_warns_of_a_design_that_the_daemon_does_not_arm(self):
        sound = self.flexarm("simulate", "-c", HIL, "--json")
        self.assertEqual(json.loads(sound.stdout)["design"], {"verdict": "sound", "found": ""})
        self.assertNotIn("warning", sound.stderr)
        result = self.run_program("flexarm", "simulate", "-c", HIL, "--json", *UNSTABLE)
        told = json.loads(result.stdout)["design"]
        self.assertEqual(told["verdict"], "rejected")
        self.assertIn("unstable with", told["found"])
        self.assertIn("warning: the daemon does not arm this design", result.stderr)
        forced = self.run_program("flexarm", "simulate", "-c", HIL, "--json", *UNSTABLE, "--set",
                                  f'controller.gains="{self.forced_gains()}"')
        self.assertEqual(json.loads(forced.stdout)["design"]["verdict"], "forced")
        self.assertIn("--force waived", forced.stderr)

    def test_a_reason_that_is_none_is_refused_before_the_daemon_is_asked(self):
        for option in ("--override-host", "--override-design"):
            for reason, said in (("", "empty"), ("  ", "empty"), ("two\nlines", "control"),
                                 ("\x1b[2J", "control"), ("x" * 201, "200 bytes"),
                                 (b"\xff", "UTF-8")):
                with self.subTest(option=option, reason=reason):
                    reason = reason if isinstance(reason, str) else reason.decode(
                        errors="surrogateescape")
                    self.assert_refused(self.run_program("flexarm", "arm", option, reason, "--socket",
                                                         self.folder / "socket"), option, said)

    @despite_stalls
    def test_a_client_cannot_bring_a_reason_that_breaks_a_line(self):
        self.start_idle()
        for overrides in ('{"host": "a\\nb"}', '{"host": "a\\u2028b"}', '{"host": ""}', '{"host": 3}',
                          '{"switches": "of another command"}', '["host"]', "null",
                          json.dumps({"host": "x" * 201})):
            with self.subTest(overrides=overrides):
                answer = self.ask(f'{{"command": "arm", "overrides": {overrides}}}'.encode())
                self.assertIs(answer["ok"], False)
                self.assertIn("overrides", answer["error"])
        raw = self.ask(b'{"command": "arm", "overrides": {"host": "\xff"}}')
        self.assertIs(raw["ok"], False)
        self.assertEqual(self.status()["state"], "Idle")
        injected = '"}]} \\n {"command": "disarm"} %s \' ü'
        self.operate("arm", "--override-host", injected)
        self.wait_for_state("Armed")
        self.assertEqual(self.status()["overrides"], [], "a simulated arm needs no machine")


if __name__ == "__main__":
    sys.exit(unittest.main())
