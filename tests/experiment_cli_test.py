#!/usr/bin/env python3
"""What every experiment's command line does: configs anywhere, settings of one's own, output elsewhere, earlier runs drawn
again, finished ones not run again.

Arguments: the program of table1_datasets, the checkout.
"""
import gzip
import json
import shutil
import unittest

from cli_fixture import ProgramTest, snapshot, take_arguments

CHECKOUT = None
NAME = "table1_datasets"


class ExperimentCli(ProgramTest):
    def setUp(self):
        for name in ("checkout", "elsewhere"):
            shutil.rmtree(self.root / name, ignore_errors=True)
        self.checkout = self.root / "checkout"
        for folder in ("experiments", "paper_figs"):
            (self.checkout / folder).mkdir(parents=True)
        shutil.copy(CHECKOUT / f"experiments/{NAME}.toml", self.checkout / "experiments")
        for script in (CHECKOUT / "paper_figs").glob(f"{NAME}*.gp"):
            shutil.copy(script, self.checkout / "paper_figs")
        (self.root / "elsewhere").mkdir()

    def run_it(self, *more, cwd="checkout"):
        return self.good("--profile", "smoke", *more, cwd=self.root / cwd)

    def runs(self, folder):
        return sorted(folder.glob(f"{NAME}/*/*/run.json"))

    def record(self, folder):
        (run,) = self.runs(folder)
        return json.loads(run.read_text())

    def test_the_standard_run(self):
        self.run_it()
        record = self.record(self.checkout / "results")
        self.assertTrue(record["standard"])
        self.assertEqual(record["profile"], "smoke")
        self.assertGreater(record["peak_memory_bytes"], 1e6)
        self.assertIn("datasets.csv", record["files"])
        self.assertTrue((self.checkout / f"paper_figs/smoke/{NAME}.md").exists())
        self.assertFalse((self.checkout / f"paper_figs/{NAME}.md").exists(), "that is the standard profile's")

    def test_settings_of_ones_own_leave_the_figures_alone(self):
        for more in (("--set", "surface_side=6"), ("--config", "../elsewhere/mine.toml")):
            with self.subTest(more[0]):
                self.setUp()
                shutil.copy(CHECKOUT / f"experiments/{NAME}.toml", self.root / "elsewhere/mine.toml")
                self.run_it(*more)
                self.assertFalse(self.record(self.checkout / "results")["standard"])
                self.assertFalse((self.checkout / "paper_figs/smoke").exists())
                (run,) = self.runs(self.checkout / "results")
                self.assertTrue((run.parent / f"{NAME}.md").exists())

    def test_output_elsewhere(self):
        self.run_it("--output", "../elsewhere/mine")
        self.assertFalse(self.runs(self.checkout / "results"))
        self.assertFalse(self.record(self.root / "elsewhere/mine")["standard"])
        self.assertTrue((self.root / f"elsewhere/mine/{NAME}.md").exists())
        self.assertFalse((self.checkout / "paper_figs/smoke").exists())

    def test_outside_of_any_checkout(self):
        result = self.run_program("--profile", "smoke", cwd=self.root / "elsewhere")
        self.assertEqual(result.returncode, 2)
        self.assertIn("lies in a checkout", result.stderr)

    def test_resume(self):
        self.run_it()
        revision = self.record(self.checkout / "results")["git_revision"]
        told = self.run_it("--resume").stderr
        if revision.endswith("-dirty"):  # which may be any program
            self.assertNotIn("is there", told)
        else:
            self.assertIn(f"{NAME} is there", told)
            self.record(self.checkout / "results")  # still one
        self.run_it("--resume", "--threads", "1")
        self.assertGreater(len(self.runs(self.checkout / "results")), 1, "another machine, so to say")

    def test_an_earlier_run_drawn_again(self):
        self.run_it()
        (run,) = self.runs(self.checkout / "results")
        run = run.parent
        drawn = (self.checkout / f"paper_figs/smoke/{NAME}.md").read_bytes()
        before = snapshot(self.checkout)
        rows = (run / "datasets.csv").read_bytes()
        for packed in (False, True):
            if packed:  # as in results/reference
                (run / "datasets.csv.gz").write_bytes(gzip.compress(rows))
                (run / "datasets.csv").unlink()
                before = snapshot(self.checkout)
            self.good("--config", "../checkout/experiments/table1_datasets.toml", "--run", run, "--output", ".",
                      cwd=self.root / "elsewhere")  # fmt: skip
            self.assertEqual((self.root / f"elsewhere/{NAME}.md").read_bytes(), drawn)
            self.assertEqual(snapshot(self.checkout), before)
            shutil.rmtree(self.root / "elsewhere")
            (self.root / "elsewhere").mkdir()
        (run / "datasets.csv.gz").unlink()
        for damage in (rows[:-20], rows.replace(b"star", b"stat"), b""):
            (run / "datasets.csv").write_bytes(damage)
            self.refused("--run", run, says=["datasets.csv: not as the run wrote it", "run the experiment again"],
                         cwd=self.checkout)  # fmt: skip
        record = json.loads((run / "run.json").read_text())
        (run / "run.json").write_text(json.dumps(record | {"program": "fig7_convergence"}))
        self.refused("--run", run, says=[f"not of {NAME}"], cwd=self.checkout)
        (run / "run.json").write_text("{}")
        self.refused("--run", run, says=["run.json: 'program' is missing", "run the experiment again"],
                     cwd=self.checkout)  # fmt: skip


if __name__ == "__main__":
    ProgramTest.program, CHECKOUT = take_arguments(2)
    unittest.main()
