#!/usr/bin/env python3
"""Smoke of one experiment: at the smoke profile, in a temporary folder, it leaves its figures, and rows that can be true.

Arguments: the experiment's program, the checkout, radiafit, where its results are left for smoke_report_test.py.
"""
import csv
import json
import math
import pathlib
import shutil
import statistics
import struct
import unittest

from cli_fixture import ProgramTest, snapshot, take_arguments
from report_page import copy_sources

CHECKOUT = RADIAFIT = RESULTS = None


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


class Smoke(ProgramTest):
    def setUp(self):
        self.name = self.program.name
        copy_sources(CHECKOUT, self.root)
        self.config = self.root / "experiments" / f"{self.name}.toml"

    def run_experiment(self, *more):
        return self.good("--config", f"experiments/{self.name}.toml", "--profile", "smoke", *more)

    def test_rows_and_figures(self):
        self.run_experiment()
        runs = list((self.root / "results" / self.name).glob("*/*/run.json"))
        self.assertEqual(len(runs), 1)
        record = json.loads(runs[0].read_text())
        self.assertIn(self.name, record["program"])
        self.assertTrue(record["config"], "the resolved config is part of the record")
        self.assertGreater(min(record["wall_s"], record["cpu_s"]), 0.01, "of the whole run")
        self.assertLessEqual(record["utc_start"], record["utc_end"])
        self.assertTrue(runs[0].parent.name.startswith(record["utc_start"].replace("-", "").replace(":", "")))
        self.assertEqual(bool(record["datasets"]), self.name not in ("certified", "batches"))
        for dataset in record["datasets"]:
            self.assertRegex(dataset["source"], "^radiafit generate .* --seed [123]\\b" if self.name == "fig9_error" else "^radiafit generate .* --seed 1\\b")
            self.assertRegex(dataset["checksum"], "^[0-9a-f]{16}$")
        self.assertIn("kernel", record["machine"])

        tables = sorted(runs[0].parent.glob("*.csv"))
        self.assertTrue(tables)
        for table in tables:
            rows = read_rows(table)
            self.assertTrue(rows, f"{table.name} is empty")
            for row in rows:
                for column, text in row.items():
                    value = number(text)
                    if value is not None:
                        self.assertTrue(math.isfinite(value), f"{table.name}: {column} = {text}")
        self.check_gl(record, {row["renderer"] for table in tables for row in read_rows(table) if "renderer" in row})
        self.check_figures()
        check = getattr(self, "check_" + self.name, None)
        if check:
            check({table.stem: read_rows(table) for table in tables})
        # radiafit compare knows every column, and can match the rows
        told = json.loads(self.good("compare", runs[0].parent, runs[0].parent, "--json", program=RADIAFIT).stdout)
        self.assertLessEqual(set(told["verdicts"]), {"SAME", "UNCLEAR"})
        self.assertFalse([path for path in snapshot(self.root) if pathlib.Path(path).name.startswith(".tmp")])
        shutil.rmtree(RESULTS, ignore_errors=True)
        shutil.copytree(self.root / "results", RESULTS)

    def check_gl(self, record, renderers):
        """The record names the one OpenGL that made rows, and none where none did."""
        renderers = {renderer for renderer in renderers if not renderer.startswith("cpu")}
        self.assertEqual({record["gl"]["renderer"]} if "gl" in record else set(), renderers)
        if renderers:
            self.assertTrue(record["gl"]["vendor"])
            self.assertRegex(record["gl"]["version"], r"^\d+\.\d+")

    def check_figures(self):
        figures = self.root / "paper_figs/smoke"
        if (self.root / "paper_figs" / f"{self.name}.gp").exists():
            self.assertIn("<svg", (figures / f"{self.name}.svg").read_text()[:2000])
        drawn = list(figures.glob(f"{self.name}.*"))
        self.assertTrue(drawn, "no figure and no table")
        for path in drawn:
            self.assertGreater(path.stat().st_size, 500, path.name)
            if path.suffix == ".png":
                width, height = struct.unpack_from(">II", path.read_bytes(), 16)
                self.assertGreater(min(width, height), 50)

    def check_table1_datasets(self, tables):
        rows = tables["datasets"]
        self.assertEqual([(row["dataset"], row["sides"]) for row in rows],
                         [("star", "one"), ("star", "own"), ("bust", "one"), ("bust", "own"), ("ornament", "one")])
        ornament = rows.pop()
        self.assertEqual((ornament["images"], ornament["problems"], ornament["parameters"]),
                         ("240", str(320 * 21), str(9 * 320 * 21)))
        self.assertGreater(float(ornament["median_samples_per_texel"]), 10)
        for row in rows:
            self.assertEqual((row["triangles"], row["images"], row["held_out"]), ("320", "24", "3"))
            self.assertEqual(int(row["image_bytes"]), 24 * 64 * 64 * 3)
            self.assertEqual(int(row["problems"]), 3 * int(row["vertices"]))
            self.assertEqual(2 * int(row["vertices"]), int(row["triangles"]) + 4)  # Euler: a closed surface without holes
            samples, pixels = int(row["samples"]), int(row["covered_pixels"])
            self.assertLessEqual(samples, pixels)  # a pixel feeds at most one texel
            self.assertLess(pixels, 21 * 64 * 64)
            self.assertAlmostEqual(float(row["kept_share"]), samples / pixels, places=3)
            files = row["dataset"] + ("_own_sides" if row["sides"] == "own" else "")
            histogram = tables[files + "_samples_per_texel"]
            self.assertEqual(sum(int(bin["samples"]) * int(bin["texels"]) for bin in histogram), samples)
            texels = sum(int(bin["texels"]) for bin in histogram)
            self.assertEqual(texels == 36 * 320, row["sides"] == "one")
            without = sum(int(bin["texels"]) for bin in histogram if bin["samples"] == "0")
            self.assertAlmostEqual(float(row["without_samples_share"]), without / texels, places=4)
            images = tables[files + "_images"]
            self.assertEqual(len(images), 21)
            self.assertEqual(sum(int(image["kept_pixels"]) for image in images), samples)
            self.assertEqual(sum(int(image["covered_pixels"]) for image in images), pixels)
            for image in images:
                self.assertTrue(0.3 * texels < int(image["facing_texels"]) < 0.7 * texels)
            ratios = sorted(int(image["facing_texels"]) / int(image["covered_pixels"]) for image in images)
            self.assertAlmostEqual(float(row["texels_per_pixel"]), ratios[10], places=3)
            if row["sides"] == "own":  # as many texels as pixels where a triangle is largest, so more in most images
                self.assertGreater(ratios[0], 1)

    def check_fig7_convergence(self, tables):
        solvers = ["cg_paper", "sd", "sd_growing", "cg_modern", "lbfgs", "adam", "varpro"]
        self.assertEqual([(row["dataset"], row["lambda"]) for row in tables["summary"]],
                         [(d, lam) for d in ("star", "bust") for lam in ("0.0001", "0.001", "0.01")])
        for row in tables["summary"]:
            own = [p for p in tables["problems"] if (p["dataset"], p["lambda"]) == (row["dataset"], row["lambda"])]
            cap = int(row["cap"])
            self.assertEqual(len(own), int(row["problems"]))
            for solver in solvers:
                self.assertTrue(all(-1 <= int(p[solver]) <= cap for p in own), solver)
            for p in own:
                self.assertGreater(float(p["best_error"]), 0)
                self.assertIn(p["best_solver"], solvers)
            ratios = sorted((int(p["sd"]) if int(p["sd"]) >= 0 else cap) / (int(p["cg_paper"]) if int(p["cg_paper"]) >= 0 else cap)
                            for p in own)
            self.assertAlmostEqual(float(row["ratio_median"]), ratios[len(ratios) // 2], delta=0.1 * ratios[len(ratios) // 2])
            for method, solver in (("cg", "cg_paper"), ("sd", "sd")):
                censored = sum(p[solver] == "-1" for p in own) / len(own)
                self.assertAlmostEqual(float(row[f"{method}_censored_share"]), censored, places=3)
            if row["lambda"] == "0.0001":
                self.assertGreater(float(row["ratio_median"]), 1, "steepest descent is no faster than conjugate gradients")
                self.assertLess(float(row["cg_censored_share"]), 0.5)
                self.assertLess(float(row["varpro_median_iterations"]), float(row["cg_median_iterations"]))
                curves = [c for c in tables["curves"] if c["dataset"] == row["dataset"]]
                self.assertEqual({(c["method"], c["shown"]) for c in curves}, {(m, s) for m in ("cg", "sd") for s in "123"})
                for method in ("cg", "sd"):
                    errors = [float(c["error_over_best"]) for c in curves if (c["method"], c["shown"]) == (method, "1")]
                    self.assertEqual(errors, sorted(errors, reverse=True))  # what raises the error is not accepted
                    self.assertGreaterEqual(errors[-1], 0.9999)
                ends = [e for e in tables["ends"] if e["dataset"] == row["dataset"]]
                self.assertEqual(len(ends), 3 * 10)
                best = {(p["vertex"], p["channel"]): float(p["best_error"]) for p in own}
                for e in ends:
                    least = min(float(e["cg_error"]), float(e["sd_error"]))
                    self.assertGreaterEqual(least, 0.9999 * best[e["vertex"], e["channel"]])
                    self.assertLessEqual(int(e["cg_iterations"]), 1000)
                self.assertTrue(any(e["cg_at_rest"] == "1" for e in ends))

    def check_fig8_time(self, tables):
        bars = tables["times"]
        self.assertEqual({(row["method"], row["optimizer"]) for row in bars},
                         {(m, o) for o in ("cg", "sd") for m in ("two-step (full record)", "two-step (compact record)",
                                                                 "OpenGL (paper passes)", "OpenGL (combined passes)",
                                                                 "OpenGL (paper passes in 32 bits)")})
        for row in bars:
            parts = ("distribution_s", "streaming_s", "computation_s", "switching_s", "remainder_s")
            self.assertAlmostEqual(sum(float(row[part]) for part in parts), float(row["total_s"]), delta=1e-3)
            self.assertGreaterEqual(float(row["computation_s"]), 0)
            self.assertEqual(row["method"].startswith("two-step"), int(row["bytes_written"]) > 0)
            if row["method"].startswith("two-step") or "32 bits" in row["method"]:
                self.assertGreater(float(row["agreeing_share"]), 0.95, "vertices that end where the cpu engine does")
            own = [r for r in tables["repetitions"] if all(r[k] == row[k] for k in ("method", "optimizer", "threads")) and
                   r["iterations"] == row["timed_iterations"]]
            self.assertEqual(len(own), int(row["repetitions"]))
            further = int(row["iterations"]) - int(row["timed_iterations"])
            totals = [float(r["total_s"]) + further * float(r["iteration_s"]) for r in own]
            self.assertLessEqual(min(totals) * 0.99, float(row["total_s"]))
            self.assertLessEqual(float(row["total_s"]), max(totals) * 1.01)
        full, compact = (sum(int(row["bytes_written"]) for row in bars if kind in row["method"])
                         for kind in ("full", "compact"))
        self.assertGreater(full, 5 * compact)
        self.assertIn("10", {r["iterations"] for r in tables["repetitions"]})  # of claim C4 alone
        work = {(r["method"], r["optimizer"]): r for r in tables["work"]}
        methods = ["OpenGL (paper passes)", "OpenGL (combined passes, image by image)", "OpenGL (combined passes)"]
        in_32_bits = "OpenGL (paper passes in 32 bits)"
        self.assertEqual(set(work), {(m, o) for m in (*methods, in_32_bits) for o in ("cg", "sd")})
        for optimizer in ("cg", "sd"):
            for what in ("reads", "switches"):  # what passes are combined for (Section 6.5), and batches besides
                amounts = [int(work[m, optimizer][what]) for m in methods]
                self.assertEqual(amounts, sorted(set(amounts), reverse=True))
                self.assertEqual(work[in_32_bits, optimizer][what], work[methods[0], optimizer][what])
        for row in tables["iterations"]:
            self.assertGreater(float(row["seconds"]), float(row["streaming_s"]))
            self.assertGreater(float(row["switching_s"]), 0)

    def both_instructions(self, instructions, widest, base):
        """With AVX-512 there is a row without it, too."""
        if instructions[widest] == "AVX-512" and base in instructions:
            self.assertEqual(instructions[base], "AVX2")
        elif instructions[widest] == "AVX-512":
            self.assertNotIn("AVX2", instructions.values(), "compiled for AVX-512 alone")
        else:
            self.assertNotIn(base, instructions)

    def check_solvers(self, tables):
        rows = tables["solvers"]
        self.assertLessEqual({"cg modern", "cg paper", "sd", "lbfgs", "adam"},
                             {r["setting"] for r in rows if r["solver"] == "two-step"})
        self.assertEqual({r["solver"] for r in rows}, {"two-step", "als", "varpro", "ceres"})
        times = [float(r["seconds_to_101"]) / int(r["vertices"]) for r in rows]
        self.assertEqual(times, sorted(times))
        self.assertEqual({(r["solver"], r["precision"], r["together"]) for r in rows},
                         {("two-step", "32, sums in 64", "3"), ("varpro", "64, Schur complement in 32", "3"), ("als", "64", "3"),
                          ("ceres", "64", "1")})  # fmt: skip
        self.both_instructions({(r["solver"], r["setting"]): r["instructions"] for r in rows}, ("varpro", ""), ("varpro", "AVX2"))
        self.assertEqual([r["times_cg_modern"] for r in rows if r["setting"] == "cg modern"], ["1"])
        self.assertEqual([r["times_varpro"] for r in rows if r["solver"] == "varpro" and not r["setting"]], ["1"])
        least = {}  # (vertex, channel): the least error of any solver
        for p in tables["problems"]:
            key = p["vertex"], p["channel"]
            least[key] = min(least.get(key, math.inf), float(p["error"]))
        for row in rows:
            own = [p for p in tables["problems"] if (p["solver"], p["setting"]) == (row["solver"], row["setting"])]
            self.assertEqual(len(own), int(row["problems"]))
            self.assertEqual(len(own), 3 * int(row["vertices"]))
            repeated = [r for r in tables["repetitions"] if (r["solver"], r["setting"]) == (row["solver"], row["setting"])]
            self.assertEqual(len(repeated), int(row["repetitions"]))
            self.assertEqual({r["vertices"] for r in repeated}, {row["vertices"]})
            self.assertEqual(min(float(r["seconds_to_101"]) for r in repeated), float(row["seconds_to_101_least"]))
            reached = [p for p in own if p["reached"] == "1"]
            vertices = [v for v in tables["vertices"] if (v["solver"], v["setting"]) == (row["solver"], row["setting"])]
            self.assertEqual([v["vertex"] for v in vertices], [p["vertex"] for p in own[::3]])
            self.assertEqual([int(v["reached"]) for v in vertices],
                             [sum(int(p["reached"]) for p in own[i : i + 3]) for i in range(0, len(own), 3)])
            if len(repeated) <= 2:  # their median is their mean then, and that of sums the sum of those
                self.assertAlmostEqual(sum(float(v["seconds_to_101"]) for v in vertices) / float(row["seconds_to_101"]), 1, delta=1e-3)
            self.assertAlmostEqual(float(row["reached_share"]), len(reached) / len(own), places=4)
            self.assertGreaterEqual(float(row["final_over_best_median"]), 1)
            self.assertLessEqual(float(row["seconds_to_101"]), float(row["seconds_total"]) * 1.001)
            for p in own:
                self.assertEqual(float(p["best_error"]), least[p["vertex"], p["channel"]])
                self.assertLessEqual(int(p["iterations_to_101"]), int(p["iterations"]))
                if p["reached"] == "1":  # an error never rises; 32-bit parameters round it
                    self.assertLessEqual(float(p["error"]), 1.0101 * float(p["best_error"]))
        newton = next(r for r in rows if r["setting"] == "sparse-normal-cholesky")
        self.assertEqual(float(newton["reached_share"]), 1)

    def check_fig9_error(self, tables):
        rows = {(r["dataset"], r["seed"], r["method"], r["weights"], int(r["terms"])): r for r in tables["errors"]}
        one_term = [("mean", ""), ("pca-published", ""), ("pca-refilled", ""), ("cg-high", "chosen"), ("cg-high", "0.0001"),
                    ("cg-modern-high", "chosen"), ("cg-low", "chosen"), ("cg-low-brief", "chosen"),
                    ("cg-low-fp16", "chosen")]  # fmt: skip
        two_terms = [("pca-refilled", ""), ("cg-high", "chosen"), ("cg-low", "chosen")]
        shapes, seeds = ("star", "bust"), ("1", "2")
        self.assertEqual(set(rows), {(d, s, *m, 1) for d in shapes for s in seeds for m in one_term} |
                         {(d, "1", *m, 2) for d in shapes for m in two_terms})
        for (dataset, seed, method, weights, k), row in rows.items():
            half, pca, cg = method == "cg-low-fp16", method.startswith("pca"), method.startswith("cg")
            self.assertAlmostEqual(float(row["surface_texels"]), 36 if "low" in method else 55, delta=0 if "low" in method else 8)
            self.assertEqual(row["texels_per_pixel"] in ("", "0.0", "0"), "low" in method)
            self.assertEqual([row[key] for key in ("storage", "sums", "passes")],
                             ["fp16", "fp16", "paper"] if half else ["fp32", "", ""])
            self.assertEqual(row["mode"], "" if not cg else "modern" if "modern" in method else "paper")
            self.assertEqual(row["renderer"].startswith("cpu"), not half)
            self.assertEqual((row["lambda_surface"] != "", row["invented_share"] != ""), (cg, pca))
            if pca:
                self.assertTrue(0 < float(row["invented_share"]) < 1)
            if method != "mean" and weights != "0.0001":  # better than no view dependence, on views not fitted too
                self.assertGreater(float(row["train_psnr_db"]), float(row["held_psnr_db"]))
                self.assertGreater(float(row["held_psnr_db"]), float(rows[dataset, seed, "mean", "", 1]["held_psnr_db"]))
            if half:
                self.assertAlmostEqual(float(row["train_psnr_db"]), delta=0.5, second=
                                       float(rows[dataset, seed, "cg-low-brief", "chosen", 1]["train_psnr_db"]))
        # seeds make other objects
        self.assertEqual(len({r["train_psnr_db"] for (*_, method, _, _), r in rows.items() if method == "mean"}), 4)
        for dataset in shapes:
            for method, column in (("cg-high", "lambda_view"), ("cg-low", "lambda_view"), ("pca-refilled", "refills")):
                trials = [r for r in tables["choice"] if (r["dataset"], r["seed"], r["method"]) == (dataset, "1", method)]
                best = max(trials, key=lambda r: float(r["validation_psnr_db"]))
                self.assertEqual([r["chosen"] for r in trials], ["1" if r is best else "0" for r in trials])
                self.assertEqual(len(trials), 2)
                weights = "" if method.startswith("pca") else "chosen"
                self.assertEqual(rows[dataset, "2", method, weights, 1][column], best[column])

    def check_fig10_utilization(self, tables):
        rows = {(r["problem"], r["passes"], r["optimizer"]): r for r in tables["utilization"]}
        problems = ["light field map", "Lafortune"]
        self.assertEqual(set(rows), {(p, k, o) for p in problems for k in ("paper", "combined", "paper in 32 bits") for o in ("sd", "cg")})
        self.assertEqual(set(rows), {(r["problem"], r["passes"], r["optimizer"]) for r in tables["work"]})
        peaks = {}
        for p in tables["peaks"]:
            if p["device"] == tables["utilization"][0]["renderer"]:
                peaks.setdefault(p["peak"], []).append(float(p["per_second"]))
        self.assertEqual(set(peaks), {"operations of fragments", "texture reads", "bytes"})
        for row in tables["work"]:
            key = row["problem"], row["passes"], row["optimizer"]
            times = [float(t["seconds"]) for t in tables["iterations"]
                     if (t["problem"], t["passes"], t["optimizer"]) == key]
            for share, amount, peak in (("computation", "operations", "operations of fragments"),
                                        ("reads", "reads", "texture reads"), ("bandwidth", "bytes", "bytes")):
                each = [int(row[amount]) / s / p for s, p in zip(times, peaks[peak], strict=True)]
                value = float(rows[key][share + "_share"])
                self.assertAlmostEqual(statistics.median(each) / value, 1, delta=0.01)
                # A busy machine lowers a round's peak, or stretches its time: what is left by the best peak and the
                # longest time was done for sure.
                sure = int(row[amount]) / max(times) / max(peaks[peak])
                self.assertTrue(0 < value and sure < 1.2, f"{key}: {value}, for sure {sure} of the peak; no more than noise is above it")
            self.assertLess(int(row["penalty_operations"]) + int(row["shared_operations"]), int(row["operations"]) / 2)
            own = [p for p in tables["passes"] if (p["problem"], p["passes"], p["optimizer"]) == key]
            for amount in ("operations", "reads"):
                self.assertEqual(sum(int(p[amount]) for p in own), int(row[amount]))
            self.assertEqual(sum(int(p["draws"]) for p in own), int(row["switches"]))  # a pass is a switch
            traffic = sum(int(p[b]) for p in own for b in ("read_bytes", "written_bytes", "blended_bytes"))
            self.assertLess(traffic, int(row["bytes"]))  # clears come on top
            lines = ("gather/line_term", "combine/tile_line", "reflect/line")
            self.assertEqual(any(p["program"].startswith(lines) for p in own), key[2] == "cg")
        for problem in problems:  # what the passes are combined for (Section 6.5)
            for optimizer in ("sd", "cg"):
                paper, combined = (next(r for r in tables["work"] if (r["problem"], r["passes"], r["optimizer"]) ==
                                        (problem, passes, optimizer)) for passes in ("paper", "combined"))
                self.assertLess(int(combined["reads"]), int(paper["reads"]))

    def check_streaming(self, tables):
        rows = tables["times"]
        sources = ("disk-cold", "disk", "memory", "device")
        problems = ["light field map", "Lafortune"]
        self.assertEqual([(r["problem"], r["passes"], r["optimizer"], r["source"]) for r in rows],
                         [(p, k, o, s) for p in problems for k in ("paper", "combined") for o in ("sd", "cg") for s in sources])
        for row in rows:
            own = [t for t in tables["iterations"] if all(t[k] == row[k] for k in ("problem", "passes", "source"))]
            self.assertEqual(len(own), int(row["repetitions"]))
            halves = ("direction",) if row["optimizer"] == "sd" else ("direction", "line")
            times = [sum(float(t[half + "_s"]) for half in halves) for t in own]
            self.assertLessEqual(min(times) * 0.999, float(row["seconds_per_iteration"]))
            self.assertLessEqual(float(row["seconds_per_iteration"]), max(times) * 1.001)
            if row["source"] == "device":  # nothing is streamed
                self.assertEqual(float(row["streaming_s"]), 0)
            else:
                self.assertTrue(0 < float(row["streaming_share"]) < 1)
            if row["source"] == "disk-cold":
                self.assertEqual(float(row["over_disk_cold"]), 1)
        for row in tables["iterations"]:  # a cold disk's images are not cached, a warm one's are
            self.assertTrue(row["source"] not in ("disk-cold", "disk") or
                            (float(row["cached_share"]) > 0.5) == (row["source"] == "disk"), row)

    def check_stopping(self, tables):
        rules = tables["rules"]
        self.assertEqual({(r["rule"], r["optimizer"]) for r in rules},
                         {(rule, o) for rule in ("none", "residual", "output change") for o in ("cg", "sd")})
        self.assertTrue(all(0.2 < float(w["weight"]) < 0.6 for w in tables["weights"]))
        count = 3 * len(tables["weights"])
        for row in rules:
            keys = ("rule", "levels", "optimizer")
            own = [c for c in tables["curves"] if all(c[k] == row[k] for k in keys)]
            active = [float(c["active_share"]) for c in own]
            median = [float(c["median_error_over_best"]) for c in own]
            self.assertEqual(own[-1]["iteration"], row["iterations"])
            self.assertEqual(active, sorted(active, reverse=True))  # a stopped problem stays so
            self.assertEqual(median, sorted(median, reverse=True))  # an error never rises
            problems = [p for p in tables["problems"] if all(p[k] == row[k] for k in keys)]
            self.assertEqual(len(problems), count)
            idle = sorted(int(p["stopped_at"]) for p in problems if p["stopped_at"] != "-1")
            half = idle[count // 2] if len(idle) > count // 2 else -1  # more than half are idle from then on
            self.assertEqual(int(row["first_below_half"]), half)
            last = sum(p["stopped_at"] == "-1" for p in problems) / count
            self.assertAlmostEqual(active[-1], last, places=4)
            short = sum(p["arrived_at"] == "-1" for p in problems) / count
            self.assertAlmostEqual(float(row["short_of_best_share"]), short, places=4)
            if row["levels"] == "0":
                self.assertGreater(active[-1], 0.9, "nothing but rounding stops a problem without a threshold")
        for rule in ("residual", "output change"):  # a looser threshold stops no fewer
            for optimizer in ("cg", "sd"):
                means = [float(r["mean_active_share"]) for level in ("8", "4", "2", "1", "0.5") for r in rules
                         if (r["rule"], r["levels"], r["optimizer"]) == (rule, level, optimizer)]
                self.assertEqual(means, sorted(means))

    def check_departures(self, tables):
        rows = tables["fits"]
        kinds = {}
        for row in rows:
            kinds.setdefault((row["problem"], row["optimizer"], row["numbers"]), []).append(row)
            for share in ("arrived_share", "stalled_share", "not_finite_share"):
                self.assertTrue(row[share] == "" or 0 <= float(row[share]) <= 1, share)
        self.assertEqual(set(kinds), {(p, o, "fp32") for p in ("light field map", "Lafortune") for o in ("cg", "sd")} |
                         {("light field map", "cg", f"fp16, sums {sums}") for sums in ("fp32", "fp16")})
        for own in kinds.values():
            self.assertEqual([row["departure"] for row in own].index(""), 0)
            self.assertEqual(float(own[0]["error_ratio"]), 1)
        rows = {(r["problem"], r["optimizer"], r["numbers"], r["without"]): r for r in rows}
        for problem in ("light field map", "Lafortune"):
            climbing = rows[problem, "cg", "fp32", "Eq. 7 as printed"]
            self.assertGreater(float(climbing["error_ratio"]), 1.1)  # it never leaves its start
            self.assertLess(float(climbing["arrived_share"]), 0.5)
        self.assertGreater(float(rows["light field map", "cg", "fp32", "all mends"]["arrived_share"]), 0.05)
        culled, all_triangles = tables["culling"]
        self.assertEqual(culled["operations_ratio"], "1.0000")
        self.assertGreater(float(all_triangles["operations_ratio"]), 1)
        self.assertEqual((culled["same_parameters"], all_triangles["same_parameters"]), ("1", "1"))

    def check_reflectance(self, tables):
        rows = {(r["images"], r["method"], r["group"]): r for r in tables["fits"]}
        methods = {r["method"] for r in tables["fits"]}
        self.assertLessEqual({"Ceres", "Ceres varpro", "TinySolver", "TinySolver in floats", "LM", "Lambertian", "cg modern", "cg paper", "sd", "lbfgs", "adam", "cg modern OpenGL"}, methods)
        for group in ("gold", "green"):
            for method in ("Ceres", "LM", "cg modern"):
                self.assertLess(float(rows["noise-free", method, group]["worst_error_median"]), 1e-3)
            # noise hides the truth, and the paper's optimizers are slower to it
            self.assertGreater(float(rows["noisy", "LM", group]["worst_error_median"]), 1e-3)
            self.assertGreater(float(rows["noise-free", "sd", group]["worst_error_median"]),
                               float(rows["noise-free", "LM", group]["worst_error_median"]))
        for images in ("noise-free", "noisy"):
            for group in ("moderate lobes", "sharp lobes"):
                self.assertEqual(float(rows[images, "Ceres", group]["within_share"]), 1)
                self.assertGreater(float(rows[images, "LM", group]["within_share"]), 0.95)
        for row in tables["times"]:
            self.assertGreater(float(row["fits_per_s"]), 0)
            self.assertGreater(float(row["load_s"]), 0)
        for images in ("noise-free", "noisy"):  # one distribution for all, and OpenGL's, which differs in some pixels
            samples = {how: {int(r["samples"]) for r in tables["times"]
                             if r["images"] == images and r["distributes"] == how} for how in ("once", "every sweep")}
            self.assertEqual(len(samples["once"]), 1)
            for count in samples["every sweep"]:
                self.assertLess(abs(count / min(samples["once"]) - 1), 0.02)
        for row in tables["fits"]:
            other_model = row["group"] == "white" or row["method"] == "Lambertian"
            self.assertEqual((row["worst_error_median"] == "", row["recovered_share"] == ""), (other_model, other_model))
        arrivals = {}  # method: shares by iterations
        for row in tables["arrival"]:
            self.assertTrue(0 < float(row["seconds_least"]) <= float(row["seconds"]) <= float(row["seconds_most"]))
            arrivals.setdefault(row["method"], []).append(float(row["arrived_share"]))
        self.assertLessEqual({"LM", "TinySolver", "TinySolver in floats", "Ceres", "cg modern"}, set(arrivals))
        self.both_instructions({r["method"]: r["instructions"] for r in tables["arrival"]}, "LM", "LM, AVX2")
        for method in ("LM", "TinySolver", "TinySolver in floats", "Ceres"):
            self.assertEqual(arrivals[method], sorted(arrivals[method]))
            self.assertGreater(arrivals[method][-1], 0.9)
        errors = {(r["images"], r["method"], r["part"]): r for r in tables["images"]}
        self.assertEqual({part for *_, part in errors}, {"all", "gold", "green", "white"})
        self.assertEqual({method for _, method, _ in errors}, methods)
        for images, method, part in errors:
            if part == "all":
                pixels = [int(errors[images, method, p]["pixels"]) for p in ("all", "gold", "green", "white")]
                self.assertEqual(pixels[0], sum(pixels[1:]))
        for images in ("noise-free", "noisy"):
            for part in ("gold", "green"):  # they shine
                self.assertGreater(float(errors[images, "LM", part]["held_psnr_db"]),
                                   float(errors[images, "Lambertian", part]["held_psnr_db"]))

    def check_scaling(self, tables):
        for row in tables["memory"]:
            self.assertEqual(row["planned_bytes"], row["allocated_bytes"])
            self.assertEqual(row["allocated_bytes"], row["opengl_bytes"], "of Mesa; another driver may store another format")
            self.assertGreater(int(row["allocated_bytes"]), 7 * int(row["parameters"]) * (4 if row["storage"] == "fp32" else 2))
            self.assertGreater(int(row["process_bytes"]), 0)
        kinds = [f"fragment {p} {s}" for p in ("paper", "combined") for s in ("fp32", "fp16")]
        summary = {(r["of"], r["engine"]): r for r in tables["summary"]}
        for kind in kinds:  # what doesn't grow is a few images: the slope tends to 1 from below
            self.assertTrue(0.5 < float(summary["bytes over parameters", kind]["median"]) < 1.01, kind)
        fragment, compute = {"fragment paper", "fragment combined"}, {"compute gather", "compute scatter"}
        of_part = {"samples": {"cpu"} | fragment, "texels": {"cpu"} | fragment | compute}
        self.assertEqual(set(summary), {("bytes over parameters", k) for k in kinds} |
                         {(f"seconds over {size}", e) for size, engines in of_part.items() for e in engines} |
                         {("seconds of sweeps over texels", e) for e in fragment | compute} |
                         {("time with distribution over time without", e) for e in {"fragment paper", "cpu"} | compute})
        for row in tables["summary"]:
            self.assertLessEqual(float(row["low"]), float(row["median"]))
            self.assertLessEqual(float(row["median"]), float(row["high"]))
        times = {}
        for row in tables["time"]:
            times.setdefault(tuple(row[key] for key in ("part", "engine", "what", "side", "images")), []).append(row)
        for rows in times.values():
            self.assertEqual([row["repetition"] for row in rows], [str(i) for i in range(6)])
            self.assertEqual(len({(row["texels"], row["samples"], row["parameters"]) for row in rows}), 1)
            for row in rows:
                streams = row["engine"] != "cpu" and row["what"] == "iteration" or row["engine"] == "fragment paper"
                self.assertEqual(row["sweep_seconds"] != "", streams, row)
                if streams:
                    self.assertLess(float(row["sweep_seconds"]), float(row["seconds"]))
        for part, size in (("samples", "images"), ("texels", "side")):
            for engine in of_part[part]:
                lines = [rows[0] for key, rows in times.items() if key[:2] == (part, engine)]
                self.assertEqual(len(lines), 3)
                for smaller, larger in zip(lines, lines[1:]):
                    self.assertLess(int(smaller[size]), int(larger[size]))
                    self.assertLess(int(smaller["samples"]), int(larger["samples"]))
        what = {key[1:3] for key in times if key[0] == "distribution"}
        self.assertEqual(what, {(e, w) for e in {"fragment paper"} | compute for w in ("iteration", "iteration, samples kept")} |
                         {("cpu", "iteration"), ("cpu", "distribution")})
        counts = {row["samples"] for row in tables["time"] if row["part"] == "distribution" and row["engine"] == "compute scatter"
                  and row["what"] == "iteration"}  # fmt: skip
        self.assertEqual(counts, {row["samples"] for row in tables["time"] if row["part"] == "distribution"
                                  and row["engine"] == "fragment paper"}, "the same pixels as fragment programs find")

    def check_passes(self, tables):
        steps = ["the paper's passes", "combined passes, image by image", "combined passes, several images",
                 "compute, redistributing, gather", "compute, redistributing, scatter", "compute, cached samples, scatter",
                 "compute, cached samples, gather", "CPU, redistributing", "CPU, cached samples",
                 "CPU, cached samples, vertex by vertex"]  # fmt: skip
        self.assertEqual([(r["step"], r["name"]) for r in tables["ladder"]], [(str(i), n) for i, n in enumerate(steps)])
        rounds = {name: {r["repetition"]: float(r["ms_per_image_and_sweep"]) for r in tables["rounds"] if r["name"] == name}
                  for name in steps}  # fmt: skip
        self.assertEqual({(r["images"], r["samples"]) for r in tables["rounds"]}, {("4", tables["rounds"][0]["samples"])})
        for row, before in zip(tables["ladder"], [steps[0], *steps]):
            times = rounds[row["name"]]
            self.assertEqual(set(times), {"0", "1", "2"})
            self.assertAlmostEqual(float(row["median_ms"]) / sorted(times.values())[1], 1, places=3)
            for column, other in (("over_previous", before), ("over_first", steps[0])):
                ratios = sorted(t / rounds[other][k] for k, t in times.items())
                self.assertAlmostEqual(float(row[column]) / ratios[1], 1, places=3)
            self.assertEqual((row["low_ms"], row["high_ms"]), ("", ""))
            self.assertEqual(row["renderer"].startswith("cpu, "), row["name"].startswith("CPU"))

    def check_precision(self, tables):
        kinds = {(s, k) for s in ("fp32", "fp16", "fp16-truncate") for k in ("fp32", "fp16")}
        for optimizer in ("cg", "sd"):
            finals = {(r["storage"], r["sums"]): r for r in tables["finals"] if r["optimizer"] == optimizer}
            self.assertEqual(set(finals), kinds)
            self.assertEqual(float(finals["fp32", "fp32"]["error_over_fp32"]), 1)
            self.assertEqual(len({float(r["error"]) for r in finals.values()}), len(kinds), "a choice without effect")
            for kind, row in finals.items():
                errors = [float(c["error"]) for c in tables["curves"]
                          if (c["optimizer"], c["storage"], c["sums"]) == (optimizer, *kind)]  # fmt: skip
                self.assertEqual(len(errors), 4)
                self.assertLess(errors[-1], 0.5 * errors[0])
                self.assertLess(abs(float(row["psnr_less_fp32"])), 0.2)  # claim C9's bound

    def test_bad_config_and_unwritable_results(self):
        text = self.config.read_text()
        arguments = ("--config", f"experiments/{self.name}.toml", "--profile", "smoke")
        self.config.write_text("surface_sid = 8\n" + text)
        self.refused(*arguments, says=[f"experiments/{self.name}.toml:1: unknown key 'surface_sid'", "did you mean"])
        self.config.write_text("surface_side = \n" + text)
        self.refused(*arguments, says=[f"experiments/{self.name}.toml:1: ", "correct the line"])
        self.config.write_text(text)
        self.refused(*arguments, "--set", "nonsense=1", says=["--set nonsense=1: unknown key"])
        self.refused(*arguments[:3], "smok", says=[f"experiments/{self.name}.toml: no profile 'smok'", "choose one of: "])
        self.refused("--config", "experiments/none.toml", says=["experiments/none.toml: no such", "check the path"])
        if "datasets" in text:
            self.refused(*arguments, "--set", 'datasets=["cube"]', says=['"cube"', "there are star, bust and ornament"])
        results = self.root / "results"
        if results.exists():
            results.rename(self.root / "kept")
        results.write_text("a file where the results belong\n")
        self.refused(*arguments, says=[f"results/{self.name}", "choose a writable folder"])
        results.unlink()
        if (self.root / "kept").exists():
            (self.root / "kept").rename(results)


if __name__ == "__main__":
    ProgramTest.program, CHECKOUT, RADIAFIT, RESULTS = take_arguments(4)
    unittest.main()
