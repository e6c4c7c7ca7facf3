#!/usr/bin/env python3
"""The programs that talk to a daemon, against one that answers anything."""

import contextlib
import itertools
import json
import socket
import threading
import unittest

from program import ProgramTest

GOOD = {
    "ok": True, "protocol": 1, "state": "Idle", "time_s": 1.5, "tick": 75, "rig": "r",
    "version": "1", "config": {"file": "/f", "hash": "0"}, "lease": {"name": "a", "uid": 1,
                                                                      "seconds_left": 3.0},
    "present": [{"name": "hub-rate-1", "value": 1.0, "limit": 2.0, "channel_name": "joint 1"}],
    "run": {"number": 3, "name": "n", "outcome": "done", "elapsed_s": 1.0, "duration_s": 2.0},
    "inputs": {"limit-1-low": 1}, "wiring": {"proved": True, "why_not": None},
    "joint_angle_deg": [1.0, 2.0], "joint_angle_unknown": [None, None], "torque_nm": [0.0, 0.0],
    "gauges_missing": [], "at_rest": True, "payload": {"kg": 0.1, "sigma_kg": 0.1,
                                                       "delay_found": 0, "warnings": []},
    "delay_ms": 1.0, "delay_max_ms": 1.0, "delay_margin_ms": 1.0,
    "trip": {"name": "hub-rate-1", "text": "t", "value": 1.0, "limit": 0.5, "bus": None,
             "channel_name": "joint 1", "time_utc": None, "before_start": False,
             "record_problem": None, "unit": "rad/s", "report": "/runs/a.trip.html"},
    "latch_problem": None,
    "timing": {"trips": True, "safety_overruns": 0, "safety_worst_ms": 0.1,
               "deadlines_missed_in_a_row": 0, "deadlines_often_missed": 0},
    "buses": [{"name": "can0", "ok": True, "failed": 0, "recovered": 0, "longest_ms": 1.0,
               "declared_ms": 2.0, "slow": 0, "fault": None, "counters": {"a": 1}}],
    "log_records_dropped": 0,
    "threads": [{"name": "safety", "activations": 1, "missed_deadlines": 0, "skipped_periods": 0,
                 "worst_lateness_us": 1.0}],
    "host": {"verdict": "ready", "findings": [{"name": "n", "text": "t", "advice": True}]},
    "design": {"verdict": "sound", "findings": []},
    "overrides": [{"condition": "host", "reason": "r"}],
    "switches": {"proved": False, "why_not": "x", "steps": 11, "step": None, "text": None},
}
VALUES = (None, [], {}, [None], [[], {}], "", "\x1b[31m\u009b2J\x07", "x" * 100_000, True, -1, 1e300,
          10**25)


class FalseDaemon:
    """Answers each line with the next text."""

    def __init__(self, path, texts):
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(str(path))
        self.listener.listen(16)
        self.texts = iter(texts)
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            with client, contextlib.suppress(OSError, StopIteration):
                client.makefile().readline()
                client.sendall(next(self.texts) + b"\n")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.listener.close()


def changed(value):
    """GOOD with each of its values, also of the objects in it, replaced by `value`."""
    for key, old in GOOD.items():
        yield {**GOOD, key: value}
        if isinstance(old, dict):
            for inner in old:
                yield {**GOOD, key: {**old, inner: value}}
        if isinstance(old, list) and old and isinstance(old[0], dict):
            for inner in old[0]:
                yield {**GOOD, key: [{**old[0], inner: value}]}


class Client(ProgramTest):
    def ask(self, *command):
        return self.run_program("flexarm", *command, "--socket", self.folder / "socket",
                                timeout_s=20)

    def assert_sound(self, result, text):
        told = f"{text[:300]}\n{result.stdout}{result.stderr}"
        self.assertIn(result.returncode, (0, 1, 2), told)
        self.assertNotIn("json.exception", told)
        for sign in told:
            self.assertTrue(sign in "\n" or sign.isprintable(), repr(told))

    def test_whatever_a_status_holds_it_is_shown(self):
        texts = [json.dumps(GOOD).encode()]
        texts += [json.dumps(status).encode() for status in
                  itertools.chain.from_iterable(changed(value) for value in VALUES)][::7]
        with FalseDaemon(self.folder / "socket", texts):
            for text in texts:
                self.assert_sound(self.ask("status"), text.decode())

    def test_whatever_an_answer_is_a_verb_ends_with_a_code(self):
        texts = [json.dumps(value).encode() for value in VALUES]
        texts += [json.dumps({"ok": value, "error": value, "command": value, "state": value,
                              "run": value, "strain": value, "answer": [value], "remedy": value,
                              "encoder": [{"joint": value, "zero_counts": value}]}).encode()
                  for value in VALUES]
        texts += [b"", b"{", b"\xff\xfe", b"nul", b"{\"ok\":true}" * 2, b"[" * 100_000]
        for command in (("status",), ("arm",), ("tare",), ("pluck",)):
            with FalseDaemon(self.folder / "socket", texts):
                for text in texts:
                    self.assert_sound(self.ask(*command), text.decode(errors="replace"))
            (self.folder / "socket").unlink()

    def test_a_refusal_ends_a_status(self):
        refused = json.dumps({"ok": False, "refusal": "not-permitted", "error": "e", "remedy": "r"})
        with FalseDaemon(self.folder / "socket", [refused.encode()] * 2):
            result = self.ask("status")
            self.assertEqual((result.returncode, result.stdout), (1, ""))
            self.assertEqual(result.stderr, "flexarm: e; r\n")


if __name__ == "__main__":
    unittest.main()
