#!/usr/bin/env python3
"""Several users of one daemon: who may do what, and who commands the arm."""

import contextlib
import json
import os
import signal
import socket
import subprocess
import time
import unittest

from program import ProgramTest, doublet, rows

LONG = doublet("long", 60.0)

# Numbers of users and groups that need no account.
ALICE, BOB, VIEWER, OUTSIDER = 41001, 41002, 41003, 41004
OPERATORS, VIEWERS = 42001, 42002
GROUPS = {ALICE: [OPERATORS], BOB: [7, OPERATORS], VIEWER: [VIEWERS], OUTSIDER: [7]}

# The daemon sees groups of its own, in a mount namespace; this computer keeps its own.
WITH_GROUPS = """
groups=$1; shift
mount --make-rprivate / && mount --bind "$groups" /etc/group && exec "$@"
"""


def namespaces_permitted():
    return os.geteuid() == 0 and subprocess.run(
        ["unshare", "--mount", "mount", "--make-rprivate", "/"], capture_output=True,
        check=False).returncode == 0


@unittest.skipUnless(namespaces_permitted(), "only root can act for several users")
class Users(ProgramTest):
    def setUp(self):
        super().setUp()
        self.folder.chmod(0o755)
        groups = self.folder / "group"
        groups.write_text(f"flexarm:x:{OPERATORS}:\nflexarm-view:x:{VIEWERS}:\n", encoding="utf-8")
        self.start_daemon(before=["unshare", "--mount", "sh", "-c", WITH_GROUPS, "sh", groups])
        self.wait_for_state("Idle")

    def as_user(self, user, action):
        """Calls `action` in a child process of another user. @returns its pid, and a pipe from it"""
        ours, its = os.pipe()
        child = os.fork()
        if child == 0:
            code = 1
            try:
                os.setgroups(GROUPS[user])
                os.setgid(user)
                os.setuid(user)
                with os.fdopen(its, "w", encoding="utf-8") as pipe:
                    action(pipe)
                code = 0
            finally:
                os._exit(code)
        os.close(its)
        return child, os.fdopen(ours, encoding="utf-8")

    def ask(self, user, name, **more):
        """The answer to a command of a user."""
        def action(pipe):
            with socket.socket(socket.AF_UNIX) as client:
                client.settimeout(30)
                client.connect(str(self.folder / "socket"))
                with contextlib.suppress(BrokenPipeError):
                    client.sendall(json.dumps({"command": name, **more}).encode() + b"\n")
                pipe.write(client.makefile().readline())

        child, pipe = self.as_user(user, action)
        with pipe:
            told = pipe.read()
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        return json.loads(told)

    def arm(self, user):
        end = time.monotonic() + 20
        while not (answer := self.ask(user, "arm"))["ok"]:
            self.assertEqual(answer["refusal"], "not-at-rest", answer)  # not yet
            self.assertLess(time.monotonic(), end, answer)
        return answer

    def test_a_user_without_a_role_is_told_so_and_does_nothing(self):
        for name in ("status", "arm", "stop"):
            answer = self.ask(OUTSIDER, name)
            self.assertEqual(answer["refusal"], "not-permitted")
            self.assertIn("flexarm", answer["remedy"])
            self.assertEqual(answer["by"]["uid"], OUTSIDER)
        self.wait_for_state("Idle")
        self.assertIn(f"connection by uid {OUTSIDER} (uid {OUTSIDER}, pid ", self.daemon_log())

    def test_a_viewer_sees_the_status_and_stops_the_arm(self):
        self.arm(ALICE)
        self.assertIs(self.ask(ALICE, "run", experiment=LONG)["ok"], True)
        self.assertEqual(self.ask(VIEWER, "status")["state"], "Running")
        for name in ("arm", "run", "disarm", "reset", "tare", "sim"):
            self.assertEqual(self.ask(VIEWER, name)["refusal"], "not-permitted", name)
        stopped = self.ask(VIEWER, "stop")
        self.assertIs(stopped["ok"], True)
        self.assertEqual(stopped["by"]["uid"], VIEWER)
        self.wait_for_state("Armed")

    def test_one_user_commands_and_another_takes_over(self):
        armed = self.arm(ALICE)
        self.assertEqual(armed["by"]["uid"], ALICE)
        self.assertEqual(self.ask(BOB, "status")["lease"]["uid"], ALICE)
        held = self.ask(BOB, "run", experiment=LONG)
        self.assertEqual(held["refusal"], "held-by")
        self.assertEqual(held["held_by"]["uid"], ALICE)
        self.assertIs(self.ask(ALICE, "run", experiment=LONG)["ok"], True)  # another process
        self.assertEqual(self.ask(BOB, "disarm", take_over=True)["refusal"], "held-by")
        self.assertIs(self.ask(BOB, "stop")["ok"], True)
        self.wait_for_state("Armed")
        self.assertIs(self.ask(BOB, "disarm", take_over=True)["ok"], True)
        self.wait_for_state("Idle")
        lease = self.ask(VIEWER, "status")["lease"]
        self.assertEqual(lease["uid"], BOB)
        self.assertGreater(lease["seconds_left"], 30.0)
        self.assertEqual(self.ask(ALICE, "arm")["refusal"], "held-by")
        self.assertIn("lease: taken over from", self.daemon_log())
        self.assert_in_the_log()

    def assert_in_the_log(self):
        """The log of the run says who gave which command."""
        time.sleep(1)  # the recorder closes it
        run = sorted((self.folder / "runs").glob("*.flexarm"))[-1]
        events = rows(run, "SELECT kind, name, value_json FROM event")
        given = [(name, json.loads(value)["by"]["uid"], json.loads(value)["ok"])
                 for kind, name, value in events if kind == "operator"]
        for command in (("arm", ALICE, True), ("run", BOB, False), ("run", ALICE, True),
                        ("disarm", BOB, False), ("stop", BOB, True)):
            self.assertIn(command, given)
        self.assertIn(("lease", "begun"), [(kind, name) for kind, name, _ in events])

    def test_connections_of_one_user_lock_no_other_out(self):
        def hold(pipe):
            clients = [socket.socket(socket.AF_UNIX) for _ in range(40)]
            for client in clients:
                client.connect(str(self.folder / "socket"))
            pipe.write("connected\n")
            pipe.flush()
            time.sleep(60)

        with contextlib.ExitStack() as stack:
            for user in (VIEWER, ALICE):
                child, pipe = self.as_user(user, hold)
                stack.callback(os.waitpid, child, 0)
                stack.callback(os.kill, child, signal.SIGKILL)
                self.assertEqual(stack.enter_context(pipe).readline(), "connected\n")
            with socket.socket(socket.AF_UNIX) as root:
                root.connect(str(self.folder / "socket"))
                reader = root.makefile()
                for user in (BOB, VIEWER, ALICE):
                    self.assertEqual(self.ask(user, "status")["state"], "Idle")
                    root.sendall(b"{\"command\": \"status\"}\n")
                    self.assertIs(json.loads(reader.readline())["ok"], True, "root is kept")


if __name__ == "__main__":
    unittest.main()
