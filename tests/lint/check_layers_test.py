#!/usr/bin/env python3
"""Breaks each rule of tools/lint/check_layers.py once, in a small tree of its own."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHECKER = ROOT / "tools/lint/check_layers.py"
NOTE = "TO" + "DO"  # so that this file passes its own rule

# A tree that breaks nothing; every case below replaces or adds one file.
GOOD = {
    "model/problem.h": "#pragma once\n",
    "model/beam.h": """#pragma once

#include <cmath>

namespace flexarm {

/// A uniform beam.
struct Beam {
  double length_m;
  double stiffness_nm_per_rad;
  double ratio;  ///< of critical damping
};

/// Natural frequency number `mode`, 1-based.
double FrequencyHz(const Beam& beam, int mode);

}  // namespace flexarm
""",
    "hal/frame.h": '#pragma once\n\n#include "model/problem.h"\n',
    "hal/sim/rig.h": '#pragma once\n\n#include "hal/frame.h"\n#include "model/beam.h"\n',
    "estimator/state_estimator.cpp": '#include "hal/frame.h"\n\nint Half(int x) { return x / 2; }\n',
    "controller/safety/safety_state.h": "#pragma once\n",
    "controller/safety/gate.h": "#pragma once\n",
    "controller/runtime/task.h": "#pragma once\n",
    "controller/law/step.h": '#pragma once\n\n#include "controller/safety/safety_state.h"\n',
    "controller/runlog/log.cpp": "#include <mutex>  // this folder is not real time\n",
    "config/config.cpp": '#include "controller/law/step.h"\n',
    "tools/flexarm.cpp": '#include "config/config.cpp"\n#include <iostream>\n',
    "tests/model/beam_test.cpp": '#include "model/beam.h"\n',
}

LONG_FUNCTION = "int Long(int x) {\n" + "  ++x;\n" * 61 + "  return x;\n}\n"

# name -> (file, content, rule that must object, on which line)
BROKEN = {
    "model uses the controller":
        ("model/a.cpp", '#include "controller/law/step.h"\n', "layers", 1),
    "model uses the hal": ("model/a.cpp", '\n#include "hal/frame.h"\n', "layers", 2),
    "the hal's interface uses a backend": ("hal/a.h", '#include "hal/sim/rig.h"\n', "layers", 1),
    "the hal's interface uses the model": ("hal/a.h", '#include "model/beam.h"\n', "layers", 1),
    "the estimator uses a backend": ("estimator/a.h", '#include "hal/sim/rig.h"\n', "layers", 1),
    "the estimator uses the controller":
        ("estimator/a.h", '#include "controller/law/step.h"\n', "layers", 1),
    "the law uses the gate": ("controller/law/a.h", '#include "controller/safety/gate.h"\n', "layers", 1),
    "the law uses a task": ("controller/law/a.h", '#include "controller/runtime/task.h"\n', "layers", 1),
    "safety uses the law": ("controller/safety/a.h", '#include "controller/law/step.h"\n', "layers", 1),
    "the controller uses the config": ("controller/a.h", '#include "config/config.cpp"\n', "layers", 1),
    "the config uses a tool": ("config/a.h", '#include "tools/flexarm.cpp"\n', "layers", 1),
    "a product uses the tests": ("tools/a.cpp", '#include "tests/model/beam_test.cpp"\n', "layers", 1),
    "an include from beside the file": ("model/a.cpp", '#include "beam.h"\n', "layers", 1),
    "a lock in the safety task":
        ("controller/runtime/safety_task.cpp", "#include <mutex>\n", "realtime", 1),
    "a log line in the model": ("model/a.cpp", 'void F() { spdlog::info("x"); }\n', "realtime", 1),
    "a stream in the estimator": ("estimator/a.cpp", "#include <iostream>\n", "realtime", 1),
    "a clock in the law": ("controller/law/a.cpp", "#include <chrono>\n", "realtime", 1),
    "printing in the simulated rig": ("hal/sim/a.cpp", '\nvoid F() { printf("x"); }\n', "realtime", 2),
    "a sine in the step":
        ("estimator/state_estimator.cpp", "double S(double x) { return std::sin(x); }\n", "libm", 1),
    "a hyperbolic tangent in the law that finds the payload":
        ("controller/law/scheduled_law.cpp", "double T(double x) { return std::tanh(x); }\n", "libm", 1),
    "an endless file": ("model/a.cpp", "// line\n" * 401, "file-size", 401),
    "an endless test": ("tests/a.cpp", "// line\n" * 601, "file-size", 601),
    "a to-do note": ("model/a.cpp", f"// {NOTE}: later\n", "leftover", 1),
    "a to-do note in a script": ("tools/a.py", f"# {NOTE}: later\n", "leftover", 1),
    "a double without a unit":
        ("model/a.h", "#pragma once\n\n/// A thing.\nstruct A {\n  double length;\n};\n", "unit", 5),
    "an array of doubles without a unit":
        ("model/a.h", "#pragma once\n\n/// A thing.\nstruct A {\n  std::array<double, 2> torque;\n};\n",
         "unit", 5),
    "a function without a comment":
        ("model/a.h", "#pragma once\n\ndouble Sum(double a, double b);\n", "comment", 3),
    "a class without a comment":
        ("model/a.h", "#pragma once\n\nclass A {\n  int x_;\n};\n", "comment", 3),
}


def check(files):
    """Writes the files into a fresh tree and checks it."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content, encoding="utf-8")
        return subprocess.run([sys.executable, CHECKER, "--root", folder],
                              capture_output=True, text=True, check=False)


class CheckLayers(unittest.TestCase):
    def test_accepts_a_tree_that_keeps_every_rule(self):
        result = check(GOOD)
        self.assertEqual((result.returncode, result.stdout),
                         (0, "check_layers: 0 errors, 0 warnings\n"), result.stderr)

    def test_objects_to_each_broken_rule_at_its_line_and_to_nothing_else(self):
        for name, (path, content, rule, line) in BROKEN.items():
            with self.subTest(name):
                result = check({**GOOD, path: content})
                findings = result.stdout.splitlines()[:-1]
                self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
                self.assertEqual(len(findings), 1, findings)
                self.assertTrue(findings[0].startswith(f"{path}:{line}: {rule}: "), findings[0])

    def test_warns_of_a_long_function_and_passes(self):
        result = check({**GOOD, "model/a.cpp": LONG_FUNCTION})
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertIn("model/a.cpp:1: warning: function: Long has 63 lines", result.stdout)

    def test_reads_neither_comments_nor_literals_as_code(self):
        result = check({**GOOD, "model/a.cpp": '// std::mutex\nconst char* kText = "std::cout";\n'})
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_refuses_a_folder_that_is_no_source_tree(self):
        self.assertEqual(check({"README.md": "x"}).returncode, 2)


if __name__ == "__main__":
    unittest.main()
