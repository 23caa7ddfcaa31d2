#!/usr/bin/env python3
"""The report over runs of results/reference, damaged ones, and made-up ones.

Arguments: the program, the claims program, the checkout.
"""
import csv
import json
import re
import shutil
import unittest

from cli_fixture import ProgramTest, take_arguments
from report_page import check_page, copy_sources, read_page

CLAIMS = CHECKOUT = None
EXPERIMENTS = ("streaming", "passes", "solvers", "departures")  # that are drawn quickly
OTHER_OPENGL = re.compile("^zink|osmesa")


class ReportPage(ProgramTest):
    def setUp(self):
        for name in ("results", "experiments", "paper_figs"):
            shutil.rmtree(self.root / name, ignore_errors=True)
        copy_sources(CHECKOUT, self.root)
        for name in EXPERIMENTS:
            shutil.copytree(CHECKOUT / "results/reference" / name, self.root / "results" / name)

    def report(self, *more, path="results/report/index.html"):
        self.good("--config", "experiments/report.toml", *more)
        return self.root / path

    def checked(self):
        """The page, after it was compared with what the claims program says of the same runs."""
        self.good("--config", "experiments/claims.toml", program=CLAIMS)
        return check_page(self, self.report(), json.loads((self.root / "results/claims.json").read_text())["claims"])

    def newest(self, experiment, device="*", profile="paper"):
        """None of OSMesa and zink, of which the reference has short runs."""
        runs = [path.parent for path in (self.root / "results" / experiment).glob(f"{device}/*/run.json")
                if json.loads(path.read_text())["profile"] == profile and not OTHER_OPENGL.search(path.parts[-3])]
        return max(runs, key=lambda run: run.name)

    def keep_newest(self, experiment, device="*"):
        """All its other runs go."""
        kept = self.newest(experiment, device)
        for run in (self.root / "results" / experiment).glob("*/*"):
            if run != kept:
                shutil.rmtree(run)
        return kept

    def test_every_claim_figure_and_table(self):
        page = self.checked()
        for name in EXPERIMENTS:
            article = page.one("article", id=name)
            self.assertEqual(len(list(article.all("figure"))) > 0, name != "departures", name)
            self.assertTrue(list(article.all("table")), name)
            self.assertIn(f"PROFILE=paper ONLY={name}", article.text())
        streaming = page.one("article", id="streaming")
        self.assertIn("The paper, Section 6.5.", streaming.text())
        table = next(table for table in streaming.all("table") if "times.csv" in table.one("caption").text())
        with open(self.newest("streaming") / "times.csv", encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertEqual(len(table.table()), len(lines) - 1)
        self.assertEqual(table.table()[0]["seconds per iteration"], lines[1].split(",")[4])
        self.assertIn("repetitions 9", table.one("caption").text())
        for name in ("fig7_convergence", "captures"):  # nothing was run
            self.assertIn("not run", page.one("article", id=name).text())
        shown = page.one("section", id="environment").text()
        self.assertIn(json.loads((self.newest("streaming") / "run.json").read_text())["git_revision"], shown)
        self.assertIn("GNU 12.2.0", shown)

    def test_a_removed_and_a_damaged_file_of_rows(self):
        run = self.keep_newest("streaming", "llvmpipe*")
        (run / "iterations.csv").unlink()
        passes = self.keep_newest("passes") / "ladder.csv"
        passes.write_text(passes.read_text().replace("1", "2", 1))
        page = self.checked()
        streaming = page.one("article", id="streaming")
        self.assertFalse(list(streaming.all("figure")))
        self.assertRegex(streaming.text(), r"not run the figure: \S*iterations\.csv: no such file; run the experiment again")
        self.assertTrue(list(streaming.all("table")), "the other file's table is there")
        self.assertEqual(page.one("article", id="C6").one("div", data_profile="paper").attributes["data-verdict"], "not run")
        self.assertIn("not run the table: ", page.one("article", id="passes").text())
        self.assertIn("not as the run wrote it", page.one("article", id="passes").text())

    def test_nothing_run(self):
        shutil.rmtree(self.root / "results")
        page = self.checked()
        self.assertFalse(list(page.all("img")))
        self.assertEqual({row["Verdict"] for row in page.one("table", id="claims-table").table()}, {"not run"})
        self.assertIn("make experiments PROFILE=paper ONLY=fig8_time", page.one("article", id="C4").text())
        self.assertIn("not run", page.one("section", id="environment").text())

    def made_up_solvers(self, rows, **files):
        """A run of `solvers` with these rows (solver, setting, vertex, reached, seconds)."""
        kept = self.keep_newest("solvers")
        record = json.loads((kept / "run.json").read_text())
        record.pop("files", None)
        (kept / "run.json").write_text(json.dumps(record))
        lines = ["solver,setting,vertex,reached,seconds_to_101", *(",".join(map(str, row)) for row in rows)]
        (kept / "vertices.csv").write_text("\n".join(lines) + "\n")

    def test_performance_profile(self):
        self.made_up_solvers([("a", "x", 7, 3, 1), ("a", "x", 8, 3, 8), ("a", "x", 9, 2, 1), ("b", "", 7, 3, 3), ("b", "", 8, 3, 2)])
        section = self.checked().one("section", id="performance-profile")
        self.assertEqual(len(list(section.all("img"))), 1)
        self.assertEqual(section.one("table").table(), [
            {"solver": "a x", "vertices tried": "3", "fastest": "33 %", "within 2 times": "33 %", "within 5 times": "67 %",
             "within 10 times": "67 %", "within 100 times": "67 %", "solved": "67 %"},
            {"solver": "b", "vertices tried": "2", "fastest": "50 %", "within 2 times": "50 %", "within 5 times": "100 %",
             "within 10 times": "100 %", "within 100 times": "100 %", "solved": "100 %"}][::-1])  # fmt: skip

    def test_no_times_of_vertices_no_profile(self):
        kept = self.keep_newest("solvers")
        record = json.loads((kept / "run.json").read_text())
        record.pop("files", None)  # so that nothing seems to be lost
        (kept / "run.json").write_text(json.dumps(record))
        (kept / "vertices.csv").unlink()
        section = self.checked().one("section", id="performance-profile")
        self.assertFalse(list(section.all("img")))
        self.assertIn("not run", section.text())
        self.assertIn("no vertices.csv", section.text())
        self.made_up_solvers([("a", "x", 7, 3, -1)])
        self.assertIn("a time below 0", self.checked().one("section", id="performance-profile").text())

    def test_text_of_rows_is_text(self):
        self.made_up_solvers([("<script>alert(1)</script>", "&amp;\"'", 7, 3, 1)])
        section = self.checked().one("section", id="performance-profile")
        self.assertIn("<script>alert(1)</script> &amp;\"'", section.text())

    def test_against_the_reference(self):
        self.assertIn("no such folder", self.checked().one("section", id="comparison").text())
        shutil.copytree(self.root / "results/departures", self.root / "results/reference/departures")
        file = max((self.root / "results/departures").glob("*/*/fits.csv"), key=lambda path: path.parent.name)
        record = json.loads((file.parent / "run.json").read_text())
        record.pop("files")
        (file.parent / "run.json").write_text(json.dumps(record))
        with file.open(newline="") as f:
            rows = list(csv.reader(f))
        column = rows[0].index("psnr_db")
        rows[1][column] = str(float(rows[1][column]) + 1)
        with file.open("w", newline="") as f:
            csv.writer(f, lineterminator="\n").writerows(rows)
        section = self.checked().one("section", id="comparison")
        rows = next(section.all("table")).table()
        self.assertEqual({row["experiment"] for row in rows}, {"departures"})
        self.assertTrue(any(re.search(r"\b1 DIFFERENT\b", row["figures"]) for row in rows), rows)
        self.assertIn("Only in the results: ", section.text())
        self.assertIn(": 1 dB", list(section.all("details"))[1].text())  # the section's own fold is the first

    def test_the_reference_itself_elsewhere(self):
        (self.root / "results/passes").rename(self.root / "kept")
        shutil.rmtree(self.root / "results")
        (self.root / "results/reference").mkdir(parents=True)
        (self.root / "kept").rename(self.root / "results/reference/passes")
        setting = ("--set", 'results="results/reference"')
        self.refused("--config", "experiments/report.toml", *setting, says=["the report in `results`", "--output"])
        page = read_page(self.report(*setting, "--output", "mine", path="mine/report/index.html"))
        self.assertIn("the reference itself", page.one("section", id="comparison").text())
        self.assertTrue(list(page.one("article", id="passes").all("figure")))

    def test_software_renderers_side_by_side(self):
        # The reference has three.
        page = read_page(self.report("--output", "three", path="three/report/index.html"))
        headers = page.one("section", id="renderers").text()
        self.assertIn("OSMesa", headers)
        self.assertIn("zink (llvmpipe", headers)
        for device in (self.root / "results").glob("*/*"):
            if OTHER_OPENGL.search(device.name):
                shutil.rmtree(device)
        page = read_page(self.report("--output", "one", path="one/report/index.html"))
        self.assertEqual(list(page.all("section", id="renderers")), [], "there is one alone")
        zink = "zink (llvmpipe (LLVM 15.0.6, 256 bits))"
        run = self.keep_newest("streaming", "llvmpipe*")
        other = shutil.copytree(run, run.parents[1] / "zink" / run.name)
        record = json.loads((other / "run.json").read_text())
        record["gl"]["renderer"] = zink
        del record["files"]
        (other / "run.json").write_text(json.dumps(record))
        rows = (other / "times.csv").read_text().replace("llvmpipe (LLVM 15.0.6, 256 bits)", zink)
        (other / "times.csv").write_text(rows)
        page = read_page(self.report("--output", "two", path="two/report/index.html"))
        section = page.one("section", id="renderers")
        self.assertIn("no verdict rests on them", section.text())
        shown = next(table for table in section.all("table") if table.one("caption").text().startswith("C11: "))
        self.assertTrue(shown.table())
        for row in shown.table():
            of_zink = next(value for name, value in row.items() if name.startswith("zink"))
            of_llvmpipe = next(value for name, value in row.items() if name.startswith("llvmpipe"))
            self.assertEqual(of_llvmpipe, of_zink)
            self.assertRegex(of_zink, r"^[0-9.]+ times \([0-9.]+ to [0-9.]+ times\)$")

    def test_other_profiles_lie_apart(self):
        shutil.rmtree(self.root / "results")
        self.assertFalse((self.root / "results/report/index.html").exists())
        page = self.report("--profile", "smoke", path="results/report/smoke/index.html")
        self.assertIn("make report PROFILE=smoke", page.read_text(encoding="utf-8"))
        self.assertFalse((self.root / "results/report/index.html").exists())

    def test_bad_configurations(self):
        arguments = ("--config", "experiments/report.toml")
        self.refused(*arguments, "--set", "results=''", "--output", "mine", says=["results = ''"])
        self.refused(*arguments, "--set", "result='x'", says=["unknown key", "did you mean"])
        (self.root / "experiments/page/page.css").unlink()
        self.refused(*arguments, says=["experiments/page/page.css", "no such"])


if __name__ == "__main__":
    ProgramTest.program, CLAIMS, CHECKOUT = take_arguments(3)
    unittest.main()
