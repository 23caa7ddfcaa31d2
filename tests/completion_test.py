#!/usr/bin/env python3
"""Completions in bash itself, and the manual page. Arguments: the program."""
import re
import shutil
import subprocess
import unittest

from cli_fixture import ProgramTest, take_arguments


class Completion(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.root / "radiafit.bash").write_text(cls.good("completion", "bash").stdout)

    def complete(self, line):
        """What bash offers for the last word of a line; words break at = as in bash."""
        words = re.findall(r"=|[^\s=]+", line) + ([""] if line.endswith((" ", "=")) else [])
        if line.endswith("="):
            words = words[:-1]
        script = (f"source radiafit.bash; COMP_WORDS=({' '.join(repr(word) for word in words)}); COMP_CWORD={len(words) - 1}; "
                  "_radiafit; printf '%s\\n' \"${COMPREPLY[@]}\"")  # fmt: skip
        done = subprocess.run(["bash", "-euc", script], cwd=self.root, capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_commands(self):
        self.assertEqual(self.complete("radiafit f"), ["fit"])
        self.assertLessEqual({"fit", "judge", "import", "tune", "completion"}, set(self.complete("radiafit ")))
        self.assertEqual(self.complete("radiafit import co"), ["colmap"])
        self.assertEqual(self.complete("radiafit --quiet ju"), ["judge"])

    def test_options(self):
        self.assertEqual(self.complete("radiafit fit star --surface-"), ["--surface-side"])
        self.assertEqual(self.complete("radiafit fit star --res"), ["--resume"])
        self.assertEqual(self.complete("radiafit import lights --sample"), ["--sample-width"])
        self.assertEqual(self.complete("radiafit judge fit --qu"), ["--quiet"])
        self.assertEqual(self.complete("radiafit judge fit --surf"), [])

    def test_values(self):
        for line in ("radiafit fit star --engine ", "radiafit fit star --engine=", "radiafit fit --terms 2 star --engine "):
            self.assertEqual(self.complete(line), ["cpu", "fragment", "compute"])
        self.assertEqual(self.complete("radiafit plan star --optimizer=lb"), ["lbfgs"])
        self.assertIn("two-step", self.complete("radiafit fit star --solver t"))
        self.assertIn("lafortune", self.complete("radiafit fit star --model la"))
        self.assertEqual(self.complete("radiafit generate b"), ["bust"])
        self.assertEqual(self.complete("radiafit completion z"), ["zsh"])
        self.assertEqual(self.complete("radiafit judge fit --split va"), ["validation"])
        self.assertEqual(self.complete("radiafit fit st"), [])  # files, which bash goes on with

    def test_every_option_of_the_help_is_completed(self):
        for command in ("fit", "plan", "judge", "render", "tune", "generate", "import colmap"):
            told = set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", self.good(*command.split(), "--help").stdout, re.M))
            self.assertGreater(len(told), 3, command)
            self.assertLessEqual(told, set(self.complete(f"radiafit {command} --")), command)

    def test_other_shells(self):
        self.assertTrue(self.good("completion", "zsh").stdout.startswith("#compdef radiafit\n"))
        fish = self.good("completion", "fish").stdout
        self.assertRegex(fish, r"(?m)^complete -c radiafit -n '__fish_seen_subcommand_from fit' -l engine -x -a 'cpu fragment compute'")
        for shell, program in (("zsh", "zsh"), ("fish", "fish")):
            if shutil.which(program):
                subprocess.run([program, "-n"], input=self.good("completion", shell).stdout, text=True, check=True)
        self.refused("completion", "tcsh", says=["tcsh", "bash", "zsh", "fish"])


class ManualPage(ProgramTest):
    REQUESTS = {"TH", "SH", "SS", "TP", "PP"}

    def test_structure(self):
        page = self.good("options", "--man").stdout
        lines = page.splitlines()
        self.assertRegex(lines[0], r'^\.TH RADIAFIT 1 "" "radiafit \S+" "User Commands"$')
        self.assertEqual(re.findall(r"(?m)^\.SH (.*)", page),
                         ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "COMMANDS", "EXIT STATUS", "ENVIRONMENT", "FILES"])
        for line in lines:
            self.assertNotEqual(line, "")  # roff would set a space
            if line[0] in ".'":
                self.assertIn(re.match(r"[.'](\w+)", line)[1], self.REQUESTS, line)
            self.assertRegex(line, r"^([^\\]|\\-|\\e|\\&|\\f[BIR])*$")
            opened = re.findall(r"\\f([BIR])", line)
            self.assertTrue(not opened or opened[-1] == "R", line)
        for option in ("fit", "import colmap", "judge"):
            self.assertIn(f".SS radiafit {option}\n", page)
        self.assertIn("\\fB\\-\\-surface\\-side\\fR \\fIINT\\fR", page)

    def test_groff_has_no_complaint(self):
        page = self.good("options", "--man").stdout
        for tool in (["groff", "-man", "-Tascii", "-ww", "-z"], ["mandoc", "-T", "lint", "-W", "warning"]):
            if shutil.which(tool[0]):
                done = subprocess.run(tool, input=page, capture_output=True, text=True)
                self.assertEqual(done.stdout + done.stderr, "", tool)


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
