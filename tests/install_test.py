#!/usr/bin/env python3
"""What a user of the library gets: the installed tree alone, from which the examples configure, build with the compiler's
default flags, and run; and what the compiler says of an incomplete texel model.
Usage: install_test.py BUILD_FOLDER SOURCE_FOLDER"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

# Of examples/own_model.cpp what the model itself goes through.
MODEL_ALONE = """#include <radiafit/model/texel_model_of.h>
#define RADIAFIT_TEXEL_MODEL blinn_phong
#define RADIAFIT_TEXEL_FILE "own_model.glsl"
#include <radiafit/model/define_texel_text.h>
radiafit::TexelModelOf<radiafit::texel_text::blinn_phong<float>> model;
"""

build, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def run(*command, cwd=None, good=True):
    environment = {name: os.environ[name] for name in ("PATH", "HOME", "CCACHE_DIR") if name in os.environ}
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, env=environment, check=False)
    said = done.stdout + done.stderr
    if (done.returncode == 0) != good:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{said[-4000:]}")
    return said


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-install-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        run("cmake", "--install", build, "--prefix", cls.folder / "prefix")
        shutil.copytree(source / "examples", cls.folder / "examples")
        cls.configured = run("cmake", "-S", cls.folder / "examples", "-B", cls.folder / "build",
                             f"-DCMAKE_PREFIX_PATH={cls.folder / 'prefix'}")
        cls.built = run("cmake", "--build", cls.folder / "build", "--parallel", "2")

    def result(self, name):
        return run(self.folder / "build" / name, cwd=self.folder)

    def test_nothing_is_warned_about(self):
        self.assertNotRegex(self.configured + self.built, r"[Ww]arning")  # GCC notes how it passes eight floats without AVX

    def test_fit_star_fits_and_judges(self):
        said = self.result("fit_star")
        before, after, psnr = map(float, re.search(r"error (\S+) -> (\S+); held out: PSNR (\S+) dB", said).groups())
        self.assertLess(after, before / 50)
        self.assertGreater(psnr, 21.3)  # the mean colour per texel has less

    def test_own_model_fits(self):
        self.assertGreater(float(re.search(r"PSNR (\S+) dB", self.result("own_model"))[1]), 23)

    def test_own_optimizer_descends(self):
        before, after = map(float, re.search(r"error (\S+) -> (\S+)", self.result("own_optimizer")).groups())
        self.assertLess(after, before / 20)

    def test_examples_are_short_and_link_the_core_alone(self):
        for path in (self.folder / "examples").glob("*.cpp"):
            self.assertLessEqual(len(path.read_text(encoding="utf-8").splitlines()), 40, path.name)
            linked = run("ldd", self.folder / "build" / path.stem)
            self.assertNotRegex(linked.lower(), "openimageio|ceres|assimp|glog")

    def test_nothing_of_this_machine_is_installed(self):
        for path in (self.folder / "prefix").rglob("*"):
            if path.suffix in (".h", ".cmake", ".glsl"):
                text = path.read_text(encoding="utf-8")
                # not within another name: lib/radiafit of a checkout in /radiafit
                self.assertNotRegex(text, r"(?<![\w.}-])" + re.escape(str(source)), path)
                self.assertNotIn("march", text, path)

    def test_the_installed_program_runs(self):
        program = self.folder / "prefix" / "bin" / "radiafit"
        self.assertIn("radiafit", run(program, "--version", cwd=self.folder))

    def test_the_manual_page_and_completions_name_every_option_of_the_table(self):
        table = run(self.folder / "prefix" / "bin" / "radiafit", "options", cwd=self.folder)
        options = re.findall(r"^\| `--([\w-]+)", table, re.M)
        self.assertGreater(len(options), 40)
        share = self.folder / "prefix" / "share"
        named = {  # how each writes an option
            "man/man1/radiafit.1": lambda option: r"\fB\-\-" + option.replace("-", r"\-") + r"\fR",
            "bash-completion/completions/radiafit": "--{} ".format,
            "zsh/site-functions/_radiafit": "--{} ".format,
            "fish/vendor_completions.d/radiafit.fish": "from fit' -l {} ".format,
        }
        for name, written in named.items():
            text = (share / name).read_text(encoding="utf-8")
            self.assertEqual([option for option in options if written(option) not in text], [], name)

    def test_an_incomplete_model_is_told_what_it_lacks(self):
        text = (source / "examples" / "own_model.glsl").read_text(encoding="utf-8")
        lacking = {
            "Basis basis(Shape, Terms)": text.replace("Basis basis(", "Basis other("),
            "coefficient_names[BASIS_COUNT]": text.replace("coefficient_names", "other_names"),
            "TERM_COUNT, BASIS_COUNT and SHAPE_COUNT": text.replace("#define BASIS_COUNT 2", "const int basis_count_ = 2;"),
        }
        include = self.folder / "prefix" / "include"
        for message, lacks in lacking.items():
            trial = self.folder / "trial"
            trial.mkdir(exist_ok=True)
            (trial / "own_model.cpp").write_text(MODEL_ALONE, encoding="utf-8")
            (trial / "own_model.glsl").write_text(lacks, encoding="utf-8")
            said = run("c++", "-std=c++20", "-fsyntax-only", "-I", trial, "-isystem", include, "-isystem", include / "radiafit",
                       "-isystem", "/usr/include/eigen3", trial / "own_model.cpp", good=False)
            self.assertIn(message, said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
