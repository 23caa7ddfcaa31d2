"""Made-up results, judged by the claims program."""
import csv
import json
import shutil

from cli_fixture import ProgramTest

LLVMPIPE = "llvmpipe (LLVM 15.0.6, 256 bits)"
GPU = "NVIDIA H100/PCIe/SSE2"


class ClaimsTest(ProgramTest):
    checkout = None  # set by claims_test.py

    def setUp(self):
        for name in ("results", "experiments", "paper_figs"):
            shutil.rmtree(self.root / name, ignore_errors=True)
        (self.root / "experiments").mkdir()
        (self.root / "paper_figs").mkdir()
        shutil.copy(self.checkout / "experiments/claims.toml", self.root / "experiments")

    def add(self, experiment, tables, *, device="cpu", time="20240101T000000Z", profile="paper", standard=True, gl=None, **config):
        """One run: tables are {name of the CSV file: [row as a dict]}."""
        run = self.root / "results" / experiment / device / f"{time}-abc"
        run.mkdir(parents=True)
        record = {"program": experiment, "utc_start": time, "git_revision": "abc", "compiler": "c", "profile": profile,
                  "standard": standard, "cpu": "C", "cores": 2, "threads": 2, "config": config} | ({"gl": gl} if gl else {})
        (run / "run.json").write_text(json.dumps(record))
        for name, rows in tables.items():
            with open(run / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, rows[0], extrasaction="ignore")
                writer.writeheader()
                writer.writerows(rows)
        return run

    def judge(self, *more):
        """All findings, and those at the paper's scale by claim."""
        self.good("--config", "experiments/claims.toml", *more)
        rows = json.loads((self.root / "results/claims.json").read_text())["claims"]
        report = (self.root / "paper_figs/claims.md").read_text()
        for row in rows:
            self.assertIn(f"\n## {row['id']}: {row['paper']}\n", report)
        return rows, {row["id"]: row for row in rows if row["profile"] == "paper"}

    def finding(self, claim, experiment, tables, **more):
        """What the program finds of a claim in results that are nothing but these."""
        self.setUp()
        self.add(experiment, tables, **more)
        return self.judge()[1][claim]

    def other(self, finding, kind="former", place=0):
        """What another rule of the claim says: a former one, or one of the readings."""
        return finding[kind][place]["by_the_rule"]

    def verdict(self, claim, experiment, tables, **more):
        return self.finding(claim, experiment, tables, **more)["verdict"]
