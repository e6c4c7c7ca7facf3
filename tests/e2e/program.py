"""Running the programs as a user does, and looking at what they leave."""

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("FLEXARM_BIN", ROOT / "build/release/tools"))
HIL = ROOT / "config/hil.toml"
SQUARE = ROOT / "config/experiments/square-30deg.toml"

# Signs of a program that fell over instead of saying what is wrong.
CRASH_SIGNS = ("terminate called", "Sanitizer", "runtime error:", "Assertion", "core dumped")


def realtime_permitted():
    return subprocess.run(["chrt", "-f", "90", "true"], capture_output=True,
                          check=False).returncode == 0


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own, `self.folder`."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="flexarm e2e "))  # a space: paths may have one
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_program(self, name, *arguments, timeout_s=120):
        result = subprocess.run([BIN / name, *map(str, arguments)], cwd=self.folder,
                                capture_output=True, text=True, errors="backslashreplace",
                                timeout=timeout_s, check=False)
        told = f"{name} {' '.join(map(str, arguments))}\n{result.stdout}\n{result.stderr}"
        self.assertGreaterEqual(result.returncode, 0, f"killed by a signal: {told}")
        for sign in CRASH_SIGNS:
            self.assertNotIn(sign, result.stderr, told)
        return result

    def flexarm(self, *arguments, expect=0):
        result = self.run_program("flexarm", *arguments)
        self.assertEqual(result.returncode, expect,
                         f"flexarm {' '.join(map(str, arguments))}\n{result.stdout}\n{result.stderr}")
        return result

    def flexarm_json(self, *arguments, expect=0):
        """One JSON object on stdout, and nothing else."""
        return json.loads(self.flexarm(*arguments, "--json", expect=expect).stdout)

    def simulate(self, name, *arguments, experiment=SQUARE):
        run = self.folder / name
        result = self.flexarm_json("simulate", "-c", HIL, "--experiment", experiment, "-o", run,
                                   *arguments)
        return run, result

    def assert_refused(self, result, *said):
        """Exit 2 with a short message that says what is wrong, and nothing on stdout."""
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertTrue(result.stderr.strip(), "no message")
        self.assertLess(len(result.stderr.splitlines()), 12, result.stderr)
        for text in said:
            self.assertIn(text, result.stderr)

    def experiment(self, text):
        file = self.folder / "experiment.toml"
        file.write_text(text, encoding="utf-8")
        return file

    def start_daemon(self, *arguments):
        """The daemon with its own log folder and socket; ended when the test is."""
        options = [] if realtime_permitted() else ["--without-realtime"]
        with open(self.folder / "daemon.log", "w", encoding="utf-8") as log:
            daemon = subprocess.Popen(
                [BIN / "flexarmd", "--config", HIL, "--log-dir", self.folder / "runs",
                 "--socket", self.folder / "socket", *options, *map(str, arguments)],
                cwd=self.folder, stdout=log, stderr=log)

        def end():
            if daemon.poll() is None:
                daemon.send_signal(signal.SIGKILL)
            daemon.wait()

        self.addCleanup(end)
        return daemon

    def daemon_log(self):
        return (self.folder / "daemon.log").read_text(encoding="utf-8")

    def only_run(self):
        runs = list((self.folder / "runs").glob("*.flexarm"))
        self.assertEqual(len(runs), 1, f"{runs}\n{self.daemon_log()}")
        return runs[0]


def rows(run, query):
    log = sqlite3.connect(f"file:{run}?mode=ro", uri=True)
    try:
        return log.execute(query).fetchall()
    finally:
        log.close()


def ticks(run):
    """The whole tick table."""
    return rows(run, "SELECT * FROM tick ORDER BY tick")


def missed_deadlines(run, deadline_ms=5.0):
    return rows(run, "SELECT count(*) FROM timing WHERE finished_ns - due_ns >"
                     f" {deadline_ms * 1e6}")[0][0]
