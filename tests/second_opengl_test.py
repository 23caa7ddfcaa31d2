#!/usr/bin/env python3
"""The programs on OpenGLs that are made otherwise: Mesa's llvmpipe by EGL and by OSMesa, and zink over lavapipe (zink.py).

Arguments: the program, radiafit-bench. Exit status 77 (skipped) without lavapipe."""
import csv
import json
import pathlib
import sys
import unittest

import zink
from cli_fixture import ProgramTest, take_arguments

WITHIN = 0.02  # dB between OpenGLs


class SecondOpenGl(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.dataset("ornament")
        cls.zink = zink.environment()

    def psnr(self, dataset, *options, environment=None):
        self.good("fit", dataset, *options, "-o", "fit", "--replace", environment=environment)
        return json.loads(self.good("judge", "fit", "--json").stdout)["psnr"]

    def test_devices_are_told(self):
        said = self.good("devices", environment=self.zink).stdout
        self.assertRegex(said, r"(?m)^egl --device \d+: zink ")
        self.assertRegex(said, r"(?m)^osmesa: llvmpipe ")  # which crashes in Mesa if it is told to be zink
        self.assertIn("--gpu 0: zink ", self.good("--list", program=self.bench, environment=self.zink).stdout)

    def test_fits_are_as_good(self):
        for dataset, *options in [
            ("star", "--model", "lfm", "--terms", "1", "--engine", "fragment"),
            ("star", "--model", "lfm", "--terms", "1", "--engine", "compute"),
            ("star", "--model", "viewbasis", "--blocks", "4", "--engine", "compute"),
            ("ornament", "--model", "lafortune", "--iterations", "10", "--engine", "fragment"),
            ("ornament", "--model", "lafortune", "--iterations", "10", "--engine", "compute"),
        ]:
            with self.subTest(" ".join([dataset, *options])):
                of_llvmpipe = self.psnr(dataset, *options)
                of_zink = self.psnr(dataset, *options, environment=self.zink)
                self.assertLess(abs(of_zink - of_llvmpipe), WITHIN)

    def test_halves_are_rounded_alike(self):
        fit = ("star", "--model", "lfm", "--terms", "1", "--engine", "fragment", "--storage", "fp16")
        by_egl = self.psnr(*fit)
        for environment, *more in [(None, "--context", "osmesa"), (self.zink,)]:
            self.assertLess(abs(self.psnr(*fit, *more, environment=environment) - by_egl), WITHIN)

    def test_bench(self):
        self.good("--scale", "smoke", "--repetitions", 1, "--device", "fragment,compute", "--gpu", 0, "-o", "rows", program=self.bench,
                  environment=self.zink)
        (run,) = (pathlib.Path(self.root) / "rows" / "bench").glob("zink-*/*")
        with open(run / "agreement.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["problem"] for row in rows}, {"star", "bust", "ornament"})
        self.assertEqual({row["agrees"] for row in rows}, {"1"})
        with open(run / "halves.csv", newline="") as file:
            rounding = {row["of"]: (row["values"], row["subnormals"]) for row in csv.DictReader(file)}
        self.assertEqual(rounding["storage"], ("to nearest, ties to even",) * 2)


if __name__ == "__main__":
    ProgramTest.program, SecondOpenGl.bench = take_arguments(2)
    if zink.environment() is None:
        print("skipped: no lavapipe here (scripts/install-packages.sh installs it: mesa-vulkan-drivers)")
        sys.exit(77)
    unittest.main()
