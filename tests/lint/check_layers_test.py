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
    "model/beam/beam.h": """#pragma once

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
    "hal/sim/rig.h": '#pragma once\n\n#include "hal/frame.h"\n#include "model/problem.h"\n',
    "hal/sim/CMakeLists.txt": "flexarm_library(flexarm_hal_sim\n  HEADERS rig.h\n"
                              "  PUBLIC flexarm_model flexarm_hal Eigen3::Eigen)\n",
    "hal/canopen/node.h": "#pragma once\n",
    "estimator/state_estimator.cpp":
        '#include "hal/frame.h"\n\nstd::vector<int> v;\nvoid F() { v.reserve(2); }  // start-up\n',
    "controller/types/safety_state.h": "#pragma once\n",
    "controller/safety/torque_gate.h": "#pragma once\n",
    "controller/tasks/task.h": "#pragma once\n",
    "controller/law/law.h": '#pragma once\n\n#include "controller/types/safety_state.h"\n',
    "controller/runlog/log.cpp": "#include <mutex>  // this folder is not real time\n",
    "config/config.cpp": '#include "controller/types/safety_state.h"\n',
    "tools/runs/summary.h": "#pragma once\n",
    "tools/flexarm/main.cpp": '#include "tools/runs/summary.h"\n#include <iostream>\n',
    "tests/model/beam_test.cpp": '#include "model/beam/beam.h"\n',
}

LONG_FUNCTION = "int Long(int x) {\n" + "  ++x;\n" * 61 + "  return x;\n}\n"

# name -> (file, content, rule that must object, on which line)
BROKEN = {
    "model uses the controller":
        ("model/beam/a.cpp", '#include "controller/law/law.h"\n', "layers", 1),
    "model uses the hal": ("model/beam/a.cpp", '\n#include "hal/frame.h"\n', "layers", 2),
    "the hal's interface uses a backend": ("hal/a.h", '#include "hal/sim/rig.h"\n', "layers", 1),
    "the hal's interface uses beams": ("hal/a.h", '#include "model/beam/beam.h"\n', "layers", 1),
    "a driver uses another": ("hal/modbus/a.h", '#include "hal/canopen/node.h"\n', "layers", 1),
    "the estimator uses a backend": ("estimator/a.h", '#include "hal/sim/rig.h"\n', "layers", 1),
    "the estimator uses the law": ("estimator/a.h", '#include "controller/law/law.h"\n', "layers", 1),
    "the law uses the gate":
        ("controller/law/a.h", '#include "controller/safety/torque_gate.h"\n', "layers", 1),
    "the law uses a task": ("controller/law/a.h", '#include "controller/tasks/task.h"\n', "layers", 1),
    "safety uses the law": ("controller/safety/a.h", '#include "controller/law/law.h"\n', "layers", 1),
    "a task uses the config":
        ("controller/tasks/a.h", '#include "config/config.cpp"\n', "layers", 1),
    "the config uses a tool": ("config/a.h", '#include "tools/runs/summary.h"\n', "layers", 1),
    "a library of the tools uses a program":
        ("tools/runs/a.h", '#include "tools/flexarm/main.cpp"\n', "layers", 1),
    "a product uses the tests":
        ("tools/runs/a.cpp", '#include "tests/model/beam_test.cpp"\n', "layers", 1),
    "an undeclared folder": ("controller/new/a.h", "#pragma once\n", "layers", 1),
    "an include from beside the file": ("model/beam/a.cpp", '#include "beam.h"\n', "layers", 1),
    "a target that links too little":
        ("hal/sim/CMakeLists.txt", "flexarm_library(flexarm_hal_sim\n  PUBLIC flexarm_hal)\n",
         "target", 1),
    "a target that links too much":
        ("hal/sim/CMakeLists.txt", "flexarm_library(flexarm_hal_sim\n"
         "  PUBLIC flexarm_model flexarm_hal flexarm_model_arm)\n", "target", 1),
    "a target of another name":
        ("hal/sim/CMakeLists.txt", "flexarm_library(flexarm_sim\n"
         "  PUBLIC flexarm_model flexarm_hal)\n", "target", 1),
    "a folder that is no target": ("hal/sim/CMakeLists.txt", "add_library(x a.cpp)\n", "target", 1),
    "a picture of other folders": ("docs/images/folders.svg", "<svg/>\n", "picture", 1),
    "a lock in a task": ("controller/tasks/safety_task.cpp", "#include <mutex>\n", "realtime", 1),
    "a log line in the model":
        ("model/beam/a.cpp", 'void F() { spdlog::info("x"); }\n', "realtime", 1),
    "a stream in the estimator": ("estimator/a.cpp", "#include <iostream>\n", "realtime", 1),
    "a clock in the law": ("controller/law/a.cpp", "#include <chrono>\n", "realtime", 1),
    "printing in the simulated rig": ("hal/sim/a.cpp", '\nvoid F() { printf("x"); }\n', "realtime", 2),
    "a vector that grows in the step":
        ("controller/step/a.cpp", "void F() { v.push_back(1); }\n", "heap", 1),
    "an object on the heap in the law":
        ("controller/law/a.cpp", "int* F() { return new int; }\n", "heap", 1),
    "a callback with storage of its own in the safety logic":
        ("controller/safety/a.h", "#pragma once\n\nusing F = std::function<void()>;\n", "heap", 3),
    "a sine in the estimator":
        ("estimator/a.cpp", "double S(double x) { return std::sin(x); }\n", "libm", 1),
    "a sine by a using declaration":
        ("controller/step/a.cpp", "double S(double x) { using std::sin; return sin(x); }\n", "libm", 1),
    "a hyperbolic tangent in a law":
        ("controller/law/a.cpp", "double T(double x) { return std::tanh(x); }\n", "libm", 1),
    "an endless file": ("model/beam/a.cpp", "// line\n" * 401, "file-size", 401),
    "an endless test": ("tests/a.cpp", "// line\n" * 601, "file-size", 601),
    "a to-do note": ("model/beam/a.cpp", f"// {NOTE}: later\n", "leftover", 1),
    "a to-do note in a script": ("tools/a.py", f"# {NOTE}: later\n", "leftover", 1),
    "a double without a unit":
        ("model/beam/a.h", "#pragma once\n\n/// A thing.\nstruct A {\n  double length;\n};\n", "unit", 5),
    "an array of doubles without a unit":
        ("model/beam/a.h", "#pragma once\n\n/// A thing.\nstruct A {\n  std::array<double, 2> torque;\n};\n",
         "unit", 5),
    "a function without a comment":
        ("model/beam/a.h", "#pragma once\n\ndouble Sum(double a, double b);\n", "comment", 3),
    "a class without a comment":
        ("model/beam/a.h", "#pragma once\n\nclass A {\n  int x_;\n};\n", "comment", 3),
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
                findings = [line for line in result.stdout.splitlines()[:-1]
                            if "layers: cycle: " not in line]  # which the arrow may close
                self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
                self.assertEqual(len(findings), 1, findings)
                self.assertTrue(findings[0].startswith(f"{path}:{line}: {rule}: "), findings[0])

    def test_objects_to_headers_that_include_each_other(self):
        result = check({**GOOD, "hal/a.h": '#pragma once\n#include "hal/b.h"\n',
                        "hal/b.h": '#pragma once\n#include "hal/a.h"\n'})
        self.assertEqual(result.returncode, 1)
        self.assertIn("layers: cycle: hal/a.h -> hal/b.h -> hal/a.h", result.stdout)

    def test_warns_of_a_long_function_and_passes(self):
        result = check({**GOOD, "model/beam/a.cpp": LONG_FUNCTION})
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertIn("model/beam/a.cpp:1: warning: function: Long has 63 lines", result.stdout)

    def test_reads_neither_comments_nor_literals_as_code(self):
        result = check({**GOOD, "model/beam/a.cpp": '// std::mutex\nconst char* kText = "std::cout";\n'})
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_refuses_a_folder_that_is_no_source_tree(self):
        self.assertEqual(check({"README.md": "x"}).returncode, 2)


if __name__ == "__main__":
    unittest.main()
