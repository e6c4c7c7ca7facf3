#!/usr/bin/env python3
"""Breaks each rule of tools/lint/check_docs.py once, in a tree made for it; and checks this one."""

import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "lint"))

import check_docs  # noqa: E402


GOOD = {
    "tests/arm_test.cpp": "TEST(Arm, Moves) {}\nTEST_P(\n    ArmOver,\n    Stops) {}\n",
    "tests/CMakeLists.txt": "flexarm_tests(arm_unit_test LABEL unit # of the arm\n  FILES\n"
                            "    arm_test.cpp)\n",
    "tests/run.sh": "check \"it stops\" true\n",
    "tests/run_test.py": "    def test_it_stops_at_once(self):\n",
    "tools/lanes.sh": "",
    "tools/flexarm/main.cpp": """
void Add(CLI::App& app, Exit& exit) {
  CLI::App* verb = app.add_subcommand(
      "simulate", "Example: flexarm simulate -c rig.toml");
  verb->add_option("-c,--config", file, "A file");
  client.AddVerb(app, "status", "First `flexarm simulate`, see docs/page.md 1");
  AddCommand(app, exit, "stop", "use the flexarm program");
}
""",
    "tools/flexarm_study/verb_sweep.cpp": 'auto* verb = sweep->add_subcommand("merge", "Joins");\n',
    "tools/command_line/other_programs.h": 'OtherVerb{"sweep", "Many runs"},\n',
    "config/rig.toml": "[loop]\nperiod_ms = 20  # docs/page.md section 1.2\n",
    "config/loop_binding.cpp": 'reader.Number("gate_sigmas");\n',
    "model/arm/beam.h": "/// Shapes (docs/theory/plant.md 2.1 and 2.2,\n"
                        "/// page.md#1-what-it-is).\n"
                        "double beta_length;  // writes \"table.md\"\n",
    "model/arm/arm.cpp": 'WriteText(folder / "table.md");\nint arm;\n',
    "model/symbols.md": "| thesis | in equations | across files |\n|---|---|---|\n"
                        "| beta (own) | `beta_length` | `beta_*` |\n| beta (gain) | | |\n",
    "docs/page.md": """# Page
## 1. What it is
### 1.2 Names
`Arm.Moves` `ArmOver.Stops` `tests/run.sh: it stops` [page](page.md) [web](https://example.org/x)
[here](#1-what-it-is) `model/arm/` `model/{arm,sym*}` `tests/*.sh` `beam.h` `arm/` `model/NAME.h`
`beta_length` (`beam.h`), [plant](theory/plant.md) sections 2.1 and 2.2, `docs/theory/PAGE.md N`
`arm_unit_test --gtest_filter='Arm.*:*/ArmOver.Stops/*'`, `python3 tests/run_test.py -k it_stops`
`loop.period_ms = 20`, `loop.gate_sigmas`, `rig.toml`, `--config`, `--no-install`, table.md
```sh rig: commands of another arm
flexarm simulate -c config/rig.toml --config x \\
  --set loop.period_ms=10 && flexarm sweep merge a b   # --anything
cmake --preset release
flexarmd --config x
```
""",
    "docs/theory/plant.md": "# Plant\n## 2 Beams\n### 2.1 Shapes\nSee section 2.2.\n"
                            "### 2.2 Roots\n\n    beta = 1,   beta' = 2\n    beta_1 <- 3\n",
    "tools/run-tests": "run --no-install --set\n",
    "tools/flexarm/options.cpp": 'verb->add_option("--set", x);\n',
    "CHANGELOG.md": "`flexarm fly`, docs/old.md, `hal/old/`\n",
}

# name -> (file, what is added to it, what is found)
BROKEN = {
    "a test": ("docs/page.md", "`Arm.Flies`", "test: there is no test Arm.Flies"),
    "a script": ("docs/page.md", "`tests/walk.sh: it stops`", "path: there is no tests/walk.sh"),
    "a text of a script": ("docs/page.md", "`tests/run.sh: it flies`",
                           "test: tests/run.sh does not say 'it flies'"),
    "a test of a program": ("docs/page.md", "`arm_unit_test --gtest_filter='Arm.Moves:Arm.F*'`",
                            "test: arm_unit_test has no test Arm.F*"),
    "a test with parameters": ("docs/page.md", "`arm_unit_test --gtest_filter='ArmOver.Stops'`",
                               "test: arm_unit_test has no test ArmOver.Stops"),
    "a test program": ("docs/page.md", "`leg_unit_test --gtest_filter='Arm.Moves'`",
                       "test: there is no test program leg_unit_test"),
    "a test of a script": ("docs/page.md", "`python3 tests/run_test.py -k it_flies`",
                           "test: tests/run_test.py has no test with it_flies in its name"),
    "a link":
        ("docs/theory/plant.md", "[page](folder/other.txt)", "link: there is no folder/other.txt"),
    "a link to what is not installed":
        ("docs/page.md", "[beam](../model/arm/beam.h)",
         "link: ../model/arm/beam.h is not installed with the page"),
    "a page": ("docs/page.md", "See old.md.", "citation: there is no old.md"),
    "a page in a comment":
        ("model/arm/beam.h", "// beyond.md 3", "citation: there is no beyond.md"),
    "a page in a literal": ("tools/flexarm/main.cpp", 'const char* kMore = "see docs/old.md";',
                            "citation: there is no docs/old.md"),
    "a page in a script": ("tests/run.sh", "# docs/old.md", "citation: there is no docs/old.md"),
    "a page in Python": ("tests/run.py", "# docs/old.md", "citation: there is no docs/old.md"),
    "a page in a config": ("config/rig.toml", "# docs/old.md", "citation: there is no docs/old.md"),
    "a page outside": ("model/arm/beam.h", "// /home/me/notes.txt",
                       "citation: /home/me/notes.txt is not in the repository"),
    "a section": ("model/arm/beam.h", "// docs/theory/plant.md 4.2.",
                  "citation: docs/theory/plant.md has no section 4.2"),
    "a section in the next line": ("model/arm/beam.h", "// (docs/theory/plant.md\n// section 3)",
                                   "citation: docs/theory/plant.md has no section 3"),
    "a later section": ("docs/page.md", "[plant](theory/plant.md) sections 2.1 and 2.7",
                        "citation: theory/plant.md has no section 2.7"),
    "a section of a page without numbers": ("tests/run.sh", "# model/symbols.md 2",
                                            "citation: model/symbols.md has no section 2"),
    "a section of the page itself": ("docs/theory/plant.md", "as in section 5",
                                     "citation: this page has no section 5"),
    "an anchor": ("config/rig.toml", "# docs/page.md#skew",
                  "citation: docs/page.md has no heading for #skew"),
    "an anchor of the page itself": ("docs/page.md", "[there](#skew)",
                                     "citation: this page has no heading for #skew"),
    "a folder": ("docs/page.md", "`hal/rig`", "path: there is no hal/rig"),
    "a folder without its own": ("docs/page.md", "`runtime/`", "path: there is no folder runtime/"),
    "a pattern": ("docs/page.md", "`tests/*.toml`", "path: there is no tests/*.toml"),
    "an alternative": ("docs/page.md", "`model/{arm,hand}`", "path: there is no model/hand"),
    "a file of a command": ("docs/page.md", "```sh ci\nrm config/hil.toml\n```",
                            "path: there is no config/hil.toml"),
    "a header": ("docs/theory/plant.md", "`screen.h`", "path: there is no screen.h"),
    "a name in a file":
        ("docs/theory/plant.md", "`Beam` in `arm.cpp`", "path: arm.cpp does not have Beam"),
    "a verb": ("docs/page.md", "`flexarm fly`", "verb: flexarm has no verb fly"),
    "a verb of a verb":
        ("docs/page.md", "`flexarm sweep split`", "verb: flexarm sweep has no verb split"),
    "a verb of the daemon":
        ("docs/page.md", "`flexarmd status`", "verb: flexarmd has no verb status"),
    "a verb in a block": ("docs/page.md", "```sh ci\nflexarm fly -c x  # up\n```",
                          "verb: flexarm has no verb fly"),
    "a verb in a message":
        ("tools/flexarm/main.cpp", 'const char* kHelp = "Run `flexarm check-host`.";',
         "verb: flexarm has no verb check-host"),
    "a verb in an example":
        ("tools/flexarm/main.cpp", 'const char* kHelp = "Example: flexarm fly x";',
         "verb: flexarm has no verb fly"),
    "a verb in a comment":
        ("model/arm/beam.h", "/// By `flexarm fly`.", "verb: flexarm has no verb fly"),
    "an option of a command":
        ("docs/page.md", "`flexarm stop --now`", "verb: flexarm has no --now"),
    "an option": ("docs/page.md", "`--now`", "verb: no program and no script has --now"),
    "a table": ("docs/page.md", "`lop.period_ms`", "key: no config has a table lop"),
    "a key":
        ("docs/page.md", "`loop.period_s = 1`",
         "key: loop.period_s: config/ does not know period_s"),
    "a key of a command": ("docs/page.md", "`flexarm stop --set loop.rate=1`",
                           "key: loop.rate: config/ does not know rate"),
    "the tag of a block": ("docs/page.md", "```sh\nls\n```", "block: a block of commands has no tag: "
                           "write ```sh and ci, all, guest, newcomer or rig: REASON"),
    "the tag of a block beside code":
        ("model/arm/notes.md", "```sh\nls\n```",
         "block: a block of commands has no tag: write ```sh and ci, all, guest, newcomer or rig: REASON"),
    "a symbol for two things":
        ("model/symbols.md", "| beta | | |",
         "symbol: beta is in line 3 too: say in brackets which one is meant"),
    "a name of a symbol":
        ("model/symbols.md", "| eta | `e`, `eta_*` | |",
         "symbol: the code has no e", "symbol: the code has no eta_*"),
    "the number of a requirement":
        ("docs/safety.md", "| R2 | It shall stop. | `Arm.Moves` | |",
         "requirement: R2 stands in place 1"),
    "the sentence of a requirement":
        ("docs/safety.md", "| R1 | It stops. | `Arm.Moves` | |",
         "requirement: R1 is not one sentence with 'shall'"),
    "two sentences of a requirement":
        ("docs/safety.md", "| R1 | It shall stop. It moves. | `Arm.Moves` | |",
         "requirement: R1 is not one sentence with 'shall'"),
    "the test of a requirement":
        ("docs/safety.md", "| R1 | It shall stop. | `Arm` | |", "requirement: R1 names no test"),
    "a test of a requirement that is not there":
        ("docs/safety.md", "| R1 | It shall stop. | `Arm.Flies` | |",
         "test: there is no test Arm.Flies"),
    "a symbol of an equation":
        ("docs/theory/plant.md", "\n    gamma = beta", "symbol: model/symbols.md has no gamma"),
}


def write(root, files):
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


class CheckDocs(unittest.TestCase):
    def findings(self, files):
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), files)
            return check_docs.check_tree(Path(folder))

    def test_takes_what_is_there(self):
        self.assertEqual(self.findings(GOOD), [])

    def test_finds_each_thing_that_is_not_there_at_its_line_and_nothing_else(self):
        for name, (path, added, *found) in BROKEN.items():
            with self.subTest(name):
                before = GOOD.get(path, "")
                first = before.count("\n") + 1
                findings = self.findings({**GOOD, path: before + added + "\n"})
                self.assertEqual([finding.split(": ", 1)[1] for finding in findings], found)
                for finding in findings:
                    file, line = finding.split(":")[:2]
                    self.assertEqual(file, path)
                    self.assertIn(int(line), range(first, first + 2))

    def test_wants_the_folder_of_a_header_that_is_there_twice(self):
        findings = self.findings({**GOOD, "hal/beam.h": "", "docs/page.md": "`beam.h`\n"
                                  "## 1 What it is\n## 1.2 Names\n# What it is\n"})
        self.assertEqual(findings, ["docs/page.md:1: path: beam.h is model/arm/beam.h and "
                                    "hal/beam.h: name the folder"])

    def lane_findings(self, *rows, script="""
ci_lanes=(format
          asan)
only_all_lanes=(unit)
quick_lanes=(format unit)
lane_format() {
lane_asan() {
lane_unit() {
"""):
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), {"tools/lanes.sh": script, "docs/testing.md": "\n".join(rows)})
            return check_docs.check_tree(Path(folder))

    ROWS = ("| `format` | layout | 5 s | quick, CI, all | cheap |",
            "| `asan` | memory | | CI, all | input |",
            "| `unit` | tests | | quick, all | part |")

    def test_takes_a_row_for_each_lane(self):
        self.assertEqual(self.lane_findings(*self.ROWS), [])

    def test_finds_a_lane_without_a_row(self):
        self.assertEqual(self.lane_findings(*self.ROWS[:2]),
                         ["docs/testing.md:1: lane: there is no row for unit"])

    def test_finds_a_row_without_a_lane(self):
        self.assertEqual(self.lane_findings(*self.ROWS, "| `fuzz` | input | | all | slow |"),
                         ["docs/testing.md:4: lane: run-tests has no lane fuzz"])

    def test_finds_a_row_with_other_sets(self):
        self.assertEqual(
            self.lane_findings(*self.ROWS[:2], "| `unit` | tests | | quick, CI, all | part |"),
            ["docs/testing.md:3: lane: unit runs in 'quick, all'"])

    def test_finds_a_lane_that_no_set_runs(self):
        self.assertEqual(
            self.lane_findings(self.ROWS[0], script="ci_lanes=(format)\nquick_lanes=(format)\n"
                               "lane_format() {\nlane_fuzz() {\n"),
            ["tools/lanes.sh:1: lane: fuzz is either a function or in a set, and not both"])

    def law_findings(self, *rows):
        laws = '{ControllerKind::kPd, "pd", "a hub alone", false},\n{ControllerKind::kLqg,\n "lqg", "all"}'
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), {"controller/types/law_table.h": laws,
                                 "docs/theory/README.md": "\n".join(rows)})
            return check_docs.check_tree(Path(folder))

    def test_takes_a_row_for_each_law(self):
        self.assertEqual(self.law_findings("| `pd` | a hub alone | 1 |", "| `lqg` | all | 2 |"), [])

    def test_finds_a_law_without_a_row_and_a_row_without_a_law(self):
        self.assertEqual(self.law_findings("| `pd` | both hubs | 1 |", "| `lqg` | all | 2 |"),
                         ["docs/theory/README.md:1: law: there is no row for pd: a hub alone",
                          "docs/theory/README.md:1: law: controller/types/law_table.h has no pd: "
                          "both hubs"])

    def coverage_findings(self, *lines):
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), {"docs/thesis-coverage.md": "\n".join(lines)})
            return check_docs.check_tree(Path(folder))

    def test_counts_the_rows_of_the_coverage_page(self):
        rows = ("| 1 | 3.1 | links | works | x |", "| 2 | 3.2 | roots | differs: no | x |",
                "| 3 | 4.3 | curves | cannot be done: none | x |")
        count = "3 rows: 1 works, 1 differs, 1 cannot be done."
        finding = "docs/thesis-coverage.md:1: coverage: "
        self.assertEqual(self.coverage_findings(count, *rows), [])
        self.assertEqual(self.coverage_findings(count, rows[0], rows[2], rows[1]),
                         [finding + "the rows are not numbered 1, 2, 3, .."])
        wrong = [finding + "it has 2 rows: 1 works, 1 differs, 0 cannot be done"]
        self.assertEqual(self.coverage_findings(count, *rows[:2]), wrong)
        self.assertEqual(self.coverage_findings(*rows[:2]), wrong)
        self.assertIn(finding + "row 4 has the state 'partly'",
                      self.coverage_findings(count, *rows, "| 4 | 5.1 | load | partly | x |"))

    def test_this_tree_speaks_of_what_is_there(self):
        self.assertEqual(check_docs.check_tree(ROOT), [])

    def test_every_pitfall_of_the_buses_has_its_row(self):
        page = (ROOT / "docs" / "hardware.md").read_text(encoding="utf-8")
        rows = [line for line in page.splitlines() if line.startswith("| ") and line[2].isdigit()]
        numbers = [int(row.split("|")[1]) for row in rows]
        self.assertEqual(numbers, list(range(1, 22)))
        for row in rows:
            self.assertRegex(row.split("|")[4], r"`\w+\.\w+`|`tests/", row)


if __name__ == "__main__":
    unittest.main()
