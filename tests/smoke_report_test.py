#!/usr/bin/env python3
"""The claims and the report over what every experiment has just written at the smoke profile (smoke_test.py).

Arguments: the report's program, the claims', the checkout, the folder with each experiment's results, their names.
"""
import json
import shutil
import sys
import unittest

from cli_fixture import ProgramTest, take_arguments
from report_page import check_page, copy_sources

CLAIMS = CHECKOUT = RESULTS = NAMES = None


class SmokeReport(ProgramTest):
    def test_every_experiments_figure_and_tables(self):
        copy_sources(CHECKOUT, self.root)
        for name in NAMES:
            shutil.copytree(RESULTS / name, self.root / "results", dirs_exist_ok=True)
        for program, name in ((CLAIMS, "claims"), (None, "report")):
            self.good("--config", f"experiments/{name}.toml", "--profile", "smoke", program=program)
        claims = json.loads((self.root / "results/claims-smoke.json").read_text())["claims"]
        page = check_page(self, self.root / "results/report/smoke/index.html", claims)
        rivals = page.one("section", id="rivals")
        self.assertEqual(len(list(rivals.all("table"))), 2, rivals.text())
        for solver in ("variable projection", "Ceres’ L-BFGS", "Levenberg–Marquardt, the default", "Ceres’ TinySolver in floats"):
            self.assertIn(solver, rivals.text())
        for name in NAMES:
            with self.subTest(name):
                article = page.one("article", id=name)
                self.assertEqual(len(list(article.all("img"))), int((self.root / "paper_figs" / f"{name}.gp").exists()))
                self.assertTrue(list(article.all("table")))
                self.assertNotRegex(article.text(), "not run the (figure|table):")


if __name__ == "__main__":
    ProgramTest.program, CLAIMS, CHECKOUT, RESULTS = take_arguments(4)
    NAMES, sys.argv[1:] = sys.argv[1:], []
    unittest.main()
