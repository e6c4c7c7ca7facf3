#!/usr/bin/env python3
"""Manual pages and completion: both are made of the verbs and options that --help shows."""

import os
import re
import shutil
import subprocess
import unittest

from program import BIN, HIL, ROOT, ProgramTest

COMPLETION = ROOT / "tools/command_line/completions"


class Manual(ProgramTest):
    def pages(self):
        for program in ("flexarm", "flexarm-study", "flexarm-web", "flexarmd"):
            subprocess.run([BIN / program, "--write-manual", self.folder], check=True, timeout=60)
        return sorted(self.folder.glob("man*/*"))

    def test_every_verb_has_a_page_and_no_page_is_written_twice(self):
        names = {page.name for page in self.pages()}
        verbs = set(re.findall(r"^  ([a-z][a-z-]+)  ", self.flexarm("--help").stdout, re.M))
        self.assertGreater(len(verbs), 30)
        self.assertEqual({"flexarm.1", "flexarm-study.1", "flexarm-web.1", "flexarmd.8"} |
                         {f"flexarm-{verb}.1" for verb in verbs}, names)

    def test_no_page_has_a_character_that_is_not_printable(self):
        for page in self.pages():
            self.assertRegex(page.read_text(encoding="utf-8"), r"\A[\n -~]*\Z", page)

    def test_a_page_has_every_option_of_the_help(self):
        self.pages()
        for words in (("simulate",), ("config", "new"), ("modes",), ("run",)):
            page = (self.folder / f"man1/flexarm-{words[0]}.1").read_text(encoding="utf-8")
            plain = page.replace("\\-", "-").replace("\\fB", "").replace("\\fR", "")
            options = set(re.findall(r"(?<![\w-])--[a-z][\w-]*",
                                     self.flexarm(*words, "--help").stdout))
            self.assertGreater(len(options), 2)
            for option in options:
                self.assertIn(option, plain, words)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_the_pages_are_correct(self):
        for page in self.pages():
            told = subprocess.run(["groff", "-man", "-Tascii", "-ww", "-z", page], check=True,
                                  capture_output=True, text=True, timeout=60)
            self.assertEqual(told.stderr, "", page)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_a_page_reads_as_the_help_does(self):
        self.pages()
        told = subprocess.run(["groff", "-man", "-Tascii", "-P-cbou",
                               self.folder / "man1/flexarm-explain.1"], check=True,
                              capture_output=True, text=True, timeout=60).stdout
        plain = " ".join(told.split())
        self.assertIn("flexarm-explain - What a trip or a refusal means", plain)
        self.assertIn("flexarm explain [OPTIONS] [name]", plain)
        self.assertIn("Example", plain)


class Complete(ProgramTest):
    def complete(self, *words):
        """What bash offers for the last word."""
        line = " ".join(words)
        script = f"""
          source {COMPLETION}/flexarm.bash
          compopt() {{ :; }}
          COMP_WORDS=({' '.join(f"'{word}'" for word in words)})
          COMP_CWORD={len(words) - 1} COMP_LINE='{line}'
          _flexarm
          printf '%s\\n' "${{COMPREPLY[@]}}"
        """
        environment = dict(os.environ, PATH=f"{BIN}:{os.environ['PATH']}")
        told = subprocess.run(["bash", "-c", script], check=True, capture_output=True, text=True,
                              cwd=self.folder, env=environment, timeout=60)
        self.assertEqual(told.stderr, "")
        return [word for word in told.stdout.splitlines() if word]

    def test_completes_verbs(self):
        self.assertEqual(self.complete("flexarm", "sim"), ["simulate", "sim"])
        self.assertIn("modes", self.complete("flexarm", ""))
        self.assertEqual(set(self.complete("flexarm", "config", "")),
                         {"new", "show", "check", "reference"})

    def test_completes_the_options_of_each_verb(self):
        for verb in ("simulate", "modes", "dashboard"):  # of each program
            offered = set(self.complete("flexarm", verb, "--"))
            helped = set(re.findall(r"(?<![\w-])--[a-z][\w-]*",
                                    self.flexarm(verb, "--help").stdout))
            self.assertTrue(offered)
            self.assertLessEqual(offered, helped, verb)
            listed = re.findall(r"^  (?:-\w,)?(--[a-z][\w-]*)", self.flexarm(
                verb, "--help").stdout, re.M)
            self.assertEqual(set(listed), offered, verb)
        self.assertEqual(self.complete("flexarmd", "--exp"), ["--experiment"])

    def test_completes_files_where_a_file_is_expected(self):
        (self.folder / "my rig.toml").touch()
        (self.folder / "runs").mkdir()
        self.assertEqual(set(self.complete("flexarm", "simulate", "-c", "")),
                         {"my rig.toml", "runs"})
        self.assertEqual(self.complete("flexarm", "plot", "my"), ["my rig.toml"])
        self.assertEqual(self.complete("flexarm", "runs", "--folder", ""), ["runs"])
        self.assertEqual(self.complete("flexarm", "simulate", "--config", "=", "my"),
                         ["my rig.toml"])

    def test_completes_words(self):
        self.assertEqual(self.complete("flexarm", "simulate", "-c", HIL.name, "--controller",
                                       "gain"), ["gain-scheduled"])
        self.assertEqual(self.complete("flexarm", "explain", "soft"),
                         ["soft-limit-1", "soft-limit-2"])
        self.assertEqual(self.complete("flexarm", "simulate", "--set", "limits.tor"),
                         ["limits.torque_limit_nm="])
        self.assertEqual(self.complete("flexarm", "config", "reference", "limits.tor"),
                         ["limits.torque_limit_nm"])
        self.assertEqual(set(self.complete("flexarm", "home", "1", "")), {"low", "high"})

    def test_a_value_of_an_option_is_no_verb_and_no_argument(self):
        self.assertEqual(self.complete("flexarm", "simulate", "--seed", "3", "--estim"),
                         ["--estimator"])

    def test_offers_nothing_where_nothing_is_known(self):
        self.assertEqual(self.complete("flexarm", "status", ""), [])
        self.assertEqual(self.complete("flexarm", "simulate", "--seed", ""), [])

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_the_script_for_zsh_is_a_script_for_zsh(self):
        subprocess.run(["zsh", "-n", COMPLETION / "_flexarm"], check=True, timeout=60)

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_the_script_for_fish_completes(self):
        for line, words in (("flexarm explain soft", ["soft-limit-1", "soft-limit-2"]),
                            ("flexarm modes --js", ["--json"])):
            told = subprocess.run(
                ["fish", "-c", f"source {COMPLETION}/flexarm.fish; complete -C '{line}'"],
                check=True, capture_output=True, text=True, timeout=60,
                env=dict(os.environ, PATH=f"{BIN}:{os.environ['PATH']}"))
            self.assertEqual(told.stdout.split(), words)


if __name__ == "__main__":
    unittest.main()
