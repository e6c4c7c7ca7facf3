"""flexarm analyze: results for the arm, and for any linear system."""

import contextlib
import csv
import json
import math
import re
import resource
import unittest

from program import ROOT, ProgramTest

RIG = ROOT / "config/thesis-rig.toml"
QUANSER = ROOT / "config/quanser-2dsfl.toml"
REFERENCE = ("-c", RIG, "--set", "arm.link1_tip_inertia=motor")  # the basis of the reference table

# Two unit masses between walls: springs 4 to the walls, 2.5 between. Roots 2 and 3 rad/s.
TWO_MASSES = {"name": "two masses", "M": [[1, 0], [0, 1]], "K": [[6.5, -2.5], [-2.5, 6.5]],
              "B": [[1], [0]], "C": [[0, 1]]}

VERDICTS = ("holds", "holds in part", "depends on the excitation", "does not hold", "not testable")


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Reduce(ProgramTest):
    def reduce(self, *arguments):
        return self.flexarm_json("analyze", "reduce", *arguments)

    def system(self, content):
        file = self.folder / "system.json"
        file.write_text(content if isinstance(content, str) else json.dumps(content),
                        encoding="utf-8")
        return file

    def test_contributions_at_the_thesis_motions(self):
        rows = (((), (99.50, 99.23)),
                (("--scaling", "length"), (95.37, 98.18)),
                (("--theta2-deg", 45, "--theta1-rate", -1, "--theta2-rate", 3), (99.52, 99.30)),
                (("--theta2-deg", 90, "--theta1-rate", -4, "--theta2-rate", -6), (99.76, 99.84)))
        for options, expected in rows:
            with self.subTest(options=options):
                result = self.reduce(*REFERENCE, *options)
                for link, first in zip(result["links"], expected):
                    self.assertAlmostEqual(link["epsilon_percent"][0], first, delta=0.00501)
                    self.assertGreater(link["epsilon_percent"][1], 99.4)
                    self.assertEqual(len(link["epsilon_percent"]), 10)
                self.assertEqual(result["power"]["condition"], "diagonalisable")
                self.assertTrue(result["notes"])

    def test_text_says_what_was_left_out_and_how_phi_is_scaled(self):
        text = self.flexarm("analyze", "reduce", "-c", RIG).stdout
        for said in ("scaling of phi: mass", "left out: root", "rigid", "Hankel"):
            self.assertIn(said, text)

    def test_the_grid_has_every_cell_and_agrees_with_single_motions(self):
        result = self.reduce(*REFERENCE, "--grid", "--grid-cells", 4, "-o", self.folder / "out")
        grid = result["grid"]
        self.assertEqual(grid["cells"], 64)
        with open(self.folder / "out/grid.csv", encoding="utf-8") as file:
            cells = list(csv.DictReader(file))
        self.assertEqual(len(cells), 64)
        self.assertAlmostEqual(min(float(c["link2_epsilon_1_percent"]) for c in cells),
                               grid["links"][1]["epsilon_1"]["least"]["percent"], places=7)
        cell = cells[37]
        alone = self.reduce(*REFERENCE, "--theta2-deg", cell["theta2_deg"], "--theta1-rate",
                            cell["theta1_rate_rad_s"], "--theta2-rate", cell["theta2_rate_rad_s"])
        for link in (1, 2):
            self.assertAlmostEqual(float(cell[f"link{link}_epsilon_2_percent"]),
                                   alone["links"][link - 1]["epsilon_percent"][1], places=7)
        for number in range(3, 10):
            picture = self.folder / f"out/figure-6.{number}.png"
            self.assertGreater(picture.stat().st_size, 5000, picture.name)

    def test_the_bound_on_rigid_body_roots_applies_to_the_grid_too(self):
        def shares(*options):
            self.reduce(*REFERENCE, "--grid", "--grid-cells", 2, "-o", self.folder / "out",
                        "--overwrite", *options)
            with open(self.folder / "out/grid.csv", encoding="utf-8") as file:
                return [float(cell["rigid_share_percent"]) for cell in csv.DictReader(file)]

        self.assertGreater(min(shares()), 50)  # the elbow's slow oscillation
        self.assertEqual(max(shares("--rigid-below", 1000)), 0)  # lowest bending: 1730 rad^2/s^2

    def test_the_whole_grid_of_the_thesis_takes_seconds(self):
        before = cpu_seconds()
        grid = self.reduce(*REFERENCE, "--grid")["grid"]
        used = cpu_seconds() - before
        self.assertEqual(grid["cells"], 8000)
        for link in grid["links"]:  # two modes dominate everywhere
            self.assertGreater(link["epsilon_2"]["least"]["percent"], 99.4)
        self.assertLess(used, 15, "processor time; two cores have to finish in 10 s")

    def test_a_system_of_masses_and_springs(self):
        result = self.reduce("--system", self.system(TWO_MASSES))
        power = result["power"]
        self.assertEqual(power["condition"], "symmetric")
        for mode, omega in zip(power["modes"], (2, 3)):
            self.assertAlmostEqual(mode["frequency_hz"], omega / (2 * math.pi), places=12)
            self.assertAlmostEqual(mode["rho"], 0.5 / omega, places=12)
        self.assertEqual(result["gramians"]["states_kept_whole"], 4)  # nothing damps it
        damped = self.reduce("--system", self.system(
            {**TWO_MASSES, "D": [[0.2, 0], [0, 0.2]]}))
        self.assertEqual(damped["gramians"]["states_kept_whole"], 0)
        self.assertTrue(damped["power"]["damping_left_out"])
        self.assertEqual(damped["power"]["mu"], power["mu"])

    def test_a_system_in_first_order_form(self):
        result = self.reduce("--system", self.system(
            {"A": [[0, 0, 1, 0], [0, 0, 0, 1], [-4, 1, 0, 0], [0, -9, 0, -0.1]],
             "B": [[0], [0], [1], [1]], "C": [[1, 1, 0, 0]]}))
        self.assertEqual(result["power"]["condition"], "diagonalisable")
        # x' = -4 x + 3 u, y = -2 x has the one Hankel value 6/8, and no form for power balancing.
        lag = self.reduce("--system", self.system({"A": [[-4]], "B": [[3]], "C": [[-2]]}))
        self.assertIsNone(lag["power"])
        self.assertIn("odd number", lag["power_refused"])
        self.assertAlmostEqual(lag["gramians"]["hankel"][0], 0.75, places=14)

    def test_each_bad_system_is_refused_with_file_and_what_was_expected(self):
        cases = {
            "no JSON": ("{", "is not JSON"),
            "no object": ("[1]", "expected one JSON object"),
            "nothing in it": ("{}", "A: is missing"),
            "an unknown key": ({**TWO_MASSES, "Q": [[1]]}, "Q: is not a key"),
            "a ragged matrix": ({**TWO_MASSES, "K": [[1, 2], [3]]}, "K, row 2: has 1 numbers"),
            "a text in it": ({**TWO_MASSES, "K": [[1, "x"], [0, 1]]}, "K, row 1: expected finite"),
            "wrong height": ({**TWO_MASSES, "B": [[1]]}, "B: is 1 x 1; expected 2 x any"),
            "wrong width": ({**TWO_MASSES, "C": [[1]]}, "C: is 1 x 1; expected any x 2"),
            "no mass": ({**TWO_MASSES, "M": [[1, 0], [0, 0]]}, "positive definite"),
            "an empty matrix": ({**TWO_MASSES, "M": []}, "at least one number"),
            "A not square": ({"A": [[1, 2]], "B": [[1]], "C": [[1]]}, "square"),
            "a number too large": ('{"A": [[1e999]], "B": [[1]], "C": [[1]]}', "not JSON"),
        }
        for what, (content, said) in cases.items():
            with self.subTest(what):
                file = self.system(content)
                self.assert_refused(self.run_program("flexarm", "analyze", "reduce", "--system",
                                                     file), "system.json", said)

    def test_bad_usage_is_refused(self):
        for arguments, said in (
                ((), "subcommand"),
                (("reduc",), ""),
                (("reduce",), "--config"),
                (("reduce", "-c", RIG, "--system", "x.json"), "either"),
                (("reduce", "-c", "missing.toml"), "missing.toml"),
                (("reduce", "--system", "missing.json"), "missing.json"),
                (("reduce", "-c", RIG, "--modes", 0), "--modes"),
                (("reduce", "-c", RIG, "--modes", 13), "--modes"),
                (("reduce", "-c", RIG, "--theta2-deg", 200), "--theta2-deg"),
                (("reduce", "-c", RIG, "--theta2-deg", "nan"), "--theta2-deg"),
                (("reduce", "-c", RIG, "--scaling", "big"), "--scaling"),
                (("reduce", "-c", RIG, "--grid", "--grid-cells", 0), "--grid-cells"),
                (("reduce", "-c", RIG, "--grid", "--grid-theta2-deg", 30, 30), "the grid is empty"),
                (("reduce", "-c", RIG, "--grid", "--grid-theta1-rate", 0), "--grid-theta1-rate")):
            with self.subTest(arguments):
                self.assert_refused(self.run_program("flexarm", "analyze", *arguments), said)


class Parametric(ProgramTest):
    def test_every_figure_and_the_table_are_written(self):
        out = self.folder / "out"
        result = self.flexarm_json("analyze", "parametric", "-c", RIG, "-o", out)
        sweeps = {sweep["parameter"]: sweep["points"] for sweep in result["sweeps"]}
        for name in ("payload_kg", "joint1_stiffness_nm_per_rad", "joint2_stiffness_nm_per_rad",
                     "friction_factor", "backlash_deg", "link1_length_m", "link2_length_m"):
            self.assertGreaterEqual(len(sweeps[name]), 9, name)
            pictures = list(out.glob(f"figure-5.?-{name}.png"))
            self.assertEqual(len(pictures), 1, name)
            self.assertGreater(pictures[0].stat().st_size, 10000, name)
        payloads = [point["motors_free_frequency_hz"][0] for point in sweeps["payload_kg"]]
        self.assertAlmostEqual(payloads[0], 7.9197, places=3)  # exact dynamic stiffness: 7.919741
        self.assertEqual(payloads, sorted(payloads, reverse=True))
        with open(out / "parametric.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), sum(map(len, sweeps.values())))
        table = (out / "statements.md").read_text(encoding="utf-8")
        for statement in result["statements"]:
            self.assertIn(statement["model"], table)
            self.assertIn(statement["verdict"], VERDICTS)

    def test_it_takes_seconds(self):
        before = cpu_seconds()
        self.flexarm("analyze", "parametric", "-c", RIG)
        self.assertLess(cpu_seconds() - before, 60, "processor time")

    def test_bad_usage_is_refused(self):
        for arguments, said in ((("parametric",), "--config"),
                                (("parametric", "-c", RIG, "--torque-nm", 0, 1), "--torque-nm"),
                                (("parametric", "-c", RIG, "--torque-nm", 1), "--torque-nm"),
                                (("check", "-c", RIG, "--chapter", 3), "--chapter"),
                                (("check",), "--config")):
            with self.subTest(arguments):
                self.assert_refused(self.run_program("flexarm", "analyze", *arguments), said)


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def last_digit(number):
    """The value of one unit of the last printed digit."""
    mantissa, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


class Torsion(ProgramTest):
    def test_link_1_twists_under_link_2(self):
        # Finite elements and a finite-difference stress function, by a program of its own.
        result = self.flexarm_json("analyze", "torsion", "-c", RIG)
        self.assertAlmostEqual(result["links"][0]["stiffness_nm_per_rad"], 31.6236, delta=2e-3)
        carrying = result["link1_carrying"]
        for key, expected in (("frequency_hz", 2.361276), ("weight_nm", 1.907318),
                              ("twist_deg", 3.455688), ("tip_drop_by_twist_mm", 54.281821)):
            self.assertAlmostEqual(carrying[key] / expected, 1.0, delta=1e-4)
        coupled = result["link2_with_payload"]["coupled_hz"]
        self.assertAlmostEqual(coupled[3] / 95.575194, 1.0, delta=1e-5)
        straight = self.flexarm_json("analyze", "torsion", "-c", RIG, "--theta2-deg", 0,
                                     "--motor-offset-mm", 50)["link1_carrying"]
        self.assertEqual(straight["weight_nm"], 0)
        self.assertAlmostEqual(straight["twist_deg_per_m_s2"],
                               math.degrees(3.03 * 0.05 / 31.6236), delta=1e-4)
        self.assertIn("twists it by 3.456 deg", self.flexarm("analyze", "torsion", "-c", RIG).stdout)

    def test_bad_options_are_refused(self):
        self.assert_refused(self.run_program("flexarm", "analyze", "torsion", "-c", RIG,
                                             "--poisson", 0.5), "--poisson")

    def test_sections_that_are_no_rectangles_are_refused(self):
        for config, said in ((QUANSER, "link1.section[0] is no solid rectangle"),
                             (ROOT / "config/published/space-manipulator-2007.toml",
                              "link1.section[0] is no solid rectangle"),
                             (ROOT / "config/published/flexible-forearm-1990.toml",
                              "link1.section[0] has no area_m2")):
            with self.subTest(config.name):
                self.assert_refused(self.run_program("flexarm", "analyze", "torsion", "-c", config),
                                    config.name, said)


class Check(ProgramTest):
    """The committed page equals the page that the program writes: the same words and verdicts, and
    numbers that differ by at most two in their last printed digit, as another compiler or processor
    may cause."""

    def compare(self, committed, written):
        self.assertEqual(NUMBER.sub("#", committed), NUMBER.sub("#", written))
        for was, now in zip(NUMBER.findall(committed), NUMBER.findall(written)):
            self.assertLessEqual(abs(float(was) - float(now)), 2.01 * last_digit(was),
                                 f"{was} in docs/thesis-check.md is now {now}")

    def test_the_page_is_up_to_date(self):
        page = self.folder / "thesis-check.md"
        self.flexarm("analyze", "check", "-c", RIG, "-o", page)
        self.compare((ROOT / "docs/thesis-check.md").read_text(encoding="utf-8"),
                     page.read_text(encoding="utf-8"))

    def test_an_arm_other_than_that_of_the_thesis_is_refused(self):
        self.assert_refused(self.run_program("flexarm", "analyze", "check", "-c", QUANSER),
                            QUANSER.name, "link 1 is 0.281 m long")

    def test_fewer_gauges_and_another_model_have_a_page_that_says_what_they_lack(self):
        rows = self.flexarm_json("analyze", "check", "-c", RIG, "--set",
                                 "estimator.modes_per_link=1", "--set", "controller.nominal=R8",
                                 "--set", "link1.section[0].half_thickness_m=2e-3",
                                 "--set", "controller.name=sobel-thesis")["statements"]
        page = (ROOT / "docs/thesis-check.md").read_text(encoding="utf-8")
        for row in rows:
            self.assertIn(f"| {row['section']} | {row['thesis']} |", page)
        self.assertEqual(len(rows), len(re.findall(r"^\| [3-8B]", page, re.MULTILINE)))
        lacking = [row for row in rows if row["model"].startswith("not for this rig: ")]
        self.assertEqual({row["verdict"] for row in lacking}, {"not testable"})
        reasons = " ".join(row["model"] for row in lacking)
        for said in ("estimator.modes_per_link", "controller.nominal", "no solid"):
            self.assertIn(said, reasons)
        self.assertEqual(len(lacking), 6)
        self.assertNotIn("no finite number", page)

    def test_the_comparison_sees_another_verdict_and_another_number(self):
        page = (ROOT / "docs/thesis-check.md").read_text(encoding="utf-8")
        self.compare(page, page)
        with self.assertRaises(AssertionError):
            self.compare(page, page.replace("| does not hold |", "| holds |", 1))
        figure = max((n for n in NUMBER.findall(page) if "." in n), key=len)
        for other, differs in ((float(figure) + 3 * last_digit(figure), True),
                               (float(figure) - last_digit(figure), False)):
            changed = page.replace(figure, f"{other:.{len(figure.partition('.')[2])}f}", 1)
            self.assertNotEqual(changed, page)
            with self.assertRaises(AssertionError) if differs else contextlib.nullcontext():
                self.compare(page, changed)


if __name__ == "__main__":
    unittest.main()
