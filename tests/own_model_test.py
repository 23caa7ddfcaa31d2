#!/usr/bin/env python3
"""Texel-local models that are a file: fitted by every engine and optimizer, kept with the fit, refused with the line.

Arguments: the program, the checkout.
"""
import json
import os
import shutil
import tempfile
import unittest

from cli_fixture import ProgramTest, take_arguments

CHECKOUT = None
OTHER = "// Another text.\n"


class OwnModel(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("ornament")
        cache = tempfile.TemporaryDirectory(prefix="radiafit-models-")  # of models that this test compiles
        cls.addClassCleanup(cache.cleanup)
        os.environ["XDG_CACHE_HOME"] = cache.name
        os.environ["CXX"] = cls.compiler_with("-O1")
        cls.text = (CHECKOUT / "examples/own_model.glsl").read_text()
        (cls.root / "blinn.glsl").write_text(cls.text)
        cls.told = cls.good("model", "blinn.glsl").stdout
        cls.good("fit", "ornament", "--model", "blinn.glsl", "-o", "own")

    def judged(self, fit):
        return json.loads(self.good("judge", fit, "--json").stdout)["psnr"]

    def test_what_it_is_is_said(self):
        self.assertRegex(self.told, r"^blinn: compiled in [0-9.]+ s, and kept\n")
        self.assertIn("  rho_s, 0 to 4\nshape, which the channels share, with 3 starts:\n  log_n, 0 to 7\n", self.told)
        told = json.loads(self.good("model", "blinn.glsl", "--json").stdout)
        self.assertEqual((told["name"], told["compile_s"], len(told["parameters"])), ("blinn", 0, 7))

    def test_every_engine_and_optimizer_finds_what_levenberg_marquardt_does(self):
        best = self.judged("own")
        for options in (("--optimizer", "cg"), ("--optimizer", "lbfgs"), ("--solver", "two-step"),
                        ("--engine", "fragment"), ("--engine", "compute"), ("--engine", "compute", "--optimizer", "adam", "--iterations", "400")):
            self.good("fit", "ornament", "--model", "blinn.glsl", *options, "--replace", "-o", "other")
            self.assertAlmostEqual(self.judged("other"), best, delta=0.3, msg=options)

    def test_a_fit_keeps_its_text_and_is_opened_where_it_was_compiled_alone(self):
        self.assertEqual((self.root / "own/model.glsl").read_text(), self.text)
        shutil.copytree(self.root / "own", self.root / "strange")
        with open(self.root / "strange/model.glsl", "a") as file:
            file.write(OTHER)
        self.refused("judge", "strange", says=["strange/model.glsl: the fit's model is a text that was never compiled here", "run `radiafit model strange`"])
        self.assertIn("blinn: compiled in", self.good("model", "strange").stdout)
        self.assertEqual(self.judged("strange"), self.judged("own"))
        self.good("render", "own", "--all", "held-out", "-o", "renders")
        self.good("export", "maps", "own", "-o", "maps")

    def test_shards_are_merged_by_the_text_they_keep(self):
        for shard in (1, 2):
            self.good("fit", "ornament", "--model", "blinn.glsl", "--shard", f"{shard}/2", "-o", f"shard{shard}")
        self.good("merge", "shard1", "shard2", "-o", "merged")
        self.assertEqual(self.judged("merged"), self.judged("own"))

    def test_wrong_texts_are_refused_by_their_lines(self):
        # Some are compiled before they are known to be wrong, and none of those runs.
        quick = {"CXX": self.compiler_with("-O0")}
        for name, old, new, says in (
            ("names", "coefficient_names", "other_names", "a texel model's text must define coefficient_names[BASIS_COUNT]"),
            ("unknown", "exp(exp(s.x[0]) * t.x[1])", "sin(s.x[0])", "unknown.glsl:20: "),
            ("typing", "b.x[0] = t.x[0];", "b.x[0] = t.y;", "typing.glsl:19: "),
            ("cut", "    return b;\n}\n\n#ifdef", "", "cut.glsl:"),
            ("9lives", "", "", "a model is named as its file"),
            ("lafortune", "", "", "there is a model lafortune in the program already"),
            ("viewbasis", "", "", "there is a model viewbasis in the program already"),
            ("bounds", "", "", "the program has a text bounds itself"),
            ("slash", '"rho_d", "rho_s"', '"../rho", "rho_s"', "named '../rho': take letters, digits and _"),
            ("shaped", "b.x[0] = t.x[0];", "b.x[0] = t.x[0] * s.x[0];", "rho_d depends on the shape; by SHAPED_COUNT the last basis function alone does"),
            ("twice", '"rho_d", "rho_s"', '"rho_d", "log_n"', "two maps of a fit would be named log_n"),
        ):
            (self.root / f"{name}.glsl").write_text(self.text.replace(old, new) if old else self.text)
            self.refused("plan", "ornament", "--model", f"{name}.glsl", environment=quick, says=[f"{name}.glsl", says])
        self.refused("fit", "ornament", "--model", "none.glsl", "-o", "new", says=["none.glsl: no such model"])
        self.refused("fit", "ornament", "--model", "blinn.glsl", "--solver", "ceres", "-o", "new", says=["model blinn: Ceres"])
        no_compiler = {"PATH": "/nowhere", "CXX": ""}
        (self.root / "fresh.glsl").write_text(self.text)
        self.refused("model", "fresh.glsl", environment=no_compiler, says=["no C++ compiler"])

    def test_another_text_is_another_fit(self):
        self.assertIn("done already", self.good("fit", "ornament", "--model", "blinn.glsl", "-o", "own").stderr)
        (self.root / "elsewhere").mkdir()
        (self.root / "elsewhere/blinn.glsl").write_text(self.text + OTHER)
        self.refused("fit", "ornament", "--model", "elsewhere/blinn.glsl", "-o", "own", says=["--replace"])


if __name__ == "__main__":
    ProgramTest.program, CHECKOUT = take_arguments(2)
    unittest.main()
