#!/usr/bin/env python3
"""The two-step solver's files as a user meets them: records kept and found again, full disks, runs that are broken off.

Arguments: the program.
"""
import json
import resource
import shutil
import signal
import subprocess
import time
import unittest

from cli_fixture import ProgramTest, snapshot, take_arguments

FIT = ("--solver", "two-step", "--iterations", "2")


class TwoStep(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.good("generate", "star", "-o", "star")

    def setUp(self):
        for path in self.root.iterdir():
            if path.name != "star":
                shutil.rmtree(path)

    def parameters(self, fit):
        return {name: digest for name, digest in snapshot(self.root / fit).items() if name.endswith(".exr")}

    def test_kept_records_are_found_again(self):
        self.good("fit", "star", *FIT, "--records", "records", "-o", "first")
        before = snapshot(self.root / "records")
        again = self.good("fit", "star", *FIT, "--records", "records", "-o", "second")
        self.assertIn("records of an earlier run: records", again.stderr)
        self.assertEqual(before, snapshot(self.root / "records"))
        self.assertEqual(self.parameters("first"), self.parameters("second"))
        times = json.loads((self.root / "second/fit.json").read_text())["times_s"]
        self.assertEqual(times["distribution_s"], 0)

    def test_memory_does_not_change_the_records(self):
        for memory in ("1G", "20K"):
            self.good("fit", "star", *FIT, "--memory", memory, "--records", f"records-{memory}", "-o", f"fit-{memory}")
        large, small = (snapshot(self.root / f"records-{memory}") for memory in ("1G", "20K"))
        for name in ("records.bin", "index.bin"):
            self.assertEqual(large[name], small[name], name)

    def test_records_of_something_else(self):
        self.good("fit", "star", *FIT, "--records", "records", "-o", "fit")
        for other in (("--surface-side", "4"), ("--record", "full"), ("--space", "linear")):
            self.refused("fit", "star", *FIT, *other, "--records", "records", "-o", "other",
                         says=["records/records.json: ", "choose another --records folder"])

    def test_damaged_records(self):
        self.good("fit", "star", *FIT, "--records", "records", "-o", "fit")
        arguments = ("fit", "star", *FIT, "--records", "records", "-o", "other")
        large = self.root / "records/records.bin"
        whole = large.read_bytes()
        large.write_bytes(whole[:-1])
        self.refused(*arguments, says=["records/records.bin: ", "delete the folder"])
        large.write_bytes(whole)
        large.write_bytes(b"\xff" * len(whole))
        self.refused(*arguments, says=["records/records.bin: damaged", "delete the folder"])
        index = self.root / "records/index.bin"
        index.write_bytes(b"\xff" * index.stat().st_size)
        self.refused(*arguments, says=["records/index.bin: ", "delete the folder"])
        (self.root / "records/records.json").unlink()
        self.refused(*arguments, says=["records/records.json: ", "delete the folder"])

    def test_options(self):
        for memory in ("nonsense", "-1", "0", "12Q", ""):
            self.refused("fit", "star", *FIT, "--memory", memory, "-o", "fit", says=["memory", "64M"])
        self.refused("fit", "star", *FIT, "--record", "tiny", "-o", "fit", says=["'tiny'", "compact", "full"])

    def test_full_disk(self):
        def no_more_than_a_page():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        for memory in ("1G", "20K"):  # the records themselves; files in which samples wait
            before = snapshot(self.root)
            result = subprocess.run(
                [str(self.program), "fit", "star", *FIT, "--memory", memory, "--records", "records", "-o", "fit"],
                cwd=self.root, stdin=subprocess.DEVNULL, capture_output=True, text=True, preexec_fn=no_more_than_a_page)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertIn("records", result.stderr)
            self.assertIn("room", result.stderr)
            self.assertEqual(before, snapshot(self.root), "a broken run left files")

    def test_killed_in_the_middle(self):
        self.good("fit", "star", *FIT, "-o", "whole")
        arguments = [str(self.program), "fit", "star", *FIT, "--memory", "20K", "--records", "records", "-o", "killed"]
        deadline = time.monotonic() + 60
        process = subprocess.Popen(arguments, cwd=self.root, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            while process.poll() is None and not list(self.root.glob(".tmp-*/*")):
                self.assertLess(time.monotonic(), deadline)
        finally:
            process.kill()
            process.wait()
        self.assertTrue(list(self.root.glob(".tmp-*")), "killed too late")
        self.assertFalse((self.root / "records").exists())
        self.assertFalse((self.root / "killed").exists())
        again = self.good("fit", "star", *FIT, "--memory", "20K", "--records", "records", "-o", "killed")
        self.assertNotIn("earlier run", again.stderr)
        self.assertEqual(self.parameters("whole"), self.parameters("killed"))


if __name__ == "__main__":
    TwoStep.program, = take_arguments(1)
    unittest.main()
