#!/usr/bin/env python3
"""Gives tools/lint/build_cost.py compile times made up for it, around what its figures allow."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import build_cost  # noqa: E402

MODEL, MAIN = "batches/flexarm_model/model.cpp", "tools/flexarm/main.cpp"
FIGURES = {"per_thousand_lines": 1.5, "units": {MODEL: 2.0, MAIN: 1.0}}
LINES = 2.0  # in thousands, so that the figures of the units sum to that of the product
COMPILER = "/usr/bin/c++"


def findings(model, main, figures=FIGURES):
    ratios = {MODEL: model, MAIN: main}
    measured = build_cost.measured(list(ratios), lambda names: {n: ratios[n] for n in names},
                                   figures, LINES)
    return list(build_cost.excesses(measured, figures, LINES))


class Limits(unittest.TestCase):
    def test_the_figures_themselves_pass(self):
        self.assertEqual(findings(2.0, 1.0), [])

    def test_a_unit_fails_at_31_percent_more_and_is_named_with_a_remedy(self):
        found = findings(2.0, 1.31)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith("tools/flexarm/main.cpp takes the compiler 1.31 times the"
                                            " reference, 31% more than its figure 1.00"), found)
        self.assertIn("--update and say why in the commit", found[0])
        self.assertEqual(len(findings(2.62, 0.7)), 1)

    def test_a_unit_passes_at_30_percent_more(self):
        self.assertEqual(findings(2.0, 1.30), [])
        self.assertEqual(findings(2.60, 0.8), [])

    def test_the_product_fails_at_16_percent_more_a_line_and_passes_at_15(self):
        self.assertEqual(findings(2.30, 1.15), [])
        found = findings(2.32, 1.16)
        self.assertEqual(len(found), 1, found)
        self.assertIn("the product takes 1.740 references per thousand lines, 16% more than its"
                      " figure 1.500", found[0])

    def test_more_lines_may_cost_more(self):
        ratios = {MODEL: 2.6, MAIN: 1.3}
        self.assertEqual(list(build_cost.excesses(ratios, FIGURES, LINES * 1.15)), [])


class Measuring(unittest.TestCase):
    def sequence(self, *rounds):
        """A measurement that gives one of `rounds` after the other, and what it was asked for."""
        asked, left = [], list(rounds)

        def measure(names):
            asked.append(sorted(names))
            ratios = left.pop(0)
            return {name: ratios[name] for name in names}
        return measure, asked

    def test_the_smallest_of_three_counts_and_the_others_are_not_repeated(self):
        measure, asked = self.sequence({MODEL: 2.0, MAIN: 1.4}, {MAIN: 1.5}, {MAIN: 1.1})
        ratios = build_cost.measured([MODEL, MAIN], measure, FIGURES, LINES)
        self.assertEqual(ratios, {MODEL: 2.0, MAIN: 1.1})
        self.assertEqual(asked, [[MODEL, MAIN], [MAIN], [MAIN]])

    def test_a_product_above_its_limit_has_all_measured_again_that_is_above_its_figure(self):
        measure, asked = self.sequence({MODEL: 2.5, MAIN: 1.0}, {MODEL: 2.1})
        ratios = build_cost.measured([MODEL, MAIN], measure, FIGURES, LINES)
        self.assertEqual(ratios, {MODEL: 2.1, MAIN: 1.0})
        self.assertEqual(asked, [[MODEL, MAIN], [MODEL]])

    def test_the_reference_stands_all_through_the_units(self):
        self.assertEqual(build_cost.mixed(list("abcdef"), 3),
                         [None, "a", "b", None, "c", "d", None, "e", "f"])

    def test_a_time_is_the_processor_time_of_the_compiler_and_its_children(self):
        burn = "import time\nwhile time.process_time() < 0.3: pass"
        script = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {burn!r}])"
        taken = build_cost.cpu_seconds([sys.executable, "-c", script, "-o", "x"], "/", "y")
        self.assertGreater(taken, 0.29)
        with self.assertRaises(SystemExit):
            build_cost.cpu_seconds(["false", "-o", "x"], "/", "y")

    def test_the_reference_compiles(self):
        subprocess.run(["c++", *build_cost.REFERENCE, "-fsyntax-only"], check=True)


class Tree(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.build = self.root / "build" / "release"
        self.build.mkdir(parents=True)

    def commands(self, *sources_and_targets):
        (self.build / "compile_commands.json").write_text(json.dumps([
            {"directory": str(self.build), "file": str(self.root / source),
             "command": f"/usr/bin/ccache {COMPILER} -O3 -o {target} -c {self.root / source}"}
            for source, target in sources_and_targets]), encoding="utf-8")
        return build_cost.product_units(self.build, self.root)

    def test_units_are_those_of_the_product_as_they_are_built(self):
        units = self.commands(
            (f"build/release/{MODEL}", f"model/CMakeFiles/flexarm_model.dir/{MODEL}.o"),
            (MAIN, "tools/CMakeFiles/flexarm.dir/main.cpp.o"),
            ("build/release/batches/model_unit_test/tests-model.cpp",
             "tests/model/CMakeFiles/model_unit_test.dir/tests-model.cpp.o"),
            ("build/release/model/flexarm_model_verify_interface_header_sets/model/beam.h.cxx",
             "model/CMakeFiles/flexarm_model_verify_interface_header_sets.dir/beam.h.cxx.o"))
        self.assertEqual(sorted(units), [MODEL, MAIN])
        self.assertEqual(units[MAIN][0][:2], [COMPILER, "-O3"])  # without the cache

    def test_a_source_that_is_compiled_twice_has_no_figure_of_its_own(self):
        with self.assertRaises(SystemExit):
            self.commands((MAIN, "tools/CMakeFiles/a.dir/main.cpp.o"),
                          (MAIN, "tools/CMakeFiles/b.dir/main.cpp.o"))

    def test_units_and_figures_name_the_same(self):
        self.assertEqual(list(build_cost.strangers([MODEL, MAIN], FIGURES)), [])
        (new,) = build_cost.strangers([MODEL, MAIN, "tools/new.cpp"], FIGURES)
        self.assertTrue(new.startswith("tools/new.cpp has no figure: "), new)
        (gone,) = build_cost.strangers([MODEL], FIGURES)
        self.assertTrue(gone.startswith("tools/flexarm/main.cpp has a figure and is not compiled"), gone)

    def test_without_figures_the_lane_fails_and_says_what_to_do(self):
        self.commands((MAIN, "tools/CMakeFiles/flexarm.dir/main.cpp.o"))
        result = subprocess.run([ROOT / "tools/lint/build_cost.py", "--root", self.root],
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn(f"{build_cost.FIGURES} is not there", result.stdout)
        self.assertIn("--update", result.stdout)


class Figures(unittest.TestCase):
    def test_an_update_keeps_what_still_holds(self):
        new = build_cost.updated({MODEL: 2.19, MAIN: 1.2, "tools/new.cpp": 0.123}, FIGURES, LINES)
        self.assertEqual(new["units"], {MODEL: 2.0, MAIN: 1.2, "tools/new.cpp": 0.12})
        self.assertEqual(new["per_thousand_lines"], 1.756)
        self.assertEqual(list(build_cost.raised(FIGURES, new)),
                         ["the total per thousand lines", MAIN])
        self.assertEqual(build_cost.updated({MODEL: 2.0, MAIN: 1.0}, None, LINES), FIGURES)

    def test_a_commit_that_raises_a_figure_says_why(self):
        def unexplained_after(*figures_and_messages):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / build_cost.FIGURES
                path.parent.mkdir(parents=True)
                identity = {f"GIT_{who}_{what}": "x" for who in ("AUTHOR", "COMMITTER")
                            for what in ("NAME", "EMAIL")}
                subprocess.run(["git", "init", "--quiet", folder], check=True)
                for model, message in figures_and_messages:
                    path.write_text(json.dumps({**FIGURES, "units": {MODEL: model}}),
                                    encoding="utf-8")
                    for command in (["add", "-A"], ["commit", "--quiet", "-m", message]):
                        subprocess.run(["git", "-C", folder, *command], check=True,
                                       env={**os.environ, **identity})
                return list(build_cost.unexplained(Path(folder)))
        self.assertEqual(unexplained_after((2.0, "figures")), [])
        self.assertEqual(unexplained_after((2.0, "figures"), (1.9, "cheaper")), [])
        self.assertEqual(unexplained_after((2.0, "figures"), (2.5, "x\n\nBuild cost: a solver")), [])
        (found,) = unexplained_after((2.0, "figures"), (2.5, "dearer"))
        self.assertIn(f"raises the figure of {MODEL}: ", found)


if __name__ == "__main__":
    unittest.main()
