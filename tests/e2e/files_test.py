#!/usr/bin/env python3
"""Files that others wrote are read with limits, nothing of value is overwritten, and no byte of a
file reaches the terminal as it is."""

import json
import os
import shutil
import sqlite3
import subprocess
import unittest

from program import BIN, HIL, ROOT, SQUARE, ProgramTest

CHEAP = 60  # seconds, for a program that hangs: a refusal takes milliseconds


class FilesTest(ProgramTest):
    def refused(self, *arguments, said=(), program="flexarm"):
        result = self.run_program(program, *arguments, timeout_s=CHEAP)
        self.assert_refused(result, *((said,) if isinstance(said, str) else said))
        self.assert_printable(result)
        return result

    def assert_printable(self, result):
        """`errors="backslashreplace"` of the test's pipe leaves ESC and the other controls."""
        for text in (result.stdout, result.stderr):
            for c in text:
                self.assertTrue(c.isprintable() or c in "\n", repr(text[:500]))

    def special_files(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        huge = self.folder / "huge"
        with open(huge, "wb") as file:
            file.truncate(400 << 20)
        return {"a FIFO": fifo, "a device": "/dev/zero", "a directory": self.folder,
                "is larger than": huge}


class Reading(FilesTest):
    def test_a_config_that_is_no_regular_file_is_refused_by_name(self):
        for said, file in self.special_files().items():
            with self.subTest(said):
                self.refused("config", "check", file, said=(said, str(file)))
                self.refused("--config", file, said=said, program="flexarmd")
                extending = self.folder / "extending.toml"
                extending.write_text(f"extends = '{file}'\n", encoding="utf-8")
                self.refused("config", "check", extending, said=said)
                self.refused("simulate", "-c", HIL, "--experiment", file, said=said)

    def test_a_csv_gains_calibration_log_or_result_file_too(self):
        run, _ = self.simulate("run.flexarm")
        for said, file in self.special_files().items():
            with self.subTest(said):
                csv = self.folder / "special.csv"
                csv.unlink(missing_ok=True)
                csv.symlink_to(file)
                self.refused("replay", csv, "-c", HIL, said=said)
                self.refused("simulate", "-c", HIL, "--set", f"controller.gains='{file}'", said=said)
                self.refused("replay", self.exported(run), "-c", HIL, "--calibration",
                             file, said=said)
                self.refused("analyze", "reduce", "--system", file, said=said)
                if said != "is larger than":
                    self.refused("info", file, said=said)
                    self.refused("sweep", "show", file, said=said)

    def exported(self, run):
        csv = self.folder / "samples.csv"
        if not csv.exists():
            self.flexarm("export", run, "-o", csv)
        return csv

    def test_dots_that_do_not_nest_are_allowed(self):
        text = HIL.read_text(encoding="utf-8").replace(
            'extends = "', f'extends = "{HIL.parent}/', 1)
        self.assertIn(str(HIL.parent), text)
        rig = self.folder / "rig.toml"
        for added in ("# " + "1.5 " * 40 + "\n", "# [[[[" + "." * 100 + "\n"):
            rig.write_text(text + added, encoding="utf-8")
            self.flexarm("config", "check", rig)
        rig.write_bytes(b"\xef\xbb\xbf" + text.encode().replace(b"\n", b"\r\n"))
        self.flexarm("config", "check", rig)
        rig.write_text(text + "\n[more]\nx = [" + "1.0, " * 33 + "]\n", encoding="utf-8")
        self.refused("config", "check", rig, said="more")

    def trajectory(self, csv):
        experiment = self.folder / "trajectory.toml"
        shutil.copy(ROOT / "config/experiments/trajectory.toml", experiment)
        (self.folder / "trajectory.csv").write_bytes(csv)
        return "simulate", "-c", HIL, "--experiment", experiment

    def test_a_trajectory_is_refused_with_its_own_line(self):
        shipped = (ROOT / "config/experiments/trajectory.csv").read_bytes()
        lines = shipped.split(b"\n")
        broken = b"\n".join(lines[:20] + [b"\xff" + lines[20]] + lines[21:])
        self.refused(*self.trajectory(broken), said="trajectory.csv:21: found the byte \\xff")
        broken = b"\n".join(lines[:20] + [b"\x1b[31m"] + lines[21:])
        self.refused(*self.trajectory(broken), said="trajectory.csv:21: found the control")
        self.refused(*self.trajectory(shipped.replace(b",", b" ")), said="found spaces in the header")
        self.flexarm(*self.trajectory(b"\xef\xbb\xbf" + shipped.replace(b"\n", b"\r\n")))

    def test_nested_json_ends_no_program(self):
        run, _ = self.simulate("run.flexarm")
        deep = self.folder / "deep.json"
        for text in ("[" * 40_000, '{"encoder":' * 20_000, '{"a":[' + "[" * 100_000):
            deep.write_text(text, encoding="utf-8")
            self.refused("replay", self.exported(run), "-c", HIL, "--calibration", deep,
                         said="deep.json:1: is nested")
            self.refused("simulate", "-c", HIL, "--set", f"controller.gains='{deep}'",
                         said="is nested")
            calibration = self.folder / "calibration.json"
            calibration.write_text(text, encoding="utf-8")
            self.refused("--config", HIL, "--without-realtime", "--log-dir", self.folder,
                         "--socket", self.folder / "s", said="is nested", program="flexarmd")

    def test_json_of_another_form_is_refused_by_file_and_key(self):
        run, _ = self.simulate("run.flexarm")
        csv = self.exported(run)
        file = self.folder / "calibration.json"
        for text, said in (('{"encoder": [1], "strain": [2]}', "is no JSON object"),
                           ('{"encoder": 1, "strain": []}', "'encoder'"), ("{,}", ":1: is not JSON"),
                           ("[]", "expected a calibration")):
            file.write_text(text, encoding="utf-8")
            result = self.refused("replay", csv, "-c", HIL, "--calibration", file,
                                  said=("calibration.json", said))
            self.assertNotIn("json.exception", result.stderr)


class Ranges(FilesTest):
    def test_gains_that_are_not_those_of_the_config_are_refused(self):
        gains = self.folder / "gains.json"
        self.flexarm("design", "-c", HIL, "-o", gains)
        good = json.loads(gains.read_text(encoding="utf-8"))
        use = ("simulate", "-c", HIL, "--set", f"controller.gains='{gains}'")
        self.flexarm(*use)

        def scaled(name, factor):
            changed = dict(good)
            changed[name] = [[factor * value for value in row] for row in good[name]]
            gains.write_text(json.dumps(changed), encoding="utf-8")

        for name, factor in (("K", -1), ("K", 10), ("K_stop", -1), ("filter_L", 0), ("P", 1.00001)):
            with self.subTest(name=name, factor=factor):
                scaled(name, factor)
                self.refused(*use, said=(str(gains), f"'{name}'[", "flexarm design"))
                self.refused("--config", HIL, "--without-realtime", "--log-dir", self.folder,
                             "--socket", self.folder / "s", "--set", f"controller.gains='{gains}'",
                             said=f"'{name}'[", program="flexarmd")

    def test_a_payload_that_is_no_number_is_bad_usage(self):
        for value in ("nan", "inf", "-1", "1e3"):
            self.refused("simulate", "-c", HIL, f"--payload-kg={value}", said="payload-kg")
            self.refused("design", "-c", HIL, "-o", self.folder / "g", f"--payload-kg={value}",
                         said="payload-kg")

    def test_an_arm_without_natural_frequencies_is_refused_with_file_and_key(self):
        rig = ROOT / "config/thesis-rig.toml"
        self.refused("config", "check", rig, "--set", "link1.section[0].youngs_modulus_pa=1e-30",
                     said=("thesis-rig.toml", "link1"))

    def test_an_experiment_that_cannot_be_planned_is_named(self):
        experiment = self.folder / "far.toml"
        experiment.write_text('name = "far"\nduration_s = 2.0\n[[move]]\nstart_s = 0.1\n'
                              "duration_s = 0.1\nto_deg = [60.0, 60.0]\n", encoding="utf-8")
        self.refused("simulate", "-c", HIL, "--experiment", experiment, said="far.toml")


class Writing(FilesTest):
    def setUp(self):
        super().setUp()
        self.precious = self.folder / "precious"
        self.precious.write_text("the only copy\n", encoding="utf-8")

    def kept(self, *arguments, file=None, said="--overwrite"):
        file = file or self.precious
        before = file.read_bytes()
        self.refused(*arguments, said=(said, str(file)))
        self.assertEqual(file.read_bytes(), before)

    def test_no_verb_replaces_a_file_that_it_did_not_write(self):
        run, _ = self.simulate("run.flexarm")
        png = self.folder / "holiday.png"
        png.write_text("a photograph", encoding="utf-8")
        self.kept("design", "-c", HIL, "-o", self.precious)
        self.kept("design", "-c", HIL, "-o", self.precious, "--force")
        self.kept("export", run, "-o", self.precious)
        self.kept("plot", run, "-o", png, file=png)
        self.kept("modes", "-c", HIL, "-o", png, file=png)
        self.kept("gauges", "-c", HIL, "-o", png, file=png)
        self.kept("analyze", "check", "-c", HIL, "-o", self.precious)
        self.kept("analyze", "excite", "-c", HIL, "-o", png, file=png)
        self.kept("analyze", "linearize", "-c", HIL, "-o", png, file=png)
        self.kept("benchmark", "-c", HIL, "-o", self.folder / "b.sqlite", "--page", self.precious)
        self.kept("benchmark", "-c", HIL, "-o", self.precious, said="is not a result file")
        self.kept("sweep", "-c", HIL, "--seeds", "1", "-o", self.precious,
                  said="is not a result file")
        self.kept("sweep", "-c", HIL, "--seeds", "1", "-o", run, said="is not a result file",
                  file=run)
        self.kept("simulate", "-c", HIL, "-o", self.precious, said="never overwritten")

    def test_a_folder_with_files_needs_to_be_asked_for(self):
        run, _ = self.simulate("run.flexarm")
        for verb in (("analyze", "reduce", "-c", HIL), ("analyze", "parametric", "-c", HIL),
                     ("identify", "--run", run, "--free", "joint1.coulomb_friction_nm")):
            self.refused(*verb, "-o", self.folder, said="is a folder with files")

    def test_its_own_files_are_replaced_and_others_when_asked(self):
        run, _ = self.simulate("run.flexarm")
        for _ in range(2):
            self.flexarm("design", "-c", HIL, "-o", "gains.json")
            self.flexarm("export", run, "-o", "samples.csv")
            for picture in ("a.png", "a.svg"):
                self.flexarm("plot", run, "-o", picture)
        self.flexarm("design", "-c", HIL, "-o", self.precious, "--overwrite")
        self.assertIn("flexarm-gains", self.precious.read_text(encoding="utf-8"))
        self.assertEqual((self.folder / "a.png").read_bytes()[1:4], b"PNG")
        self.assertEqual([entry.name for entry in self.folder.iterdir()
                          if entry.name.endswith(".part")], [])

    def test_an_input_is_never_written(self):
        run, _ = self.simulate("run.flexarm")
        rig = self.folder / "rig.toml"
        rig.write_text(f"extends = '{HIL}'\n", encoding="utf-8")
        link = self.folder / "link.flexarm"
        link.symlink_to(run)
        for flag in ((), ("--overwrite",)):
            self.kept("export", run, "-o", run, *flag, file=run, said="is an input")
            self.kept("design", "-c", rig, "-o", rig, *flag, file=rig, said="is an input")
            before = run.read_bytes()
            self.refused("export", run, "-o", link, *flag, said="is an input")
            self.assertEqual(run.read_bytes(), before)

    def test_the_cause_of_a_failure_is_told_and_nothing_else(self):
        run, _ = self.simulate("run.flexarm")
        for output in ("no/where/x.png", "no/where/x.svg"):
            result = self.refused("plot", run, "-o", output, said="No such file or directory")
            self.assertEqual(result.stdout, "")
            self.assertLess(len(result.stderr), 200)
        self.refused("design", "-c", HIL, "-o", "no/gains.json", said="No such file or directory")
        self.refused("export", run, "-o", "no/samples.csv", said="No such file or directory")

    def test_lost_output_is_a_failure(self):
        run, _ = self.simulate("run.flexarm")
        for verb in (("info", run), ("info", run, "--json"), ("config", "check", HIL),
                     ("diff", run, run), ("--help",)):
            with open("/dev/full", "wb") as full:
                result = subprocess.run([BIN / "flexarm", *map(str, verb)], stdout=full,
                                        stderr=subprocess.PIPE, text=True, timeout=CHEAP,
                                        check=False)
            self.assertEqual(result.returncode, 1, verb)
            self.assertIn("standard output cannot be written", result.stderr)


class Printing(FilesTest):
    def test_bytes_of_a_csv_stay_out_of_the_terminal(self):
        run, _ = self.simulate("run.flexarm")
        csv = self.folder / "samples.csv"
        self.flexarm("export", run, "-o", csv)
        lines = csv.read_text(encoding="utf-8").splitlines()
        cells = lines[1].split(",")
        for cell in ("\u009b31m", "x" * 100_000, "\u202e"):
            csv.write_text("\n".join([lines[0], ",".join([cell] + cells[1:])]), encoding="utf-8")
            result = self.refused("replay", csv, "-c", HIL, said="samples.csv:2: time_s")
            self.assertLess(len(result.stderr), 1000)

    def test_names_of_a_log_and_of_a_result_file_too(self):
        run, _ = self.simulate("run.flexarm")
        results = self.folder / "s.sqlite"
        self.flexarm("sweep", "-c", HIL, "--seeds", "1", "--over", "controller.alpha=3", "-o",
                     results)
        with sqlite3.connect(results) as db:
            db.execute("UPDATE axis SET value = ?, key = ? WHERE target = 'config'",
                       ("\x1b[31mred\x07", "\x1b]0;title\x07"))
        result = self.run_program("flexarm", "sweep", "show", results)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_printable(result)
        self.assertIn("\\x1b[31mred", result.stdout)
        for verb in (("--json",), ()):
            self.assert_printable(self.run_program("flexarm", "sweep", "show", results, *verb))

    def test_names_of_files_and_overrides_too(self):
        name = "\x1b[2J\u009b.toml"
        self.refused("config", "check", name, said="\\x1b[2J")
        self.refused("config", "check", HIL, "--set", "a\x1b[1m=\x1b[2m")
        self.refused("\x1b[31mverb")
        self.refused("info", name)
        (self.folder / name).write_text("x = \x1b[3m", encoding="utf-8")
        self.refused("config", "check", name, said="control character \\x1b")

    def test_a_result_file_that_is_damaged_is_refused_by_its_name(self):
        results = self.folder / "s.sqlite"
        self.flexarm("sweep", "-c", HIL, "--seeds", "1,2", "-o", results)
        with sqlite3.connect(results) as db:
            db.execute("UPDATE axis SET axis = axis + 1")
        self.refused("sweep", "show", results, said=("s.sqlite", "not numbered from 0"))
        with sqlite3.connect(results) as db:
            db.execute("DELETE FROM axis")
            db.execute("UPDATE run SET point = point + 7")
        self.refused("sweep", "show", results, said="s.sqlite")


if __name__ == "__main__":
    unittest.main()
