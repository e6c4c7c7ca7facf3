#!/usr/bin/env python3
"""A large campaign of `flexarm torture`, in shards of many seeds, with a line of results each.

Lines that are there already are kept, so a campaign that was stopped goes on with the same command;
all lines of a file must be of one build. Exit code 1 if a session broke a rule.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def read(path):
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    return {line["last_seed"]: line for line in map(json.loads, lines)}


def build_of(program):
    shown = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    return shown.stdout.partition("(")[2].partition(")")[0]


def write(path, lines):
    new = path.with_suffix(".new")
    new.write_text("".join(json.dumps(lines[i]) + "\n" for i in sorted(lines)), encoding="utf-8")
    new.replace(path)


def run(program, config, jobs, seeds):
    begin = time.monotonic()
    result = subprocess.run([program, "torture", "-c", config, "--seeds", seeds, "--jobs", str(jobs),
                             "--json"], stdout=subprocess.PIPE, text=True, check=False)
    if result.returncode > 1:
        sys.exit(f"shards: {program} torture --seeds {seeds} ended with {result.returncode}")
    return json.loads(result.stdout) | {"wall_s": round(time.monotonic() - begin)}


def tell(lines):
    def total(key):
        return sum(line[key] for line in lines.values())

    def most(key):
        return max(line[key] for line in lines.values())

    broken = [failure for line in lines.values() for failure in line["failures"]]
    print(f"build {', '.join(sorted({line['build'] for line in lines.values()}))}")
    print(f"{total('scenarios')} sessions, {total('simulated_s') / 3600:.1f} h simulated, "
          f"{total('without_fault')} without a fault, {total('observable')} with one to be named in "
          f"time, {total('tripped')} tripped, {total('replayed_steps')} steps replayed")
    print("largest share of its limit: " + ", ".join(
        f"{name} {most(f'peak_{name}_share'):.2f}" for name in ("torque", "angle", "rate", "strain")))
    print(f"{len(broken)} sessions broke a rule")
    for failure in broken:
        print(f"  seed {failure['seed']}: {failure['rule']}: {failure['what']}")
    return 1 if broken else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("lines", type=Path, help="file of results, a JSON object a line")
    parser.add_argument("--program", default=str(ROOT / "build/release/bin/flexarm"))
    parser.add_argument("--config", default=str(ROOT / "config/hil.toml"))
    parser.add_argument("--shards", type=int, default=50, help="run 1 .. N; 0: only sum up the file")
    parser.add_argument("--size", type=int, default=20_000, help="seeds of a shard")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    lines = read(arguments.lines)
    if arguments.shards > 0 and lines:
        own, others = build_of(arguments.program), {line["build"] for line in lines.values()}
        if others != {own}:
            sys.exit(f"shards: {arguments.lines} is of build {', '.join(sorted(others))}, the program "
                     f"of {own}: begin another file")
    for shard in range(1, arguments.shards + 1):
        last = shard * arguments.size
        if last in lines:
            continue
        lines[last] = run(arguments.program, arguments.config, arguments.jobs,
                          f"{last - arguments.size + 1}..{last}")
        write(arguments.lines, lines)
        print(f"shard {shard}: {lines[last]['wall_s']} s, {len(lines[last]['failures'])} broke a rule",
              flush=True)
    return tell(lines) if lines else 0


if __name__ == "__main__":
    sys.exit(main())
