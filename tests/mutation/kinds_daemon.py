"""What comes over the operator socket: experiments and commands to the daemon, and answers of a false
daemon to the client."""

import json
import socket
import threading

import judge
import mutate
from inputs import EXPERIMENTS, Daemon

COMMANDS = (
    {"command": "status"}, {"command": "stop"}, {"command": "disarm"}, {"command": "reset"},
    {"command": "arm"}, {"command": "arm", "overrides": {"host": "a reason", "design": "another"}},
    {"command": "run", "experiment": "name = \"x\"\nduration_s = 0.1\n", "name": "x.toml",
     "overrides": {"switches": "a reason"}},
    {"command": "tare"}, {"command": "zero", "joint": 1, "angle_deg": 0.0},
    {"command": "zero", "angle_deg": [0.0, 0.0]}, {"command": "calibrate"},
    {"command": "pluck", "torque_nm": 0.1, "joint": 1}, {"command": "home", "joint": 1},
    {"command": "prove-switches"}, {"command": "sim", "line": "limit-1-high", "level": 1},
)

_daemons = threading.local()


def daemon_of_this_thread(trial, fresh=False):
    """A daemon that inputs share, as long as it lives."""
    daemon = getattr(_daemons, "daemon", None)
    if daemon is None or fresh or not daemon.alive():
        if daemon is not None:
            daemon.end()
        number = getattr(_daemons, "number", 0) + 1
        _daemons.number = number
        folder = trial.programs.folder / f"daemon-{threading.get_ident()}-{number}"
        daemon = _daemons.daemon = Daemon(trial.programs, folder)
        with _all_lock:
            _all.append(daemon)
    return daemon


_all, _all_lock = [], threading.Lock()


def end_daemons():
    for daemon in _all:
        daemon.end()


def judge_daemon(trial, daemon, what):
    """It lives, answers, and its messages can be read."""
    said = []
    if not daemon.alive():
        said.append(f"the daemon has ended with {daemon.process.returncode}: {daemon.log()[-300:]}")
    elif not daemon.state():
        said.append("the daemon does not answer")
    new = (daemon.folder / "daemon.log").read_bytes()[getattr(daemon, "read", 0):]
    daemon.read = getattr(daemon, "read", 0) + len(new)
    if raw := judge.RAW.search(new):
        said.append(f"its journal has the raw text '{raw.group().decode()}'")
    if wrong := judge.unprintable(new):
        said.append(f"its journal: {wrong}")
    trial.add(what, said)


def to_state(daemon, state):
    for _ in range(200):
        now = daemon.state()
        if now == state:
            return True
        if now in ("Tripped", ""):
            return False
        if now in ("Running", "Stopping"):
            daemon.command(command="stop")
        elif state == "Armed":
            daemon.command(command="arm")
        else:
            daemon.command(command="disarm")
    return False


def experiment_to_daemon(trial):
    """A changed experiment to an armed daemon is refused, or it runs and can be stopped."""
    daemon = daemon_of_this_thread(trial)
    if not to_state(daemon, "Armed"):
        daemon = daemon_of_this_thread(trial, fresh=True)
        daemon.arm()
    chosen = trial.chosen
    good = chosen.choice([file for file in sorted(EXPERIMENTS.glob("*.toml")) if file.name != "trajectory.toml"])
    change = chosen.choice((mutate.in_text, mutate.in_numbers))
    file = trial.write(good.name, change(chosen, good.read_bytes()))
    ended = trial.flexarm("run", file, "--socket", daemon.socket, names=(file.name,))
    judge_daemon(trial, daemon, ["run", file.name])
    if ended.code == 0 and daemon.alive():
        to_state(daemon, "Armed")


def changed_command(chosen):
    command = dict(chosen.choice(COMMANDS))
    kind = chosen.randrange(5)
    if kind == 0:
        return mutate.in_bytes(chosen, json.dumps(command).encode())
    if kind == 1:
        return mutate.nested(chosen)
    if kind == 2:
        command[chosen.choice(sorted(command))] = mutate.other_value(chosen)
        return json.dumps(command).encode()
    if kind == 3:
        command[chosen.choice(("", "x", "joint", "level", "angle_deg", "overrides", "experiment"))] = \
            mutate.other_value(chosen)
        return json.dumps(command).encode()
    return mutate.in_json(chosen, json.dumps(command).encode())


def socket_command(trial):
    """A changed command gets one line of JSON that a person can read, or the connection is closed."""
    daemon = daemon_of_this_thread(trial)
    line = changed_command(trial.chosen).replace(b"\n", b" ")
    said = []
    try:
        answer = daemon.ask(line)
    except socket.timeout:
        answer = b""
        if trial.chosen.random() < 2 and not waits(line):
            said.append(f"no answer within {judge.HANG_S:g} s")
    except OSError:
        answer = b""
    if answer:
        said += judge_answer(answer)
    trial.add(["socket", ascii(line[:200])], said)
    judge_daemon(trial, daemon, ["socket", ascii(line[:200])])


def waits(line):
    """Commands whose answer comes at the end of a motion, or at the next step of a proof."""
    try:
        command = json.loads(line)
        return isinstance(command, dict) and command.get("command") in (
            "calibrate", "pluck", "home", "prove-switches", "tare", "zero")
    except (ValueError, RecursionError):
        return False


def judge_answer(answer):
    said = []
    if wrong := judge.unprintable(answer):
        said.append(f"the answer: {wrong}")
    if raw := judge.RAW.search(answer):
        said.append(f"the answer has the raw text '{raw.group().decode()}'")
    try:
        if not isinstance(json.loads(answer), dict):
            said.append("the answer is not an object")
    except ValueError:
        said.append(f"the answer is not JSON: {answer[:100]!r}")
    return said


class FalseDaemon:
    """Answers every connection with the same bytes."""

    def __init__(self, path, answer):
        self.answer = answer
        self.listening = socket.socket(socket.AF_UNIX)
        self.listening.bind(str(path))
        self.listening.listen()
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def serve(self):
        while True:
            try:
                client, _ = self.listening.accept()
            except OSError:
                return
            with client:
                try:
                    client.settimeout(20)
                    client.recv(65536)
                    client.sendall(self.answer)
                except OSError:
                    pass

    def end(self):
        self.listening.shutdown(socket.SHUT_RDWR)
        self.listening.close()
        self.thread.join()


def false_answer(trial):
    """A changed answer to `flexarm status` is printed or refused."""
    with trial.programs.lock:
        if not hasattr(trial.programs, "status"):
            with Daemon(trial.programs, trial.programs.folder / "true-daemon") as daemon:
                daemon.settle()
                trial.programs.status = daemon.ask(b'{"command": "status"}')
    good = trial.programs.status
    kind = trial.chosen.random()
    change = (mutate.in_json if kind < 0.6 else mutate.in_bytes if kind < 0.8 else mutate.in_numbers)
    answer = mutate.nested(trial.chosen) if kind > 0.97 else change(trial.chosen, good.rstrip(b"\n"))
    if trial.chosen.random() < 0.9:
        answer = answer.replace(b"\n", b" ") + b"\n"
    false = FalseDaemon(trial.folder / "socket", answer)
    verb = trial.chosen.choice((("status",), ("status",), ("status", "--json"), ("stop",)))
    trial.write("answer", answer)
    trial.flexarm(*verb, "--socket", "socket")
    false.end()


KINDS = {
    "experiment-to-daemon": experiment_to_daemon,
    "socket-commands": socket_command,
    "false-answers": false_answer,
}
