#!/usr/bin/env python3
"""Counts the instructions of every call of ControlStep::Step with callgrind, for every law and
estimator, and of every phase of the loop. Exit 1 if a step takes more than
tests/support/step_variants.h allows, or a phase more than tests/bench/budgets.toml does.

Counts do not depend on the load of the machine, so a test can limit them, unlike times.
"""

import argparse
import re
import sys
import tomllib
from pathlib import Path

import callgrind

LOCKSTEP = "flexarm::LockstepExecutor::RunUntil(long)"
PLANT = ("flexarm::ArmSimulator::Step(flexarm::ArmState&, "
         "Eigen::Matrix<double, 2, 1, 0, 2, 1> const&, double)")
STEP = "flexarm::ControlStep::Step(flexarm::StepInput const&)"
BUDGETS = Path(__file__).parent / "budgets.toml"


def by_variant(output, calls):
    """Instructions of each step, in order, and their limit, by variant."""
    steps = int(re.search(r"^steps (\d+)", output, re.M).group(1))
    variants = re.findall(r"^variant (\S+) at most (\d+)", output, re.M)
    counts = [call.instructions for call in calls if STEP in call.callees and not is_second(call)]
    if len(counts) != steps * len(variants) or not counts:
        raise SystemExit(f"step_cost: {steps} steps of {len(variants)} variants ran, {len(counts)}"
                         f" were seen; has the name {STEP} changed?")
    return {name: (counts[i * steps:(i + 1) * steps], int(most))
            for i, (name, most) in enumerate(variants)}


def is_second(call):
    """True for a second of the lock-step run: a call in which functions are called many times."""
    return LOCKSTEP in call.callees


def dearest_calls(calls):
    """Most instructions of a function in a call, by its name without namespace and arguments. Of a
    second of the lock-step run: those of the plant, and those of all else."""
    most = {}
    for call in calls:
        seen = {}
        if is_second(call):
            plant = call.callees[PLANT]
            most["plant's second"] = max(most.get("plant's second", 0), plant)
            rest = call.instructions - plant
            most["rest of a second"] = max(most.get("rest of a second", 0), rest)
            continue
        for name, instructions in call.callees.items():
            plain = name.partition("(")[0]  # overloads and clones count as one function
            seen[plain] = max(seen.get(plain, 0), instructions)
        for name, instructions in seen.items():
            short = name.removeprefix("flexarm::")
            most[short] = max(most.get(short, 0), instructions)
    return most


def check_phases(calls):
    """Prints every phase. Returns what is wrong, a line each."""
    most = dearest_calls(calls)
    errors = []
    for phase, budget in tomllib.loads(BUDGETS.read_text(encoding="utf-8")).items():
        for function in budget["functions"]:
            if function not in most:
                errors.append(f"{phase}: no call of {function} was seen; was it renamed or inlined?")
        taken = max((most.get(function, 0) for function in budget["functions"]), default=0)
        ceiling = int(budget["most"] * budget["margin"])
        print(f"  {phase:<16} {taken:10} at most (ceiling {ceiling})")
        if taken > ceiling:
            errors.append(f"{phase}: {taken} instructions, more than the ceiling of {ceiling}")
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="step_instructions")
    parser.add_argument("--note", type=Path, help="write the result here too, on one line")
    arguments = parser.parse_args()
    output, calls = callgrind.run(arguments.program)
    counts = by_variant(output, calls)
    dearest = {}  # of those with the same limit
    for name, (of_variant, most) in counts.items():
        print(f"  {name:<16} {sum(of_variant) // len(of_variant):7} on average,"
              f" {max(of_variant):7} at most (limit {most})")
        dearest[most] = max(dearest.get(most, (0, "")), (max(of_variant), name))
    errors = check_phases(calls)
    text = f"instructions at most, of {len(counts)} laws and estimators: " + ", ".join(
        f"{worst} with {name} (limit {most})" for most, (worst, name) in dearest.items())
    print(text)
    if arguments.note:
        arguments.note.write_text(text + "\n", encoding="utf-8")
    errors += [f"{name}: a step of {worst} instructions, more than {most}"
               for most, (worst, name) in dearest.items() if worst > most]
    for error in errors:
        print(f"step_cost: {error}", file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
