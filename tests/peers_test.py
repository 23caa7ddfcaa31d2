#!/usr/bin/env python3
"""experiments/peers: PyTorch's error is that of our fits, its gradient that of finite differences, and its rows are a run's.

Arguments: the program, the checkout. Without PyTorch only what is said of its absence is tested.
"""
import csv
import json
import subprocess
import sys
import unittest

from cli_fixture import ProgramTest, python_with, take_arguments

CHECKOUT = None
PYTHON = python_with("torch")

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
from torch_peers import Clock, adam, descend, lbfgs, point
from light_field import LightField
problem = LightField(sys.argv[1])
runs = {"start": [point(problem, problem.start, 0, 0)], "adam": descend(problem, lambda *to: adam(*to, 0.03), 6, 1e9),
        "lbfgs": descend(problem, lambda *to: lbfgs(*to, 5), 6, 1e9), "last": descend(problem, lambda *to: adam(*to, 0.03), 6),
        "ours": [point(problem, problem.read(sys.argv[2]), 0, 0)]}
print(json.dumps(runs))
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
        self.good("fit", "star", *options, "-o", "fit")
        self.good("export", "parameters", "fit", "-o", self.new("parameters"))
        rows = list(csv.DictReader((self.root / "fit/trace.csv").read_text().splitlines()))
        return float(rows[0]["error"]), float(rows[-1]["error"])

    def new(self, name):
        self.count = getattr(self, "count", 0) + 1
        return f"{name}-{self._testMethodName}-{self.count}"


@unittest.skipUnless(PYTHON, "PyTorch is missing")
class Torch(Peers):
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

    def test_its_run_is_one_as_those_of_other_experiments(self):
        script = CHECKOUT / "experiments/peers/torch_peers.py"
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
        self.assertIn("torch", record["libraries"]["built"])
        rows = list(csv.DictReader((run / "peers.csv").read_text().splitlines()))
        self.assertEqual([r["library"] for r in rows[:3]], ["PyTorch", "PyTorch", "radiafit"])
        self.assertEqual(len(rows), 2 + len(record["config"]["ours"]))
        curves = list(csv.DictReader((run / "curves.csv").read_text().splitlines()))
        for r in rows:
            self.assertAlmostEqual(float(r["converged_db"]) - float(r["target_db"]), 0.02, delta=2e-4)
            self.assertEqual(r["reached"] == "1", float(r["psnr_db"]) >= float(r["target_db"]) - 1e-3)
            own = [c for c in curves if c["solver"] == r["solver"] and c["library"] == r["library"]]
            self.assertEqual(own[-1]["iteration"], r["iterations"])
            self.assertLess(abs(float(own[-1]["psnr_db"]) - float(r["psnr_db"])), 5e-3)
        self.assertIn(("radiafit", "1", "1"), {(r["library"], r["reached"], r["times_ours"]) for r in rows})
        again = subprocess.run([PYTHON, "-B", script, "--run", run, "--output", self.root / "again"], capture_output=True, text=True)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.root / "again/peers.png").read_bytes(), (self.root / "out/peers.png").read_bytes())

    def test_mistakes_are_one_line(self):
        config = (CHECKOUT / "experiments/peers/torch_peers.toml").read_text()
        (self.root / "unknown.toml").write_text(config.replace("history =", "histories ="))
        (self.root / "broken.toml").write_text("dataset = ")
        (self.root / "solver.toml").write_text(config.replace("--solver varpro", "--solver varpr"))
        for arguments, said in ((["--config", "unknown.toml"], "unknown.toml: 'histor"), (["--config", "broken.toml"], "broken.toml: "),
                                (["--config", "nowhere.toml"], "nowhere.toml"), (["--radiafit", "nowhere"], "nowhere: no such program"),
                                (["--config", "solver.toml", "--profile", "smoke"], "varpr"), (["--run", "star"], "star: no run of peers")):  # fmt: skip
            command = [PYTHON, "-B", CHECKOUT / "experiments/peers/torch_peers.py", "--radiafit", self.program, "--output", "new", *arguments]
            result = subprocess.run(command, cwd=self.root, capture_output=True, text=True)
            self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
            self.assertIn(said, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertFalse((self.root / "new").exists())


class Absence(Peers):
    def test_without_pytorch_it_says_so_in_one_line(self):
        (self.root / "without").mkdir()
        (self.root / "without/torch.py").write_text("raise ImportError(\"No module named 'torch'\")\n")
        result = subprocess.run([PYTHON or sys.executable, "-B", CHECKOUT / "experiments/peers/torch_peers.py"], capture_output=True, text=True,
                                env={"PYTHONPATH": str(self.root / "without"), "PATH": "/usr/bin:/bin"})  # fmt: skip
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertRegex(result.stderr, r"^torch_peers\.py: No module named '\w+'; install it: scripts/install-packages\.sh peers\n$")


if __name__ == "__main__":
    ProgramTest.program, CHECKOUT = take_arguments(2)
    unittest.main()
