#!/usr/bin/env python3
"""radiafit-bench for other machines: linked so, it needs no shared library but the C library's; and `make radiafit-bench`
configures without the libraries of images, meshes and solvers. `make check` builds that.

Arguments: radiafit-bench-alone, the checkout, the compiler.
"""
import platform
import re
import subprocess
import tempfile
import unittest

from cli_fixture import take_arguments

PROGRAM = CHECKOUT = COMPILER = None
ABSENT = ["Ceres", "Qhull", "OpenEXR", "PkgConfig", "PNG", "GTest", "benchmark"]
NEEDED = {"linux-vdso.so.1", "libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "librt.so.1", "ld-linux-x86-64.so.2",
          "ld-linux-aarch64.so.1"}


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{(done.stdout + done.stderr)[-4000:]}")
    return done.stdout


class Alone(unittest.TestCase):
    def test_needs_the_c_library_alone(self):
        names = {line.split()[0].rpartition("/")[2] for line in run("ldd", PROGRAM).splitlines()}
        self.assertTrue(names & {"libc.so.6"}, names)
        self.assertEqual(names - NEEDED, set())

    def test_needs_no_newer_c_library_than_it_says(self):
        said = re.search(r"C library\s+\(glibc\) of version (\d+)\.(\d+)", (CHECKOUT / "docs" / "gpu.md").read_text())
        if platform.libc_ver() != ("glibc", "2.36"):
            self.skipTest("said of builds on Debian 12")
        versions = re.findall(r"GLIBC_(\d+)\.(\d+)", run("objdump", "-T", PROGRAM))
        newest = max((int(major), int(minor)) for major, minor in versions)
        self.assertEqual(newest, (int(said[1]), int(said[2])))

    def test_names_no_folder_of_this_machine(self):
        self.assertNotRegex(run("readelf", "-d", PROGRAM), "R(UN)?PATH")

    def test_runs(self):
        with tempfile.TemporaryDirectory(prefix="radiafit-bench-") as folder:
            run(PROGRAM, "--scale", "smoke", "--device", "compute", "--repetitions", "1", "-o", folder)
        # What --all is made of is there, but for want of a config.
        for part in ("fig8_time", "fig10_utilization", "streaming", "scaling", "passes"):
            self.assertIn(part, run(PROGRAM, "--part", part, "--help"))
        self.assertTrue(re.match("radiafit-bench [0-9.]+ ", run(PROGRAM, "--version")))

    def test_configures_without_other_libraries(self):
        absent = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ABSENT]
        with tempfile.TemporaryDirectory(prefix="radiafit-bench-") as build:
            run("cmake", "--preset", "bench", "-S", CHECKOUT, "-B", build, f"-DCMAKE_CXX_COMPILER={COMPILER}", *absent)
            targets = run("cmake", "--build", build, "--", "-t", "targets", "all")
        self.assertIn("bin/radiafit-bench: ", targets)
        self.assertNotRegex(targets, "radiafit_(reference|image|capture|stereo|publish|cli)[.:]")


if __name__ == "__main__":
    PROGRAM, CHECKOUT, COMPILER = take_arguments(3)
    unittest.main()
