#!/usr/bin/env python3
"""Fits that are killed, interrupted, or begun twice: they end in the same bits, and leave what they promise. Random moments
are in tests/faults. Arguments: the program."""
import contextlib
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

from cli_fixture import ProgramTest, take_arguments

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "faults"))
from judge import content

AT_ONCE = ("--checkpoint", "0.000001")  # each block, as it ends
STREAM = ("star", "--terms", "2", "--iterations", "150")
FITS = {
    "stream": STREAM,
    "two-step": ("star", "--solver", "two-step", "--iterations", "100"),
    "parts": ("star", "--terms", "2", "--iterations", "5", "--engine", "compute", "--memory", "149M"),
    "lafortune": ("ornament", "--model", "lafortune", "--iterations", "100"),
    "prior": ("ornament", "--model", "lafortune", "--prior", "surface", "--iterations", "100"),
    "viewbasis": ("star", "--model", "viewbasis", "--rank", "4", "--blocks", "60", "--surface-side", "6"),
    "sg": ("star", "--model", "sg", "--surface-side", "8", "--iterations", "20"),
}


class Resume(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.dataset("ornament")

    def setUp(self):
        for path in self.root.iterdir():
            if path.name not in ("star", "ornament"):
                shutil.rmtree(path) if path.is_dir() else path.unlink()

    def start(self, *arguments, **options):
        return subprocess.Popen([str(self.program), *arguments], cwd=self.root, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)  # fmt: skip

    def kept(self):
        """Bytes of what is finished; less where a file, or the folder, goes between two looks: merged into the whole."""
        total = 0
        with contextlib.suppress(FileNotFoundError):
            for path in (self.root / "fit.parts").glob("[!.]*"):
                total += path.stat().st_size
        return total

    def stop_once_more_is_kept(self, number, *fit):
        """Status and last words of a fit that is sent a signal once it has kept a block more than before; 0 where it
        was faster."""
        before = self.kept()
        process = self.start("fit", *fit, *AT_ONCE, "-o", "fit")
        while process.poll() is None and self.kept() <= before:
            time.sleep(0.0005)
        process.send_signal(number)
        said = process.communicate()[1]
        return process.returncode, said

    def stop(self, number, *fit):
        for _ in range(20):
            status, said = self.stop_once_more_is_kept(number, *fit)
            if status != 0:
                self.assertEqual(status, -number, said)  # a shell's 130, of SIGINT
                self.assertGreater(self.kept(), 0)
                return said
            shutil.rmtree(self.root / "fit")
        self.fail("the fit was faster than the signal, twenty times")

    def same_bits(self):
        self.assertEqual(content(self.root / "whole", False), content(self.root / "fit", False))
        self.assertEqual(sorted(path.name for path in self.root.iterdir()), ["fit", "ornament", "star", "whole"])

    def test_stopped_thrice(self):
        for name, fit in FITS.items():
            with self.subTest(name):
                self.setUp()
                self.good("fit", *fit, "-o", "whole")
                self.stop(signal.SIGKILL, *fit)
                for number in (signal.SIGINT, signal.SIGKILL):
                    status, _ = self.stop_once_more_is_kept(number, *fit)
                    if status == 0:
                        break
                else:
                    self.assertIn("fit.parts: goes on from there", self.good("fit", *fit, "--resume", "-o", "fit").stderr)
                self.same_bits()

    def test_interrupted(self):
        self.good("fit", *STREAM, "-o", "whole")
        for number in (signal.SIGINT, signal.SIGTERM):
            said = self.stop(number, *STREAM)
            self.assertEqual(said.splitlines()[-1], f"radiafit: stopped by {number.name}; fit.parts keeps what is finished; "
                             "the same command with --resume goes on from there")  # fmt: skip
            self.assertEqual([path.name for path in self.root.iterdir() if path.name.startswith(".")], [])
            self.assertFalse((self.root / "fit").exists())
        self.assertIn("fit.parts: goes on from there", self.good("fit", *STREAM, "-o", "fit").stderr)
        self.same_bits()

    def test_outliers_are_left_out_in_a_second_fit(self):
        fit = (*STREAM, "--leave-out-outliers")
        self.good("fit", *fit, "-o", "whole")
        self.stop(signal.SIGKILL, *fit)
        self.good("fit", *fit, "--resume", "-o", "fit")
        self.same_bits()

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
        process = self.start("fit", *STREAM, "-o", "fit", preexec_fn=ignore)
        process.stderr.readline()
        process.send_signal(signal.SIGINT)
        process.communicate()
        self.assertEqual(process.returncode, 0)

    def test_what_is_of_another_fit(self):
        self.stop(signal.SIGKILL, *STREAM)
        other = ("star", "--terms", "3", "--iterations", "2")
        self.refused("fit", *other, "--resume", "-o", "fit",
                     says=["fit.parts: holds parts of another fit: ", "--terms is 2 there, 3 here",
                           "--iterations is 150 there, 2 here", "leave out --resume"])  # fmt: skip
        again = self.good("fit", *other, "-o", "fit")
        self.assertIn("removed, and the fit begins anew", again.stderr)
        self.good("fit", *other, "-o", "whole")
        self.same_bits()

    def test_journals_that_are_damaged(self):
        self.good("fit", *STREAM, "-o", "whole")
        self.stop(signal.SIGKILL, *STREAM)
        journal = self.root / "fit.parts/whole.journal"
        kept = journal.read_bytes()
        first = kept.index(b"\n") + 1  # byte of the first block
        middle = (first + len(kept)) // 2
        for damaged in (kept + b"rest", kept[:-1], kept[:middle], kept[:middle] + bytes([kept[middle] ^ 1]) + kept[middle + 1 :],
                        kept[: first + 9], kept[:first] + b"\xff" * 24 + kept[first + 24 :]):  # fmt: skip
            journal.parent.mkdir(exist_ok=True)
            journal.write_bytes(damaged)
            again = self.good("fit", *STREAM, "--resume", "-o", "fit")
            self.assertRegex(again.stderr, r"warning: fit.parts/whole.journal: damaged behind byte \d+")
            self.same_bits()
            shutil.rmtree(self.root / "fit")

    def test_what_is_not_ours_stays(self):
        (self.root / "fit.parts").mkdir()
        (self.root / "fit.parts/letter.txt").write_text("dear")
        self.good("fit", *STREAM, *AT_ONCE, "-o", "fit")
        self.assertEqual([path.name for path in (self.root / "fit.parts").iterdir()], ["letter.txt"])

    def test_nothing_to_go_on_from(self):
        done = self.good("fit", "star", "--iterations", "2", "--resume", "-o", "fit")
        self.assertIn("fit.parts: nothing there to go on from; the fit begins", done.stderr)

    def test_a_second_run_into_one_folder(self):
        process = self.start("fit", "star", "--terms", "4", "--iterations", "100000", "-o", "new/fit")
        self.assertIn("needs about", process.stderr.readline())
        for command in (("fit", "star"), ("generate", "star"), ("export", "problems", "star"), ("fit", "star", "--shard", "1/2")):
            result = self.run_program(*command, "-o", "new/fit")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(result.stderr, "radiafit: new/fit: another run is writing it; wait for that to end, or choose another name\n")
        process.kill()
        process.communicate()
        self.good("fit", "star", "--iterations", "2", "-o", "new/fit")  # no lock of a dead one is in the way
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
