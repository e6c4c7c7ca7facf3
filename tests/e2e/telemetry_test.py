#!/usr/bin/env python3
"""Telemetry: datagrams of a real flexarmd against the schema of docs/telemetry.md and the run's log;
runs with a receiver that is missing, slow or forbidden against runs without telemetry."""

import contextlib
import json
import re
import socket
import time
import unittest

from program import HIL, ROOT, ProgramTest, doublet, realtime_permitted, rows

PAGE = ROOT / "docs/telemetry.md"
UNIT = ROOT / "systemd/flexarmd.service.in"
DROP_IN = ROOT / "systemd/telemetry.conf"
SHORT = doublet("short", 2.0)
WITHIN_S = 60.0


def schema():
    """{key: kind} of the page's table. Its second column begins with the kind."""
    rows = re.findall(r"^\| `(\w+)`((?:, `\w+`)*) \| (\w+(?:\[\w+\])?)",
                      PAGE.read_text(encoding="utf-8").split("\n## Lines\n")[1], re.MULTILINE)
    return {key: kind for first, more, kind in rows
            for key in (first, *re.findall(r"`(\w+)`", more))}


def is_of(kind, value, gauges):
    count = re.match(r"\w+\[(\w+)\]", kind)
    if count:
        length = gauges if count[1] == "n" else int(count[1])
        single = kind.split("[")[0]
        return (isinstance(value, list) and len(value) == length
                and all(is_of(single, one, gauges) for one in value))
    if kind == "number":
        return value is None or isinstance(value, (int, float)) and not isinstance(value, bool)
    return {"integer": type(value) is int, "text": type(value) is str,
            "flag": type(value) is bool}[kind]


class Telemetry(ProgramTest):
    def receiver(self):
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(receiver.close)
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(WITHIN_S)
        return receiver, receiver.getsockname()[1]

    def start(self, *arguments):
        ordinary = ["--without-realtime"] if realtime_permitted() else []  # else it is given anyway
        return self.start_daemon(*ordinary, *arguments)

    def to(self, port, *more):
        settings = ["telemetry.address=127.0.0.1", f"telemetry.port={port}", *more]
        return [word for setting in settings for word in ("--set", setting)]

    def test_a_run_is_received_as_the_page_says_and_as_its_log_has_it(self):
        receiver, port = self.receiver()
        self.start("--experiment", self.experiment(SHORT), *self.to(port))
        lines = [json.loads(receiver.recv(65536))]
        began = time.time()
        while not (lines[-1]["run"] and lines[-1]["state"] == "Idle"):  # the daemon disarms, and ends
            lines.append(json.loads(receiver.recv(65536)))
            self.assertLess(time.time() - began, WITHIN_S)
        keys = schema()
        self.assertGreater(len(keys), 25)
        for line in lines:
            self.assertEqual(set(line), set(keys))
            for key, kind in keys.items():
                self.assertTrue(is_of(kind, line[key], 20), f"{key}: {line[key]!r} is no {kind}")
        self.assertEqual([line["tick"] for line in lines],
                         list(range(lines[0]["tick"], lines[-1]["tick"] + 1)), "every sample")
        self.assertEqual({line["telemetry"] for line in lines}, {1})
        for line in lines:
            self.assertAlmostEqual(line["timestamp_s"] - lines[0]["timestamp_s"],
                                   line["time_s"] - lines[0]["time_s"], delta=0.01)
        self.assertLess(abs(lines[0]["timestamp_s"] - began), WITHIN_S, "seconds since 1970")
        running = [line for line in lines if line["state"] == "Running"]
        self.assertGreaterEqual(len(running), 90, "two seconds at 50 Hz are 100 samples")
        self.assert_as_logged(running)

    def assert_as_logged(self, lines):
        self.daemons[0].wait(timeout=WITHIN_S)
        logged = {tick: values for tick, *values in rows(
            self.only_run(), "SELECT tick, hub_1_deg, torque_applied_2_nm FROM tick")}
        both = [line for line in lines if line["tick"] in logged]
        self.assertGreaterEqual(len(both), 90)
        for line in both:
            angle_deg, torque_nm = logged[line["tick"]]
            # The log rounds to 1e-4 deg and 1e-4 N m, a line to seven digits of less than 100.
            self.assertAlmostEqual(line["hub_angle_deg"][0], angle_deg, delta=1e-4)
            self.assertAlmostEqual(line["applied_torque_nm"][1], torque_nm, delta=1e-4)

    def test_the_status_counts_and_one_of_so_many_is_sent(self):
        receiver, port = self.receiver()
        self.start(*self.to(port, "telemetry.every=5"))
        ticks = [json.loads(receiver.recv(65536))["tick"] for _ in range(4)]
        self.assertEqual([tick % 5 for tick in ticks], [0] * 4)
        self.assertEqual({b - a for a, b in zip(ticks, ticks[1:])}, {5})
        status = self.wait_for_state("Idle")["telemetry"]
        self.assertEqual((status["address"], status["port"], status["every"]), ("127.0.0.1", port, 5))
        self.assertGreaterEqual(status["sent"], 4)
        self.assertEqual((status["lost"], status["error"]), (0, None))
        self.assertIn(f"to 127.0.0.1 port {port}, ", self.operate("status").stdout)

    def test_it_is_off_unless_it_is_configured(self):
        self.start()
        self.assertIsNone(self.wait_for_state("Idle")["telemetry"])

    def test_a_receiver_that_is_missing_or_slow_changes_nothing(self):
        """The log of a run is, to the byte, that of the simulation in lock step."""
        slow, slow_port = self.receiver()
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)  # and it does not read
        missing, missing_port = self.receiver()
        missing.close()
        experiment = self.experiment(SHORT)
        for port in (slow_port, missing_port):
            settings = self.to(port)
            simulated = self.folder / f"simulated-{port}.flexarm"
            self.flexarm("simulate", "-c", HIL, "--experiment", experiment, "-o", simulated, *settings)
            daemon = self.start("--experiment", experiment, *settings)
            self.assertEqual(daemon.wait(timeout=WITHIN_S), 0, self.daemon_log())
            difference = self.flexarm_json("diff", self.only_run(), simulated)
            self.assertIs(difference["identical"], True, difference)
            self.only_run().unlink()
        with contextlib.suppress(BlockingIOError):
            slow.setblocking(False)
            received = 0
            while slow.recv(65536):
                received += 1
        self.assertLess(received, 100, "the system threw most of them away")

    def test_what_is_wrong_is_refused_by_name(self):
        for setting in ("telemetry.address=localhost", "telemetry.port=0", "telemetry.every=0",
                        "telemetry.addres=127.0.0.1"):
            result = self.run_program("flexarm", "config", "check", HIL, "--set", setting)
            self.assertEqual(result.returncode, 2, setting)
            self.assertIn(setting.split("=")[0], result.stderr + result.stdout)

    def test_the_drop_in_file_permits_what_the_unit_forbids(self):
        """The unit has no network; what the drop-in adds is the family and one address."""
        unit = UNIT.read_text(encoding="utf-8")
        self.assertRegex(unit, r"(?m)^IPAddressDeny=any$")
        self.assertNotRegex(unit, r"(?m)^RestrictAddressFamilies=.*AF_INET")
        settings = [line for line in DROP_IN.read_text(encoding="utf-8").splitlines()
                    if line and not line.startswith("#")]
        self.assertEqual(settings, ["[Service]", "RestrictAddressFamilies=",
                                    "RestrictAddressFamilies=AF_UNIX AF_INET",
                                    "IPAddressAllow=127.0.0.1"])


if __name__ == "__main__":
    unittest.main()
