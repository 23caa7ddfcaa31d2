#!/usr/bin/env python3
"""What the program says, and where: bars and colours on terminals alone, --quiet and --json of every command that has them.

Arguments: the program.
"""
import json
import os
import pty
import select
import subprocess
import unittest

from cli_fixture import ProgramTest, take_arguments


class Terminal(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.good("fit", "star", "--iterations", "2", "-o", "fit")

    def on_terminal(self, *arguments, **environment):
        """What a terminal gets on standard error."""
        ours, theirs = pty.openpty()
        base = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "TERM")}
        process = subprocess.Popen(
            [str(self.program), *arguments], cwd=self.root, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=theirs, env={**base, "TERM": "xterm", **environment},
        )  # fmt: skip
        os.close(theirs)
        said = b""
        while True:
            if not select.select([ours], [], [], 60)[0]:
                break
            try:
                more = os.read(ours, 65536)
            except OSError:  # the other end is closed
                break
            if not more:
                break
            said += more
        os.close(ours)
        process.wait()
        return said.decode(errors="replace")

    FIT = ("fit", "star", "--terms", "2", "--iterations", "300", "--replace", "-o", "shown")
    WRONG = ("fit", "nowhere", "-o", "shown")

    def test_bars_and_colours_of_terminals(self):
        said = self.on_terminal(*self.FIT)
        self.assertRegex(said, r"\rfit: vertices  \[#*\.*\] +\d+%")
        self.assertIn("\x1b[K", said)  # the bar goes again
        self.assertNotIn("[#", said.split("\x1b[K")[-1])
        self.assertIn("\x1b[1;31mradiafit: \x1b[0m", self.on_terminal(*self.WRONG))

    def test_no_colours_where_they_are_not_wanted(self):
        self.assertNotIn("\x1b", self.on_terminal(*self.WRONG, NO_COLOR="1"))
        self.assertIn("\x1b", self.on_terminal(*self.WRONG, NO_COLOR=""))
        for options in (self.WRONG, self.FIT):
            self.assertNotIn("\x1b", self.on_terminal(*options, TERM="dumb"))
        self.assertIn("[#", self.on_terminal(*self.FIT, NO_COLOR="1"))  # bars are no colours

    def test_neither_elsewhere(self):
        for arguments in (self.FIT, self.WRONG):
            result = self.run_program(*arguments)
            self.assertNotIn("\x1b", result.stderr)
            self.assertNotIn("\r", result.stderr)

    def test_quiet(self):
        commands = (
            ("generate", "star", "-o", "quiet-star"),
            ("fit", "star", "--iterations", "2", "-o", "quiet-fit"),
            ("plan", "star"),
            ("info", "star"),
            ("judge", "fit"),
            ("render", "fit", "-o", "quiet-view"),
            ("tune", "star", "--seconds", "1", "--model", "lfm", "--terms", "1"),
            ("export", "parameters", "fit", "-o", "quiet-parameters"),
        )
        for command in commands:
            for at in ((*command, "--quiet"), ("--quiet", *command)):
                if "-o" in command:
                    at = tuple(f"{word}-{at[0] == '--quiet'}" if word.startswith("quiet-") else word for word in at)
                self.assertEqual(self.good(*at).stderr, "", at)
        self.assertNotIn("\x1b", self.on_terminal(*self.FIT, "--quiet"))
        self.assertEqual(len(self.run_program("--quiet", *self.WRONG).stderr.splitlines()), 1)

    def test_json(self):
        for command in (
            ("generate", "star", "-o", "json-star"),
            ("fit", "star", "--iterations", "2", "-o", "json-fit"),
            ("fit", "star", "--iterations", "2", "--memory", "1G", "-o", "json-fit"),
            ("plan", "star"),
            ("plan", "star", "--engine", "compute", "--memory", "149M"),
            ("info", "star"),
            ("info", "fit"),
            ("judge", "fit"),
            ("tune", "star", "--seconds", "1", "--model", "lfm", "--terms", "1"),
            ("devices",),
        ):
            with self.subTest(command):
                result = self.good(*command, "--json")
                self.assertIsInstance(json.loads(result.stdout), dict)
                self.assertEqual(result.stderr, "")
        told = json.loads(self.good("fit", "star", "--iterations", "2", "--replace", "-o", "json-fit", "--json").stdout)
        self.assertEqual((told["fit"], told["model"], told["not_finite"]), ("json-fit", "lfm", 0))
        self.assertLess(told["error"], told["error_at_start"])
        plan = json.loads(self.good("plan", "star", "--json").stdout)
        self.assertGreater(plan["memory"]["most_bytes"], 0)
        self.good("fit", "star", "--iterations", "2", "--shard", "1/1", "-o", "json-shard")
        self.assertEqual(json.loads(self.good("merge", "json-shard", "-o", "json-merged", "--json").stdout)["fit"], "json-merged")


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
