#!/usr/bin/env python3
"""Prints how much of the system the installed unit leaves exposed, by `systemd-analyze security`: as
shipped, and with the drop-in files for rigs. Exit 1 if one exceeds the limit.

usage: exposure.py FOLDER      of flexarmd.service; its drop-in files are in share/flexarm/systemd
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MOST = 2.1
RIGS = {"as shipped": [], "a rig with CAN": ["can.conf"],
        "a rig with CAN and Modbus/TCP": ["can.conf", "modbus-tcp.conf"],
        "a rig with telemetry": ["telemetry.conf"]}


def exposure(unit, drop_ins):
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(unit, folder)
        extra = Path(folder, unit.name + ".d")
        extra.mkdir()
        for file in drop_ins:
            shutil.copy(file, extra)
        result = subprocess.run(
            ["systemd-analyze", "security", "--offline=true", "--no-pager", Path(folder, unit.name)],
            env={**os.environ, "SYSTEMD_UNIT_PATH": folder}, capture_output=True, text=True, check=True)
    return float(re.search(r"Overall exposure level.*: ([0-9.]+)", result.stdout).group(1)), result.stdout


def main():
    root = Path(sys.argv[1])
    unit, = root.rglob("systemd/system/flexarmd.service")
    shared, = root.rglob("share/flexarm/systemd")
    failed = False
    for rig, names in RIGS.items():
        found, report = exposure(unit, [shared / name for name in names])
        print(f"exposure of the unit, {rig}: {found}, at most {MOST}")
        if found > MOST:
            print("\n".join(line for line in report.splitlines() if "✗" in line))
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
