#!/usr/bin/env python3
"""The claims program over made-up results: every rule can hold and can fail; and the README's table is what the program
finds in results/reference.

Arguments: the program, the checkout.
"""
import csv
import json
import shutil
import unittest

from cli_fixture import ProgramTest, take_arguments

CHECKOUT = None
LLVMPIPE = "llvmpipe (LLVM 15.0.6, 256 bits)"
GPU = "NVIDIA H100/PCIe/SSE2"

CONVERGENCE = {"dataset": "star", "problems": 90, "ratio_quartile1": 4, "ratio_median": 10, "ratio_quartile3": 20,
               "sd_censored_share": 0.1, "cg_unfinished_share": 0.01, "cg_better_at_tenth_share": 0.9}
DATASETS = {"dataset": "star", "median_samples_per_texel": 26, "kept_share": 0.44, "shared_texels": 0}


def times(cpu=100.0, full=200.0, gl=10.0, combined=5.0, streaming=2.0, switching=(6.0, 5.0), distribution=80.0,
          cached=0.0, renderer=GPU):
    rows = []
    for optimizer, switch in zip(("cg", "sd"), switching):
        row = {"part": "figure", "optimizer": optimizer, "iterations": 100, "streaming_s": streaming,
               "distribution_s": 0, "switching_s": switch, "cached_share": cached, "source": "disk-cold"}
        rows += [
            {**row, "method": "two-step (full record)", "total_s": full, "distribution_s": distribution, "renderer": "cpu"},
            {**row, "method": "two-step (compact record)", "total_s": cpu, "renderer": "cpu"},
            {**row, "method": "OpenGL (paper passes)", "total_s": gl, "renderer": renderer},
            {**row, "method": "OpenGL (combined passes)", "total_s": combined, "renderer": renderer},
        ]
    return rows


def errors(pca=30.0, high=31.0, low=29.0, half=28.9):
    return [{"dataset": dataset, "method": method, "terms": 1, "train_psnr_db": psnr, "train_ape": 100 - psnr,
             "renderer": "r"}
            for dataset in ("star", "bust")
            for method, psnr in (("pca", pca), ("cpu-high", high), ("cpu-low", low), ("fragment-fp16", half))]


def memory(power=1.0, excess=1.0):
    return [{"engine": "fragment", "passes": "paper", "storage": "fp32", "parameters": n, "planned_bytes": 8 * n**power,
             "allocated_bytes": 8 * n**power * excess} for n in (1e5, 1e6, 1e7)]


def costs(power=1.0):
    return [{"engine": "cpu", "samples": s, "seconds_per_iteration": 1e-9 * s**power, "renderer": "cpu"}
            for s in (1e5, 1e6, 1e7)]


class Claims(ProgramTest):
    def setUp(self):
        for name in ("results", "experiments", "paper_figs"):
            shutil.rmtree(self.root / name, ignore_errors=True)
        (self.root / "experiments").mkdir()
        (self.root / "paper_figs").mkdir()
        shutil.copy(CHECKOUT / "experiments/claims.toml", self.root / "experiments")

    def add(self, experiment, tables, *, device="cpu", time="20240101T000000Z", profile="standard", gl=None, **config):
        run = self.root / "results" / experiment / device / f"{time}-abc"
        run.mkdir(parents=True)
        record = {"profile": profile, "cpu": "C", "threads": 2, "config": config} | ({"gl": gl} if gl else {})
        (run / "run.json").write_text(json.dumps(record))
        for name, rows in tables.items():
            with open(run / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, rows[0], extrasaction="ignore")
                writer.writeheader()
                writer.writerows(rows)

    def judge(self, *more):
        self.good("--config", "experiments/claims.toml", *more)
        rows = json.loads((self.root / "results/claims.json").read_text())["claims"]
        table = (self.root / "paper_figs/claims.md").read_text()
        for row in rows:
            self.assertIn(f"| {row['id']} ", table)
        return {row["id"]: row for row in rows}

    def verdict(self, claim, experiment, tables, **more):
        self.setUp()
        self.add(experiment, tables, **more)
        return self.judge()[claim]["verdict"]

    def test_nothing_run(self):
        rows = self.judge()
        self.assertEqual({row["verdict"] for row in rows.values()}, {"not run"})
        self.assertEqual(set(rows), {f"C{i}" for i in range(1, 19)})
        self.assertIn("make experiments PROFILE=standard ONLY=fig7_convergence", rows["C1"]["why"])

    def test_convergence(self):
        def both(**changed):
            return {"summary": [CONVERGENCE, {**CONVERGENCE, "dataset": "bust", **changed}]}

        rule = {"cap": 3000, "lambda": 1e-4, "tolerance": 1.01}
        self.assertEqual(self.verdict("C1", "fig7_convergence", both(), **rule), "holds")
        self.assertEqual(self.verdict("C1", "fig7_convergence", both(ratio_median=4.9), **rule), "does not hold")
        for other in ({"cap": 300}, {"lambda": 1e-3}, {"tolerance": 1.1}):
            self.assertEqual(self.verdict("C1", "fig7_convergence", both(), **{**rule, **other}), "not comparable")
        self.assertEqual(self.verdict("C1", "fig7_convergence", both(dataset="star"), **rule), "not comparable")
        self.assertEqual(self.verdict("C2", "fig7_convergence", both(), cap=3000), "holds")
        bad = both(cg_better_at_tenth_share=0.5)
        self.assertEqual(self.verdict("C2", "fig7_convergence", bad, cap=3000), "does not hold")

    def test_time(self):
        def verdict(claim, iterations=100, dataset="star", **changed):
            return self.verdict(claim, "fig8_time", {"times": times(**changed)}, iterations=iterations, dataset=dataset)

        self.assertEqual(verdict("C3"), "holds")
        self.assertEqual(verdict("C3", gl=20.0), "does not hold")
        self.assertEqual(verdict("C3", cpu=300.0, full=49.0), "does not hold", "the fastest baseline counts")
        self.assertEqual(verdict("C3", renderer=LLVMPIPE), "not comparable")
        self.assertEqual(verdict("C3", iterations=25), "not comparable")
        self.assertEqual(verdict("C3", dataset="bust"), "not comparable")
        self.assertEqual(verdict("C12"), "holds")
        self.assertEqual(verdict("C12", combined=9.6), "does not hold")
        self.assertEqual(verdict("C4"), "holds")
        self.assertEqual(verdict("C4", distribution=39.0), "does not hold")
        self.assertEqual(verdict("C5"), "holds")
        self.assertEqual(verdict("C5", streaming=0.9), "does not hold")
        self.assertEqual(verdict("C5", streaming=3.1), "does not hold")
        self.assertEqual(verdict("C5", cached=0.02), "not run")
        self.assertEqual(verdict("C7"), "holds")
        self.assertEqual(verdict("C7", switching=(5.0, 6.0)), "does not hold")
        self.assertEqual(verdict("C7", switching=(9.0, 7.0)), "does not hold")

    def test_errors(self):
        def verdict(claim, **changed):
            return self.verdict(claim, "fig9_error", {"errors": errors(**changed)})

        self.assertEqual(verdict("C8"), "holds")
        self.assertEqual(verdict("C8", pca=31.5), "does not hold")
        self.assertEqual(verdict("C9"), "holds")
        self.assertEqual(verdict("C9", half=28.7), "does not hold")
        self.assertEqual(verdict("C9", half=29.3), "does not hold")

    def test_utilization(self):
        rows = [{"problem": "light field map", "optimizer": o, "passes": p, "computation_share": 0.29, "reads_share": 0.4,
                 "bandwidth_share": 0.1, "renderer": GPU} for o in ("sd", "cg") for p in ("paper", "combined")]
        self.assertEqual(self.verdict("C10", "fig10_utilization", {"utilization": rows}), "not comparable")
        self.assertIn("light field map: computation 29.0 %", self.judge()["C10"]["value"])

    def test_streaming(self):
        def verdict(claim, share=0.7, ratio=0.9, faster=5, repetitions=5, cached=0.0):
            rows = [{"problem": problem, "passes": passes, "optimizer": o, "source": source, "streaming_share": share,
                     "over_disk_cold": 1 if source == "disk-cold" else ratio, "faster_repetitions": faster,
                     "repetitions": repetitions, "cached_share": cached, "renderer": GPU}
                    for problem in ("light field map", "Lafortune") for passes in ("paper", "combined")
                    for o in ("sd", "cg") for source in ("disk-cold", "memory", "device")]
            return self.verdict(claim, "streaming", {"times": rows})

        self.assertEqual(verdict("C6"), "holds")
        self.assertEqual(verdict("C6", share=0.49), "does not hold")
        self.assertEqual(verdict("C6", share=0.91), "does not hold")
        self.assertEqual(verdict("C6", cached=0.02), "not run")
        self.assertEqual(verdict("C11"), "holds")
        self.assertEqual(verdict("C11", ratio=0.96), "does not hold")
        self.assertEqual(verdict("C11", faster=4), "does not hold", "not significant")
        self.assertEqual(verdict("C11", faster=4, repetitions=4), "not comparable")
        self.assertEqual(verdict("C11", cached=0.02), "not run")

    def test_stopping(self):
        def verdict(residual=(-1, 20), change=(4, -1), sd=(3, -1), **config):
            rows = [{"rule": rule, "levels": levels, "optimizer": o, "first_below_half": half, "median_reached": median,
                     "idle_before_arrival": int(half >= 0 and (median < 0 or half < median))}
                    for levels in (0, 1, 4) for rule, o, (half, median) in (
                        ("residual", "cg", residual), ("residual", "sd", residual),
                        ("output change", "cg", change), ("output change", "sd", sd))]
            return self.verdict("C16", "stopping", {"rules": rows}, **{"tolerance": 1.01, "lambda": 1e-4, **config})

        self.assertEqual(verdict(), "holds")
        self.assertEqual(verdict(change=(21, 20)), "does not hold")
        self.assertEqual(verdict(sd=(-1, -1)), "does not hold", "with either optimizer")
        self.assertEqual(verdict(residual=(5, 20), change=(-1, 9)), "holds", "either rule")
        self.assertEqual(verdict(tolerance=1.1), "not comparable")

    def test_scaling(self):
        def verdict(claim, cost=1.0, **changed):
            return self.verdict(claim, "scaling", {"memory": memory(**changed), "time": costs(cost)})

        self.assertEqual(verdict("C14"), "holds")
        self.assertEqual(verdict("C14", power=1.08), "does not hold")
        self.assertEqual(verdict("C14", excess=1.06), "does not hold")
        self.assertEqual(verdict("C18"), "holds")
        self.assertEqual(verdict("C18", power=1.08), "holds")
        self.assertEqual(verdict("C18", power=0.85), "does not hold")
        self.assertEqual(verdict("C18", cost=1.2), "does not hold")

    def test_samples(self):
        def verdict(**changed):
            return self.verdict("C17", "table1_datasets", {"datasets": [DATASETS, {**DATASETS, "dataset": "bust", **changed}]})

        self.assertEqual(verdict(), "holds")
        self.assertEqual(verdict(median_samples_per_texel=9.5), "does not hold")
        self.assertEqual(verdict(shared_texels=1), "does not hold")

    def test_newest_run_of_each_device_and_profile(self):
        for time, median in (("20240103T000000Z", 9.0), ("20240102T000000Z", 30.0)):
            self.add("table1_datasets", {"datasets": [{**DATASETS, "dataset": name, "median_samples_per_texel": median}
                                                 for name in ("star", "bust")]}, time=time)
        both = {"datasets": [DATASETS, {**DATASETS, "dataset": "bust"}]}
        self.add("table1_datasets", both, time="20250101T000000Z", profile="smoke")
        self.add("table1_datasets", both, device="other", gl={"vendor": "V", "renderer": GPU, "version": "4.5"})
        self.judge()
        rows = [row for row in json.loads((self.root / "results/claims.json").read_text())["claims"] if row["id"] == "C17"]
        self.assertEqual([row["verdict"] for row in rows], ["does not hold", "holds"])
        self.assertEqual([row["run"].split("/")[1] for row in rows], ["cpu", "other"])
        self.assertEqual([row["renderer"] for row in rows], ["C, 2 threads", GPU])

    def test_damaged_results(self):
        self.add("table1_datasets", {"datasets": [{"dataset": "star"}]})
        row = self.judge()["C17"]
        self.assertEqual(row["verdict"], "not run")
        self.assertIn("median_samples_per_texel", row["why"])

    def test_the_readme_shows_the_reference(self):
        shutil.copytree(CHECKOUT / "results/reference", self.root / "results/reference")
        self.good("--config", "experiments/claims.toml", "--set", 'results="results/reference"')
        claims = json.loads((self.root / "results/reference/claims.json").read_text())["claims"]
        readme = (CHECKOUT / "README.md").read_text()
        judged = [row for row in claims if row["run"]]
        self.assertGreater(len(judged), 10)
        for row in judged:
            cells = (row["id"], row["paper"], row["value"], row["verdict"], row["renderer"])
            self.assertIn(f"| {' | '.join(cells)} |", readme, "the README's line is another")


if __name__ == "__main__":
    Claims.program, CHECKOUT = take_arguments(2)
    unittest.main()
