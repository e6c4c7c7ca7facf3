"""Runs a program under callgrind and counts the instructions of every call of Counted
(tests/bench/counted.h), and of the functions that are called in it."""

import os
import re
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Call:
    """One call of Counted."""
    instructions: int
    callees: dict[str, int] = field(default_factory=dict)  # name: instructions, with its own callees


COUNTED = "flexarm::Counted(flexarm::CountedWork const&)"  # tests/bench/counted.h


# The dynamic linker resolves all names at the start: otherwise the first call of each would pay.
ENVIRONMENT = {**os.environ, "LD_BIND_NOW": "1"}


def options(output):
    """Arguments of valgrind that write a profile to OUTPUT.1, .2, .. after every call of Counted:
    each holds what was collected since the one before."""
    return ["valgrind", "--tool=callgrind", f"--callgrind-out-file={output}",
            "--collect-atstart=no", f"--toggle-collect={COUNTED}", f"--dump-after={COUNTED}"]


def read_call(text, names):
    """The call of one profile. Each name is in the first profile that has it; `names` keeps it."""
    total = re.search(r"^(?:summary|totals): (\d+)", text, re.M)
    if not total or int(total.group(1)) == 0:
        return None
    call = Call(int(total.group(1)))
    callee = None
    is_cost = False
    for line in text.splitlines():
        if line.startswith(("fn=", "cfn=")):
            number, _, name = line.partition("=")[2].partition(" ")
            if name:
                names[number] = name
            if line[0] == "c":
                callee = names[number]
        elif line.startswith("calls="):
            is_cost = not line.startswith("calls=0 ")
        elif is_cost:
            call.callees[callee] = call.callees.get(callee, 0) + int(line.split()[-1])
            is_cost = False
    return call


def run(program):
    """Standard output of the program, and every call in order."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "out"
        result = subprocess.run([*options(output), str(program)], env=ENVIRONMENT,
                                capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise SystemExit(f"{program}: valgrind failed:\n{result.stderr}")
        names = {}
        parts = sorted(Path(folder).glob("out.*"), key=lambda part: int(part.name.split(".")[1]))
        calls = [read_call(part.read_text(encoding="utf-8"), names) for part in parts]
        return result.stdout, [call for call in calls if call]
