#!/usr/bin/env python3
"""tools/run-hil as a user calls it: the experiment runs to its end and leaves log and picture."""

import subprocess
import sys
import unittest

from program import ROOT, ProgramTest, despite_stalls, realtime_permitted

PNG = b"\x89PNG\r\n\x1a\n"


class RunHil(ProgramTest):
    @despite_stalls
    def test_the_experiment_runs_to_its_end_and_leaves_log_and_picture(self):
        options = [] if realtime_permitted() else ["--without-realtime"]
        result = subprocess.run([ROOT / "tools/run-hil", "--log-dir", self.folder / "runs", *options],
                                capture_output=True, text=True, check=False)
        print(result.stdout, file=sys.stderr)
        self.assertEqual(result.returncode, 0, f"{result.stdout}\n{result.stderr}")
        pictures = [picture.read_bytes() for picture in (self.folder / "runs").glob("*.png")]
        self.assertEqual([picture[:len(PNG)] for picture in pictures], [PNG])
        self.assertEqual(len(list((self.folder / "runs").glob("*.flexarm"))), 1)


if __name__ == "__main__":
    sys.exit(unittest.main())
