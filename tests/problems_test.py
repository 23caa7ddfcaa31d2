#!/usr/bin/env python3
"""`radiafit export`: the programs that docs/problems.md shows, run on the exported problems, find the errors that `radiafit fit`
tells; arrays are as problems.json says.

Arguments: the program.
"""
import csv
import itertools
import json
import math
import pathlib
import re
import subprocess
import unittest

from cli_fixture import ProgramTest, python_with, snapshot, take_arguments

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs/problems.md"
LIGHT_FIELD, TEXELS = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
PYTHON = python_with("numpy")
SIZES = {"<f4": 4, "<i4": 4, "<i8": 8}


class Problems(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.dataset("ornament")
        cls.names = (f"{i}" for i in itertools.count())

    def export(self, dataset, *options):
        name = next(self.names)
        self.good("export", "problems", dataset, *options, "-o", f"problems{name}")
        return f"problems{name}"

    def fit(self, dataset, *options):
        """A fit's parameters, what its trace says of start and end, and the fit."""
        name = next(self.names)
        self.good("fit", dataset, *options, "-o", f"fit{name}")
        self.good("export", "parameters", f"fit{name}", "-o", f"parameters{name}")
        rows = list(csv.DictReader((self.root / f"fit{name}/trace.csv").read_text().splitlines()))
        return f"parameters{name}", float(rows[0]["error"]), float(rows[-1]["error"]), f"fit{name}"

    def run_page(self, program, *folders):
        result = subprocess.run([PYTHON, "-c", program, *folders], cwd=self.root, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def assertNear(self, found, told):
        self.assertLess(abs(found - told), 1e-5 * told)


@unittest.skipUnless(PYTHON, "python3-numpy is missing")
class Errors(Problems):
    def test_light_field_maps(self):
        for problem in (["--model", "lfm"], ["--terms", "2", "--seed", "7"], ["--mode", "paper", "--mu", "0.5"], ["--weights", "facing", "--space", "linear"],
                        ["--texels-per-pixel", "1.5"], ["--view", "nearest", "--view-side", "5", "--surface-side", "6"],
                        ["--validation", "4", "--lambda-view", "0.1"]):  # fmt: skip
            with self.subTest(problem=problem):
                problems = self.export("star", *problem)
                parameters, start, end, _ = self.fit("star", *problem)
                self.assertLess(end, start / 3)
                at_start, at_end = self.run_page(LIGHT_FIELD, problems), self.run_page(LIGHT_FIELD, problems, parameters)
                self.assertNear(at_start["E"], start)
                self.assertNear(at_end["E"], end)
                self.assertGreater(at_end["PSNR"], at_start["PSNR"] + 1)

    def test_bounds_beyond(self):
        """Parameters far out of bounds, where the penalty is nearly all of E."""
        for mode in ("modern", "paper"):
            folder = self.root / self.export("star", "--mode", mode, "--mu", "3")
            change = f"import numpy as n; p = n.load('{folder}/start_view.npy'); p[:, 0] = -2; p[:, 1] = 20; n.save('{folder}/start_view.npy', p)"
            before = self.run_page(LIGHT_FIELD, folder)["E"]
            subprocess.run([PYTHON, "-c", change], check=True)
            about = json.loads((folder / "problems.json").read_text())
            vertices = about["arrays"]["start_view"]["shape"][0]
            one = {"modern": 0.5 * 3 * (4 + 16), "paper": 3 * (2 * 18 + 20 * 4)}[mode]
            self.assertGreater(self.run_page(LIGHT_FIELD, folder)["E"], 3 * vertices * one)
            self.assertLess(before, vertices * one)

    def test_held_out_psnr_is_near_the_judges(self):
        parameters, _, _, fit = self.fit("star", "--model", "lfm")
        judged = json.loads(self.good("judge", fit, "--pixel-points", "1", "--json").stdout)["psnr"]
        self.assertAlmostEqual(self.run_page(LIGHT_FIELD, self.export("star"), parameters)["PSNR"], judged, delta=0.3)

    def test_texel_local_models(self):
        for problem in (["--model", "lambert"], ["--model", "ptm", "--weights", "facing"],
                        ["--model", "lambert", "--clip-above", "0.9", "--shadow-below", "0.2", "--validation", "4"]):  # fmt: skip
            with self.subTest(problem=problem):
                problems = self.export("ornament", *problem)
                parameters, start, end, _ = self.fit("ornament", *problem, "--optimizer", "cg")
                self.assertNear(self.run_page(TEXELS, problems)["E"], start)
                self.assertNear(self.run_page(TEXELS, problems, parameters)["E"], end)

    def test_lafortune(self):
        problems = self.export("ornament", "--model", "lafortune")
        _, start, _, _ = self.fit("ornament", "--model", "lafortune", "--optimizer", "cg", "--iterations", "1")
        parameters, _, end, _ = self.fit("ornament", "--model", "lafortune", "--optimizer", "lm")
        at_start, at_end = self.run_page(TEXELS, problems), self.run_page(TEXELS, problems, parameters)
        self.assertNear(at_start["E"], start)
        self.assertNear(at_end["data"], end)
        lambert = self.run_page(TEXELS, self.export("ornament", "--model", "lambert"))
        self.assertGreater(at_end["PSNR"], lambert["PSNR"] + 1)

    def test_numpy_reads_what_is_promised(self):
        for problems in (self.export("star"), self.export("ornament", "--model", "ptm")):
            read = ("import json, numpy as n, sys; print(json.dumps({k: [n.load(f'{sys.argv[1]}/{k}.npy').dtype.str, "
                    "n.load(f'{sys.argv[1]}/{k}.npy', mmap_mode='r').shape] for k in json.load(open(sys.argv[1] + '/problems.json'))['arrays']}))")  # fmt: skip
            about = json.loads((self.root / problems / "problems.json").read_text())
            self.assertEqual(self.run_page(read, problems), {k: [v["dtype"], v["shape"]] for k, v in about["arrays"].items()})


class Folders(Problems):
    def test_every_file_is_described_and_whole(self):
        for problems in (self.export("star", "--terms", "3"), self.export("ornament", "--model", "lafortune")):
            folder = self.root / problems
            about = json.loads((folder / "problems.json").read_text())
            self.assertEqual({p.name for p in folder.glob("[!.]*")}, {"problems.json", *(f"{name}.npy" for name in about["arrays"])})
            for name, array in about["arrays"].items():
                data = (folder / f"{name}.npy").read_bytes()
                self.assertEqual(data[:8], b"\x93NUMPY\1\0")
                header = 10 + int.from_bytes(data[8:10], "little")
                self.assertEqual(header % 64, 0)
                said = re.fullmatch(r"\{'descr': '(.+)', 'fortran_order': False, 'shape': \((.*)\), \} *\n", data[10:header].decode())
                self.assertEqual(said[1], array["dtype"])
                self.assertEqual([int(n) for n in said[2].split(",") if n.strip()], array["shape"])
                self.assertEqual(len(data) - header, SIZES[array["dtype"]] * math.prod(array["shape"]))
                self.assertTrue(array["meaning"])

    def test_problems_and_parameters_name_one_dataset(self):
        problems = json.loads((self.root / self.export("star") / "problems.json").read_text())
        parameters, _, _, fit = self.fit("star", "--iterations", "1")
        told = json.loads((self.root / parameters / "parameters.json").read_text())
        self.assertEqual(told["dataset"], problems["dataset"])
        self.assertEqual(told["dataset"]["digest"], json.loads((self.root / fit / "fit.json").read_text())["dataset"]["digest"])
        self.assertEqual(told["format"], "radiafit-parameters")
        self.assertEqual(told["arrays"]["surface"]["shape"], problems["arrays"]["start_surface"]["shape"])
        self.assertEqual(told["arrays"]["view"]["shape"], problems["arrays"]["start_view"]["shape"])

    def test_the_same_bytes_with_any_number_of_threads(self):
        for arguments in (("star", "--terms", "2"), ("ornament", "--model", "lafortune")):
            one, three = (snapshot(self.root / self.export(*arguments, "--threads", n)) for n in (1, 3))
            for files in (one, three):
                del files["problems.json"], files[".radiafit-made.json"]  # times and threads, and how many bytes these take
            self.assertEqual(one, three)

    def test_views_are_split_as_fits_and_judges_do(self):
        def views(*options):
            return json.loads((self.root / self.export("star", *options) / "problems.json").read_text())["views"]

        every = json.loads((self.root / "star/dataset.json").read_text())["views"]
        held_out = [i for i, view in enumerate(every) if view["held_out"]]
        plain, left_out = views(), views("--validation", "4")
        self.assertEqual(plain["held_out"], held_out)
        self.assertEqual(sorted(plain["training"] + held_out), list(range(len(every))))
        self.assertEqual(sorted(left_out["training"] + left_out["held_out"]), plain["training"])
        self.assertEqual(len(left_out["held_out"]), len(plain["training"]) // 4)

    def test_nothing_is_replaced(self):
        problems = self.export("star")
        for command in (("problems", "star", "--terms", "1"), ("parameters", self.fit("star", "--iterations", "1")[3])):
            self.refused("export", *command, "-o", problems, says=[f"{problems}: is there already, made by `radiafit export problems star", "choose another name"])

    def test_a_dataset_that_holds_nothing_out(self):
        for dataset, model in (("star", "lfm"), ("ornament", "lambert")):
            name = next(self.names)
            self.dataset(dataset, f"whole{name}")
            path = self.root / f"whole{name}/dataset.json"
            about = json.loads(path.read_text())
            for view in about["views"]:
                view["held_out"] = False
            path.write_text(json.dumps(about))
            arrays = json.loads((self.root / self.export(f"whole{name}", "--model", model) / "problems.json").read_text())["arrays"]
            self.assertEqual(arrays["held_out_radiance" if model == "lfm" else "held_out_target"]["shape"], [0, 3])


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
