#!/usr/bin/env python3
"""`flexarm status --watch`: on a terminal, in a pipe, as JSON lines; resized, stopped, without an
answer."""

import contextlib
import fcntl
import json
import os
import pty
import re
import select
import signal
import socket
import struct
import subprocess
import termios
import threading
import time
import unittest

from program import BIN, ProgramTest, doublet, realtime_permitted

LONG = doublet("long", 60.0, move_deg=3.0)
WITHIN_S = 30.0
ENTER, LEAVE = b"\033[?1049h", b"\033[?1049l"
PLACE = re.compile(rb"\033\[(\d+);1H")
SEQUENCE = re.compile(rb"\033\[[0-9;?]*[A-Za-z]")


class Screen:
    """A pseudo terminal with a program on it, and what the program has written to it."""

    def __init__(self, command, columns, rows, folder, **environment):
        self.ours, its = pty.openpty()
        self.resize(columns, rows)
        self.before = termios.tcgetattr(its)
        self.its = its  # kept open: it has the settings after the program's end
        self.written = b""
        self.process = subprocess.Popen(
            command, stdin=its, stdout=its, stderr=its, cwd=folder, start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(its, termios.TIOCSCTTY, 0),
            env={**os.environ, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8", **environment})

    def resize(self, columns, rows):
        fcntl.ioctl(self.ours, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def type(self, keys):
        os.write(self.ours, keys)

    def read(self, within_s):
        if select.select([self.ours], [], [], within_s)[0]:
            self.written += os.read(self.ours, 65536)

    def frames(self):
        """The screens that are complete, because another has begun: lists of lines."""
        frames = self.written.split(b"\033[1;1H")[1:-1]
        return [[SEQUENCE.sub(b"", line).decode() for line in PLACE.split(b"\033[1;1H" + frame)[2::2]]
                for frame in frames]

    def wait_for(self, text, after=0):
        """The first screen from number `after` on with the text, and the number of the next."""
        end = time.monotonic() + WITHIN_S
        while time.monotonic() < end:
            frames = self.frames()
            for number, frame in enumerate(frames[after:], after):
                if re.search(text, "\n".join(frame)):
                    return frame, number + 1
            self.read(0.2)
        raise AssertionError(f"no {text!r}: {self.frames()[-1:]} {self.written[-2000:]}")

    def end(self):
        """Waits for the program's end, and returns its exit code."""
        end = time.monotonic() + WITHIN_S
        while self.process.poll() is None and time.monotonic() < end:
            self.read(0.05)
        self.read(0.1)
        return self.process.wait(timeout=1)

    def close(self):
        with contextlib.suppress(OSError):
            self.process.kill()
        self.process.wait()
        os.close(self.its)
        os.close(self.ours)


class Watch(ProgramTest):
    def setUp(self):
        super().setUp()
        self.start()

    def start(self):
        ordinary = ["--without-realtime"] if realtime_permitted() else []  # else it is given anyway
        self.daemon = self.start_daemon(*ordinary)
        self.wait_for_state("Idle", "Tripped")

    def command(self, *more):
        return [BIN / "flexarm", "status", "--watch", "--period", "0.1", "--socket",
                self.folder / "socket", *more]

    def screen(self, columns=80, rows=24, **environment):
        screen = Screen(self.command(), columns, rows, self.folder, **environment)
        self.addCleanup(screen.close)
        return screen

    def run_arm(self):
        end = time.monotonic() + 20
        while self.run_program("flexarm", "arm", "--socket", self.folder / "socket").returncode != 0:
            self.assertLess(time.monotonic(), end, self.daemon_log())  # it is not at rest yet
        self.operate("run", self.experiment(LONG))

    def assert_left_as_found(self, screen):
        self.assertEqual(termios.tcgetattr(screen.its), screen.before)
        self.assertEqual(screen.written.count(ENTER), screen.written.count(LEAVE))
        self.assertTrue(screen.written.endswith(b"\033[?25h" + LEAVE), screen.written[-200:])

    def test_it_shows_a_run_follows_the_size_and_ends_at_q(self):
        screen = self.screen()
        frame, seen = screen.wait_for("Idle")
        self.assertIn("relay open", "\n".join(frame))
        self.assertIn("hub1 ", "\n".join(frame), "counters while disarmed")
        self.run_arm()
        frame, seen = screen.wait_for(r"Running[^\n]*of 60\.0 s[^\n]*law sobel in force", seen)
        self.assertEqual(len([line for line in frame if re.match(r"\d\d +\[", line)]), 10)
        self.assertIn("relay CLOSED", "\n".join(frame))
        for columns, rows in ((120, 40), (40, 15), (20, 3), (80, 24)):
            screen.resize(columns, rows)
            seen = len(screen.frames())
            _, seen = screen.wait_for("Running", seen + 1)
            frame, seen = screen.wait_for("Running", seen)
            self.assertLessEqual(len(frame), rows + 1)  # the last clears what is below
            self.assertLessEqual(max(map(len, frame)), columns, frame)
        screen.type(b"q")
        self.assertEqual(screen.end(), 0)
        self.assert_left_as_found(screen)

    def test_ctrl_c_leaves_the_terminal_as_it_was(self):
        screen = self.screen()
        screen.wait_for("Idle")
        self.assertNotEqual(termios.tcgetattr(screen.its), screen.before, "keys are read at once")
        screen.type(b"\x03")
        self.assertEqual(screen.end(), 0)
        self.assert_left_as_found(screen)

    def test_every_signal_that_ends_it_leaves_the_terminal_as_it_was(self):
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            screen = self.screen()
            screen.wait_for("Idle")
            screen.process.send_signal(number)
            self.assertEqual(screen.end(), 0, number)
            self.assert_left_as_found(screen)

    def test_while_it_is_stopped_the_shell_has_the_terminal(self):
        screen = self.screen()
        _, seen = screen.wait_for("Idle")
        screen.process.send_signal(signal.SIGTSTP)
        os.waitpid(screen.process.pid, os.WUNTRACED)
        self.assertEqual(termios.tcgetattr(screen.its), screen.before)
        screen.process.send_signal(signal.SIGCONT)
        screen.wait_for("Idle", seen + 1)
        screen.type(b"q")
        self.assertEqual(screen.end(), 0)
        self.assert_left_as_found(screen)

    def test_a_switch_that_opens_and_a_trip_are_seen(self):
        screen = self.screen()
        screen.wait_for("2 high ok")
        self.operate("sim", "limit-2-high", "0")
        frame, _ = screen.wait_for("2 high OPEN")
        screen.wait_for("TRIP limit-switch-2-high|present limit-switch-2-high")
        self.assertTrue(frame)

    def test_a_daemon_that_stands_still_or_has_ended_is_named_until_it_is_back(self):
        screen = self.screen()
        _, seen = screen.wait_for("Idle")
        self.daemon.send_signal(signal.SIGSTOP)
        _, seen = screen.wait_for(r"NO ANSWER: what follows is \d", seen)
        self.daemon.send_signal(signal.SIGCONT)
        _, seen = screen.wait_for(r"^[^\n]*tick \d+[^\n]*\n Idle", seen)
        self.end_daemons()
        frame, seen = screen.wait_for("NO ANSWER", seen)
        self.assertRegex("\n".join(frame), r"start\sflexarmd|does not answer|closed")
        self.start()
        screen.wait_for(r"^[^\n]*tick \d+[^\n]*\n (Idle|Tripped)", seen)
        screen.type(b"q")
        self.assertEqual(screen.end(), 0)

    def test_colours_unless_they_are_not_wanted(self):
        for environment, coloured in (({}, True), ({"NO_COLOR": "1"}, False)):
            screen = self.screen(**environment)
            screen.wait_for("Idle")
            self.assertIs(b"\033[36m" in screen.written, coloured)
            screen.type(b"q")
            self.assertEqual(screen.end(), 0)

    def test_where_there_is_no_screen_it_writes_plain_lines(self):
        plain = subprocess.Popen(self.command(), stdout=subprocess.PIPE, text=True,
                                 env={**os.environ, "LC_ALL": "C", "COLUMNS": "100"})
        kill = threading.Timer(WITHIN_S, plain.kill)
        kill.start()
        text = ""
        while text.count("\n\n") < 2:  # two blocks
            line = plain.stdout.readline()
            self.assertTrue(line, text)
            text += line if line.strip() or text.endswith("\n") else ""
            self.assertTrue(all(" " <= sign <= "~" or sign == "\n" for sign in line), repr(line))
            self.assertLessEqual(len(line), 101)
        plain.send_signal(signal.SIGINT)
        plain.communicate()
        self.assertEqual(plain.returncode, 0)
        kill.cancel()
        self.assertIn("relay open", text)

    def test_as_json_it_is_a_line_a_period_also_without_an_answer(self):
        lines = subprocess.Popen(self.command("--json"), stdout=subprocess.PIPE, text=True)
        kill = threading.Timer(WITHIN_S, lines.kill)
        kill.start()
        ticks = [json.loads(lines.stdout.readline())["tick"] for _ in range(5)]
        self.assertEqual(ticks, sorted(ticks))
        self.assertGreater(ticks[-1], ticks[0])
        self.end_daemons()
        while (line := json.loads(lines.stdout.readline()))["ok"]:
            pass
        self.assertEqual(set(line), {"ok", "error"})
        self.start()
        while not json.loads(lines.stdout.readline())["ok"]:
            pass
        lines.send_signal(signal.SIGTERM)
        lines.communicate()
        self.assertEqual(lines.returncode, 0)
        kill.cancel()

    def test_a_second_interrupt_while_an_answer_is_waited_for_changes_nothing(self):
        with socket.socket(socket.AF_UNIX) as mute:
            mute.bind(str(self.folder / "mute.sock"))
            mute.listen()  # connects, and never answers: each question is waited for a second
            lines = subprocess.Popen(
                [BIN / "flexarm", "status", "--watch", "--json", "--period", "0.1", "--socket",
                 self.folder / "mute.sock"], stdout=subprocess.PIPE, text=True)
            kill = threading.Timer(WITHIN_S, lines.kill)
            kill.start()
            self.assertFalse(json.loads(lines.stdout.readline())["ok"])
            lines.send_signal(signal.SIGINT)
            time.sleep(0.3)  # the first is taken, the second comes at the end
            lines.send_signal(signal.SIGINT)
            lines.communicate()
            self.assertEqual(lines.returncode, 0)
            kill.cancel()

    def test_the_period_belongs_to_the_watch(self):
        self.assert_refused(self.run_program("flexarm", "status", "--period", "1"), "--watch")
        self.assert_refused(self.run_program("flexarm", "status", "--watch", "--period", "nan"),
                            "--period")


if __name__ == "__main__":
    unittest.main()
