"""Runs an experiment with steps of several sizes, and compares them: how far does joint 1 swing
beyond its target, in parts of the step?

It arms the arm, moves both joints out and back once for each size, disarms, and writes the hub
angle of joint 1 of all runs to series.csv; with Matplotlib also to series.png. An exception or
Ctrl-C stops the run under way.

    python3 series.py --steps-deg 5 10 15 --duration-s 4
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

import flexarm

AT_REST_S = 30.0  # the arm comes to rest within seconds

# A move out in the first half, and back in the second.
EXPERIMENT = """
name = "step-{step_deg:g}deg"
duration_s = {duration_s}

[[move]]
start_s = 0.0
duration_s = {move_s}
to_deg = [{step_deg}, {step_deg}]

[[move]]
start_s = {back_s}
duration_s = {move_s}
to_deg = [0.0, 0.0]
"""


def experiment(step_deg: float, duration_s: float) -> str:
    """Text of an experiment that begins and ends at 0 deg. A move takes a quarter of it."""
    return EXPERIMENT.format(step_deg=step_deg, duration_s=duration_s, move_s=duration_s / 4,
                             back_s=duration_s / 2)


def run_one(daemon: flexarm.Daemon, step_deg: float, duration_s: float) -> flexarm.RunData:
    daemon.wait_for(lambda status: status.state == "Armed" and status.at_rest, AT_REST_S)
    text = experiment(step_deg, duration_s)
    with daemon.run_text(text, name=f"{step_deg:g} deg", tags=("series",)) as run:
        run.wait()
        return run.data()


def run_series(daemon: flexarm.Daemon, steps_deg: list[float],
               duration_s: float) -> dict[float, flexarm.RunData]:
    """The data of a run by the size of its step."""
    daemon.wait_for(lambda status: status.state == "Idle" and status.at_rest, AT_REST_S)
    daemon.arm()
    runs = {step_deg: run_one(daemon, step_deg, duration_s) for step_deg in steps_deg}
    daemon.wait_for(lambda status: status.state == "Armed", AT_REST_S)
    daemon.disarm()
    return runs


def overshoot(data: flexarm.RunData, step_deg: float) -> float:
    """How far joint 1 swings beyond the step, in parts of it; negative: it does not reach it."""
    return float((data["hub_1_deg"] / step_deg).max()) - 1.0


def write_table(runs: dict[float, flexarm.RunData], file: Path) -> None:
    """The hub angle of joint 1 of each run, deg, in a row a sample from the begin of the run."""
    rows = min(len(data) for data in runs.values())
    first = next(iter(runs.values()))
    with open(file, "w", encoding="utf-8", newline="") as table:
        writer = csv.writer(table)
        writer.writerow(["time_s"] + [f"hub_1_of_{step:g}_deg" for step in runs])
        for i in range(rows):
            writer.writerow([repr(float(first["time_s"][i] - first["time_s"][0]))]
                            + [repr(float(data["hub_1_deg"][i])) for data in runs.values()])


def plot(runs: dict[float, flexarm.RunData], file: Path) -> bool:
    """Angle and reference of joint 1. @returns False: Matplotlib is not installed"""
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        return False
    figure, axes = pyplot.subplots()
    for step_deg, data in runs.items():
        time_s = data["time_s"] - data["time_s"][0]
        line, = axes.plot(time_s, data["hub_1_deg"], label=f"{step_deg:g} deg")
        axes.plot(time_s, data["reference_1_deg"], "--", color=line.get_color())
    axes.set(xlabel="time, s", ylabel="hub angle of joint 1, deg (dashed: reference)")
    axes.legend()
    figure.savefig(file)
    return True


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--socket", help="default: $FLEXARM_SOCKET, else the service's")
    parser.add_argument("--steps-deg", type=float, nargs="+", default=[5.0, 10.0, 15.0])
    parser.add_argument("--duration-s", type=float, default=4.0, help="of a run")
    parser.add_argument("--folder", type=Path, default=Path("."), help="of the results")
    options = parser.parse_args()
    try:
        with flexarm.connect(options.socket) as daemon:
            runs = run_series(daemon, options.steps_deg, options.duration_s)
    except flexarm.FlexarmError as error:
        print(f"series: {error}", *getattr(error, "__notes__", []), sep="\n", file=sys.stderr)
        return 1
    for step_deg, data in runs.items():
        print(f"{step_deg:g} deg: overshoot {100 * overshoot(data, step_deg):.1f} %, {data.file}")
    write_table(runs, options.folder / "series.csv")
    if not plot(runs, options.folder / "series.png"):
        print("no picture: Matplotlib is not installed; series.csv has the angles")
    return 0


if __name__ == "__main__":
    sys.exit(main())
