#!/usr/bin/env python3
"""Records a run with every control law on one processor, and replays them on this and on another.

usage: replays.py record PROGRAM PROCESSOR FOLDER    writes FOLDER/PROCESSOR-LAW.flexarm
       replays.py replay PROGRAM PROCESSOR FOLDER    replays every log in FOLDER

PROGRAM is flexarm, with its emulator if it needs one; PROCESSOR is the name of the one that it runs
on. Replay must be bit exact on the same processor. On another one `flexarm replay` must accept the
difference. Prints a line for each log, then the largest differences; exit 1 if a replay fails.
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXPERIMENTS = ROOT / "config/experiments"
RUNS = {
    "benchmark-square": ["sobel", "sobel-thesis", "sobel-original", "lqr-cgt", "lqr-um", "lqg", "pd", "pd-zv",
                         "pd-zvd"],
    "benchmark-waypoints": ["gain-scheduled", "receding-horizon"],
}


def record(program, processor, folder):
    for experiment, laws in RUNS.items():
        for law in laws:
            run = subprocess.run(
                [*program, "simulate", "-c", ROOT / "config/hil.toml", "--controller", law,
                 "--experiment", EXPERIMENTS / f"{experiment}.toml",
                 "-o", folder / f"{processor}-{law}.flexarm"],
                check=False, stdout=subprocess.DEVNULL)
            if run.returncode not in (0, 1):  # 1: lqr-um trips, which replays like any other run
                sys.exit(f"{law}: flexarm simulate ended with {run.returncode}")


def replay(program, processor, folder):
    logs = sorted(folder.glob("*.flexarm"))
    failed = [] if logs else ["no log"]
    estimate = torque_nm = 0.0
    for log in logs:
        run = subprocess.run([*program, "replay", log, "--json"], check=False, capture_output=True,
                             text=True)
        told = json.loads(run.stdout) if run.stdout else {"error": run.stderr}
        print(log.stem, {key: told.get(key) for key in (
            "ticks", "bit_exact", "first_different_tick", "estimate_difference",
            "max_torque_difference_nm")})
        own = log.name.startswith(processor + "-")
        if run.returncode != 0 or (own and not told["bit_exact"]):
            print(run.stderr)
            failed.append(log.stem)
            continue
        estimate = max(estimate, told["estimate_difference"])
        torque_nm = max(torque_nm, *told["max_torque_difference_nm"])
    print(f"{len(logs)} logs replayed on {processor}: the estimate differs by {estimate:.1e} of a "
          f"state's largest value, the torque by {torque_nm:.1e} N m")
    if failed:
        sys.exit("FAILED: " + ", ".join(failed))


def main():
    if len(sys.argv) != 5 or sys.argv[1] not in ("record", "replay"):
        sys.exit(__doc__)
    verb = record if sys.argv[1] == "record" else replay
    verb(sys.argv[2].split(), sys.argv[3], Path(sys.argv[4]))


if __name__ == "__main__":
    main()
