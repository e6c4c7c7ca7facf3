#!/usr/bin/env python3
"""Sends each signal to a daemon whose arm moves, and compares what happens with the table of
docs/safety.md, "Signals"."""

import os
import re
import signal
import time
import unittest
from pathlib import Path

from program import ROOT, ProgramTest, despite_stalls, doublet

LONG = doublet("long", 60.0)

PAGE = ROOT / "docs/safety.md"
SIGNALS = re.compile(r"`(\w+)` (\d+)|(\d+) to (\d+)")


def table():
    """(effect, name or None, number) of each signal in the table."""
    section = PAGE.read_text(encoding="utf-8").split("\n## Signals\n")[1].split("\n## ")[0]
    for row in re.findall(r"^\| ([a-z][^|]*) \| ([^|]*) \|", section, re.MULTILINE):
        for name, number, first, last in SIGNALS.findall(row[1]):
            if name:
                yield row[0], name, int(number)
            else:
                yield from ((row[0], None, n) for n in range(int(first), int(last) + 1))


def numbers(effect):
    return [number for is_effect, _, number in table() if is_effect == effect]


class Signals(ProgramTest):
    def start_moving(self):
        daemon = self.start_daemon()
        self.wait_for_state("Idle")
        end = time.monotonic() + 20
        while self.run_program("flexarm", "arm", "--socket", self.folder / "socket").returncode != 0:
            self.assertLess(time.monotonic(), end, self.daemon_log())  # it is not at rest yet
        self.wait_for_state("Armed")
        self.operate("run", self.experiment(LONG))
        self.wait_for_state("Running")
        return daemon

    def test_the_table_has_each_signal_once(self):
        self.assertEqual(sorted(number for _, _, number in table()), list(range(1, 65)))
        for _, name, number in table():
            if name is not None:
                self.assertEqual(getattr(signal, "SIG" + name, signal.Signals(number)), number, name)

    @despite_stalls
    def test_those_that_are_ignored_change_nothing(self):
        ignored = numbers("ignored")
        self.assertGreater(len(ignored), 40)
        daemon = self.start_moving()
        for number in ignored:
            os.kill(daemon.pid, number)
            time.sleep(0.03)
            self.assertIsNone(daemon.poll(), f"signal {number}\n{self.daemon_log()}")
            state = Path(f"/proc/{daemon.pid}/stat").read_text(encoding="utf-8").split()[2]
            self.assertNotEqual(state, "T", f"signal {number}")
        self.wait_for_state("Running", within_s=1)

    @despite_stalls
    def test_those_that_end_it_do_so_in_order(self):
        ends = numbers("ends in order")
        self.assertIn(signal.SIGTERM, ends)
        for number in ends:
            with self.subTest(number):
                daemon = self.start_moving()
                os.kill(daemon.pid, number)
                self.assertEqual(daemon.wait(timeout=20), 0, f"signal {number}\n{self.daemon_log()}")
                info = self.flexarm_json("info", self.only_run())
                self.assertIs(info["closed"], True)
                self.assertEqual(info["final_state"], "Idle")
                self.new_folder()

    @despite_stalls
    def test_a_crash_takes_the_power_away_says_so_and_ends_it(self):
        for number in numbers("crash"):
            with self.subTest(number):
                daemon = self.start_moving()
                os.kill(daemon.pid, number)
                self.assert_crashed(daemon, number)
                said = re.findall(r"^flexarmd: (\w+) in thread '[^']+': relay and charge pump are off, "
                                  "the daemon ends$", self.daemon_log(), re.MULTILINE)
                self.assertEqual(said, [signal.Signals(number).name], self.daemon_log())
                self.start_daemon()
                self.assertEqual(self.wait_for_state("Tripped")["trip"]["name"], "ended-while-armed")
                self.end_daemons()
                self.new_folder()

    def assert_crashed(self, daemon, number):
        code = daemon.wait(timeout=20)
        if "ASAN_OPTIONS" in os.environ:  # the sanitizer reports it, and ends with a code
            self.assertNotEqual(code, 0)
        else:
            self.assertEqual(code, -number, self.daemon_log())

    @despite_stalls
    def test_kill_ends_it_at_once(self):
        self.assertEqual(numbers("ends at once"), [signal.SIGKILL])
        daemon = self.start_moving()
        os.kill(daemon.pid, signal.SIGKILL)
        self.assertEqual(daemon.wait(timeout=5), -signal.SIGKILL)

    @despite_stalls
    def test_stop_holds_it_until_cont(self):
        self.assertEqual(numbers("stands still"), [signal.SIGSTOP])
        self.assertEqual(numbers("goes on"), [signal.SIGCONT])
        daemon = self.start_moving()
        os.kill(daemon.pid, signal.SIGSTOP)
        pid, status = os.waitpid(daemon.pid, os.WUNTRACED)
        self.assertEqual((pid, os.WIFSTOPPED(status)), (daemon.pid, True))
        os.kill(daemon.pid, signal.SIGCONT)
        self.wait_for_state("Running", "Tripped")
        self.assertIsNone(daemon.poll())


if __name__ == "__main__":
    unittest.main()
