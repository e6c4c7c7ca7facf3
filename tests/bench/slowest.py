#!/usr/bin/env python3
"""Searches the slowest control step, safety tick and plan, by the instructions that callgrind
counts, or counts those that a search has found (tests/bench/slowest.txt). Exit 1 if one takes more
than 1.3 times the instructions of the stored one, or more than three times the median of undisturbed
inputs where the stored one does not.

The same seed and program find the same inputs.
"""

import argparse
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import callgrind

STORED = Path(__file__).parent / "slowest.txt"
MARGIN = 1.3  # for another compiler: as in budgets.toml
AIM = 3.0  # times the median, for all whose stored candidate keeps to it


def lines_of(program, words):
    """Lines that slowest_step prints under callgrind."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "out"
        result = subprocess.run(
            [*callgrind.options(output), str(program), str(output), *words],
            env=callgrind.ENVIRONMENT, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise SystemExit(f"slowest: slowest_step {' '.join(words)} failed:\n{result.stderr}")
    return result.stdout.splitlines()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=Path, required=True, help="slowest_step")
    parser.add_argument("--names", nargs="+", default=[""], help="parts of the scenarios' names, each"
                        " searched by its own process")
    parser.add_argument("--search", type=int, help="candidates of a scenario; without: the stored")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--store", action="store_true", help="replace the stored candidates")
    parser.add_argument("--note", type=Path, help="write the result here too, on one line")
    arguments = parser.parse_args()

    def lines_with(names):
        if arguments.search:
            return lines_of(arguments.program,
                            ["search", names, str(arguments.seed), str(arguments.search)])
        return lines_of(arguments.program, ["check", names, str(STORED)])

    with ThreadPoolExecutor(arguments.jobs) as pool:
        lines = [line for part in pool.map(lines_with, arguments.names) for line in part]
    if not lines:
        raise SystemExit("slowest: no scenario has such a name")
    found = {line.split()[0]: line for line in lines}
    stored = {line.split()[0]: line for line in STORED.read_text(encoding="utf-8").splitlines()}
    if arguments.store:
        STORED.write_text("".join(f"{line}\n" for line in (stored | found).values()),
                          encoding="utf-8")
    ratios, errors = {}, []
    for name, line in found.items():
        instructions, median = (int(word) for word in line.split()[1:3])
        ratios[name] = instructions / median
        print(f"  {name:<24} {instructions:9} at most, {median:9} in the median:"
              f" {ratios[name]:.2f} times")
        if name not in stored:
            errors.append(f"{name} has no stored candidate")
            continue
        before, its_median = (int(word) for word in stored[name].split()[1:3])
        limit = MARGIN * before
        if before <= AIM * its_median:
            limit = min(limit, AIM * median)
        if instructions > limit:
            errors.append(f"{name}: {instructions} instructions, more than {int(limit)}")
    worst = max(ratios, key=ratios.get)
    text = f"slowest of {len(ratios)}: {worst}, {ratios[worst]:.2f} times its median"
    print(text)
    if arguments.note:
        arguments.note.write_text(text + "\n", encoding="utf-8")
    for error in errors:
        print(f"slowest: {error}", file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
