#!/usr/bin/env python3
"""--set and -c work where they are accepted, and are refused with a reason elsewhere."""

import re
import unittest

from program import HIL, ProgramTest

# What a verb needs besides -c to read its config. A verb that is missing here needs nothing.
NEEDS = {
    ("design",): ("-o", "gains.json"),
    ("sweep",): ("--seeds", "1", "-o", "results.sqlite"),
    ("report",): ("-o", "report"),
    ("benchmark",): ("-o", "benchmark"),
    ("identify",): ("--run", "run.flexarm", "--free", "joint1.coulomb_friction_nm"),
    ("replay",): ("run.flexarm",),
    ("bound",): ("--from", "0,0", "--to", "30,30"),
}
NAMES_FILE = {("config", "check"), ("config", "show")}  # the config is an argument


def listed(help_text, heading):
    """The first words of the lines of a part of --help."""
    part = re.search(rf"^{heading}:\n((?:  .*\n|\n)+)", help_text, re.M)
    return re.findall(r"^  (\S+)", part.group(1), re.M) if part else []


class SetOption(ProgramTest):
    def verbs(self, above=()):
        """Every verb of the programs, by what --help lists."""
        text = self.flexarm(*above, "--help").stdout
        for name in listed(text, "Subcommands"):
            yield (*above, name)
            yield from self.verbs((*above, name))

    def test_each_verb_uses_set_or_refuses_it(self):
        self.simulate("run.flexarm")
        verbs = list(self.verbs())
        for named in (("simulate",), ("run",), ("sweep", "show"), ("analyze", "reduce"),
                      ("runs", "tag"), ("config", "new"), ("log", "recover"), ("identify",)):
            self.assertIn(named, verbs)
        used = 0
        for verb in verbs:
            with self.subTest(" ".join(verb)):
                accepts = "--set KEY=VALUE" in self.flexarm(*verb, "--help").stdout
                if accepts:
                    config = (HIL,) if verb in NAMES_FILE else ("-c", HIL)
                    result = self.run_program("flexarm", *verb, *NEEDS.get(verb, ()), *config,
                                              "--set", "nonsense.key=1")
                    self.assertEqual(result.returncode, 2, result.stdout)
                    self.assertRegex(result.stderr, r"nonsense(\.key)?.*unknown|unknown.*nonsense")
                    used += 1
                else:
                    result = self.run_program("flexarm", *verb, "--set", "nonsense.key=1")
                    self.assert_refused(result, f"{' '.join(verb)}: --set has no effect here: ")
                    self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertGreater(used, 15)

    def test_says_what_to_do_instead(self):
        for verb, said in ((("run", "x.toml"), "flexarmd --config FILE --set KEY=VALUE"),
                           (("status",), "flexarmd --config FILE --set KEY=VALUE"),
                           (("info", "run.flexarm"), "flexarm replay RUN -c FILE"),
                           (("sweep", "show", "x"), "the config of their sweep")):
            with self.subTest(verb):
                self.assert_refused(self.run_program("flexarm", *verb, "--set=controller.alpha=1"),
                                    said)
        self.assert_refused(self.run_program("flexarm", "info", "run.flexarm", "-c", HIL),
                            "--config has no effect here")
        self.assert_refused(self.run_program("flexarm", "--set", "a=1", "simulate"),
                            "it belongs after the verb")
        self.assert_refused(self.run_program("flexarm", "sweep", "-c", HIL, "show", "x"),
                            "sweep show: --config and --set have no effect here")

    def test_a_config_tells_a_client_of_the_daemon_its_socket(self):
        config = self.folder / "rig.toml"
        config.write_text(f'extends = "{HIL}"\n[daemon]\nsocket = "{self.folder}/elsewhere"\n',
                          encoding="utf-8")
        refused = self.run_program("flexarm", "status", "-c", config)
        self.assert_refused(refused, "elsewhere")
        self.assert_refused(self.run_program("flexarm", "status", "-c", config, "--socket", "s"),
                            "excludes")

    def test_replay_applies_set_to_the_config_of_the_log(self):
        run, _ = self.simulate("run.flexarm")
        own = self.flexarm_json("replay", run)
        self.assertTrue(own["bit_exact"])
        other = self.flexarm_json("replay", run, "--set", "controller.alpha=2.0")
        self.assertIsNone(other["bit_exact"])
        self.assertGreater(max(other["max_torque_difference_nm"]), 0.01)

    def test_the_daemon_refuses_an_unknown_key(self):
        self.assert_refused(self.run_program("flexarmd", "-c", HIL, "--set", "nonsense.key=1"),
                            "nonsense")


class Guesses(ProgramTest):
    def test_a_misspelt_verb_option_or_key_gets_a_guess(self):
        for arguments, meant in ((("simulat",), "did you mean simulate?"),
                                 (("config", "chek", HIL), "did you mean check?"),
                                 (("simulate", "-c", HIL, "--sead", "2"), "did you mean --seed?"),
                                 (("simulate", "-c", HIL, "--sead=2"), "did you mean --seed?"),
                                 (("modes", "-c", HIL, "--jsn"), "did you mean --json?"),
                                 (("simulate", "-c", HIL, "--set", "controller.alfa=2"), "alpha")):
            with self.subTest(arguments):
                self.assert_refused(self.run_program("flexarm", *arguments), meant)
        self.assert_refused(self.run_program("flexarmd", "--confg", HIL), "did you mean --config?")

    def test_what_is_not_close_to_anything_gets_none(self):
        result = self.run_program("flexarm", "zzzzzzzz")
        self.assert_refused(result, "flexarm --help lists all verbs")
        self.assertNotIn("did you mean", result.stderr)


if __name__ == "__main__":
    unittest.main()
