#!/usr/bin/env python3
"""The daemon on the simulated arm in real time, for an hour or FLEXARM_SOAK_S seconds.

It is armed, runs experiment after experiment and is disarmed, over and over. Required: every run
ends as planned and replays to the bit, no record is missing, nothing trips, and neither memory nor
open files grow. Lateness is counted and printed, never judged: it is that of the host. If the host
was so late that the daemon tripped by it, as cyclictest beside it tells, that is counted as well,
and a new daemon goes on.
"""

import argparse
import collections
import json
import os
import re
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "e2e"))
from program import ProgramTest, StallWitness  # noqa: E402

SECONDS = float(os.environ.get("FLEXARM_SOAK_S", "3600"))

# A thread of the highest priority waited so long: that costs the daemon a period, and two in a row
# are a trip.
STALL_MS = 10.0

# The first runs of each kind take memory that later ones use again.
SETTLED_SHARE = 0.1
GROWTH_MB = 4.0

RUNS_BETWEEN_DISARMS = 20

MOVE = """
name = "soak-{number}"
duration_s = {duration_s}

[[move]]
start_s = 0.2
duration_s = 2.0
to_deg = [{to_deg}, {to_deg}]
"""


class Soak(ProgramTest):
    def setUp(self):
        super().setUp()
        self.said = collections.Counter()
        self.memory_mb, self.open_files, self.late = [], [], []
        self.begun = time.monotonic()

    def elapsed_s(self):
        return time.monotonic() - self.begun

    def start(self):
        self.witness = StallWitness()
        self.witness.__enter__()
        self.addCleanup(self.witness.__exit__)
        self.daemon = self.start_daemon("--state-dir", self.folder / f"state{len(self.late)}")
        self.wait_for_state("Idle", "Tripped")
        self.arm()

    def arm(self):
        end = time.monotonic() + 20
        while self.verb("arm").returncode != 0:  # it is not at rest yet
            if self.status()["state"] == "Tripped":
                self.was_late()  # it has armed another daemon
                return
            self.assertLess(time.monotonic(), end, self.daemon_log())
        self.said["arm"] += 1

    def status(self):
        return json.loads(self.operate("status", "--json").stdout)

    def sample(self):
        process = Path(f"/proc/{self.daemon.pid}")
        status = (process / "status").read_text(encoding="utf-8")
        self.memory_mb.append((self.elapsed_s(),
                               int(re.search(r"VmRSS:\s*(\d+)", status).group(1)) / 1024))
        self.open_files.append((self.elapsed_s(), len(list((process / "fd").iterdir()))))

    def was_late(self):
        """The daemon tripped because the host was late: counts it, and starts another."""
        status = self.status()
        self.assertEqual(status["state"], "Tripped", self.daemon_log())
        longest_ms = max(self.witness.waits_ms, default=0.0)
        self.assertGreaterEqual(longest_ms, STALL_MS, self.daemon_log())
        self.late.append(f"{status['trip']['name']} after {longest_ms} ms")
        self.stop(code=1)
        self.start()

    def stop(self, code=0):
        _ = self.witness.waits_ms  # ends its recording
        self.daemon.terminate()
        self.assertEqual(self.daemon.wait(timeout=60), code, self.daemon_log())
        for line in self.daemon_log().splitlines():
            counts = re.search(r"(\S+): (\d+) activations, (\d+) missed deadlines, (\d+) skipped", line)
            if counts:
                thread, *numbers = counts.groups()
                for what, number in zip(("activations", "missed", "skipped"), numbers):
                    self.said[f"{thread} {what}"] += int(number)
        self.daemons.remove(self.daemon)

    def test_runs_follow_runs(self):
        experiments = []
        for number, (duration_s, to_deg) in enumerate([(6.0, 20.0), (12.0, -30.0), (3.0, 0.0)]):
            file = self.folder / f"experiment{number}.toml"
            file.write_text(MOVE.format(number=number, duration_s=duration_s, to_deg=to_deg),
                            encoding="utf-8")
            experiments.append(file)
        self.start()
        while self.elapsed_s() < SECONDS:
            for number in range(RUNS_BETWEEN_DISARMS):
                result = self.verb("run", "--wait", experiments[number % len(experiments)])
                if result.returncode != 0:
                    self.assertIn("trip", result.stderr)
                    self.was_late()
                    break
                self.said["run"] += 1
                self.sample()
                if self.elapsed_s() >= SECONDS:
                    break
            else:
                self.operate("disarm")
                self.wait_for_state("Idle", "Tripped")
                self.arm()
        self.stop()
        self.judge()

    def judge(self):
        logs = self.runs()
        steps = 0
        for log in logs:
            replay = self.flexarm_json("replay", log)
            self.assertEqual([replay["bit_exact"], replay["safety_exact"]], [True, True], log)
            checks = json.loads(self.run_program("flexarm", "check", log, "--json").stdout)["checks"]
            broken = {check["name"] for check in checks if not check["passed"]}
            self.assertLessEqual(broken, {"no-gap"}, log)  # a period that the host withheld
            self.said["with a gap"] += len(broken)
            steps += replay["ticks"]
        known = self.said
        print(f"{self.elapsed_s():.0f} s, {known['arm']} arms, {known['run']} runs,"
              f" {len(logs)} logs with {steps} samples, {known['with a gap']} with skipped ones,"
              f" trips by a late host: {self.late}")
        for key in sorted(key for key in known if key.endswith(" activations")):
            thread = key.removesuffix(" activations")
            print(f"{thread}: {known[key]} activations, {known[thread + ' missed']} missed"
                  f" deadlines, {known[thread + ' skipped']} skipped periods")
        for name, samples in (("memory", self.memory_mb), ("open files", self.open_files)):
            print(f"{name}: {samples[0][1]:.1f} at first, {samples[-1][1]:.1f} at last")
        self.assertGreaterEqual(len(logs), known["run"])
        if self.late:
            return  # each daemon has its own memory
        settled = max(value for at_s, value in self.memory_mb
                      if at_s <= max(SETTLED_SHARE * SECONDS, self.memory_mb[0][0]))
        self.assertLess(self.memory_mb[-1][1], settled + GROWTH_MB)
        self.assertEqual(self.open_files[-1][1], self.open_files[0][1])


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__).parse_args()
    unittest.main()
