#!/usr/bin/env python3
"""What `fit` announces of memory holds: every solver takes no more, and no solver a small part of it only.

Arguments: the program.
"""
import os
import re
import subprocess
import unittest

from bad_inputs.fixtures import write_tiny
from cli_fixture import ProgramTest, take_arguments

PROGRAM = 150e6  # part of what is announced: the program itself, with the largest of its libraries
SHADERS = 20e6  # what a driver in software may take for the shaders that one optimizer has more than another
UNITS = {"kB": 1e3, "MB": 1e6, "GB": 1e9}
# Solver and sizes at which one vertex takes much more than the program.
SOLVERS = [
    ("--solver als --surface-side 28 --view-side 28 --terms 4 --iterations 1", 2),
    ("--solver varpro --surface-side 28 --view-side 12 --terms 4 --iterations 1", 3),
    ("--solver ceres --ceres dense-normal-cholesky --surface-side 14 --view-side 14 --terms 3 --iterations 1", 3),
    ("--solver ceres --ceres dense-qr --surface-side 10 --view-side 10 --terms 4 --iterations 1", 3),
    ("--solver ceres --ceres dense-schur --surface-side 16 --view-side 20 --terms 3 --iterations 1", 4),
    ("--solver ceres --ceres dense-schur-maps --surface-side 14 --view-side 12 --terms 3 --iterations 1", 3),
    ("--solver ceres --ceres iterative-schur --surface-side 64 --view-side 2 --terms 4 --iterations 1", 4),
    ("--solver ceres --ceres cgnr --surface-side 64 --view-side 2 --terms 4 --iterations 1", 4),
    ("--solver pca --surface-side 32 --view-side 32 --terms 2", 4),
]


class Needs(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_tiny(cls.root / "photos")
        cls.good("import", "colmap", "--model", "photos/text", "--images", "photos/images", "--mesh", "photos/mesh.obj",
                 "--holdout", "none", "-o", "tiny")  # fmt: skip
        cls.dataset("star")

    def measured_and_announced(self, *options, dataset="tiny"):
        """Bytes: the largest resident set, and what stderr says."""
        command = [self.program, "--threads", "1", "fit", dataset, *options, "--replace", "-o", "new"]
        with open(self.root / "stderr", "w+") as stderr:
            # Each run compiles its shaders, so that all take the driver's memory for it; large blocks of memory go back
            # when they are let go.
            environment = os.environ | {"MESA_SHADER_CACHE_DISABLE": "true", "MALLOC_MMAP_THRESHOLD_": "65536"}
            process = subprocess.Popen(command, cwd=self.root, env=environment, stdin=subprocess.DEVNULL, stderr=stderr)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            stderr.seek(0)
            text = stderr.read()
        self.assertEqual(process.returncode, 0, text)
        number, unit = re.search(r"fit needs about ([\d.]+) (.B) of memory", text).groups()
        return usage.ru_maxrss * 1024, float(number) * UNITS[unit] - PROGRAM

    def test_vertex_after_vertex(self):
        empty, _ = self.measured_and_announced("--iterations", "0")
        for options, most in SOLVERS:
            with self.subTest(options):
                measured, announced = self.measured_and_announced(*options.split())
                measured -= empty
                self.assertGreater(measured, 4e6)
                self.assertGreater(announced, measured)
                self.assertLess(announced, most * measured)

    def test_vectors_of_the_optimizer(self):
        # The CPU holds them for one vertex at a time, the others for all; shaders of few terms compile faster.
        one_vertex = ("tiny", "--surface-side", "64", "--view-side", "64", "--terms", "16")
        all_vertices = ("star", "--surface-side", "24", "--view-side", "40", "--terms", "1")
        for engine, (dataset, *sides), least, shaders in (("cpu", one_vertex, 10e6, 0), ("fragment", all_vertices, 80e6, SHADERS),
                                                          ("compute", all_vertices, 80e6, SHADERS)):  # fmt: skip
            (plain, plain_announced), (measured, announced) = (
                self.measured_and_announced("--engine", engine, *sides, "--iterations", "0", *more, dataset=dataset)
                for more in ((), ("--optimizer", "lbfgs", "--history", "8")))
            with self.subTest(engine):
                self.assertGreater(measured - plain, least)
                self.assertGreater(announced - plain_announced, 0.9 * (measured - plain - shaders))
                self.assertLess(announced - plain_announced, 1.3 * (measured - plain))


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
