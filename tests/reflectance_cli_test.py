#!/usr/bin/env python3
"""Reflectance fits as a user meets them: fit, judge, render, over a mesh and over a grid; and what is refused.

Arguments: the program.
"""
import json
import os
import shutil
import unittest

from bad_inputs.fixtures import write_lit, write_pfm
from cli_fixture import ProgramTest, read_png, snapshot, take_arguments


class Reflectance(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("ornament-f32")
        cls.dataset("star")
        cls.good("fit", "ornament", "--model", "lafortune", "-o", "lm")

    def judged(self, fit, *options):
        return json.loads(self.good("judge", fit, "--json", *options).stdout)

    def test_a_fit_above_its_baseline_says_nothing_of_it(self):
        self.assertNotIn("baseline", self.good("fit", "ornament", "-o", "chosen").stderr)

    def test_lafortune_explains_its_own_materials(self):
        judged = self.judged("lm")
        self.assertGreater(judged["psnr"], judged["baseline"]["psnr"])
        self.assertEqual([part["name"] for part in judged["parts"]], ["white", "gold", "green"])
        for fit, diffuse in list(zip(judged["parts"], judged["baseline"]["parts"]))[1:]:
            self.assertGreater(fit["psnr"], diffuse["psnr"] + 8)
        truth = {material["name"]: material for material in judged["truth"]}
        self.assertNotIn("worst_median", truth["white"])  # of another model
        for name in ("gold", "green"):
            self.assertLess(truth[name]["worst_median"], 1e-3)
            self.assertEqual(set(truth[name]["median"]),
                             {f"rho_{k}.{c}" for k in "ds" for c in "RGB"} | {"Cx", "Cz", "n"})
            self.assertLess(truth[name]["rmse"], truth["white"]["rmse"])

    def test_both_instruction_sets_find_the_same(self):
        base = dict(os.environ, RADIAFIT_INSTRUCTIONS="base")
        for optimizer in ("lm", "cg"):
            widest = self.good("fit", "ornament", "--model", "lafortune", "--optimizer", optimizer, "--replace", "-o", "widest")
            self.good("fit", "ornament", "--model", "lafortune", "--optimizer", optimizer, "--replace", "-o", "narrow", environment=base)
            self.assertFalse(json.loads((self.root / "narrow/fit.json").read_text())["provenance"]["march"]["avx512"])
            a, b = self.judged("widest"), self.judged("narrow")
            self.assertAlmostEqual(a["psnr"], b["psnr"], delta=1e-3)

    def test_every_solver_finds_it(self):
        for options in (("--optimizer", "cg", "--iterations", "40"),
                        ("--solver", "two-step"),
                        ("--solver", "two-step", "--optimizer", "cg", "--iterations", "40", "--sort-memory", "1M"),
                        ("--engine", "fragment", "--iterations", "30"),
                        ("--solver", "ceres")):
            self.good("fit", "ornament", "--model", "lafortune", *options, "--replace", "-o", "other")
            truth = {material["name"]: material for material in self.judged("other")["truth"]}
            for name in ("gold", "green"):
                self.assertLess(truth[name]["worst_median"], 1e-3, options)

    def test_a_fit_without_a_finite_problem_is_none(self):
        write_lit(self.root / "lit")
        for i in range(4):
            write_pfm(self.root / f"lit/pfm/{i}.pfm", 6, 5, [1e38 * (1 + (7 * i + j) % 11 / 10) for j in range(90)])
        self.good("import", "lights", "--images", "lit/pfm", "--lights", "lit/lights.txt", "-o", "glaring")
        for optimizer in ("lm", "cg"):
            self.refused("fit", "glaring", "--model", "lambert", "--optimizer", optimizer, "-o", "nothing",
                         says=["glaring: none of 30 problems came to a finite result", "gains and lights"])  # fmt: skip

    def test_one_image_far_brighter_than_all_others_is_told(self):
        write_lit(self.root / "warm")
        write_pfm(self.root / "warm/pfm/2.pfm", 6, 5, [1e5] + [0.5] * 89)
        self.good("import", "lights", "--images", "warm/pfm", "--lights", "warm/lights.txt", "-o", "hot")
        fit = ("fit", "hot", "--model", "lambert", "--iterations", "1", "--replace", "-o", "hot-fit")
        told = self.good(*fit, "--engine", "fragment", "--optimizer", "cg").stderr
        self.assertRegex(told, r"warning: hot: image '2.pfm' goes up to 1e\+05, image '\d.pfm' to 0?\.\d+ only: ")
        self.assertNotIn("warning", self.good(*fit).stderr)  # values themselves, not 16 bits of them

    def test_two_step_gives_the_same_bits(self):
        self.good("fit", "ornament", "--model", "lafortune", "--solver", "two-step", "-o", "steps")
        lm, steps = ({name: digest for name, digest in snapshot(self.root / fit).items() if name.endswith(".exr")}
                     for fit in ("lm", "steps"))
        self.assertEqual(set(lm), {"rho_d.exr", "rho_s.exr", "shape.exr", "problems.exr"})
        self.assertEqual(lm, steps)

    def test_records_are_kept_and_shared(self):
        def fit(*options):
            return ("fit", "ornament", "--solver", "two-step", "--records", "records", *options)

        self.good(*fit("--model", "lambert", "-o", "shared"))
        before = snapshot(self.root / "records")
        self.assertEqual(set(before), {"records.json", "index.bin", "records.bin"})
        for options in (("lafortune", "--optimizer", "cg", "--iterations", "2"), ("lambert", "--clip-above", "0.9"),
                        ("ptm", "--shadow-below", "0.1")):
            again = self.good(*fit("--model", *options, "--replace", "-o", "shared"))
            self.assertIn("records of an earlier run: records", again.stderr)
        self.assertEqual(before, snapshot(self.root / "records"))
        self.refused(*fit("--model", "lambert", "--validation", "5", "-o", "no"),
                     says=["records/records.json", "choose another --records folder"])
        for name in ("index.bin", "records.bin"):
            path = self.root / "records" / name
            whole = path.read_bytes()
            path.write_bytes(whole[:-1])
            self.refused(*fit("--model", "lambert", "-o", "no"), says=[f"records/{name}: damaged", "delete the folder"])
            path.unlink()
            self.refused(*fit("--model", "lambert", "-o", "no"), says=[f"records/{name}: missing", "delete the folder"])
            path.write_bytes(whole)

    def test_fit_json_says_what_was_fitted(self):
        fit = json.loads((self.root / "lm/fit.json").read_text())
        self.assertEqual(fit["model"], "lafortune")
        self.assertEqual(fit["space"], "linear")
        self.assertEqual(fit["options"]["space"], "linear")
        self.assertEqual(fit["options"]["optimizer"], "lm")
        self.assertEqual(fit["options"]["surface_side"], 6)  # the side of the dataset's normals
        self.assertEqual(fit["reflectance"]["parameters"][-1], "log_n")
        self.assertEqual(sum(fit["problems"]["status"].values()), fit["problems"]["count"])
        trace = (self.root / "lm/trace.csv").read_text().splitlines()
        self.assertTrue(trace[1].startswith("lm,cpu,0,"))

    def test_info_and_plan(self):
        self.assertIn("lafortune, 9 parameters in each of 6720 texels", self.good("info", "lm").stdout)
        self.assertEqual(json.loads(self.good("info", "lm", "--json").stdout)["problems"], 6720)
        self.assertIn("samples", self.good("plan", "ornament", "--model", "lafortune").stdout)
        engine = self.good("plan", "ornament", "--model", "lafortune", "--optimizer", "cg").stdout
        self.assertIn("batches of eight", engine)

    def test_options_are_chosen_by_views_left_out(self):
        self.good("fit", "ornament", "--model", "lambert", "--validation", "5", "-o", "partial")
        validation = self.judged("partial", "--split", "validation")
        train, test = self.judged("partial", "--split", "train"), self.judged("partial")
        self.assertEqual((validation["images"], train["images"], test["images"]), (42, 168, 30))  # of 210 and 30
        self.assertEqual(validation["split"], "validation")
        self.refused("judge", "lm", "--split", "validation", says=["--validation"])
        description = self.root / "partial" / "fit.json"
        whole = description.read_text()
        for value in ("4294967298", "true", "5.0", "-5"):
            description.write_text(whole.replace('"validation": 5', f'"validation": {value}'))
            self.refused("judge", "partial", says=["options.validation is no number of views"])
        description.write_text(whole)
        self.refused("fit", "ornament", "--model", "lambert", "--validation", "1", "-o", "no", says=["validation = 1"])

    def test_renders(self):
        self.good("render", "lm", "-o", "view")
        width, height, _ = read_png(self.root / "view.png")
        sheet_width, sheet_height, _ = read_png(self.root / "view_sheet.png")
        self.assertEqual((sheet_width, sheet_height), (4 * width + 12, height))
        self.good("render", "lm", "--light", "0,0,1", "-o", "lit")
        self.good("render", "lm", "--light", "0,0,-1", "-o", "dark")
        self.assertFalse((self.root / "lit_sheet.png").exists())
        lit, dark = (sum(read_png(self.root / f"{name}.png")[2]) for name in ("lit", "dark"))
        self.assertNotEqual(lit, dark)
        self.good("render", "lm", "--turntable", "2", "-o", "turns")
        self.good("render", "lm", "--problems", "-o", "problems")
        self.assertTrue((self.root / "problems.svg").exists())
        self.assertGreater(len(set(read_png(self.root / "problems.png")[2])), 20)
        self.assertFalse(list(self.root.glob(".tmp*")))
        for light, shown in (("0,0,0", "0,0,0"), ("1e300,0,0", "1e+300,0,0"), ("nan,0,1", "nan,0,1")):
            self.refused("render", "lm", "--light", light, "-o", "none", says=[f"--light {shown}: ", "finite and not 0"])
        self.refused("render", "lm", "--view", "-1", "-o", "none", says=["view = -1: ", "from 0"])
        self.refused("render", "lm", "--view", "240", "-o", "none", says=["--view 240: ", "views 0 to 239"])

    def test_a_moved_dataset_is_named(self):
        self.good("fit", "ornament", "--model", "lambert", "-o", "left")
        self.good("fit", "star", "--iterations", "1", "-o", "map")
        for fit, dataset in (("left", "ornament"), ("map", "star")):
            moved, text = f"{dataset}-moved", (self.root / fit / "fit.json").read_text()
            shutil.copytree(self.root / dataset, self.root / moved)
            (self.root / fit / "fit.json").write_text(text.replace(f'"../{dataset}"', '"../gone"'))
            for command in (("judge", fit), ("render", fit, "--replace", "-o", "picture")):
                self.refused(*command, says=["gone", "name its folder by --dataset"])
                self.refused(*command, "--dataset", "nowhere", says=["nowhere", "name its folder by --dataset"])
                self.good(*command, "--dataset", moved)
            self.good("info", fit, "--dataset", moved)
            other = {"ornament": "star", "star": "ornament"}[dataset]
            self.refused("info", fit, "--dataset", other, says=[f"{other}: differs", "name the right folder"])
        self.refused("info", "left", says=["gone", "name its folder by --dataset"])
        self.refused("info", "star", "--dataset", "ornament", says=["--dataset ornament", "star is no fit"])

    def test_a_truth_of_another_size(self):
        folder = self.root / "cut"
        shutil.copytree(self.root / "ornament", folder)
        text = json.loads((folder / "truth.json").read_text())
        text["texels"] -= 1
        (folder / "truth.json").write_text(json.dumps(text))
        for name, size in (("truth_parameters.f32", 36), ("truth_material.u8", 1)):
            (folder / name).write_bytes((folder / name).read_bytes()[:-size])
        self.refused("judge", "lm", "--dataset", "cut", says=["cut: the truth has 6719 texels where the dataset has 6720"])

    def test_a_truth_that_went_is_missed(self):
        folder = self.root / "gone-truth"
        shutil.copytree(self.root / "ornament", folder)
        (folder / "truth.json").unlink()
        (folder / "truth.json").symlink_to("nowhere")
        for command in (("judge", "lm", "--dataset", "gone-truth"), ("info", "gone-truth")):
            self.refused(*command, says=["gone-truth/truth.json: no such truth"])

    def test_a_truth_larger_than_it_says_is_not_read_whole(self):
        folder = self.root / "large-truth"
        shutil.copytree(self.root / "ornament", folder)
        for name in ("truth_parameters.f32", "truth_material.u8"):
            size = (folder / name).stat().st_size
            os.truncate(folder / name, 10**12)
            result = self.run_program("info", "large-truth")
            self.assertEqual(result.returncode, 2)
            self.assertRegex(result.stderr, f"^radiafit: large-truth/{name}: .*bytes")
            os.truncate(folder / name, size)

    def test_tune_takes_a_robust_loss_where_images_are_spoilt(self):
        for name, noise, robust in (("whole", (), False), ("spoilt", (3, 6, 11, 19), True)):
            dataset = self.flat_sample(name, count=24, noise=noise)
            tried = json.loads(self.good("tune", dataset, "--seconds", "2", "--json").stdout)["tried"]
            self.assertTrue(any("--loss huber" in t["options"] for t in tried))
            self.assertEqual("--loss" in tried[0]["options"], robust, tried[0])

    def test_grid_of_a_flat_sample(self):
        dataset = self.flat_sample("flat")
        self.good("fit", dataset, "--model", "lambert", "-o", "flat-fit")
        judged = self.judged("flat-fit")
        self.assertGreater(judged["psnr"], 45)  # 8 bits
        self.assertAlmostEqual(judged["psnr"], judged["baseline"]["psnr"], places=6)
        self.good("render", "flat-fit", "--light", "0,0,1", "-o", "flat")
        width, height, rgb = read_png(self.root / "flat.png")
        self.assertEqual((width, height), (8, 8))
        reds = [rgb[3 * x] for x in range(8)]
        self.assertEqual(reds, sorted(reds))
        for option in (("--surface-side", "5"), ("--distributor", "gl"), ("--solver", "two-step", "--distributor", "gl")):
            for command in (("fit", dataset, "-o", "no"), ("plan", dataset)):
                self.refused(*command, "--model", "lambert", *option, says=[f"{option[-2]} means nothing to", "over a grid"])

    def test_what_makes_no_sense_is_refused(self):
        for options, words in (
            (("star", "--model", "lafortune"), ["star", "lamp per image", "--model lfm"]),
            (("ornament", "--model", "lfm"), ["lamp that moves"]),
            (("ornament", "--model", "lafortun"), ["model 'lafortun'", "nearest: lafortune"]),
            (("ornament", "--model", "lafortune", "--solver", "pca"), ["pca"]),
            (("star", "--optimizer", "lm"), ["optimizer lm", "cg or sd"]),
            (("ornament", "--model", "lafortune", "--terms", "2"), ["--terms", "means nothing"]),
            (("ornament", "--model", "lafortune", "--mode", "paper"), ["--mode", "means nothing"]),
            (("ornament", "--model", "lafortune", "--optimizer", "cg", "--mu", "-1"), ["mu = -1", "from 0"]),
            (("ornament", "--model", "lafortune", "--optimizer", "cg", "--mu", "nan"), ["mu = nan", "from 0"]),
            (("star", "--mu", "-1"), ["mu = -1", "from 0"]),
            (("star", "--clip-above", "0.9"), ["--clip-above", "means nothing"]),
            (("ornament", "--model", "lafortune", "--shadow-below", "1.5"), ["shadow-below", "from 0 to 1 (0 is off)"]),
            (("ornament", "--model", "lafortune", "--surface-side", "9"), ["surface side 6", "--surface-side 6"]),
        ):
            self.refused("fit", *options, "-o", "refused", says=words)
            self.assertFalse((self.root / "refused").exists())

    def test_damaged_fits_are_refused(self):
        self.good("fit", "ornament", "--model", "lambert", "-o", "damaged")
        (self.root / "damaged/albedo.exr").unlink()
        self.refused("judge", "damaged", says=["damaged/albedo.exr", "no such file"])
        text = (self.root / "damaged/fit.json").read_text()
        (self.root / "damaged/fit.json").write_text(text.replace('"lambert"', '"lambertian"'))
        self.refused("judge", "damaged", says=["damaged/fit.json", "lambertian", "fit again"])


if __name__ == "__main__":
    Reflectance.program, = take_arguments(1)
    unittest.main()
