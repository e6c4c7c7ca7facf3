#!/usr/bin/env python3
"""Counts the instructions of every call of ControlStep::Step with callgrind, for every law and
estimator. Exit 1 if one takes more than tests/support/step_variants.h allows.

Counts do not depend on the load of the machine, so a test can limit them, unlike times.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FUNCTION = "flexarm::CountedStep(flexarm::ControlStep&, flexarm::StepInput const&)"


def count(program):
    """Instructions of each call, in order, and their limit, by variant."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "out"
        # One profile a call: each holds what was collected since the one before.
        result = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={output}", "--collect-atstart=no",
             f"--toggle-collect={FUNCTION}", f"--dump-after={FUNCTION}", str(program)],
            capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise SystemExit(f"step_cost: valgrind failed:\n{result.stderr}")
        steps = int(re.search(r"^steps (\d+)", result.stdout, re.M).group(1))
        variants = re.findall(r"^variant (\S+) at most (\d+)", result.stdout, re.M)
        counts = []
        for part in sorted(Path(folder).glob("out.*"), key=lambda p: int(p.name.split(".")[1])):
            totals = re.search(r"^totals: (\d+)", part.read_text(encoding="utf-8"), re.M)
            if totals and int(totals.group(1)) > 0:
                counts.append(int(totals.group(1)))
    if len(counts) != steps * len(variants) or not counts:
        raise SystemExit(f"step_cost: {steps} steps of {len(variants)} variants ran, {len(counts)}"
                         f" were seen; has the name {FUNCTION} changed?")
    return {name: (counts[i * steps:(i + 1) * steps], int(most))
            for i, (name, most) in enumerate(variants)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="step_instructions")
    parser.add_argument("--note", type=Path, help="write the result here too, on one line")
    arguments = parser.parse_args()
    counts = count(arguments.program)
    dearest = {}  # of those with the same limit
    for name, (of_variant, most) in counts.items():
        print(f"  {name:<16} {sum(of_variant) // len(of_variant):7} on average,"
              f" {max(of_variant):7} at most (limit {most})")
        dearest[most] = max(dearest.get(most, (0, "")), (max(of_variant), name))
    text = f"instructions at most, of {len(counts)} laws and estimators: " + ", ".join(
        f"{worst} with {name} (limit {most})" for most, (worst, name) in dearest.items())
    print(text)
    if arguments.note:
        arguments.note.write_text(text + "\n", encoding="utf-8")
    return 1 if any(worst > most for most, (worst, _) in dearest.items()) else 0


if __name__ == "__main__":
    sys.exit(main())
