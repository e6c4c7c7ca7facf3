#!/usr/bin/env python3
"""Gives changed inputs of every kind to the programs. None may crash one, hang it, make it print a
library's text or an unprintable byte, change an input, end with a code outside the contract, take 1 GB,
or be refused without its name. Exit 1 if one does.

The same seed makes the same inputs. A bad one is named with the command that repeats it alone.
"""

import argparse
import collections
import os
import random
import resource
import shutil
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import kinds_daemon
import kinds_files
import kinds_logs
from inputs import ROOT, Programs
from trial import Trial

KINDS = {**kinds_files.KINDS, **kinds_logs.KINDS, **kinds_daemon.KINDS}
# Parts of the inputs, as in the review of every kind: what is read most is changed most.
PARTS = {
    "config-structure": 10, "config-numbers": 10, "config-accepted": 5, "special-files": 4,
    "experiment-structure": 7, "experiment-numbers": 5, "trajectory": 5, "csv": 6, "gains": 6,
    "calibration": 5, "arguments": 6, "log-bytes": 12, "log-flipped-bit": 6, "log-made-to-hurt": 4,
    "sweep-results": 5, "experiment-to-daemon": 6, "socket-commands": 14, "false-answers": 6,
}
SHOWN = 40  # findings


def shares(kinds, inputs):
    """How many inputs of each kind, in proportion, and one at least."""
    whole = sum(PARTS[kind] for kind in kinds)
    return {kind: max(1, round(inputs * PARTS[kind] / whole)) for kind in kinds}


class Campaign:
    def __init__(self, options, programs):
        self.options = options
        self.programs = programs
        self.bad = []
        self.counts = collections.Counter()
        self.bad_counts = collections.Counter()
        self.seconds = collections.Counter()

    def try_one(self, kind, number):
        """Its folder is kept if it is bad and --keep was given."""
        folder = Path(tempfile.mkdtemp(prefix=f"{kind}-{number}-", dir=self.programs.folder))
        trial = Trial(random.Random(f"{self.options.seed}/{kind}/{number}"), folder, self.programs)
        began = time.monotonic()
        KINDS[kind](trial)
        self.counts[kind] += 1
        self.seconds[kind] += time.monotonic() - began
        if trial.found:
            self.bad_counts[kind] += 1
            self.bad.append((kind, number, trial.found))
            if self.options.keep:
                shutil.copytree(folder, self.options.keep / f"{kind}-{number}", symlinks=True,
                                ignore=shutil.ignore_patterns("socket", "special.*"))
        shutil.rmtree(folder, ignore_errors=True)

    def run(self):
        work = [(kind, number) for kind, share in shares(self.options.kinds, self.options.inputs).items()
                for number in range(share)]
        random.Random(self.options.seed).shuffle(work)
        with ThreadPoolExecutor(self.options.jobs) as pool:
            for done in [pool.submit(self.try_one, *each) for each in work]:
                done.result()

    def report(self):
        print(f"{'kind':22} {'inputs':>7} {'bad':>5} {'s':>6}")
        for kind in self.options.kinds:
            print(f"{kind:22} {self.counts[kind]:7} {self.bad_counts[kind]:5} {self.seconds[kind]:6.0f}")
        for kind, number, found in sorted(self.bad)[:SHOWN]:
            print(f"\n{kind} {number}: repeat with\n  tests/mutation/mutation_test.py --seed "
                  f"{self.options.seed} --only {kind} {number} --keep FOLDER")
            for text in found:
                print(f"    {text}")
        if len(self.bad) > SHOWN:
            print(f"\n.. and {len(self.bad) - SHOWN} more")
        largest_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024
        return (f"seed {self.options.seed}: {sum(self.counts.values())} inputs of "
                f"{len(self.options.kinds)} kinds, {len(self.bad)} bad; {largest_mb} MB at most")


def read_options():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=Path, help="folder of the programs",
                        default=Path(os.environ.get("FLEXARM_BIN", ROOT / "build/release/bin")))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--inputs", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS), metavar="KIND")
    parser.add_argument("--without", nargs="+", choices=KINDS, default=[], metavar="KIND")
    parser.add_argument("--only", nargs=2, metavar=("KIND", "NUMBER"), help="one input alone")
    parser.add_argument("--keep", type=Path, help="folder for the files of bad inputs")
    parser.add_argument("--note", type=Path, help="file for the last line of the report")
    options = parser.parse_args()
    options.kinds = [kind for kind in options.kinds if kind not in options.without]
    return options


def main():
    options = read_options()
    with tempfile.TemporaryDirectory(prefix="flexarm-mutation-") as folder:
        campaign = Campaign(options, Programs(options.bin, Path(folder)))
        try:
            if options.only:
                options.kinds = [options.only[0]]
                campaign.try_one(options.only[0], int(options.only[1]))
            else:
                campaign.run()
        finally:
            kinds_daemon.end_daemons()
        summary = campaign.report()
    print(summary)
    if options.note:
        options.note.write_text(summary + "\n", encoding="utf-8")
    return 1 if campaign.bad else 0


if __name__ == "__main__":
    sys.exit(main())
