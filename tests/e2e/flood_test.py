#!/usr/bin/env python3
"""The operator socket under misuse: whatever clients send, the arm can be stopped, and the daemon
lives on with the memory that it had."""

import contextlib
import json
import os
import socket
import time
import unittest
from pathlib import Path

from program import ProgramTest, realtime_permitted

LONG = """
name = "long"
duration_s = 60.0

[[doublet]]
start_s = 0.0
duration_s = 1.0
shape = "square"
move_deg = [10.0, 10.0]
"""

# What a flood may add to the memory of the daemon: 16 clients hold 1.3 MB each at most, and one
# line of 1 MB takes 50 MB while it is read as JSON.
MOST_MB = 64


class Flood(ProgramTest):
    def setUp(self):
        super().setUp()
        ordinary = ["--without-realtime"] if realtime_permitted() else []  # else it is given anyway
        self.daemon = self.start_daemon(*ordinary)
        self.wait_for_state("Idle")
        end = time.monotonic() + 20
        while self.run_program("flexarm", "arm", "--socket", self.folder / "socket").returncode != 0:
            self.assertLess(time.monotonic(), end, self.daemon_log())  # it is not at rest yet
        self.operate("run", self.experiment(LONG))
        self.wait_for_state("Running")
        self.start_mb = self.resident_mb()

    def resident_mb(self):
        status = Path(f"/proc/{self.daemon.pid}/status").read_text(encoding="utf-8")
        return int(status.split("VmRSS:")[1].split()[0]) / 1024

    def client(self):
        client = socket.socket(socket.AF_UNIX)
        client.connect(str(self.folder / "socket"))
        client.settimeout(20)
        return client

    def assert_can_be_stopped(self):
        self.assertIsNone(self.daemon.poll(), self.daemon_log())
        self.operate("stop")
        self.wait_for_state("Armed")
        self.operate("disarm")
        self.wait_for_state("Idle")
        if "ASAN_OPTIONS" not in os.environ:  # which keeps freed memory
            self.assertLess(self.resident_mb() - self.start_mb, MOST_MB)

    def test_silent_connections_block_no_other(self):
        with contextlib.ExitStack() as stack:
            for k in range(200):
                client = stack.enter_context(self.client())
                client.sendall(b"{\"command\": \"st" if k % 2 else b"")
            self.assert_can_be_stopped()

    def test_newlines_do_not_hold_the_daemon(self):
        with contextlib.ExitStack() as stack:
            for _ in range(4):
                client = stack.enter_context(self.client())
                client.settimeout(0.2)
                with contextlib.suppress(OSError):
                    for _ in range(20):
                        client.sendall(b"\n" * 200_000)
            self.assert_can_be_stopped()

    def test_nested_brackets_are_refused(self):
        for text in (b"[" * 900_000, b"{\"command\":\"pluck\",\"x\":" + b"[" * 40_000 + b"]" * 40_000 +
                     b"}", b"{\"command\":\"home\",\"x\":" + b"{\"a\":" * 40_000 + b"}"):
            with self.client() as client:
                client.sendall(text + b"\n")
                self.assertIn("not a command", json.loads(client.recv(4096))["error"])
        with self.client() as client:  # not deep, and large in memory
            client.sendall(b"{\"command\":\"home\",\"x\":[" + b"[]," * 300_000 + b"[]]}\n")
            self.assertIs(json.loads(client.recv(4096))["ok"], False)
        self.assert_can_be_stopped()

    def test_more_commands_than_a_period_can_take_are_each_answered(self):
        with self.client() as client:
            client.sendall(b"{\"command\":\"status\"}\n" * 50 + b"{\"command\":\"stop\"}\n" * 300)
            answers = b""
            while answers.count(b"\n") < 350:
                part = client.recv(65536)
                self.assertTrue(part, "closed")
                answers += part
            self.assertTrue(all(json.loads(line)["ok"] for line in answers.splitlines()))
        self.wait_for_state("Armed")
        self.operate("disarm")

    def test_a_stop_of_a_client_that_closes_at_once_is_heard(self):
        with self.client() as client:
            client.sendall(b"{\"command\":\"stop\"}\n")
        self.wait_for_state("Armed")

    def test_a_client_that_never_reads_is_closed(self):
        with self.client() as client:
            client.settimeout(0.5)
            with self.assertRaises(OSError):
                for _ in range(200):
                    client.sendall(b"{\"command\":\"status\"}\n" * 2000)
                    time.sleep(0.02)
        self.assert_can_be_stopped()

    def test_random_bytes_are_answered_or_closed(self):
        for _ in range(200):
            with self.client() as client, contextlib.suppress(OSError):
                client.sendall(os.urandom(2000) + b"\n")
        self.assert_can_be_stopped()


if __name__ == "__main__":
    unittest.main()
