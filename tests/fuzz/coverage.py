#!/usr/bin/env python3
"""Prints for each target of fuzzing what its corpus and what fuzzing has discovered reach of the code
that reads its inputs: edges of the functions that are entered, and how many functions are not, among
which are those that the compiler has inlined everywhere."""

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

SYMBOLIZER = "/usr/lib/llvm-19/bin/llvm-symbolizer"  # of package llvm-19
ROOT = Path(__file__).resolve().parents[2]
SOURCES = {  # beginnings of the paths of a target's code
    "calibration": ("controller/commissioning/calibration_file", "controller/files/external_"),
    "can": ("hal/canopen/canopen_codec", "hal/canopen/canopen_d", "hal/canopen/canopen_re", "hal/canopen/confirmed",
            "hal/canopen/node_setup", "hal/canopen/sdo"),
    "client": ("controller/operator/operator_client", "tools/status/"),
    "comedi": ("hal/comedi/board_proof", "hal/comedi/comedi_device", "hal/comedi/daq_codec", "hal/comedi/scan_clock"),
    "config": ("config/", "controller/types/"),
    "csv": ("controller/runlog/csv",),
    "experiment": ("config/experiment_file", "controller/reference/"),
    "gains": ("controller/design/design_json",),
    "log": ("controller/runlog/re", "controller/runlog/run_", "controller/runlog/word_blocks"),
    "modbus": ("hal/modbus/modbus_device", "hal/modbus/modbus_link", "hal/modbus/modbus_value"),
    "socket": ("controller/operator/",),
    "telemetry": ("controller/telemetry/telemetry_line",),
}
FUNCTION = re.compile(r"COVERED_FUNC: hits: \d+ edges: (\d+)/(\d+) .* (\S+?):\d+$", re.M)


def edges_of(target, build, inputs):
    """Edges reached, all edges of functions that are entered, their number, and that of the others."""
    folders = [folder for folder in (inputs / target, ROOT / "tests/fuzz/corpus" / target,
                                     ROOT / "tests/fuzz/found" / target) if folder.exists()]
    done = subprocess.run([build / "tests/fuzz" / f"fuzz_{target}", "-runs=0", "-print_coverage=1", *folders],
                          capture_output=True, check=True,
                          env={"ASAN_SYMBOLIZER_PATH": SYMBOLIZER, **os.environ})
    reached = total = entered = others = 0
    for edges, of, file in FUNCTION.findall(done.stderr.decode(errors="replace")):
        path = os.path.relpath(os.path.normpath(file), ROOT)
        if not path.startswith(SOURCES[target]):
            continue
        if edges == "0":
            others += 1
            continue
        entered += 1
        reached += int(edges)
        total += int(of)
    return reached, total, entered, others


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--build", type=Path, default=ROOT / "build/fuzz")
    arguments.add_argument("--inputs", type=Path, default=ROOT / "build/fuzz/inputs",
                           help="what fuzzing has discovered, a folder for each target")
    arguments.add_argument("target", nargs="*", default=sorted(SOURCES))
    options = arguments.parse_args()
    for target in options.target:
        reached, total, entered, others = edges_of(target, options.build, options.inputs)
        print(f"{target:12} {reached:5} of {total:5} edges, {100 * reached / max(total, 1):3.0f} %, of {entered:3} "
              f"functions; {others} others", flush=True)
    return os.EX_OK


if __name__ == "__main__":
    sys.exit(main())
