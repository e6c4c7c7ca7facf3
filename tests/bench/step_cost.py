#!/usr/bin/env python3
"""Counts the instructions of every call of ControlStep::Step with callgrind, for every law and
estimator. Exit 1 above the limit.

Counts do not depend on how busy the machine is, so they can be a gate where times cannot.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FUNCTION = "flexarm::CountedStep(flexarm::ControlStep&, flexarm::StepInput const&)"


def count(program):
    """Instructions of each call, in order, by variant."""
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
        variants = re.findall(r"^variant (\S+)", result.stdout, re.M)
        counts = []
        for part in sorted(Path(folder).glob("out.*"), key=lambda p: int(p.name.split(".")[1])):
            totals = re.search(r"^totals: (\d+)", part.read_text(encoding="utf-8"), re.M)
            if totals and int(totals.group(1)) > 0:
                counts.append(int(totals.group(1)))
    if len(counts) != steps * len(variants) or not counts:
        raise SystemExit(f"step_cost: {steps} steps of {len(variants)} variants ran, {len(counts)}"
                         f" were seen; has the name {FUNCTION} changed?")
    return {name: counts[i * steps:(i + 1) * steps] for i, name in enumerate(variants)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="step_instructions")
    parser.add_argument("--limit", type=int, required=True, help="instructions of the dearest call")
    parser.add_argument("--note", type=Path, help="write the result here too, on one line")
    arguments = parser.parse_args()
    counts = count(arguments.program)
    for name, of_variant in counts.items():
        print(f"  {name:<16} {sum(of_variant) // len(of_variant):6} on average,"
              f" {max(of_variant):6} at most")
    dearest = max(counts, key=lambda name: max(counts[name]))
    worst = max(counts[dearest])
    text = (f"{len(counts)} laws and estimators, {worst} instructions at most, with {dearest}"
            f" (limit {arguments.limit})")
    print(text)
    if arguments.note:
        arguments.note.write_text(text + "\n", encoding="utf-8")
    return 1 if worst > arguments.limit else 0


if __name__ == "__main__":
    sys.exit(main())
