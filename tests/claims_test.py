#!/usr/bin/env python3
"""The claims program over made-up results: every rule can hold, fail and stay undecided; and the table of docs/claims.md is what it
finds in results/reference.

Arguments: the program, the checkout.
"""
import datetime
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import unittest
import zlib

from claims.convergence import *  # noqa: F403
from claims.convergence import CONFIG, SUMMARY, ends, problems
from claims.fixture import ClaimsTest
from claims.images import *  # noqa: F403
from claims.samples import *  # noqa: F403
from claims.scale import *  # noqa: F403
from claims.stopping import *  # noqa: F403
from claims.time import *  # noqa: F403
from cli_fixture import snapshot, take_arguments


def told_first(claims, root):
    """Of each claim the judged row that tables show: of a run that the claim can be judged by, with all its rounds, the newest."""
    def precedence(row):
        cut_short = json.loads((root / row["run"] / "run.json").read_text()).get("rounds_left_out", False)
        return row["verdict"] not in ("not comparable", "not run"), not cut_short, row["run"].rsplit("/", 1)[-1]

    first = {}
    for row in claims:
        if row["profile"] == "paper":
            first[row["id"]] = max(first.get(row["id"], row), row, key=precedence)
    return first


class Report(ClaimsTest):
    def test_nothing_run(self):
        rows, judged = self.judge()
        self.assertEqual({row["verdict"] for row in rows}, {"not run"})
        self.assertEqual(set(judged), {f"C{i}" for i in range(1, 24)})
        self.assertIn("make experiments PROFILE=paper ONLY=fig7_convergence", judged["C1"]["reason"])

    def test_the_newest_run_of_each_device_and_the_reference(self):
        images = [{"covered_pixels": 100, "kept_pixels": 99, "facing_texels": 200}]

        def tables(samples):
            histogram = [{"samples": i, "texels": int(i == samples)} for i in range(samples + 1)]
            both = [(name, sides) for name in ("star", "bust") for sides in ("one", "own")]
            return {"datasets": [{"dataset": name, "sides": sides, "shared_texels": 0} for name, sides in both]} | {
                f"{name}{'_own_sides' if sides == 'own' else ''}_{kind}": rows for name, sides in both
                for kind, rows in (("images", images), ("samples_per_texel", histogram))}

        self.add("table1_datasets", tables(9), time="20240103T000000Z")
        self.add("table1_datasets", tables(30), time="20240102T000000Z")
        self.add("table1_datasets", tables(40), time="20250101T000000Z", profile="standard")
        self.add("table1_datasets", tables(50), device="other", gl={"vendor": "V", "renderer": "GPU", "version": "4.5"})
        self.add("table1_datasets", tables(60), time="20260101T000000Z", standard=False)
        rows = [row for row in self.judge()[0] if row["id"] == "C17"]
        self.assertEqual([(row["profile"], row["verdict"], row["by_the_rule"]) for row in rows],
                         [("paper", "does not hold", "does not hold"), ("paper", "holds", "holds"),
                          ("standard", "not comparable", "holds")])
        self.assertEqual([row["run"].split("/")[2] for row in rows], ["cpu", "other", "cpu"])
        self.assertEqual([row["renderer"] for row in rows], ["C, 2 threads", "GPU", "C, 2 threads"])
        self.assertIn("the standard profile is not of the paper's scale", rows[2]["reason"])
        self.assertEqual([row["rule_is_younger_than_rows"] for row in rows], [True, True, True], "of 2024 and 2025")
        # The same out of an archive, for a checkout that has none of these runs.
        with tarfile.open(self.root / "all.tar", "w") as archive:
            archive.add(self.root / "results", "results")
        (self.root / "results").rename(self.root / "away")
        self.good("--config", "experiments/claims.toml", "--run", "all.tar", "--output", "judged")
        judged = json.loads((self.root / "judged/claims.json").read_text())["claims"]
        self.assertEqual([(row["profile"], row["verdict"], row["run"]) for row in judged if row["id"] == "C17"],
                         [(row["profile"], row["verdict"], row["run"]) for row in rows])
        shutil.rmtree(self.root / "judged")
        (self.root / "away").rename(self.root / "results")
        # What came with the checkout is judged where the user ran nothing, and not otherwise.
        (self.root / "results/reference").mkdir()
        (self.root / "results/table1_datasets").rename(self.root / "results/reference/table1_datasets")
        self.assertEqual([row["verdict"] for row in self.judge()[0] if row["id"] == "C17"],
                         ["does not hold", "holds", "not run"])

    def test_runs_of_other_objects_and_weights_are_told_and_judge_nothing(self):
        def run(ratios, day, standard=False, **config):
            tables = {"problems": problems(ratios), "summary": SUMMARY, "ends": ends()}
            self.add("fig7_convergence", tables, time=f"2024010{day}T000000Z", standard=standard, **{**CONFIG, **config})

        run((10, 12), 1, standard=True)
        run((20, 24), 2, object=2)  # an older one
        run((2, 4), 3, object=2)
        run((2, 4), 4, vertices=5)  # of the same object and weight
        rows, judged = self.judge()
        self.assertEqual(judged["C1"]["verdict"], "holds")
        told = json.loads((self.root / "results/claims.json").read_text())["varied"]
        self.assertEqual({(v["id"], v["settings"]) for v in told}, {(claim, "object = 2") for claim in ("C1", "C2", "C19", "C22")})
        (c1,) = [v for v in told if v["id"] == "C1"]
        self.assertEqual(c1["by_the_measures"], "does not hold")
        self.assertIn("20240103", c1["run"])
        self.assertEqual([r["name"] for v in told if v["id"] == "C2" for r in v["readings"]], ["as mathematics"])
        report = (self.root / "paper_figs/claims.md").read_text()
        self.assertIn("with object = 2: does not hold", report)
        self.assertIn("\nWith object = 2, ", report)

    def test_rows_that_are_missing_cut_or_altered(self):
        whole = b"dataset,sides,shared_texels\nstar,one,0\n"
        for damage, words in ((None, "no such file"), (whole[:-4], "not as the run wrote it"),
                              (whole.replace(b"0", b"1"), "not as the run wrote it"),
                              (whole, "star_images.csv: no such file")):  # that one is as it was
            self.setUp()
            run = self.add("table1_datasets", {"datasets": [{"dataset": "star", "sides": "one", "shared_texels": 0}]})
            record = json.loads((run / "run.json").read_text())
            record["files"] = {"datasets.csv": {"bytes": len(whole), "crc32": f"{zlib.crc32(whole):08x}"}}
            (run / "run.json").write_text(json.dumps(record))
            (run / "datasets.csv").unlink()
            if damage is not None:
                (run / "datasets.csv").write_bytes(damage)
            row = self.judge()[1]["C17"]
            self.assertEqual(row["verdict"], "not run")
            self.assertIn(words, row["reason"])

    def test_the_reference_names_no_place_of_a_machine(self):
        runs = list((self.checkout / "results/reference").glob("*/*/*/run.json"))
        self.assertGreater(len(runs), 10)
        for run in runs:
            for dataset in json.loads(run.read_text())["datasets"]:
                self.assertNotRegex(dataset["source"], r"(^| )/", run)

    def test_rules_are_registered_before_the_rows_that_they_judge(self):
        """By git: since when a rule reads as it does. A verdict by an older run says so."""
        def git(*command):
            result = subprocess.run(["git", "-C", self.checkout, *command], capture_output=True, text=True)
            return result.stdout if result.returncode == 0 else ""

        file = "experiments/claims/rules.toml"
        commits = [line.split() for line in git("log", "--format=%H %ct", "--", file).splitlines()]
        if not commits or git("rev-parse", "--is-shallow-repository").strip() == "true":
            self.skipTest("no history here")
        judged_by = ("rule", "premises", "asks", "since")
        fixed = {}  # {claim: when}
        now = tomllib.loads((self.checkout / file).read_text())
        for commit, seconds in commits:  # the newest first
            then = tomllib.loads(git("show", f"{commit}:{file}"))
            for claim, rule in now.items():
                if fixed.get(claim, (None, True))[1] and all(then.get(claim, {}).get(k) == rule[k] for k in judged_by):
                    fixed[claim] = (int(seconds), True)
                elif claim in fixed:
                    fixed[claim] = (fixed[claim][0], False)
        uncommitted = [claim for claim in now if claim not in fixed]
        self.assertEqual(uncommitted, [], "rules that no commit holds judge no rows")
        for claim, (seconds, _) in fixed.items():
            day = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).date()
            self.assertGreaterEqual(now[claim]["since"], day, f"{claim} was changed on {day}: say so in since, and keep the former rule")
        for row in json.loads((self.checkout / "results/reference/claims.json").read_text())["claims"]:
            if row["run"] and not row["rule_is_younger_than_rows"]:
                taken = datetime.datetime.strptime(row["run"].rsplit("/", 1)[1][:16] + "+0000", "%Y%m%dT%H%M%SZ%z").timestamp()
                self.assertLess(fixed[row["id"]][0], taken, f"{row['id']} was registered after {row['run']}")

    def test_the_page_shows_the_reference(self):
        shutil.copytree(self.checkout / "results/reference", self.root / "results/reference")
        before = snapshot(self.root / "results")
        self.refused("--config", "experiments/claims.toml", "--set", 'results="results/reference"',
                     says=["say by --output where the verdicts go"])
        self.good("--config", "experiments/claims.toml", "--set", 'results="results/reference"', "--output", "judged")
        self.assertEqual(snapshot(self.root / "results"), before)
        report = (self.root / "judged/claims.md").read_text()
        def lines_of(text):
            return [" ".join(line.split()) for line in text.splitlines() if re.match(r"\| C\d+ ", line)]

        reported, shown = lines_of(report), lines_of((self.checkout / "docs/claims.md").read_text())
        claims = dict.fromkeys(line.split()[1] for line in reported)
        self.assertEqual([line.split()[1] for line in shown], list(claims), "docs/claims.md has one line for each claim")
        judged = json.loads((self.root / "judged/claims.json").read_text())["claims"]
        first = told_first(judged, self.root)
        self.assertEqual([row for row in judged if row["told_first"]], [first[row["id"]] for row in first.values()])
        for line in shown:
            self.assertTrue(line in reported, f"the line of docs/claims.md is not the reference's: {line}")
            row = first[line.split()[1]]
            self.assertIn(" ".join(row["sentence"].split()), line, "of the run that is told first")
            self.assertEqual("these rows are older than the rule" in line, row["rule_is_younger_than_rows"], line)
        told = subprocess.run([sys.executable, "-B", self.checkout / "tests/recompute_claims.py", self.root / "judged/claims.json",
                               self.root], capture_output=True, text=True)  # fmt: skip
        self.assertEqual(told.returncode, 0, told.stdout + told.stderr)
        shipped = json.loads((self.checkout / "results/reference/claims.json").read_text())
        self.assertEqual(json.loads((self.root / "judged/claims.json").read_text()), shipped)

    def test_the_readme_counts_the_reference(self):
        first = told_first(json.loads((self.checkout / "results/reference/claims.json").read_text())["claims"], self.checkout)
        verdicts = [row["verdict"] for row in first.values()]
        text = " ".join((self.checkout / "README.md").read_text().split())
        counts = re.search(r"of 23, (\d+) hold, (\d+) do not, (\d+) waits? for a graphics chip or for rows of their own, and undecided (?:is|are) (\d+)", text)
        older = sum(row["rule_is_younger_than_rows"] for row in first.values())
        said = re.search(r"(\d+) of the verdicts are still of rows older than their rule", text)
        self.assertEqual(int(said[1]) if said else 0, older)
        builds = {json.loads((self.checkout / row["run"] / "run.json").read_text())["march"]["resolved"] for row in first.values()}
        self.assertEqual(len(builds), 1, "rows of programs that were compiled for the same instructions")
        self.assertEqual([int(n) for n in counts.groups()], [verdicts.count("holds"), verdicts.count("does not hold"),
                         sum(v in ("not comparable", "not run") for v in verdicts), verdicts.count("undecided")])  # fmt: skip


if __name__ == "__main__":
    program, checkout = take_arguments(2)
    ClaimsTest.program, ClaimsTest.checkout = program, pathlib.Path(checkout)
    unittest.main()
