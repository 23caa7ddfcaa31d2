#!/usr/bin/env python3
"""experiments/peers: PyTorch's and SciPy's errors are those of our fits, their derivatives those of finite differences, and the rows
are a run's.

Arguments: the program, the checkout. Without PyTorch and SciPy only what is said of their absence is tested.
"""
import csv
import json
import subprocess
import sys
import unittest

from cli_fixture import ProgramTest, python_with, take_arguments

CHECKOUT = None
PYTHON = python_with("torch, scipy")

# Of an exported problem: E at the start, and how its derivative along a random direction compares with central differences.
CHECK = """
import json, sys
import torch
from light_field import LightField
torch.manual_seed(1)
single, double = (LightField(sys.argv[1], t) for t in (torch.float32, torch.float64))
p = [x + 0.3 * torch.randn_like(x) for x in double.start]  # beyond the bounds, too
d = [torch.randn_like(x) for x in p]
at = lambda step: double.error(*[x + step * y for x, y in zip(p, d)]).item()
q = [x.clone().requires_grad_() for x in p]
double.error(*q).backward()
step = 1e-4
print(json.dumps({"E": single.error(*single.start).item(), "slope": sum((x.grad * y).sum() for x, y in zip(q, d)).item(),
                  "difference": (at(step) - at(-step)) / (2 * step), "below": sum((x < 0).sum() for x in p).item()}))
"""

# E after a few iterations of each optimizer, those of the start first; and the PSNR of given parameters.
DESCEND = """
import json, sys
import torch
from light_field import LightField
from torch_solvers import adam, descend, lbfgs, point
problem = LightField(sys.argv[1])
runs = {"start": [point(problem, problem.start, 0, 0)], "adam": descend(problem, lambda *to: adam(*to, 0.03), 6, 1e9),
        "lbfgs": descend(problem, lambda *to: lbfgs(*to, 5), 6, 1e9), "last": descend(problem, lambda *to: adam(*to, 0.03), 6),
        "ours": [point(problem, problem.read(sys.argv[2]), 0, 0)]}
print(json.dumps(runs))
"""

# Of each problem of batches at random maps: d'J'J d of random directions d by the blocks of J'J and by differences of residuals,
# the slope by gradients and by differences of errors, and the error by SciPy; likewise the residuals' derivatives by SciPy.
BLOCKS = """
import json, sys
import numpy as np
import torch
from batched_lm import batches
from light_field import LightField
from scipy_solvers import Problem
torch.manual_seed(1)
problem = LightField(sys.argv[1], torch.float64)
start, to = ([f(x) for x in problem.start] for f in (lambda x: x + 0.3 * torch.randn_like(x), torch.randn_like))
found = {name: [] for name in ("curvature", "differences", "slope", "errors", "error", "scipy", "beyond", "apart", "start")}
step = 1e-7  # so short that hardly a parameter passes a bound, where the penalty bends
for b in batches(problem, 5):
    (g, h), (dg, dh) = b.cut(*start), b.cut(*to)
    ahead, here, behind = (b.residuals(g + x * dg, h + x * dh) for x in (step, 0, -step))
    x, v = dg.flatten(2)[..., None], b.times(dh, b.look_up.mT).reshape(len(dh), 1, -1, 1)
    images = torch.diag_embed(b.image_block(g)).transpose(2, 3).reshape(len(dh), v.shape[2], -1)
    view = dh.reshape(len(dh), -1, 1)
    total = (x.mT @ b.surface_block(g, h) @ x + 2 * v.mT @ b.joint_block(g, h) @ x).sum((1, 2, 3))
    found["curvature"] += (total + (view.mT @ b.view_block(h, images) @ view).sum((1, 2))).tolist()
    found["differences"] += sum(((p - q) / (2 * step)).flatten(1).square().sum(1) for p, q in zip(ahead, behind)).tolist()
    slopes = b.surface_gradient(g, h, here) * dg, b.view_gradient(g, here) * dh
    found["slope"] += sum(y.flatten(1).sum(1) for y in slopes).tolist()
    found["errors"] += ((b.errors(ahead) - b.errors(behind)) / (2 * step)).tolist()
    found["start"] += b.errors(b.residuals(*b.cut(*problem.start))).tolist()
    for i, vertex in enumerate(b.vertices[:2]):
        for channel in range(3):
            p = Problem(problem, vertex, channel)
            found["error"].append(float(b.errors(here)[3 * i + channel]))
            x, d = p.pack(*(y.numpy() for y in start)), p.pack(*(y.numpy() for y in to))
            found["scipy"].append(0.5 * float((p.residuals(x) ** 2).sum()))
            found["beyond"].append(int((x[p.bounded] < 0).sum()))
            by_differences = (p.residuals(x + step * d) - p.residuals(x - step * d)) / (2 * step)
            found["apart"].append(float(abs(p.jacobian(x) @ d - by_differences).max()))
found["sum"] = problem.error(*problem.start).item()
print(json.dumps(found))
"""

# Errors of each problem, at the start and after each step of both ways; and after steps of SciPy's of a few.
SOLVE = """
import json, sys
import torch
from batched_lm import Descent, batches
from light_field import LightField
from scipy_solvers import Problem
torch.set_num_threads(2)
problem = LightField(sys.argv[1])
all, found = batches(problem, 64), {}
for name, project in (("joint", False), ("projected", True)):
    descents, rows = [Descent(b, *problem.start, 1e-2) for b in all], []
    for step in range(int(sys.argv[2]) + 1):
        for d in descents if step else []:
            d.step(project)
        rows.append([e for d in descents for e in d.error.tolist()])
    found[name] = rows
    maps = [x.clone() for x in problem.start]
    for d in descents:
        d.batch.paste(d.g, d.h, *maps)
    found[name + " sum"] = problem.error(*maps).item()
for name, how in (("lm", {"method": "lm", "max_nfev": 100}), ("trf", {"method": "trf", "tr_solver": "lsmr", "max_nfev": 30})):
    several = [Problem(problem, v, 1) for v in descents[-1].batch.vertices[:2]]
    found[name] = [[0.5 * float((p.residuals(x) ** 2).sum()) for _, x in p.solve(**how)] for p in several]
found["same"] = [float(descents[-1].error[i]) for i in (1, 4)]
print(json.dumps(found))
"""


class Peers(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")

    def python(self, program, *arguments):
        result = subprocess.run([PYTHON, "-B", "-c", program, *arguments], cwd=self.root, capture_output=True, text=True,
                                env={"PYTHONPATH": str(CHECKOUT / "experiments/peers"), "PATH": "/usr/bin:/bin"})  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def told_errors(self, *options):
        """Of a fit's start and end, with its parameters exported."""
        self.good("fit", "star", *options, "--replace", "-o", "fit")
        self.good("export", "parameters", "fit", "-o", self.new("parameters"))
        rows = list(csv.DictReader((self.root / "fit/trace.csv").read_text().splitlines()))
        return float(rows[0]["error"]), float(rows[-1]["error"])

    def new(self, name):
        self.count = getattr(self, "count", 0) + 1
        return f"{name}-{self._testMethodName}-{self.count}"


@unittest.skipUnless(PYTHON, "PyTorch or SciPy is missing")
class Solvers(Peers):
    def test_its_error_is_ours_and_its_gradient_that_of_differences(self):
        for options in (["--terms", "2"], ["--mode", "paper", "--mu", "0.5"], ["--weights", "facing", "--texels-per-pixel", "1"]):
            with self.subTest(options=options):
                problems = self.new("problems")
                self.good("export", "problems", "star", *options, "-o", problems)
                start, _ = self.told_errors(*options, "--iterations", "1")
                found = self.python(CHECK, problems)
                self.assertLess(abs(found["E"] - start), 1e-5 * start)
                self.assertGreater(found["below"], 0)
                # The printed penalty jumps at its bounds, where the differences step over it.
                self.assertLess(abs(found["slope"] - found["difference"]), (0.05 if "paper" in options else 1e-5) * abs(found["slope"]))

    def test_a_few_iterations_lower_the_error(self):
        self.good("export", "problems", "star", "-o", "problems")
        _, end = self.told_errors("--iterations", "10")
        runs = self.python(DESCEND, "problems", f"parameters-{self._testMethodName}-1")
        start = runs["start"][0]["error"]
        self.assertLess(abs(runs["ours"][0]["error"] - end), 1e-5 * end)
        for name in ("adam", "lbfgs"):
            self.assertEqual([p["iterations"] for p in runs[name]], [1, 2, 3, 4, 5, 6])
            self.assertLess(runs[name][-1]["error"], 0.7 * start)
            self.assertGreater(runs[name][-1]["psnr_db"], runs["start"][0]["psnr_db"])
            seconds = [p["seconds"] for p in runs[name]]
            self.assertEqual(seconds, sorted(seconds))
            self.assertGreater(seconds[0], 0)
        self.assertEqual([p["error"] for p in runs["last"]], [runs["adam"][-1]["error"]])

    def test_derivatives_are_those_of_differences_and_errors_are_alike(self):
        for options in (["--terms", "1"], ["--terms", "2", "--mu", "0.5", "--weights", "facing"]):
            with self.subTest(options=options):
                problems = self.new("problems")
                self.good("export", "problems", "star", *options, "--surface-side", "5", "--view-side", "4", "-o", problems)
                found = self.python(BLOCKS, problems)
                self.assertGreater(sum(found["beyond"]), 0)
                for one, other in (("curvature", "differences"), ("slope", "errors"), ("error", "scipy")):
                    most = max(map(abs, found[other]))
                    for x, y in zip(found[one], found[other], strict=True):
                        self.assertLess(abs(x - y), 1e-6 * (most if one != "error" else y))
                self.assertLess(max(found["apart"]), 1e-6)
                self.assertLess(abs(sum(found["start"]) - found["sum"]), 1e-9 * found["sum"])

    def test_every_problem_falls_to_where_our_variable_projection_ends(self):
        options = ["--terms", "1", "--surface-side", "5", "--view-side", "5", "--lambda-surface", "1e-2", "--lambda-view", "0.1"]
        self.good("export", "problems", "star", *options, "-o", "falling")
        _, end = self.told_errors(*options, "--solver", "varpro", "--iterations", "40")
        found = self.python(SOLVE, "falling", "20")
        for name in ("joint", "projected"):
            for before, after in zip(found[name], found[name][1:]):
                self.assertFalse([e for e, f in zip(before, after, strict=True) if f > e])
            self.assertLess(abs(sum(found[name][-1]) - end), 0.01 * end)
            self.assertLess(abs(found[name + " sum"] - sum(found[name][-1])), 1e-5 * end)
        for name, apart in (("lm", 0.01), ("trf", 0.2)):  # the latter creeps at its end
            for errors, same in zip(found[name], found["same"], strict=True):
                self.assertEqual(errors, sorted(errors, reverse=True))
                self.assertLess(abs(errors[-1] - same), apart * same)

    def test_its_run_is_one_as_those_of_other_experiments(self):
        script = CHECKOUT / "experiments/peers/peers.py"
        command = [PYTHON, "-B", script, "--profile", "smoke", "--radiafit", self.program, "--output", self.root / "out"]
        result = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        (run,) = (self.root / "out/peers").glob("*/*")
        self.assertEqual({p.name for p in run.iterdir()}, {"run.json", "curves.csv", "times.csv", "peers.csv"})
        self.assertIn("SAME", self.good("compare", run, run).stdout)
        self.assertFalse([p for p in (self.root / "out").rglob(".radiafit-*")])
        self.assertGreater((self.root / "out/peers.png").stat().st_size, 10000)
        record = json.loads((run / "run.json").read_text())
        self.assertEqual((record["program"], record["profile"], record["standard"]), ("peers", "smoke", False))
        self.assertLessEqual({"torch", "scipy", "numpy"}, set(record["libraries"]["built"]))
        rows = list(csv.DictReader((run / "peers.csv").read_text().splitlines()))
        self.assertEqual([r["library"] for r in rows], ["SciPy"] * 2 + ["PyTorch"] * 4 + ["radiafit"] * len(record["config"]["ours"]))
        for r in rows:
            self.assertEqual(r["times_ours"] == "", r["library"] == "SciPy")
            self.assertEqual(int(r["problems"]) < int(rows[-1]["problems"]), r["library"] == "SciPy")
            self.assertLessEqual(int(r["batch"]), int(r["problems"]))
            self.assertEqual(r["precision"], {"SciPy": "64", "PyTorch": "32"}.get(r["library"], r["precision"]))
        curves = list(csv.DictReader((run / "curves.csv").read_text().splitlines()))
        for r in rows:
            short = 0.2 if r["library"] == "SciPy" else 0.02
            self.assertAlmostEqual(float(r["converged_db"]) - float(r["target_db"]), short, delta=2e-4)
            self.assertEqual(r["reached"] == "1", float(r["psnr_db"]) >= float(r["target_db"]) - 1e-3)
            own = [c for c in curves if c["solver"] == r["solver"] and c["library"] == r["library"]]
            self.assertEqual(own[-1]["iteration"], r["iterations"])
            self.assertLess(abs(float(own[-1]["psnr_db"]) - float(r["psnr_db"])), 5e-3)
        self.assertIn(("radiafit", "1", "1"), {(r["library"], r["reached"], r["times_ours"]) for r in rows})
        again = subprocess.run([PYTHON, "-B", script, "--run", run, "--output", self.root / "again"], capture_output=True, text=True)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.root / "again/peers.png").read_bytes(), (self.root / "out/peers.png").read_bytes())

    def test_mistakes_are_one_line(self):
        config = (CHECKOUT / "experiments/peers/peers.toml").read_text()
        (self.root / "unknown.toml").write_text(config.replace("history =", "histories ="))
        (self.root / "broken.toml").write_text("dataset = ")
        (self.root / "solver.toml").write_text(config.replace("--solver varpro", "--solver varpr"))
        (self.root / "paper.toml").write_text(config.replace("--terms 1", "--mode paper"))
        for arguments, said in ((["--config", "unknown.toml"], "unknown.toml: 'histor"), (["--config", "broken.toml"], "broken.toml: "),
                                (["--config", "nowhere.toml"], "nowhere.toml"), (["--radiafit", "nowhere"], "nowhere: no such program"),
                                (["--config", "solver.toml", "--profile", "smoke"], "varpr"), (["--run", "star"], "star: no run of peers"),
                                (["--config", "paper.toml", "--profile", "smoke"], "no sum of squares")):  # fmt: skip
            command = [PYTHON, "-B", CHECKOUT / "experiments/peers/peers.py", "--radiafit", self.program, "--output", "new", *arguments]
            result = subprocess.run(command, cwd=self.root, capture_output=True, text=True)
            self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
            self.assertIn(said, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertFalse((self.root / "new").exists())


class Absence(Peers):
    def test_without_a_library_it_says_so_in_one_line(self):
        for library in ("torch", "scipy"):
            (self.root / library).mkdir()
            (self.root / library / f"{library}.py").write_text(f"raise ImportError(\"No module named '{library}'\")\n")
            command = [PYTHON or sys.executable, "-B", CHECKOUT / "experiments/peers/peers.py"]
            environment = {"PYTHONPATH": str(self.root / library), "PATH": "/usr/bin:/bin"}
            result = subprocess.run(command, capture_output=True, text=True, env=environment)
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertRegex(result.stderr, r"^peers\.py: No module named '\w+'; install it: scripts/install-packages\.sh peers\n$")


if __name__ == "__main__":
    ProgramTest.program, CHECKOUT = take_arguments(2)
    unittest.main()
