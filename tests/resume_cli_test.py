#!/usr/bin/env python3
"""Fits that are killed, interrupted, or begun twice: they end in the same bits, and leave what they promise.

Arguments: the program. Environment: COUNT, kills for each kind of fit (2); SEED (1).
"""
import os
import pathlib
import random
import shlex
import shutil
import signal
import subprocess
import sys
import time
import unittest

from cli_fixture import ProgramTest, snapshot, take_arguments

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "faults"))
from judge import content

COUNT = int(os.environ.get("COUNT", "2"))
SEED = int(os.environ.get("SEED", "1"))
OFTEN = ("--checkpoint", "0.01")

# Fits whose finished problems are kept, and some that begin anew.
FITS = {
    "stream": ("star", "--terms", "2", "--iterations", "150"),
    "two-step": ("star", "--solver", "two-step", "--iterations", "100"),
    "als": ("star", "--solver", "als", "--iterations", "20"),
    "pca": ("star", "--solver", "pca", "--terms", "2", "--refills", "20"),
    "parts": ("star", "--terms", "2", "--iterations", "60", "--engine", "compute", "--memory", "149M"),
    "lafortune": ("ornament", "--model", "lafortune", "--iterations", "200"),
    "lafortune ceres": ("ornament", "--model", "lafortune", "--solver", "ceres", "--iterations", "10"),
    "fragment": ("star", "--engine", "fragment", "--iterations", "4"),
}


class Resume(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.good("generate", "star", "-o", "star")
        cls.good("generate", "ornament", "-o", "ornament")

    def setUp(self):
        for path in self.root.iterdir():
            if path.name not in ("star", "ornament"):
                shutil.rmtree(path) if path.is_dir() else path.unlink()

    def start(self, *arguments, **options):
        return subprocess.Popen([str(self.program), *arguments], cwd=self.root, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)  # fmt: skip

    def whole(self, *fit):
        begun = time.monotonic()
        self.good("fit", *fit, "-o", "whole")
        return time.monotonic() - begun

    def journal(self, out="fit"):
        return self.root / f"{out}.parts/whole.journal"

    def interrupt_with_something_kept(self, *fit, number=signal.SIGINT):
        """Returns the process's status and what it said, once it has ended."""
        for _ in range(20):
            process = self.start("fit", *fit, *OFTEN, "-o", "fit")
            while process.poll() is None and not self.journal().exists():
                time.sleep(0.001)
            process.send_signal(number)
            said = process.communicate()[1]
            if process.returncode != 0:
                return process.returncode, said
            shutil.rmtree(self.root / "fit")
        self.fail("the fit was faster than the signal, twenty times")

    def same_bits(self):
        self.assertEqual(content(self.root / "whole", False), content(self.root / "fit", False))
        self.assertEqual(sorted(path.name for path in self.root.iterdir()), ["fit", "ornament", "star", "whole"])

    def test_killed_at_random_moments(self):
        for name, fit in FITS.items():
            with self.subTest(name):
                self.setUp()
                duration, chance, killed = self.whole(*fit), random.Random(f"{SEED} {name}"), 0
                while killed < COUNT:
                    process = self.start("fit", *fit, *OFTEN, "--resume", "-o", "fit")
                    try:
                        process.communicate(timeout=chance.uniform(0, duration))
                    except subprocess.TimeoutExpired:
                        process.send_signal(chance.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGINT, signal.SIGTERM)))
                        process.communicate()
                    killed += process.returncode < 0
                    if process.returncode == 0:  # what was kept made it short
                        self.same_bits()
                        shutil.rmtree(self.root / "fit")
                        duration *= 0.9
                self.good("fit", *fit, "--resume", "-o", "fit")
                self.same_bits()

    def test_interrupted(self):
        fit = FITS["stream"]
        self.whole(*fit)
        for number in (signal.SIGINT, signal.SIGTERM):
            status, said = self.interrupt_with_something_kept(*fit, number=number)
            self.assertEqual(status, -number)  # 130 or 143 of a shell
            last = said.splitlines()[-1]
            self.assertRegex(last, f"radiafit: stopped by {number.name}; what is finished is kept in fit.parts; to go on: ")
            self.assertEqual([path.name for path in self.root.iterdir() if path.name.startswith(".")], [])
            self.assertFalse((self.root / "fit").exists())
            again = subprocess.run(shlex.split(last.split("to go on: ")[1]), cwd=self.root, capture_output=True, text=True)
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertIn("fit.parts: goes on from there", again.stderr)
            self.same_bits()
            shutil.rmtree(self.root / "fit")

    def test_a_second_signal_ends_at_once(self):
        process = self.start("fit", "star", "--terms", "4", "--iterations", "100000", "-o", "fit")
        self.assertIn("needs about", process.stderr.readline())
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        process.communicate()
        self.assertIn(process.returncode, (-signal.SIGINT, -signal.SIGTERM))

    def test_a_signal_that_is_ignored_stays_ignored(self):
        ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)  # as of nohup and of jobs in the background
        process = self.start("fit", *FITS["stream"], "-o", "fit", preexec_fn=ignore)
        process.stderr.readline()
        process.send_signal(signal.SIGINT)
        process.communicate()
        self.assertEqual(process.returncode, 0)

    def test_what_is_of_another_fit(self):
        fit = FITS["stream"]
        self.interrupt_with_something_kept(*fit)
        other = ("star", "--terms", "3", "--iterations", "2")
        self.refused("fit", *other, "--resume", "-o", "fit",
                     says=["fit.parts: holds parts of another fit: ", "--terms is 2 there, 3 here",
                           "--iterations is 150 there, 2 here", "leave out --resume"])  # fmt: skip
        self.good("generate", "star", "--seed", "2", "-o", "star2")
        self.refused("fit", "star2", *fit[1:], "--resume", "-o", "fit", says=["it is of another dataset"])
        shutil.rmtree(self.root / "star2")
        again = self.good("fit", *other, "-o", "fit")
        self.assertIn("removed, and the fit begins anew", again.stderr)
        self.good("fit", *other, "-o", "whole")
        self.same_bits()

    def test_journals_that_are_damaged(self):
        fit = FITS["stream"]
        self.whole(*fit)
        self.interrupt_with_something_kept(*fit)
        kept = self.journal().read_bytes()
        for damaged in (b"", kept[:10], b"x" + kept[1:], kept[:200] + b"\1" + kept[201:]):
            self.journal().write_bytes(damaged)
            self.refused("fit", *fit, "--resume", "-o", "fit", says=["whole.journal is damaged"])
        middle = len(kept) - len(kept) // 3
        for damaged in (kept[:-1], kept[:middle], kept[:middle] + b"\1\2\3" + kept[middle + 3 :], kept + b"rest"):
            self.journal().parent.mkdir(exist_ok=True)
            self.journal().write_bytes(damaged)
            again = self.good("fit", *fit, "--resume", "-o", "fit")
            self.assertRegex(again.stderr, r"warning: fit.parts/whole.journal: damaged behind byte \d+")
            self.same_bits()
            shutil.rmtree(self.root / "fit")

    def test_what_is_not_ours_stays(self):
        (self.root / "fit.parts").mkdir()
        (self.root / "fit.parts/letter.txt").write_text("dear")
        fit = FITS["stream"]
        self.interrupt_with_something_kept(*fit)
        self.good("fit", *fit, "-o", "fit")
        self.assertEqual([path.name for path in (self.root / "fit.parts").iterdir()], ["letter.txt"])

    def test_nothing_to_go_on_from(self):
        done = self.good("fit", "star", "--iterations", "2", "--resume", "-o", "fit")
        self.assertIn("fit.parts: nothing there to go on from; the fit begins", done.stderr)
        self.refused("fit", "star", "--checkpoint", "-1", "-o", "new", says=["checkpoint = -1", "0 is never"])

    def test_a_second_run_into_one_folder(self):
        process = self.start("fit", "star", "--terms", "4", "--iterations", "100000", "-o", "new/fit")
        self.assertIn("needs about", process.stderr.readline())
        says = ["new/fit: another run is writing it; wait for that to end, or choose another name"]
        for command in (("fit", "star"), ("generate", "star"), ("export", "problems", "star"), ("fit", "star", "--shard", "1/2")):
            result = self.run_program(*command, "-o", "new/fit")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(len(result.stderr.splitlines()), 1)
            self.assertIn(says[0], result.stderr)
        process.kill()
        process.communicate()
        self.good("fit", "star", "--iterations", "2", "-o", "new/fit")  # no lock of a dead one is in the way
        self.assertEqual(list(snapshot(self.root / "new")), list(snapshot(self.root / "new")))
        self.assertEqual([path.name for path in (self.root / "new").iterdir()], ["fit"])

    def test_tune_prints_what_it_tried(self):
        process = self.start("tune", "star", "--seconds", "600")
        process.stderr.readline()  # of the first that was tried
        process.send_signal(signal.SIGINT)
        printed, said = process.communicate()
        self.assertEqual(process.returncode, -signal.SIGINT)
        self.assertIn("radiafit: stopped by SIGINT; the best of ", said)
        self.assertRegex(printed, r"PSNR, dB .*\n +\d")


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
