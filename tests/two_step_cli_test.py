#!/usr/bin/env python3
"""The two-step solver's files as a user meets them: records kept and found again, full disks, runs that are broken off.

Arguments: the program.
"""
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import unittest

from cli_fixture import ProgramTest, snapshot, take_arguments

FIT = ("--solver", "two-step", "--iterations", "2")


class TwoStep(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")

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

    def test_surface_maps_of_their_own_sides(self):
        own = ("--iterations", "2", "--texels-per-pixel", "1.5")
        self.good("fit", "star", "--solver", "two-step", *own, "--records", "records", "-o", "two-step")
        again = self.good("fit", "star", "--solver", "two-step", *own, "--records", "records", "-o", "again")
        self.assertIn("records of an earlier run", again.stderr)
        self.good("fit", "star", *own, "-o", "stream")
        self.assertIn("sides.exr", self.parameters("stream"))
        self.assertRegex(self.good("info", "stream").stdout, r"surface maps of sides 2 to \d+")
        psnr = [json.loads(self.good("judge", fit, "--json").stdout)["psnr"] for fit in ("two-step", "again", "stream")]
        self.assertEqual(psnr[0], psnr[1])
        self.assertAlmostEqual(psnr[0], psnr[2], delta=0.01)
        self.good("render", "stream", "-o", "picture")
        for option, words in ((("--engine", "fragment"), "all surface maps have one side"),
                              (("--distributor", "gl", "--solver", "two-step"), "all surface maps have one side"),
                              (("--model", "lambert"), "--texels-per-pixel means nothing to"),
                              (("--surface-side", "5"), "leave out --surface-side")):  # fmt: skip
            self.refused("fit", "star", "--texels-per-pixel", "1", *option, "-o", "no", says=[words])

    def test_memory_does_not_change_the_records(self):
        for memory in ("1G", "20K"):
            self.good("fit", "star", *FIT, "--sort-memory", memory, "--records", f"records-{memory}", "-o", f"fit-{memory}")
        large, small = (snapshot(self.root / f"records-{memory}") for memory in ("1G", "20K"))
        for name in ("records.bin", "index.bin"):
            self.assertEqual(large[name], small[name], name)

    def test_records_of_something_else(self):
        self.good("fit", "star", *FIT, "--records", "records", "-o", "fit")
        for other in (("--surface-side", "4"), ("--record", "full"), ("--space", "linear"), ("--texels-per-pixel", "1")):
            self.refused("fit", "star", *FIT, *other, "--records", "records", "-o", "other",
                         says=["records/records.json: ", "choose another --records folder"])

    def test_records_of_other_pixels(self):
        shutil.copytree(self.root / "star", self.root / "other")
        description = self.root / "other/dataset.json"  # as older versions wrote it, without checksums
        text = re.sub(r',?"checksum":"\w+"|"checksums": .*,', "", description.read_text())
        description.write_text(text.replace('"version": 4', '"version": 1'))
        self.good("fit", "other", *FIT, "--records", "records", "-o", "fit")
        images = self.root / "other/images.bin"
        images.write_bytes(bytes(byte // 2 for byte in images.read_bytes()))
        self.refused("fit", "other", *FIT, "--records", "records", "-o", "again",
                     says=["records/records.json: ", "choose another --records folder"])

    def test_damaged_records(self):
        self.good("fit", "star", *FIT, "--records", "records", "-o", "fit")
        for name in ("records.bin", "index.bin", "records.json"):
            path = self.root / "records" / name
            whole = path.read_bytes()
            # cut short, a bit changed somewhere
            middle = len(whole) // 2
            for bad in (whole[:-1], whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]):
                path.write_bytes(bad)
                with self.subTest(name=name, length=len(bad) - len(whole)):
                    if name == "records.json" and len(bad) < len(whole):
                        continue  # the last byte is a line's end
                    self.refused("fit", "star", *FIT, "--records", "records", "-o", "other", says=[f"records/{name}: "])
            path.unlink()
            if name != "records.json":
                self.refused("fit", "star", *FIT, "--records", "records", "-o", "other",
                             says=[f"records/{name}: missing", "delete the folder records"])
            path.write_bytes(whole)
        self.good("fit", "star", *FIT, "--records", "records", "-o", "other")

    def test_folders_that_are_no_records(self):
        (self.root / "empty").mkdir()
        for folder in ("empty", "star"):
            self.refused("fit", "star", *FIT, "--records", folder, "-o", "fit",
                         says=[f"{folder}/records.json: holds no whole records", "choose another --records folder"])
        for records, output in (("same", "same"), ("a", "a/fit"), ("fit/records", "fit/")):
            self.refused("fit", "star", *FIT, "--records", records, "-o", output, says=["one inside the other"])

    def test_options(self):
        for memory in ("nonsense", "-1", "0", "12Q", ""):
            self.refused("fit", "star", *FIT, "--sort-memory", memory, "-o", "fit", says=["memory", "64M"])
        self.refused("fit", "star", *FIT, "--record", "tiny", "-o", "fit", says=["'tiny'", "compact", "full"])

    def test_full_disk(self):
        def no_more_than_a_page():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        for memory in ("1G", "20K"):  # the records themselves; files in which samples wait
            before = snapshot(self.root)
            result = subprocess.run(
                [str(self.program), "fit", "star", *FIT, "--sort-memory", memory, "--records", "records", "-o", "fit"],
                cwd=self.root, stdin=subprocess.DEVNULL, capture_output=True, text=True, preexec_fn=no_more_than_a_page)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("fit needs about ", result.stderr.splitlines()[0])
            self.assertEqual(result.stderr.count("\n"), 2, result.stderr)
            self.assertIn("records", result.stderr)
            self.assertIn("room", result.stderr)
            self.assertEqual(before, snapshot(self.root), "a broken run left files")

    def kill_while_distributing(self):
        """Starts a fit and kills it while it writes records. False: it was too fast for this machine."""
        process = subprocess.Popen(
            [str(self.program), "fit", "star", *FIT, "--sort-memory", "20K", "--records", "records", "-o", "killed"],
            cwd=self.root, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            while process.poll() is None:
                names = [name for name in os.listdir(self.root) if name.startswith(".radiafit-tmp-") and name.endswith("-records")]
                if any((self.root / name / "waiting.bin").exists() for name in names):
                    break
        finally:
            process.kill()
            process.wait()
        return not (self.root / "records").exists()

    def test_killed_in_the_middle(self):
        self.good("fit", "star", *FIT, "-o", "whole")
        for _ in range(50):
            if self.kill_while_distributing():
                break
            shutil.rmtree(self.root / "records")
            shutil.rmtree(self.root / "killed", ignore_errors=True)
        else:
            self.fail("no run could be killed in time")
        self.assertFalse((self.root / "killed").exists())
        again = self.good("fit", "star", *FIT, "--sort-memory", "20K", "--records", "records", "-o", "killed")
        self.assertNotIn("earlier run", again.stderr)
        self.assertEqual(self.parameters("whole"), self.parameters("killed"))
        self.assertFalse(list(self.root.glob(".radiafit-tmp-*")), "what the killed run left")


if __name__ == "__main__":
    TwoStep.program, = take_arguments(1)
    unittest.main()
