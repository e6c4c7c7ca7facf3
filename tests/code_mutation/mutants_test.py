#!/usr/bin/env python3
"""Asks generate.py for the mutants of small texts, and mutants.py how it judges and what is stale."""

import contextlib
import io
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

import generate  # noqa: E402
import mutants  # noqa: E402


def changes(text):
    return [mutant.apply(text) for mutant in generate.mutants_of(text)]


def mutations(text):
    return [(mutant.operator, mutant.mutation) for mutant in generate.mutants_of(text)]


class Generate(unittest.TestCase):
    def test_a_comparison_becomes_off_by_one_and_its_condition_is_negated(self):
        self.assertEqual(mutations("if (a <= b) c();"),
                         [("negate", "a <= b -> !(a <= b)"), ("off-by-one", "<= -> <"),
                          ("drop", "c() -> nothing")])

    def test_a_condition_that_another_mutant_negates_is_not_negated_twice(self):
        self.assertEqual(mutations("if (!a) {\n}"), [("negate", "! -> nothing")])
        self.assertEqual(mutations("if (a == b) {\n}"), [("swap", "== -> !=")])

    def test_both_operands_of_and_stay(self):
        self.assertIn("x = a || b;", changes("x = a && b;"))

    def test_a_statement_is_dropped_and_a_declaration_is_not(self):
        self.assertIn("{ ; }", changes("{ count_ = x; }"))
        self.assertIn("{ ; }", changes("{ Call(x); }"))
        for declaration in ("{ int x = y; }", "{ const T& a = b; }", "{ Foo foo(x); }",
                            "{ std::array<int> a = b; }"):
            self.assertNotIn("{ ; }", changes(declaration))

    def test_the_statement_of_an_if_is_dropped(self):
        self.assertIn("if (a) ;", changes("if (a) b = c;"))

    def test_a_number_grows_by_one(self):
        self.assertIn("x = (7 + 1);", changes("x = 7;"))
        self.assertIn("x = (1e-9 + 1.0);", changes("x = 1e-9;"))
        self.assertIn("x = (1'000 + 1);", changes("x = 1'000;"))
        self.assertIn("x = (0xE1u + 1);", changes("x = 0xE1u;"))

    def test_branches_of_a_conditional_change_places(self):
        self.assertIn("x = a ? (c ? d : e) : (b);", changes("x = a ? b : c ? d : e;"))
        self.assertIn("f(a ? (g(x, y)) : (b), z);", changes("f(a ? b : g(x, y), z);"))

    def test_what_is_returned_becomes_the_zero_of_its_type(self):
        self.assertIn("return {};", changes("return a[{1}];"))
        self.assertEqual(mutations("return {};"), [])

    def test_a_named_constant_becomes_zero_but_neither_a_label_nor_a_definition(self):
        self.assertIn("x = static_cast<decltype(E::kA)>(0);", changes("x = E::kA;"))
        self.assertEqual(changes("case E::kA:"), [])
        self.assertEqual(changes("constexpr int kA = x;"), [])

    def test_comments_texts_templates_and_the_preprocessor_are_left_alone(self):
        for text in ('// a < b && 3', '/* 1 + 2 */', 'auto a = "a < b, 3";', "#if A && 3\n#define B \\\n 4",
                     "std::array<int, 3> a;", "static_assert(a < 3);", "T&& move;"):
            self.assertEqual(changes(text), [], text)

    def test_the_same_mutation_on_lines_of_the_same_text_is_numbered(self):
        text = "bool x = a && b && c;"
        found = [(m.mutation, m.nth) for m in generate.mutants_of(text)]
        self.assertEqual(found, [("&& -> ||", 1), ("&& -> ||", 2)])

    def test_the_same_text_has_the_same_mutants_and_none_is_the_text_itself(self):
        for source in mutants.read_json(mutants.HERE / "map.json", {}):
            text = (ROOT / source).read_text(encoding="utf-8")
            found = generate.mutants_of(text)
            self.assertEqual(found, generate.mutants_of(text))
            lines = text.count("\n")  # a header may have little but declarations
            self.assertGreater(len(found), 10 if source.endswith(".cpp") else lines // 20, source)
            self.assertNotIn(text, [mutant.apply(text) for mutant in found])


class Judge(unittest.TestCase):
    def test_the_first_stage_that_notices_ends_the_trial(self):
        def never():
            self.fail("it was killed before")
        self.assertEqual(mutants.judge([lambda: (False, ""), never]), ("killed", 1))
        self.assertEqual(mutants.judge([lambda: (True, ""), lambda: (True, "")]), ("survived", 2))

    def test_what_does_not_compile_is_no_kill_but_a_static_assert_is_one(self):
        self.assertEqual(mutants.judge([lambda: (None, "error: no type")]), ("not compiled", 1))
        self.assertEqual(mutants.judge([lambda: (None, "error: static assertion failed")]),
                         ("killed", 1))

    def test_a_program_that_does_not_end_is_stopped(self):
        self.assertIsNone(mutants.run(["sleep", "60"], "/", 0.1)[0])

    def test_an_argument_is_found_by_text_and_its_number(self):
        one, two = generate.mutants_of("bool x = a && b && c;")
        entry = {"file": "f", "line": "bool x = a && b && c;", "mutation": "&& -> ||"}
        self.assertTrue(mutants.is_argued(two, "f", [entry]))
        self.assertFalse(mutants.is_argued(two, "f", [{**entry, "nth": 1}]))
        self.assertTrue(mutants.is_argued(one, "f", [{**entry, "nth": 1}]))
        self.assertFalse(mutants.is_argued(one, "g", [entry]))

    def test_a_survivor_or_one_that_is_left_shows_in_the_last_line(self):
        with contextlib.redirect_stdout(io.StringIO()):
            total, line = mutants.report({"a.h": Counter(killed=3, survived=1),
                                          "b.cpp": Counter(left=2)})
        self.assertEqual((total["survived"], total["left"]), (1, 2))
        self.assertEqual(line, "6 mutants of 2 files: 3 killed, 0 not compiled, 1 survived, "
                               "0 argued, 2 left")

    def test_a_copied_file_that_did_not_change_keeps_its_time(self):
        with tempfile.TemporaryDirectory() as folder:
            shop = mutants.Workshop(Path(folder), 1)
            shop.write("a/b.h", b"x")
            before = (shop.tree / "a/b.h").stat().st_mtime_ns
            shop.write("a/b.h", b"x")
            self.assertEqual((shop.tree / "a/b.h").stat().st_mtime_ns, before)


class Lists(unittest.TestCase):
    def test_every_argument_is_about_a_mutant_that_exists_and_has_a_reason(self):
        argued = mutants.read_json(mutants.HERE / "argued.json", [])
        self.assertEqual(mutants.stale(argued), [])
        for entry in argued:
            self.assertGreater(len(entry["reason"]), 20, entry)

    def test_an_argument_about_a_line_that_is_gone_is_stale(self):
        entry = {"file": "controller/safety/torque_gate.cpp", "line": "gone", "mutation": "x -> y"}
        self.assertEqual(mutants.stale([entry]), [entry])

    def test_the_map_names_sources_tests_and_programs_that_exist(self):
        lists = "".join(path.read_text(encoding="utf-8")
                        for path in (ROOT / "tests").rglob("CMakeLists.txt"))
        for source, entry in mutants.read_json(mutants.HERE / "map.json", {}).items():
            self.assertTrue((ROOT / source).is_file(), source)
            self.assertTrue(entry["first"] is None or (ROOT / entry["first"]).is_file(), source)
            for program in entry["programs"]:
                self.assertIn(f"flexarm_tests({program} ", lists)


if __name__ == "__main__":
    sys.exit(unittest.main())
