#!/usr/bin/env python3
"""Runs the benchmarks for a few seconds each and reports the figures that the project guarantees.

Times on a shared machine are only reported. The only limit is the speed of the default experiment,
realtime_factor at least 100 (median of 5), which has a margin for other load on the machine.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

MIN_REALTIME_FACTOR = 100
PLAN_EVERY = 10  # controller.plan.every_periods


def run(program):
    """The figures of one benchmark program, by benchmark."""
    result = subprocess.run([program, "--benchmark_format=json", "--benchmark_min_time=0.1"],
                            stdout=subprocess.PIPE, text=True, check=True)
    benchmarks = json.loads(result.stdout)["benchmarks"]
    print(f"\n{program.name}")
    for b in benchmarks:
        unit = b["time_unit"]
        extra = "  ".join(f"{key} {value:.4g}" for key, value in b.items()
                          if key.endswith("_us") or key == "realtime_factor")
        name = f"{b['name']} {b.get('label', '')}"
        print(f"  {name:<42} {b['real_time']:10.3f} {unit}  {extra}")
    return {b["name"]: b for b in benchmarks}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, required=True, help="build folder")
    parser.add_argument("--note", type=Path, help="write the summary here, on one line")
    parser.add_argument("--min-realtime-factor", type=float, default=MIN_REALTIME_FACTOR)
    arguments = parser.parse_args()

    folder = arguments.build / "tests/bench"
    control = run(folder / "control_benchmark")
    run(folder / "model_benchmark")
    plan = run(folder / "planner_benchmark")
    steps = [b for name, b in control.items() if name.startswith("Step/")]
    payload = [b for b in steps
               if b["label"] == "sobel"
               or b["label"].startswith(("ekf-payload", "gain-scheduled", "receding-horizon"))]
    slowest = max((b for b in steps if b not in payload), key=lambda b: b["p99.9_us"])
    with_payload = max(payload, key=lambda b: b["p99.9_us"])
    thesis = next(b for b in steps if b["label"] == "sobel-thesis")
    planned = next(b for b in steps if b["label"] == "receding-horizon")
    per_sample = planned["p50_us"] + 1e3 * plan["Plan/warm:1"]["real_time"] / PLAN_EVERY
    factor, two_modes = (next(b for name, b in control.items() if name.startswith(
        f"SimulatedRun/modes:{modes}"))["realtime_factor"] for modes in (4, 2))
    text = (f"Step of {len(steps)} laws and estimators: p99.9 {slowest['p99.9_us']:.1f} us at most"
            f" ({slowest['label']}), with payload filter {with_payload['p99.9_us']:.0f} us"
            f" ({with_payload['p50_us'] / thesis['p50_us']:.0f} times sobel-thesis, medians);"
            f" a sample of receding-horizon {per_sample:.0f} us with its share of a plan"
            f" ({per_sample / thesis['p50_us']:.0f} times sobel-thesis), a first plan"
            f" {plan['Plan/warm:0']['real_time']:.1f} ms;"
            f" default experiment {factor:.0f} times real time"
            f" ({two_modes:.0f} with two modes a link)")
    print("\n" + text)
    if arguments.note:
        arguments.note.write_text(text + "\n", encoding="utf-8")
    if factor < arguments.min_realtime_factor:
        print(f"too slow: at least {arguments.min_realtime_factor:.0f} times is required",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
