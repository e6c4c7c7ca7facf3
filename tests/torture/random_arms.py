#!/usr/bin/env python3
"""`flexarm torture` on arms drawn at random, each described to `flexarm config new`. An arm that
`config new` refuses is told and passed over. The same number draws the same arm. Exit code 1 if a
session broke a rule, or if no arm was left.
"""

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MODULUS_PA = 70e9  # aluminium


class Draw(random.Random):
    def across(self, low, high):
        """As many small values as great ones: uniform in the logarithm."""
        return math.exp(self.uniform(math.log(low), math.log(high)))


def link(draw, thickness_mm):
    """Length, width, thickness, and the torque that bends it by a radian."""
    length_m, width_mm = draw.across(0.2, 1.0), draw.uniform(20, 60)
    second_moment_m4 = width_mm * 1e-3 * (thickness_mm * 1e-3) ** 3 / 12
    return length_m, width_mm, thickness_mm, MODULUS_PA * second_moment_m4 / length_m


def arm(number):
    """Options of `flexarm config new`."""
    draw = Draw(number)
    shoulder_mm = draw.across(1.2, 4)
    links = [link(draw, shoulder_mm), link(draw, shoulder_mm * draw.uniform(0.5, 1))]
    shoulder_nm = max(0.3, links[0][3] * draw.uniform(0.1, 0.6))
    elbow_nm = min(links[1][3] * draw.uniform(0.1, 0.6), shoulder_nm * draw.uniform(0.15, 0.6))
    options = {
        "material": "aluminium",
        "elbow_mass_kg": draw.across(0.1, 1.5),
        "tip_mass_kg": draw.across(0.05, 1),
        "gauges_per_link": draw.choice([2, 3, 5, 10]),
        "rate_hz": draw.choice([50, 100, 200]),
    }
    for i, torque_nm in enumerate([shoulder_nm, max(0.1, elbow_nm)]):
        length_m, width_mm, thickness_mm, bending_nm = links[i]
        options |= {
            f"link{i + 1}.length_m": length_m,
            f"link{i + 1}.width_mm": width_mm,
            f"link{i + 1}.thickness_mm": thickness_mm,
            f"joint{i + 1}.torque_limit_nm": torque_nm,
            f"joint{i + 1}.encoder_counts_per_turn": draw.choice([4096, 8192, 20_000, 65_536]),
        }
        if draw.random() < 0.5:
            options[f"joint{i + 1}.rotor_encoder_counts_per_turn"] = draw.choice([2_000, 8_192])
        if draw.random() < 0.5:
            options[f"joint{i + 1}.coulomb_friction_nm"] = torque_nm * draw.across(0.003, 0.08)
        if draw.random() < 0.4:
            options[f"joint{i + 1}.stiffness_nm_per_rad"] = bending_nm * draw.across(20, 200)
    return [word for key, value in options.items()
            for word in (f"--{key}", f"{value:.4g}" if isinstance(value, float) else str(value))]


def torture(program, number, seeds, jobs, folder):
    """How many sessions broke a rule; None: there is no such arm."""
    config = folder / f"arm-{number}.toml"
    made = subprocess.run([program, "config", "new", "-o", config, "--overwrite", *arm(number)],
                          capture_output=True, text=True, check=False)
    if made.returncode != 0:
        reason = (made.stderr.strip() or made.stdout.strip()).splitlines()[-1]
        print(f"arm {number}: no config: {reason}", flush=True)
        return None
    result = subprocess.run([program, "torture", "-c", config, "--seeds", seeds, "--jobs", str(jobs),
                             "--json"], capture_output=True, text=True, check=False)
    if result.returncode > 1:
        sys.exit(f"random_arms: arm {number}: torture ended with {result.returncode}:\n{result.stderr}")
    told = json.loads(result.stdout)
    print(f"arm {number}: {told['scenarios']} sessions with {', '.join(told['laws'])}: "
          f"{told['tripped']} tripped, {len(told['failures'])} broke a rule", flush=True)
    for failure in told["failures"]:
        print(f"  seed {failure['seed']}: {failure['rule']}: {failure['what']}")
    return len(told["failures"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=str(ROOT / "build/release/bin/flexarm"))
    parser.add_argument("--first", type=int, default=1, help="number of the first arm")
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--seeds", default="1..150", help="of the sessions of each arm")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--configs", type=Path, help="keep the configs in this folder")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = arguments.configs or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        broken = [torture(arguments.program, number, arguments.seeds, arguments.jobs, folder)
                  for number in range(arguments.first, arguments.first + arguments.arms)]
    return 1 if any(broken) or all(count is None for count in broken) else 0


if __name__ == "__main__":
    sys.exit(main())
