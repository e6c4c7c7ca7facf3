#!/usr/bin/env python3
"""Which files tools/lint/tidy.py and headers.py check when others have changed."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import headers  # noqa: E402
import tidy  # noqa: E402

FILES = {
    "model/beam.cpp": '#include "model/beam.h"\n#include "model/beam_impl.h"\n',
    "model/arm.cpp": '#include "model/beam.h"\n',
    "tests/model/arm_test.cpp": '#include "model/arm.h"\n#include "tests/model/swing.h"\n',
}


class Tidy(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        for name, text in FILES.items():
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            (self.root / name).write_text(text, encoding="utf-8")
        self.entries = [{"file": str(self.root / name), "command": "c++"} for name in FILES]

    def chosen(self, *changed):
        with mock.patch.object(tidy, "ROOT", self.root):
            entries = tidy.only_changed(self.entries, changed)
        return [Path(entry["file"]).relative_to(self.root).as_posix() for entry in entries]

    def test_sources_come_in_the_order_of_the_changes_and_once(self):
        self.assertEqual(self.chosen("model/beam.cpp", "docs/page.md", "model/arm.cpp",
                                     "model/beam.h"), ["model/beam.cpp", "model/arm.cpp"])

    def test_a_header_is_checked_with_its_source_or_with_one_that_includes_it(self):
        self.assertEqual(self.chosen("model/beam.h"), ["model/beam.cpp"])
        self.assertEqual(self.chosen("model/beam_impl.h"), ["model/beam.cpp"])
        self.assertEqual(self.chosen("tests/model/swing.h"), ["tests/model/arm_test.cpp"])
        self.assertEqual(self.chosen("model/unused.h"), [])

    def test_rules_that_change_concern_all_files_below_them(self):
        self.assertEqual(self.chosen("tests/.clang-tidy"), ["tests/model/arm_test.cpp"])
        self.assertEqual(self.chosen(".clang-tidy"), list(FILES))

    def test_what_the_time_does_not_allow_is_left_and_named(self):
        out = io.StringIO()
        with (mock.patch.object(tidy, "ROOT", self.root),
              mock.patch.object(tidy, "STAMPS", self.root), contextlib.redirect_stdout(out)):
            result = tidy.check(self.entries[0], self.root, "versions", end=0)
        self.assertEqual((result, out.getvalue()), ("left", "left: model/beam.cpp\n"))


class Headers(unittest.TestCase):
    def test_a_public_header_has_a_target_of_its_own(self):
        target = "model/CMakeFiles/flexarm_model_verify_interface_header_sets.dir/beam.h.cxx.o"
        source = "/b/model/flexarm_model_verify_interface_header_sets/model/beam.h.cxx"
        self.assertEqual(headers.header_targets(
            [{"file": source, "command": f"c++ -o {target} -c {source}"},
             {"file": "/r/model/arm.cpp", "command": "c++ -o arm.cpp.o -c /r/model/arm.cpp"}]),
            {"model/beam.h": target})


if __name__ == "__main__":
    unittest.main()
