#!/usr/bin/env python3
"""A killed sweep can be continued; merged shards equal the whole sweep; wrong input is refused."""

import json
import os
import sqlite3
import subprocess
import time
import unittest

from program import BIN, HIL, ROOT, SQUARE, ProgramTest, rows

GRID = ("-c", HIL, "--over", "controller.alpha=1.0,2.0,3.0", "--payload-kg", "0,0.1",
        "--seeds", "1..3")
POINTS = 18
SCRIPT = ROOT / "tools/cluster/flexarm-shards.sbatch"


def results(file):
    """Every column of every run, except its wall time."""
    columns = [name for _, name, *_ in rows(file, "PRAGMA table_info(run)") if name != "wall_s"]
    quoted = ", ".join(f'"{name}"' for name in columns)
    return columns, rows(file, f"SELECT {quoted} FROM run ORDER BY point")


class Sweep(ProgramTest):
    def sweep(self, name, *arguments, grid=GRID, expect=0):
        file = self.folder / name
        return file, self.flexarm_json("sweep", *grid, *arguments, "-o", file, expect=expect)

    def runs_in(self, file):
        """The number of runs in the file, after SQLite has rolled back incomplete transactions."""
        results_file = sqlite3.connect(file)
        try:
            if not results_file.execute("SELECT 1 FROM sqlite_master").fetchall():
                return 0
            return results_file.execute("SELECT count(*) FROM run").fetchone()[0]
        finally:
            results_file.close()

    def refused(self, *arguments, said):
        self.assert_refused(self.run_program("flexarm", "sweep", *arguments), said)

    def test_runs_in_the_file_are_not_repeated(self):
        file, first = self.sweep("all.sqlite")
        self.assertEqual((first["points"], first["run_now"]), (POINTS, POINTS))
        before = rows(file, "SELECT * FROM run")
        _, again = self.sweep("all.sqlite")
        self.assertEqual((again["run_now"], again["there_already"]), (0, POINTS))
        self.assertEqual(rows(file, "SELECT * FROM run"), before)  # the wall times too

    def test_a_sweep_that_is_killed_at_any_instant_continues_to_the_same_results(self):
        whole, _ = self.sweep("whole.sqlite")
        file = self.folder / "killed.sqlite"
        kills, there, wait_s = 0, 0, 0.02
        while kills < 6 or there == 0:
            process = subprocess.Popen([BIN / "flexarm", "sweep", *GRID, "--jobs", "1", "-o", file],
                                       stdout=subprocess.DEVNULL)
            time.sleep(wait_s)
            if process.poll() is not None:
                break  # it had finished the remaining runs
            process.kill()
            process.wait()
            kills += 1
            there = self.runs_in(file)
            wait_s *= 1.4
        self.assertGreater(kills, 0, "never killed: the test shows nothing")
        there = self.runs_in(file)
        _, told = self.sweep("killed.sqlite")
        self.assertEqual(told["there_already"], there)
        self.assertEqual(results(file), results(whole))

    def test_merged_shards_equal_the_whole_sweep_for_any_number_of_jobs(self):
        whole, _ = self.sweep("whole.sqlite", "--jobs", "1")
        parts = [self.sweep(f"part-{i}.sqlite", "--shard", f"{i}/4", "--jobs", i)[0]
                 for i in (1, 2, 3, 4)]
        merged = self.folder / "merged.sqlite"
        told = self.flexarm_json("sweep", "merge", *parts, "-o", merged)
        self.assertEqual((told["done"], told["missing"]), (POINTS, []))
        self.assertEqual(results(merged), results(whole))

    def test_a_merge_names_missing_points_and_the_sweep_fills_them(self):
        part, _ = self.sweep("part.sqlite", "--shard", "2/3")
        merged = self.folder / "merged.sqlite"
        told = self.flexarm_json("sweep", "merge", part, "-o", merged, expect=1)
        self.assertEqual(told["missing"], [i for i in range(POINTS) if i % 3 != 1])
        _, filled = self.sweep("merged.sqlite")
        self.assertEqual(filled["there_already"], POINTS // 3)
        self.assertEqual(len(results(merged)[1]), POINTS)

    def test_a_run_of_a_sweep_equals_that_of_simulate(self):
        file, _ = self.sweep("one.sqlite", grid=("-c", HIL, "--over", "controller.alpha=2.0",
                                                 "--payload-kg", "0.2", "--seeds", "5"))
        single = self.flexarm_json("simulate", "-c", HIL, "--set", "controller.alpha=2.0",
                                   "--payload-kg", "0.2", "--seed", "5")
        [found] = rows(file, "SELECT joint1_rms_error_deg, joint2_final_error_deg,"
                             " tip_settling_time_s, peak_torque1_nm, ticks FROM run")
        self.assertEqual(list(found), [
            single["joint_rms_error_deg"][0], single["joint_final_error_deg"][1],
            single["tip_settling_time_s"], single["peak_torque_nm"][0], single["ticks"]])

    def test_config_and_plant_axes_are_not_the_same(self):
        key = "joint1.coulomb_friction_nm=0.0,0.48"
        both, _ = self.sweep("both.sqlite", grid=("-c", HIL, "--over", key))
        plant, _ = self.sweep("plant.sqlite", grid=("-c", HIL, "--plant", key))
        self.assertIn("joint1.coulomb_friction_nm", results(both)[0])
        self.assertIn("plant:joint1.coulomb_friction_nm", results(plant)[0])
        self.assertEqual(rows(plant, "SELECT count(DISTINCT joint1_rms_error_deg) FROM run"), [(2,)])

    def test_a_run_that_trips_or_is_refused_is_a_result(self):
        file, told = self.sweep("bad.sqlite", grid=(
            "-c", HIL, "--over", "limits.strain_limit=[8.5e-4, 1.9e-3],[1.9e-3, 1.9e-3]",
            "--over", "limits.soft_angle_deg=[20.0, 90.0],[90.0, 90.0]"))
        self.assertEqual(told["run_now"], 4)
        found = rows(file, "SELECT completed, trip IS NOT NULL, refused IS NOT NULL FROM run"
                           " ORDER BY point")
        self.assertEqual(found, [(0, 0, 1), (0, 1, 0), (0, 0, 1), (1, 0, 0)])

    def test_show_gives_a_table_json_csv_and_a_picture(self):
        file, _ = self.sweep("all.sqlite")
        table = self.flexarm("sweep", "show", file).stdout.splitlines()
        self.assertEqual(len(table), 1 + 6 + 1)  # a head, one line per group, a foot
        shown = self.flexarm_json("sweep", "show", file, "--by", "payload_kg")
        self.assertEqual([(group["controller.alpha"], group["payload_kg"], group["runs"])
                          for group in shown["groups"]],
                         [(a, p, 3) for a in ("1.0", "2.0", "3.0") for p in ("0", "0.1")])
        of_group = rows(file, 'SELECT joint1_rms_error_deg FROM run WHERE "controller.alpha" = 1'
                              " AND payload_kg = 0")
        self.assertEqual(shown["groups"][0]["joint1_rms_error_deg"], sorted(of_group)[1][0])
        self.flexarm("sweep", "show", file, "-o", self.folder / "table.csv")
        self.assertEqual(len((self.folder / "table.csv").read_text().splitlines()), 1 + 6)
        self.flexarm("sweep", "show", file, "-o", self.folder / "picture.png")
        self.assertEqual((self.folder / "picture.png").read_bytes()[:4], b"\x89PNG")
        self.flexarm("sweep", "show", file, "--by", "controller.alpha", "-o",
                     self.folder / "picture.svg")
        picture = (self.folder / "picture.svg").read_text(encoding="utf-8")
        for label in ("controller.alpha, 1/s", " kg"):  # of the axis; of the curves' payloads
            self.assertIn(label, picture)

    def test_wrong_input_is_refused(self):
        out = ("-o", self.folder / "x.sqlite")
        rig = ("-c", HIL)
        self.refused(*rig, *out, said="nothing to sweep")
        self.refused(*rig, "--seeds", "1", said="--output")
        self.refused("--seeds", "1", *out, said="--config")
        self.refused(*rig, "--over", "controller.alfa=1.0,2.0", *out, said="controller.alfa")
        self.refused(*rig, "--over", "controller.alpha=", *out, said="empty")
        self.refused(*rig, "--over", "controller.alpha=1.0,-5.0", *out, said="controller.alpha")
        self.refused(*rig, "--plant", "controller.alpha=1.0", *out, said="controller.alpha")
        self.refused(*rig, "--variants", "wooden", *out, said="nominal, backlash")
        self.refused(*rig, "--seeds", "1..3", "--shard", "0/4", *out, said="0/4")
        self.refused(*rig, "--seeds", "1..3", "--jobs", "0", *out, said="--jobs")
        self.refused(*rig, "--seeds", "one", *out, said="sim.seed")
        self.assertFalse((self.folder / "x.sqlite").exists(), "refused, but a file was created")

    def test_files_without_a_sweep_or_of_another_sweep_are_refused(self):
        text = self.folder / "notes.sqlite"
        text.write_text("no database\n" * 1000, encoding="utf-8")
        run, _ = self.simulate("run.flexarm")
        for file in (text, run, self.folder):
            for arguments in (("show", file), ("merge", file, "-o", self.folder / "y.sqlite"),
                              (*GRID, "-o", file)):
                self.refused(*arguments, said=file.name)
        self.refused("show", self.folder / "missing", said="missing")
        file, _ = self.sweep("one.sqlite", grid=("-c", HIL, "--seeds", "1"))
        self.refused("-c", HIL, "--seeds", "1..2", "-o", file, said="seed = 1,2")
        self.refused("-c", HIL, "--set", "controller.sigma=0.03", "--seeds", "1", "-o", file,
                     said="sigma")
        other = self.experiment(SQUARE.read_text(encoding="utf-8").replace("30.0]", "25.0]"))
        self.refused("-c", HIL, "--experiment", other, "--seeds", "1", "-o", file,
                     said="experiment")
        self.assertEqual(len(results(file)[1]), 1)

    def test_a_full_disk_gives_one_message(self):
        limited = f"ulimit -f 24; exec '{BIN / 'flexarm'}' sweep -c '{HIL}' --seeds 1..500 -o f.sqlite"
        result = subprocess.run(["bash", "-c", "trap '' XFSZ; " + limited], cwd=self.folder,
                                capture_output=True, text=True, check=False, timeout=120)
        self.assert_refused(result, "f.sqlite")


class Cluster(ProgramTest):
    """The tasks of a Slurm array, without Slurm: tests/cluster/slurm_test.sh has it."""

    def task(self, number, of, *arguments, first=1, expect=0, **more):
        environment = {**os.environ, "FLEXARM": str(BIN / "flexarm"),
                       "SLURM_ARRAY_TASK_ID": str(number), "SLURM_ARRAY_TASK_COUNT": str(of),
                       "SLURM_ARRAY_TASK_MIN": str(first), "SLURM_ARRAY_TASK_MAX": str(of), **more}
        result = subprocess.run([SCRIPT, *map(str, arguments)], env=environment, cwd=self.folder,
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def test_each_task_has_its_part_and_a_repeated_one_continues_it(self):
        parts = self.folder / "parts of it"
        for number in (1, 2):
            self.task(number, 2, parts, "sweep", *GRID)
        self.assertIn(f"{POINTS // 2} were in the file", self.task(2, 2, parts, "sweep", *GRID))
        told = self.flexarm_json("sweep", "merge", *sorted(parts.glob("*.sqlite")), "-o",
                                 self.folder / "all.sqlite")
        self.assertEqual(told["missing"], [])

    def test_the_summary_of_a_torture_is_whole_or_not_there(self):
        self.task(1, 2, "out", "torture", "-c", HIL, "--seeds", "1..8")
        summary = json.loads((self.folder / "out/part-1.json").read_text(encoding="utf-8"))
        self.assertEqual(summary["scenarios"], 4)
        self.task(2, 2, "out", "torture", "-c", HIL, "--seeds", "none", expect=2)
        self.assertFalse((self.folder / "out/part-2.json").exists())

    def test_an_array_that_is_not_1_to_n_is_refused(self):
        for number, of, more in ((3, 3, {"first": 2}), (9, 8, {"FLEXARM_SHARDS": "8"})):
            self.assertIn("flexarm-shards:", self.task(number, of, "out", "sweep", expect=2, **more))
        self.assertIn("no shards", self.task(1, 1, "out", "simulate", expect=2))


if __name__ == "__main__":
    unittest.main()
