#!/usr/bin/env python3
"""`radiafit compare` over the runs in results/reference and over planted differences.

Arguments: the program, the checkout.
"""
import csv
import gzip
import json
import re
import shutil
import unittest

from cli_fixture import ProgramTest, take_arguments

CHECKOUT = None
OTHER_OPENGL = re.compile("^zink|osmesa")


class Compare(ProgramTest):
    def setUp(self):
        self.take("fig9_error", "fig10_utilization", "precision", "streaming")

    def take(self, *experiments):
        """Both sides become copies of the reference runs of these."""
        for side in ("before", "after"):
            shutil.rmtree(self.root / side, ignore_errors=True)
            for experiment in experiments:
                shutil.copytree(CHECKOUT / "results/reference" / experiment, self.root / side / experiment)
            for path in (self.root / side).glob("*/*/*/run.json"):  # rows are changed here: without checksums
                record = json.loads(path.read_text())
                record.pop("files", None)
                path.write_text(json.dumps(record))

    def edit(self, experiment, file, change, side="after"):
        """change(rows) of one file of the newest run of an experiment."""
        path = max((self.root / side / experiment).glob(f"*/*/{file}"), key=lambda path: path.parent.name)
        with open(path, newline="", encoding="utf-8") as opened:
            rows = list(csv.DictReader(opened))
        columns = list(rows[0])
        change(rows)
        with open(path, "w", newline="", encoding="utf-8") as opened:
            writer = csv.DictWriter(opened, columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)

    def compare(self, *more, status):
        result = self.run_program("compare", "before", "after", *more)
        self.assertEqual((result.returncode, result.stderr), (status, ""), result.stdout)
        return result.stdout

    def figures(self, status, *more):
        """All figures that are neither the same nor unclear, by experiment."""
        told = json.loads(self.compare("--json", *more, status=status))
        self.assertEqual((told["format"], told["version"]), ("radiafit-comparison", 1))
        return [(c["experiment"], f) for c in told["comparisons"] for f in c["figures"] if f["verdict"] != "UNCLEAR"]

    def unclear(self, row, column):
        told = json.loads(self.compare("--json", "--only", "streaming", status=0))
        return [f for c in told["comparisons"] for f in c["figures"]
                if (f["verdict"], f["row"], f.get("column")) == ("UNCLEAR", row, column)]

    def newest(self, side, experiment):
        """Of those with nine rounds: of OSMesa and zink the reference has short ones."""
        runs = [path.parent for path in (self.root / side / experiment).glob("*/*/run.json") if not OTHER_OPENGL.search(path.parts[-3])]
        return max(runs, key=lambda run: run.name)

    def newest_only(self, experiment):
        """All other runs go."""
        for side in ("before", "after"):
            newest = self.newest(side, experiment)
            for run in (self.root / side / experiment).glob("*/*"):
                if run != newest:
                    shutil.rmtree(run)

    def another_program(self, experiment):
        """The newest run after becomes one of another revision."""
        path = self.newest("after", experiment) / "run.json"
        record = json.loads(path.read_text())
        record["git_revision"] = "f00"
        path.write_text(json.dumps(record))

    def run_again(self, experiment):
        """The newest run before stands twice: times that don't differ from run to run."""
        run = self.newest("before", experiment)
        shutil.copytree(run, run.with_name(run.name + "-2"))

    def test_the_reference_is_the_same_as_itself_and_every_column_has_its_rule(self):
        runs = (CHECKOUT / "results/reference").glob("*/*/*/run.json")
        there = {run.parents[2].name for run in runs if json.loads(run.read_text()).get("standard", True)}
        self.take(*there)
        told = json.loads(self.compare("--json", "--all", status=0))
        self.assertEqual({c["experiment"] for c in told["comparisons"]}, there)
        self.assertLessEqual(set(told["verdicts"]), {"SAME", "UNCLEAR"})
        self.assertEqual(sum(told["verdicts"].values()), sum(len(c["figures"]) for c in told["comparisons"]))
        for c in told["comparisons"]:
            self.assertTrue(c["figures"], f"nothing of {c['experiment']} is compared")
            for f in c["figures"]:  # one timing of a run tells nothing; of repetitions some do
                if f["verdict"] == "UNCLEAR":
                    self.assertTrue("reason" in f or f["interval"][0] < 1 < f["interval"][1])

    def test_packed_rows_are_as_good_as_others(self):
        self.take("fig7_convergence", "streaming")
        packed = list((self.root / "after").rglob("*.csv.gz"))
        self.assertTrue(packed)
        for path in packed:
            path.with_suffix("").write_bytes(gzip.decompress(path.read_bytes()))
            path.unlink()
        self.assertEqual(self.figures(0, "--only", "fig7"), [])

    def test_a_changed_psnr(self):
        def change(rows):
            rows[3]["held_psnr_db"] = f"{float(rows[3]['held_psnr_db']) - 0.5:.4f}"
            rows[4]["held_psnr_db"] = f"{float(rows[4]['held_psnr_db']) - 0.25:.4f}"

        self.edit("fig9_error", "errors.csv", change)
        figures = self.figures(1)
        self.assertEqual({(e, f["verdict"], f["column"]) for e, f in figures}, {("fig9_error", "DIFFERENT", "held_psnr_db")})
        self.assertAlmostEqual(max(f["difference"] for _, f in figures), 0.5)
        text = self.compare("--only", "fig9", status=1)
        self.assertRegex(text, r"(?m)^DIFFERENT +errors.csv +held_psnr_db +2 .*: 0.5 dB +star, 1, .*$")
        self.assertIn("2 DIFFERENT", text.splitlines()[0])
        self.assertNotIn("fig10", text)
        self.assertEqual(self.figures(0, "--only", "streaming"), [])

    def test_a_slower_time(self):
        def steady(factor):
            def change(rows):
                for i, row in enumerate(rows):
                    if (row["problem"], row["passes"], row["source"]) == ("Lafortune", "paper", "memory"):
                        row["line_s"] = f"{factor * (1 + 0.001 * (i % 3)):.5g}"

            return change

        self.newest_only("streaming")
        self.edit("streaming", "iterations.csv", steady(1.0), "before")
        self.edit("streaming", "iterations.csv", steady(1.05))
        (figure,) = self.unclear("Lafortune, paper, memory", "line_s")
        self.assertIn("1.05", f"{figure['ratio']:.2f}", "of one program: that is how much this machine's times differ")
        self.another_program("streaming")
        (figure,) = self.unclear("Lafortune, paper, memory", "line_s")
        self.assertTrue(figure["reason"].startswith("no two runs of one program"), figure)
        self.run_again("streaming")
        ((experiment, figure),) = self.figures(1)
        self.assertEqual((experiment, figure["verdict"], figure["row"]), ("streaming", "SLOWER", "Lafortune, paper, memory"))
        self.assertAlmostEqual(figure["ratio"], 1.05, places=2)
        self.assertTrue(1.04 < figure["interval"][0] < figure["interval"][1] < 1.06)
        self.edit("streaming", "iterations.csv", steady(0.95))
        self.assertEqual([f["verdict"] for _, f in self.figures(0)], ["FASTER"])

    def test_rows_of_one_run_only(self):
        self.edit("precision", "finals.csv", lambda rows: rows.pop(5))
        ((_, figure),) = self.figures(1)
        self.assertEqual((figure["verdict"], figure["row"]), ("MISSING", "cg, fp16-truncate, fp16"))
        shutil.rmtree(self.root / "before")
        (self.root / "after").rename(self.root / "before")
        shutil.copytree(CHECKOUT / "results/reference/precision", self.root / "after/precision")
        shutil.copytree(CHECKOUT / "results/reference/streaming", self.root / "after/streaming")
        for experiment in ("fig9_error", "fig10_utilization"):
            shutil.rmtree(self.root / "before" / experiment)
        ((_, figure),) = self.figures(0)
        self.assertEqual(figure["verdict"], "NEW")

    def test_other_devices_are_told_and_their_times_left(self):
        self.newest_only("streaming")
        record = max((self.root / "after/streaming").glob("*/*/run.json"), key=lambda path: path.parent.name)
        before = json.loads(record.read_text())
        cpu, renderer = before["cpu"], before["gl"]["renderer"]
        record.write_text(record.read_text().replace(renderer, "Acme GPU 1"))
        self.edit("streaming", "iterations.csv", lambda rows: [r.update(line_s="1e-6") for r in rows])
        text = self.compare("--only", "streaming", status=0)
        self.assertIn(f"device: {cpu}, {before['cores']} cores, {before['threads']} threads; {renderer}, then {cpu}", text)
        self.assertIn("of another device", text)
        self.assertNotIn("FASTER", text)

    def test_an_experiment_of_one_side_is_told(self):
        self.newest_only("precision")
        arguments = json.loads((self.newest("before", "precision") / "run.json").read_text())["arguments"]
        profile = arguments[arguments.index("--profile") + 1]
        shutil.rmtree(self.root / "after/precision")
        text = self.compare(status=0)
        self.assertRegex(text, rf"(?m)^only in before: precision \({profile}, AMD EPYC")
        told = json.loads(self.compare("--json", status=0))
        self.assertEqual(len(told["only_before"]), 1)

    def test_everything_is_listed_where_asked_for(self):
        self.assertNotRegex(self.compare(status=0), r"(?m)^SAME")
        self.assertRegex(self.compare("--all", status=0), r"(?m)^SAME +errors.csv +train_psnr_db +\d+ ")


if __name__ == "__main__":
    Compare.program, CHECKOUT = take_arguments(2)
    unittest.main()
