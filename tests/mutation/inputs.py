"""The good inputs, which are made once by the programs themselves, and the daemons that take some."""

import functools
import json
import os
import shutil
import socket
import subprocess
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CONFIGS = ROOT / "config"
EXPERIMENTS = CONFIGS / "experiments"

SHORT = """
name = "short"
duration_s = 0.4

[[doublet]]
start_s = 0.0
duration_s = 0.32
shape = "square"
move_deg = [2.0, 2.0]
"""


class Programs:
    """The programs under test and the files that they make of good input, below one folder."""

    def __init__(self, binaries, folder):
        self.binaries = binaries.resolve()
        self.folder = folder
        self.lock = threading.Lock()

    def path(self, name):
        return self.binaries / name

    def make(self, *arguments):
        done = subprocess.run([self.path("flexarm"), *map(str, arguments)], cwd=self.folder,
                              capture_output=True, check=False, timeout=300)
        if done.returncode != 0:
            raise RuntimeError(f"flexarm {arguments}: {done.stderr.decode()}")

    def _made(self, name, *arguments):
        with self.lock:
            file = self.folder / name
            if not file.exists():
                self.make(*arguments)
        return file

    @functools.cached_property
    def experiment(self):
        file = self.folder / "short.toml"
        file.write_text(SHORT, encoding="utf-8")
        return file

    @property
    def run(self):
        """A log of 20 samples."""
        return self._made("run.flexarm", "simulate", "-c", CONFIGS / "hil.toml", "--experiment",
                          self.experiment, "-o", "run.flexarm", "--json")

    @property
    def csv(self):
        run = self.run
        return self._made("run.csv", "export", run, "-o", "run.csv")

    @property
    def gains(self):
        return self._made("gains.json", "design", "-c", CONFIGS / "hil.toml", "-o", "gains.json", "--json")

    @property
    def sweep(self):
        return self._made("sweep.sqlite", "sweep", "-c", CONFIGS / "hil.toml", "--experiment",
                          self.experiment, "--over", "controller.alpha=2.5,3.0", "--seeds", "1..2", "-o",
                          "sweep.sqlite", "--json")

    @property
    def calibration(self):
        with self.lock:
            file = self.folder / "calibration.json"
            if not file.exists():
                with Daemon(self, self.folder / "calibrated") as daemon:
                    daemon.settle()
                    daemon.operate("tare")
                    shutil.copy(daemon.folder / "runs/calibration.json", file)
        return file


class Daemon:
    """A daemon with the simulated arm, in a folder of its own."""

    def __init__(self, programs, folder):
        self.programs = programs
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        self.socket = folder / "socket"
        with open(folder / "daemon.log", "wb") as log:
            self.process = subprocess.Popen(
                [programs.path("flexarmd"), "--config", CONFIGS / "hil.toml", "--log-dir", folder / "runs",
                 "--socket", self.socket, "--without-realtime"], cwd=folder, stdout=log, stderr=log)
        end = time.monotonic() + 60
        while self.state() not in ("Idle", "Tripped"):
            if time.monotonic() > end or self.process.poll() is not None:
                raise RuntimeError(f"the daemon does not start: {self.log()}")
            time.sleep(0.05)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        self.process.kill()
        self.process.wait()

    def log(self):
        return (self.folder / "daemon.log").read_text(encoding="utf-8", errors="backslashreplace")

    def alive(self):
        return self.process.poll() is None

    def ask(self, line, within_s=10.0):
        """The answer to one line of bytes; b"": the daemon has closed the connection."""
        with socket.socket(socket.AF_UNIX) as client:
            client.settimeout(within_s)
            client.connect(str(self.socket))
            client.sendall(line + b"\n")
            answer = b""
            while not answer.endswith(b"\n"):
                part = client.recv(65536)
                if not part:
                    break
                answer += part
            return answer

    def command(self, **command):
        return json.loads(self.ask(json.dumps(command).encode()))

    def state(self):
        try:
            return self.command(command="status")["state"]
        except (OSError, ValueError):
            return ""

    def operate(self, *verb):
        done = subprocess.run([self.programs.path("flexarm"), *verb, "--socket", self.socket],
                              capture_output=True, check=False, timeout=120)
        return done.returncode == 0

    def wait_for(self, state, within_s=20.0):
        end = time.monotonic() + within_s
        while self.state() != state:
            if time.monotonic() > end:
                raise RuntimeError(f"not {state} but {self.state()}: {self.log()[-2000:]}")
            time.sleep(0.02)

    def settle(self):
        """At rest for half a second."""
        self.wait_for("Idle")
        time.sleep(0.8)

    def arm(self, within_s=20.0):
        end = time.monotonic() + within_s
        while not self.command(command="arm").get("ok") and time.monotonic() < end:
            time.sleep(0.1)
        self.wait_for("Armed")


def copy_of_configs(folder):
    """The shipped rigs, whose texts an input changes."""
    for file in CONFIGS.glob("*.toml"):
        shutil.copy(file, folder)
    (folder / "experiments").mkdir()
    for file in (*EXPERIMENTS.glob("*.toml"), *EXPERIMENTS.glob("*.csv")):
        shutil.copy(file, folder / "experiments")


def special_file(chosen, path, good):
    """Something else in the place of a file: what it is."""
    kinds = {
        "a FIFO": lambda: os.mkfifo(path),
        "a folder": path.mkdir,
        "a link to itself": lambda: path.symlink_to(path.name),
        "a link to nothing": lambda: path.symlink_to("nothing"),
        "/dev/zero": lambda: path.symlink_to("/dev/zero"),
        "/dev/null": lambda: path.symlink_to("/dev/null"),
        "100 MB of nothing": lambda: path.touch() or os.truncate(path, 100_000_000),
        "100 MB of a line": lambda: path.write_bytes(b"x" * 100_000_000),
        "an empty file": lambda: path.write_bytes(b""),
        "CR line ends": lambda: path.write_bytes(good.replace(b"\n", b"\r")),
        "CR LF line ends": lambda: path.write_bytes(good.replace(b"\n", b"\r\n")),
        "UTF-16": lambda: path.write_bytes(good.decode().encode("utf-16")),
        "a byte-order mark": lambda: path.write_bytes(b"\xef\xbb\xbf" + good),
        "two byte-order marks": lambda: path.write_bytes(b"\xef\xbb\xbf" * 2 + good),
        "nuls at the end": lambda: path.write_bytes(good + bytes(1000)),
        "no last line end": lambda: path.write_bytes(good.rstrip(b"\n")),
        "a long line": lambda: path.write_bytes(good + b"#" + b"x" * 900_000 + b"\n"),
        "nothing at all": lambda: None,
    }
    name = chosen.choice(sorted(kinds))
    kinds[name]()
    return name
