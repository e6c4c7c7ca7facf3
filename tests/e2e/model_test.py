"""flexarm modes, analyze excite and analyze linearize: the model's beams, motions and linear arm."""

import math
import unittest

from program import ROOT, ProgramTest

RIG = ROOT / "config/thesis-rig.toml"
STIFFENED = ROOT / "config/thesis-rig-stiffened.toml"
PNG = b"\x89PNG\r\n\x1a\n"


class Modes(ProgramTest):
    def modes(self, *arguments):
        return self.flexarm_json("modes", "-c", RIG, *arguments)

    def test_clamped_links_are_those_of_the_reference(self):
        links = self.modes("--modes", 3, "--set", "arm.link1_tip_inertia=motor")["links"]
        self.assertEqual([link["base"] for link in links], ["clamped", "clamped"])
        for found, expected in zip(links[0]["frequency_hz"], (0.8542954, 12.958359, 39.649129)):
            self.assertAlmostEqual(found / expected, 1.0, delta=2e-7)
        self.assertAlmostEqual(links[1]["beta_l"][0], 1.4551580656, delta=1e-10)

    def test_the_root_may_be_pinned_or_a_spring(self):
        clamped, pinned = self.modes()["links"], self.modes("--base", "pinned")["links"]
        spring = self.modes("--base", "spring", "--base-spring-nm-per-rad", 20)["links"]
        for link in range(2):
            self.assertEqual(spring[link]["base"], "spring")
            # The modes with a spring lie between; the list of the pinned beam has no rigid-body
            # mode.
            for mode in range(1, 4):
                self.assertLess(pinned[link]["frequency_hz"][mode - 1],
                                spring[link]["frequency_hz"][mode])
                self.assertLess(spring[link]["frequency_hz"][mode],
                                clamped[link]["frequency_hz"][mode])

    def test_the_lumped_beam_converges_as_the_square_of_its_parts(self):
        links = self.modes("--convergence")["convergence"]
        # Only the lowest two of link 1: in its higher modes the heavy end hardly moves, so that the
        # N^-2 term is negligible and the next term dominates.
        for link, modes in zip(links, (2, 4)):
            errors = dict(zip(link["parts"], link["error_percent"]))
            for coarse, fine in list(zip(errors[100], errors[200]))[:modes]:
                self.assertAlmostEqual(coarse / fine, 4.0, delta=0.02)
            self.assertEqual(len(link["fit_coefficients"][0][0]), 4)
            self.assertLess(max(link["fit_rms_residual"]), 1e-6)  # falls as N^-4: 4e-8 at 200
        self.assertNotIn("convergence", self.modes())

    def test_frequencies_that_have_not_converged_are_marked(self):
        # 100 Hermite elements a link, by a program of its own: 160.776 and 189.689 Hz.
        json = self.modes()
        arm = json["arm"]
        self.assertEqual(arm["converged"], 8 * [True] + 2 * [False])
        for found, expected in zip(arm["frequency_hz"][8:], (503.878, 571.514)):
            self.assertAlmostEqual(found, expected, delta=1e-3)
        for found, expected in zip(arm["exact_hz"][8:], (160.776250, 189.688954)):
            self.assertAlmostEqual(found / expected, 1.0, delta=1e-6)
        self.assertEqual(json["arm_motors_held"]["converged"], 8 * [True] + 2 * [False])
        text = self.flexarm("modes", "-c", RIG).stdout
        self.assertEqual(text.count("not converged; exact: Hz"), 2)
        self.assertIn("160.776", text)

    def test_the_friction_switch_for_every_link_mode_and_amplitude(self):
        # Closed-form beam with a moment at its root, by a program of its own.
        expected = {(1, 1): ((0.0855602, True, 0.850564), (7.140428, False, 8.291590)),
                    (1, 5): ((0.4278010, False, 0.520017), (35.702139, False, 8.284165)),
                    (2, 1): ((0.0216424, False, 1.280778), (0.3906347, False, 10.625582)),
                    (2, 5): ((0.1082121, False, 0.565192), (1.9531735, False, 10.483619))}
        roots = self.modes("--modes", 2, "--friction-amplitude-mm", 1, 5)["friction_roots"]
        self.assertEqual([link["friction_nm"] for link in roots], [0.16, 0.01])
        for link in roots:
            for row in link["amplitudes"]:
                for mode, (moment, sticks, hz) in enumerate(
                        expected[link["link"], row["amplitude_mm"]]):
                    self.assertAlmostEqual(row["clamped_moment_nm"][mode] / moment, 1, delta=1e-6)
                    self.assertEqual(row["sticks"][mode], sticks)
                    self.assertAlmostEqual(row["frequency_hz"][mode] / hz, 1, delta=1e-5)
        loose = self.modes("--modes", 2, "--friction-amplitude-mm", 1, "--friction-nm", 0, 10)
        sticks = [link["amplitudes"][0]["sticks"] for link in loose["friction_roots"]]
        self.assertEqual(sticks, [[False, False], [True, True]])
        self.assertNotIn("friction_roots", self.modes())
        self.assertIn("slips", self.flexarm("modes", "-c", RIG, "--friction-amplitude-mm", 5).stdout)

    def test_it_draws(self):
        picture = self.folder / "modes.png"
        self.flexarm("modes", "-c", RIG, "--modes", 2, "-o", picture)
        self.assertTrue(picture.read_bytes().startswith(PNG))

    def test_bad_options_are_refused(self):
        for options, said in ((("--modes", 0), "--modes"),
                              (("--base", "spring"), "--base-spring-nm-per-rad"),
                              (("--base-spring-nm-per-rad", 3), "--base spring"),
                              (("--base", "glued"), "--base"),
                              (("--friction-amplitude-mm", 0), "--friction-amplitude-mm"),
                              (("--friction-nm", 1, 1), "--friction-amplitude-mm"),
                              (("-o", "modes.gif"), "expected .png or .svg"),
                              (("--set", "link1.section[0].length_m=-1"), "length_m"),
                              (("--set", "joint2.stiffness_nm_per_rad=0"), "stiffness_nm_per_rad"),
                              (("--set", "joint2.backlash_rad=-1"), "backlash_rad")):
            with self.subTest(options=options):
                self.assert_refused(self.run_program("flexarm", "modes", "-c", RIG, *options), said)


class Bound(ProgramTest):
    MOVE = ("--from", "0,0", "--to", "5,50", "--payload-kg", 0)

    def test_three_times_of_a_move(self):
        # tests/golden/bounds.json: 0.301, 0.299, 0.40 s with 5.6 N m; here 5.58 N m, 0.2 % slower.
        bound = self.flexarm_json("bound", "-c", RIG, *self.MOVE)
        self.assertAlmostEqual(bound["rigid_straight_s"], 0.301, delta=0.002)
        self.assertAlmostEqual(bound["rigid_free_s"], 0.299, delta=0.004)
        self.assertAlmostEqual(bound["flexible_best_found_s"], 0.40, delta=0.06)
        self.assertLess(bound["flexible_violation"], 0.002)
        straight = bound["limits_reached"]["rigid_straight"][0]
        self.assertEqual((straight["key"], straight["index"]), ("limits.strain_limit", 1))
        self.assertGreater(bound["iterations"]["flexible"], 10)

    def test_the_rigid_arm_alone_as_text_and_with_all_torque(self):
        # The elbow alone, which its torque limits: 2 sqrt(M22 D / u), M22 = 0.881906 kg m^2 with 1 kg
        # by the other program, D = 60 deg, u = 0.93 and 1 of 6 N m.
        move = ("--from", "0,-30", "--to", "0,30", "--payload-kg", 1, "--rigid")
        text = self.flexarm("bound", "-c", RIG, *move).stdout
        self.assertIn("rigid arm, straight in joint angles", text)
        self.assertIn("0.814 s, at limits.torque_limit_nm 2 (100 %)", text)
        self.assertNotIn("flexible", text)
        more = self.flexarm_json("bound", "-c", RIG, *move, "--torque-share", 1)
        self.assertEqual(more["torque_nm"], [30.0, 6.0])
        self.assertAlmostEqual(more["rigid_straight_s"], 0.78465, delta=1e-4)
        self.assertNotIn("flexible_best_found_s", more)

    def test_bad_options_are_refused(self):
        for options, said in ((("--from", "0,0", "--to", "0,95"), "limits.soft_angle_deg"),
                              (("--from", "0,0", "--to", "0,0"), "ends where it begins"),
                              (("--from", "0", "--to", "1,1"), "--from"),
                              (("--from", "0,x", "--to", "1,1"), "found x"),
                              (("--to", "1,1"), "--from"),
                              (("--from", "0,0", "--to", "1,1", "--payload-kg", "1.5"),
                               "controller.payload_range_kg"),
                              (("--from", "0,0", "--to", "1,1", "--torque-share", "nan"),
                               "--torque-share")):
            with self.subTest(options=options):
                self.assert_refused(self.run_program("flexarm", "bound", "-c", RIG, *options), said)


class Gauges(ProgramTest):
    def gauges(self, *arguments, rig=RIG):
        return self.flexarm_json("gauges", "-c", rig, *arguments)

    def test_shipped_proposed_and_the_thesis_gauges(self):
        # Mode shapes and least squares by a program of its own.
        for link, sigma in zip(self.gauges()["links"], ((5.28491956e-5, 4.27385192e-7),
                                                        (9.46667472e-5, 5.64682578e-6))):
            self.assertEqual(len(link["shipped"]["position_m"]), 10)
            for found, expected in zip(link["shipped"]["sigma_m"], sigma):
                self.assertAlmostEqual(found / expected, 1.0, delta=1e-6)
            self.assertAlmostEqual(link["shipped"]["covariance_m2"][0][0] / sigma[0] ** 2, 1.0,
                                   delta=1e-6)
            self.assertLess(link["proposed"]["sigma_m"][0], link["shipped"]["sigma_m"][0])
            self.assertEqual(len(link["five_half_bridges"]["position_m"]), 5)
        link = self.gauges("--modes", 3, "--per-link", 6, "--noise", 2)["links"][0]
        self.assertEqual(len(link["proposed"]["position_m"]), 6)
        self.assertEqual(len(link["proposed"]["sigma_m"]), 3)
        self.assertEqual(link["noise_strain"], 2e-6)
        for rig in ("half-bridges.toml", "quanser-2dsfl.toml"):
            self.flexarm("gauges", "-c", ROOT / "config" / rig)

    def test_five_half_bridges_a_link_control_the_arm(self):
        for payload in (0.01, 0.1, 0.2):
            result = self.flexarm_json("simulate", "-c", ROOT / "config/half-bridges.toml",
                                       "--payload-kg", payload, "-o",
                                       self.folder / f"{payload}.flexarm")
            self.assertIs(result["completed"], True)
            self.assertLess(result["tip_settling_time_s"], 2)

    def test_it_draws_the_deflection_by_gauges_and_truly(self):
        picture = self.folder / "gauges.png"
        errors = self.gauges("-o", picture)["verification"]
        self.assertTrue(picture.read_bytes().startswith(PNG))
        self.assertLess(max(errors["modal_rms_mm"]), 0.12)
        self.assertGreater(min(errors["largest_mm"]), 7)

    def test_bad_options_are_refused(self):
        for options, said in ((("--modes", 0), "--modes"), (("--modes", 3, "--per-link", 2), "modes"),
                              (("--per-link", 90), "no room"), (("-o", "x.gif"), ".png or .svg"),
                              (("--noise-microstrain", 0), "--noise-microstrain")):
            with self.subTest(options=options):
                self.assert_refused(self.run_program("flexarm", "gauges", "-c", RIG, *options), said)


class Excite(ProgramTest):
    def excite(self, *arguments):
        return self.flexarm_json("analyze", "excite", "-c", RIG, *arguments)

    def test_the_square_wave_of_chapter_4_moves_the_arm_as_the_reference_does(self):
        # The tip at 3 s by an eighth-order integrator; the default one, of second order, differs by
        # 6 um.
        picture = self.folder / "square-wave.png"
        result = self.excite("--without-dissipation", "--motor-lag-ms", 0, 0, "--modes", 2, "--set",
                             "arm.link1_tip_inertia=motor", "-o", picture)
        for found, expected in zip(result["final_tip_m"], (1.690807100, 0.145161223)):
            self.assertAlmostEqual(found, expected, delta=2e-5)
        # Link 2's peak lies between the reference's samples, 10 ms apart.
        self.assertAlmostEqual(result["peak_bending_mm"][0], 18.56, delta=0.03)
        self.assertAlmostEqual(result["peak_bending_mm"][1], 15.06, delta=0.03)
        self.assertTrue(picture.read_bytes().startswith(PNG))

    def test_the_motors_lag_is_that_of_the_config_or_another(self):
        shipped, none, slow = (self.excite(*options) for options in (
            (), ("--motor-lag-ms", 0, 0), ("--motor-lag-ms", 10, 10)))
        self.assertEqual(shipped["motor_lag_ms"], [2, 2])
        self.assertEqual(none["motor_lag_ms"], [0, 0])
        self.assertAlmostEqual(none["peak_bending_mm"][0], 7.88, delta=0.02)
        for one, other in zip(none["peak_bending_mm"], slow["peak_bending_mm"]):
            self.assertLess(other, 0.96 * one)
        self.assertEqual(shipped, self.excite("--motor-lag-ms", 2, 2))

    def test_friction_and_damping_reduce_the_bending(self):
        free = self.excite("--without-dissipation")["peak_bending_mm"]
        for with_losses, without in zip(self.excite()["peak_bending_mm"], free):
            self.assertLess(with_losses, 0.8 * without)

    def test_bad_options_are_refused(self):
        for options, said in ((("--modes", 0), "--modes"), (("--duration-s", "nan"), "--duration-s"),
                              (("--torque-nm", 1), "--torque-nm"),
                              (("-o", "picture.gif"), "expected .png or .svg")):
            with self.subTest(options=options):
                self.assert_refused(self.run_program("flexarm", "analyze", "excite", "-c", RIG,
                                                     *options), said)


class Linearize(ProgramTest):
    def linearize(self, config, *arguments):
        return self.flexarm_json("analyze", "linearize", "-c", config, *arguments)

    def test_roots_at_rest_are_the_natural_frequencies(self):
        undamped = ("--set", "arm.damping=none", "--theta2-deg", 60, "--duration-s", 0.01)
        roots = self.linearize(RIG, *undamped)["roots"]
        found = [root["frequency_hz"] for root in roots if root["frequency_hz"] > 0.1]
        expected = self.flexarm_json("modes", "-c", RIG, "--theta2-deg", 60)["arm"]["frequency_hz"]
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertAlmostEqual(a / b, 1.0, delta=1e-6)

    def test_speed_makes_the_thesis_arm_unstable_and_not_the_stiffened_one(self):
        fast = ("--theta1-rate", 5.229, "--set", "arm.damping=none", "--duration-s", 0.01)
        self.assertGreater(self.linearize(RIG, *fast)["largest_real_part_1_s"], 1.0)
        self.assertLess(self.linearize(STIFFENED, *fast)["largest_real_part_1_s"], 0.01)

    def test_the_perturbation_test_is_close_for_small_waves_and_draws(self):
        picture = self.folder / "perturbation.png"
        result = self.linearize(RIG, "--modes", 2, "--theta2-deg", 45, "--theta1-rate", 1,
                                "--delta-nm", 0.01, 0.0025, "--duration-s", 1, "-o", picture)
        self.assertTrue(picture.read_bytes().startswith(PNG))
        for name, error in result["perturbation"]["relative_error"].items():
            self.assertLess(error, 0.05, name)
        self.assertEqual(len(result["A"]), 16)
        self.assertEqual(len(result["B"][0]), 2)

    def test_smoothed_friction_damps(self):
        still = ("--modes", 1, "--duration-s", 0.01)
        without = self.linearize(RIG, *still)["A"]
        smoothed = self.linearize(RIG, *still, "--friction-gain", 2)["A"]
        self.assertLess(smoothed[6][6], without[6][6])
        self.assertTrue(math.isfinite(smoothed[6][6]))

    def test_zeros_and_poles_at_the_origin(self):
        # Zeros by the QZ algorithm on the system's pencil, in a program of its own.
        still = ("--modes", 2, "--theta2-deg", 45, "--duration-s", 0.01)
        result = self.linearize(RIG, *still)
        self.assertEqual(result["poles_at_origin"], {"count": 4, "chains": 2})
        smoothed = self.linearize(RIG, *still, "--friction-gain", 50)
        self.assertEqual(smoothed["poles_at_origin"], {"count": 2, "chains": 2})
        zeros = result["zeros"]
        right = {name: outputs["right_half_plane"] for name, outputs in zeros.items()}
        self.assertEqual(right, {"rotors": 0, "hubs": 0, "link_ends": 1, "tip": 3})
        self.assertIs(zeros["hubs"]["minimum_phase"], True)
        self.assertIs(zeros["tip"]["minimum_phase"], False)
        unstable = [zero["real_1_s"] for zero in zeros["tip"]["zeros"] if zero["real_1_s"] > 0]
        for found, expected in zip(unstable, (76.767, 164.497, 268.728)):
            self.assertAlmostEqual(found, expected, delta=1e-3)
        self.assertAlmostEqual(smoothed["zeros"]["rotors"]["zeros"][0]["imaginary_rad_s"], 4.4538,
                               delta=1e-4)
        self.assertIsNone(self.linearize(RIG, "--modes", 2, "--duration-s", 0.01)["zeros"]["tip"])
        text = self.flexarm("analyze", "linearize", "-c", RIG, *still).stdout
        self.assertIn("poles at the origin: 4, in 2 chains", text)

    def test_bad_options_are_refused(self):
        for options, said in ((("--modes", 0), "--modes"), (("--theta2-deg", "nan"), "--theta2-deg"),
                              (("--duration-s", 0), "--duration-s"),
                              (("--torque-nm", 1), "--torque-nm"),
                              (("-o", "picture.gif"), "expected .png or .svg")):
            with self.subTest(options=options):
                self.assert_refused(self.run_program("flexarm", "analyze", "linearize", "-c", RIG,
                                                     *options), said)


if __name__ == "__main__":
    unittest.main()
