#!/usr/bin/env python3
"""The verb that judges the machine: check-host."""

import json
import os
import platform
import subprocess
import sys
import unittest

from program import BIN, HIL, ROOT, ProgramTest

WIRED = ROOT / "config/hil-wire.toml"


def as_stranger(*command):
    """A user without permissions for real time; only root may become one."""
    return ["prlimit", "--rtprio=0", "--", "setpriv", "--reuid=65534", "--clear-groups",
            "--bounding-set=-all", *map(str, command)]


class CheckHost(ProgramTest):
    def checks(self, *arguments):
        """The checks by name; verdict and exit status must follow from them."""
        result = self.run_program("flexarm", "check-host", *arguments, "--json")
        told = json.loads(result.stdout)
        failed = [c["name"] for c in told["checks"] if not c["ok"] and not c["advice"]]
        self.assertEqual(told["verdict"], "not-ready" if failed else "ready")
        self.assertEqual(result.returncode, 1 if failed else 0)
        for check in told["checks"]:
            self.assertEqual(set(check), {"name", "ok", "advice", "value", "required", "remedy"})
            self.assertTrue(check["value"] and check["required"], check)
            self.assertEqual(check["ok"], not check["remedy"], check)
        return {check["name"]: check for check in told["checks"]}

    def test_it_judges_this_machine(self):
        checks = self.checks()
        self.assertEqual(checks["preempt-rt"]["value"], platform.version())
        self.assertIs(checks["preempt-rt"]["ok"], "PREEMPT_RT" in platform.version())
        self.assertEqual([name for name in checks if ":" in name], [], "no rig was given")

    def test_with_a_wired_rig_it_names_what_the_buses_lack(self):
        checks = self.checks("-c", WIRED)
        if not os.path.exists("/sys/class/net/vcan0"):
            self.assertIn("unknown", checks["can-queue:vcan0"]["value"])
            self.assertIn("missing", checks["interrupts:vcan0"]["value"])
        self.assertIs(checks["clock-steps"]["advice"], True)

    def test_the_simulated_rig_needs_no_bus(self):
        self.assertEqual(self.checks("-c", HIL).keys(), self.checks().keys())

    def test_the_text_names_the_remedy_and_ends_with_the_verdict(self):
        result = self.run_program("flexarm", "check-host", "-c", WIRED)
        failed = result.returncode == 1
        self.assertEqual("FAILED" in result.stdout, failed)
        self.assertEqual("remedy: " in result.stdout, failed or "advice " in result.stdout)
        self.assertEqual(result.stdout.splitlines()[-1],
                         "verdict: " + ("not-ready" if failed else "ready"))

    def test_a_user_without_permissions_is_told_so(self):
        if os.geteuid() != 0:
            self.skipTest("dropping a permission needs root")
        result = subprocess.run(as_stranger(BIN / "flexarm", "check-host", "--json"), cwd="/",
                                capture_output=True, text=True, timeout=60, check=False)
        if result.returncode == 126 or not result.stdout:
            self.skipTest("another user cannot enter the build folder")
        checks = {check["name"]: check for check in json.loads(result.stdout)["checks"]}
        self.assertIs(checks["fifo-priority"]["ok"], False)
        self.assertIn("RLIMIT_RTPRIO is 0", checks["fifo-priority"]["value"])
        self.assertEqual(result.returncode, 1)

    def test_bad_usage_is_refused(self):
        self.assert_refused(self.run_program("flexarm", "check-host", "--wrong"), "--wrong")
        self.assert_refused(self.run_program("flexarm", "check-host", "-c", self.folder / "none"),
                            "none")
        self.assert_refused(self.run_program("flexarm", "check-host", "--set", "a.b=1"), "--config")


if __name__ == "__main__":
    sys.exit(unittest.main())
