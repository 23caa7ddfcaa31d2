#!/usr/bin/env python3
"""The Python module against the program: the same datasets, fits and figures, without copies.

Arguments: the folder of the module, the program, the checkout.
"""
import gc
import json
import os
import subprocess
import sys
import unittest
from unittest import mock

from cli_fixture import ProgramTest, take_arguments

MODULE = CHECKOUT = None


class PythonModule(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        global np, radiafit
        sys.path.insert(0, str(MODULE))
        import numpy as np
        import radiafit

    def setUp(self):
        if not (self.root / "star").exists():
            self.good("generate", "star", "--seed", "3", "-o", "star")
            self.dataset("ornament")
        self.star, self.ornament = (radiafit.Dataset(self.root / name) for name in ("star", "ornament"))

    def memory_of(self, array):
        return array.__array_interface__["data"][0]

    def check_view(self, get):
        """Read-only memory of the owner, the same each time, and there as long as the array is."""
        array = get()
        self.assertFalse(array.flags.owndata)
        self.assertFalse(array.flags.writeable)
        self.assertEqual(self.memory_of(array), self.memory_of(get()))
        with self.assertRaises(ValueError):
            array[...] = 0
        return array

    def test_dataset_is_as_its_file_says(self):
        about = json.loads((self.root / "star/dataset.json").read_text())
        self.assertEqual(self.star.name, about["name"])
        self.assertEqual([v.name for v in self.star.views], [v["name"] for v in about["views"]])
        self.assertEqual(self.star.held_out, [i for i, v in enumerate(about["views"]) if v["held_out"]])
        self.assertEqual(sorted(self.star.held_out + self.star.training), list(range(len(about["views"]))))
        self.assertEqual(self.star.views[0].size, (about["views"][0]["camera"]["width"], about["views"][0]["camera"]["height"]))
        vertices, triangles = self.check_view(lambda: self.star.vertices), self.check_view(lambda: self.star.triangles)
        self.assertEqual(triangles.max(), len(vertices) - 1)
        self.assertTrue(np.isfinite(vertices).all())
        self.assertIsNone(self.star.views[0].light)
        self.assertAlmostEqual(np.linalg.norm(self.ornament.views[0].light["place"]), 1, places=6)

    def test_images_are_the_files(self):
        about = json.loads((self.root / "star/dataset.json").read_text())["views"][1]
        image = self.star.image(1)
        data = (self.root / "star/images.bin").read_bytes()[about["pixel_offset"] :][: image.size]
        self.assertEqual(image.tobytes(), data)
        self.assertIsInstance(image, np.memmap)
        mask = self.star.mask(1)
        self.assertTrue(mask is None or mask.shape == image.shape[:2])
        with self.assertRaises(IndexError):
            self.star.image(len(self.star.views))

    def test_samples_are_those_of_the_exported_problems(self):
        options = {"model": "lfm", "terms": 2, "surface_side": 4}
        self.good("export", "problems", "star", "--model", "lfm", "--terms", "2", "--surface-side", "4", "-o", "problems")
        samples = self.star.samples(**options)
        colours = self.check_view(lambda: samples.colours)
        radiance = np.load(self.root / "problems/training_radiance.npy")
        np.testing.assert_allclose(colours * np.float32(samples.scale), radiance, rtol=1e-6)
        first = self.check_view(lambda: samples.group_first)
        np.testing.assert_array_equal(first, np.load(self.root / "problems/training_group_first.npy"))
        np.testing.assert_array_equal(samples.group_images, np.load(self.root / "problems/training_group_image.npy"))
        self.assertEqual(list(samples.views), self.star.training)
        self.assertEqual(first[-1], len(colours))
        self.assertEqual(len(samples.triangle_groups), len(self.star.triangles) + 1)
        self.assertLess(samples.texels.max(), 10)

    def test_fit_is_the_programs(self):
        for name, options in (("star", {"model": "lfm", "terms": 2, "surface_side": 4}),
                              ("star", {"model": "viewbasis", "rank": 4, "surface_side": 4}),
                              ("star", {"model": "sg", "lobes": 1, "surface_side": 4}),
                              ("ornament", {"model": "lafortune"})):  # fmt: skip
            with self.subTest(**options):
                words = [word for key, value in options.items() for word in (f"--{key.replace('_', '-')}", str(value))]
                out = "fit-" + options["model"]
                self.good("fit", name, *words, "-o", out)
                mine, theirs = radiafit.fit(radiafit.Dataset(self.root / name), **options), radiafit.open_fit(self.root / out)
                for key in mine.arrays:
                    np.testing.assert_array_equal(mine.arrays[key], theirs.arrays[key])
                for key in ("status", "iterations", "samples", "error"):
                    np.testing.assert_array_equal(self.check_view(lambda: getattr(mine, key)), getattr(theirs, key))
                self.assertEqual(mine.options[next(iter(options))], options["model"])
                figures, told = mine.judge(), json.loads(self.good("judge", out, "--json").stdout)
                for key in ("psnr", "ape", "ssim"):
                    self.assertAlmostEqual(figures[key], told[key], places=6)
                self.assertAlmostEqual(figures["baseline"]["psnr"], told["baseline"]["psnr"], places=6)
                self.assertGreater(mine.judge("training", baseline=False)["psnr"], 10)
                texels = self.check_view(lambda: mine.arrays["texels"])
                self.assertTrue(np.isfinite(texels).all())
                kept = texels.copy()
                del mine, theirs
                gc.collect()
                np.testing.assert_array_equal(texels, kept)
                self.assertEqual(set(radiafit.open_fit(self.root / out).array_meanings), set(radiafit.open_fit(self.root / out).arrays))

    def test_a_model_that_is_a_file(self):
        environment = mock.patch.dict(os.environ, CXX=self.compiler_with("-O1"), XDG_CACHE_HOME=str(self.root / "cache"))
        environment.start()
        self.addCleanup(environment.stop)
        options = ["ornament", "--model", CHECKOUT / "examples/own_model.glsl", "--optimizer", "cg"]
        self.good("fit", *options, "-o", "own")
        opened = [sys.executable, "-c", "import radiafit, sys; print(radiafit.open_fit(sys.argv[1]).judge(baseline=False)['psnr'])"]
        judged = subprocess.run([*opened, "own"], cwd=self.root, env={**os.environ, "PYTHONPATH": str(MODULE)}, check=True, capture_output=True, text=True)
        self.assertAlmostEqual(float(judged.stdout), json.loads(self.good("judge", "own", "--json").stdout)["psnr"], places=6)
        mine = radiafit.fit(radiafit.Dataset(self.root / "ornament"), model=str(options[2]), optimizer="cg")
        theirs = radiafit.open_fit(self.root / "own")
        for key in mine.arrays:
            np.testing.assert_array_equal(mine.arrays[key], theirs.arrays[key])
        mine.save(self.root / "own_by_python")
        self.assertEqual(self.good("judge", "own_by_python", "--json").stdout, self.good("judge", "own", "--json").stdout)
        with self.assertRaisesRegex(radiafit.UserError, "none.glsl: no such model"):
            radiafit.fit(radiafit.Dataset(self.root / "ornament"), model="none.glsl")

    def test_saved_fits_are_the_programs(self):
        self.good("fit", "star", "--model", "viewbasis", "--rank", "3", "--surface-side", "4", "-o", "theirs")
        fit = radiafit.fit(self.star, model="viewbasis", rank=3, surface_side=4)
        fit.save(self.root / "mine")
        with self.assertRaisesRegex(radiafit.UserError, "is there already; replace=True"):
            fit.save(self.root / "mine")
        fit.save(self.root / "mine", replace=True)
        theirs = {p.name: p.read_bytes() for p in (self.root / "theirs").rglob("*") if p.suffix == ".exr"}
        self.assertTrue(theirs)
        self.assertEqual(theirs, {p.name: p.read_bytes() for p in (self.root / "mine").rglob("*") if p.suffix == ".exr"})
        self.assertEqual(json.loads(self.good("judge", "mine", "--json").stdout)["psnr"], fit.judge()["psnr"])
        with self.assertRaises(radiafit.UserError):
            radiafit.open_fit(self.root / "mine").save(self.root / "again")

    def test_light_field_maps_are_the_exported_parameters(self):
        self.good("fit", "star", "--model", "lfm", "--terms", "2", "--surface-side", "4", "-o", "maps")
        self.good("export", "parameters", "maps", "-o", "parameters")
        view = np.load(self.root / "parameters/view.npy")
        arrays = radiafit.open_fit(self.root / "maps").arrays
        for vertex in (0, len(view) // 2, len(view) - 1):
            begin = arrays["first_texels"][vertex, 1]
            np.testing.assert_array_equal(arrays["texels"][begin : begin + view.shape[1]], view[vertex])

    def test_render_is_the_programs(self):
        fit = radiafit.fit(self.ornament, model="lafortune")
        seen = fit.render(self.ornament.held_out[0])
        self.assertEqual(seen.shape[2], 4)
        self.assertTrue(0 <= seen[..., 3].min() and seen[..., 3].max() == 1)
        lit = fit.render(self.ornament.held_out[0], light=[0, 0, 2])
        self.assertFalse(np.array_equal(seen, lit))
        np.testing.assert_array_equal(lit, fit.render(self.ornament.held_out[0], light=[0, 0, 1]))

    def test_what_a_user_can_mend_says_how(self):
        fit = radiafit.fit(self.star, model="lfm", terms=1, surface_side=2)
        for call, says in ((lambda: radiafit.Dataset(self.root / "none"), "none"),
                           (lambda: radiafit.fit(self.star, terms=0), "terms"),
                           (lambda: radiafit.fit(self.star, term=1), "terms"),
                           (lambda: radiafit.fit(self.star, model="lafortune"), "light"),
                           (lambda: radiafit.open_fit(self.root / "star"), "star"),
                           (lambda: fit.judge("test"), "held_out"),
                           (lambda: fit.render(0, light=[0, 0, 1]), "light"),
                           (lambda: fit.render(1000), "view 1000")):  # fmt: skip
            with self.assertRaises(radiafit.UserError) as caught:
                call()
            self.assertIn(says, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))

    def test_solve_takes_arrays_as_the_program_does(self):
        text = (CHECKOUT / "examples/solve/peak.glsl").read_text()
        y, x = np.mgrid[:5, :5].reshape(2, -1)
        terms = np.stack([x, y], 1).astype(float)
        rng = np.random.default_rng(1)
        truth = np.stack([rng.uniform(80, 120, 30), rng.uniform(1.5, 2.5, 30), rng.uniform(1.5, 2.5, 30), rng.uniform(1, 1.4, 30), rng.uniform(5, 9, 30)], 1)
        away = (x - truth[:, 1:2]) ** 2 + (y - truth[:, 2:3]) ** 2
        targets = truth[:, :1] * np.exp(-away / (2 * truth[:, 3:4] ** 2)) + truth[:, 4:] + rng.normal(0, 1, (30, 25))
        start = {"height": 100, "x0": 2, "y0": 2, "width": 1.2, "ground": 6}
        found = radiafit.solve(text, terms, targets, start=start)
        self.assertEqual(found["parameter_names"], ["height", "x0", "y0", "width", "ground"])
        self.assertEqual(found["covariance"].shape, (30, 5, 5))
        self.assertTrue((found["status"] == found["status_names"].index("converged")).all())
        self.assertLess(abs((found["parameters"] - truth) / found["sigma"]).max(), 5)
        single = radiafit.solve(text, terms, targets, start=start, precision="float", covariance=False)
        self.assertEqual(single["parameters"].dtype, np.float32)
        self.assertIsNone(single["covariance"])
        np.testing.assert_allclose(single["parameters"], found["parameters"], rtol=1e-3)

        (self.root / "peaks").mkdir()
        (self.root / "peak.glsl").write_text(text)
        np.save(self.root / "peaks/terms.npy", terms)
        np.save(self.root / "peaks/targets.npy", targets)
        given = ",".join(f"{name}={value}" for name, value in start.items())
        self.good("solve", "peaks", "--model", "peak.glsl", "--start", given, "-o", "found")
        for name in ("parameters", "sigma", "covariance", "chi2", "status", "iterations", "samples"):
            np.testing.assert_array_equal(np.load(self.root / f"found/{name}.npy"), found[name])

        # several starts, and sets of different lengths; mistakes name their array
        ragged = radiafit.solve(text, np.tile(terms, (30, 1)), targets.ravel(), start=np.array([[[100, 2, 2, 1.2, 6.0]], [[50, 1, 3, 2, 1.0]]]),
                                offsets=25 * np.arange(31))  # fmt: skip
        self.assertTrue((ragged["chi2"] <= found["chi2"] * (1 + 1e-12)).all())
        for wrong, says in (({"start": {"height": 1}}, "x0"), ({"start": start, "weights": terms}, "weights"),
                            ({"start": start, "lower": {"tilt": 1}}, "tilt"), ({"start": start, "loss": "none"}, "huber"),
                            ({"start": np.ones(4)}, "start"), ({"start": start, "offsets": [0, 3]}, "targets")):  # fmt: skip
            with self.assertRaises(radiafit.UserError) as caught:
                radiafit.solve(text, terms, targets, **wrong)
            self.assertIn(says, str(caught.exception))

    def test_example_plots(self):
        subprocess.run([sys.executable, "-B", CHECKOUT / "examples/plot_fit.py", "star", "plot.png", "model=lfm", "terms=1"],
                       check=True, capture_output=True, cwd=self.root, env={"PYTHONPATH": str(MODULE), "PATH": "/usr/bin:/bin", "HOME": str(self.root)})  # fmt: skip
        self.assertEqual((self.root / "plot.png").read_bytes()[:4], b"\x89PNG")


if __name__ == "__main__":
    MODULE, PythonModule.program, CHECKOUT = take_arguments(3)
    unittest.main()
