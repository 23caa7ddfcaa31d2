#!/usr/bin/env python3
"""radiafit-bench: rows that can be true, and what it refuses.

Arguments: the program, radiafit, the checkout, the program as it travels.
"""
import csv
import json
import math
import os
import shutil
import signal
import statistics
import subprocess
import tarfile
import time
import unittest

from cli_fixture import ProgramTest, take_arguments

RADIAFIT = CHECKOUT = TRAVELS = None
PROBLEMS = ["star", "bust", "ornament"]
STREAMED = ["compute, redistributing", "compute, redistributing, scattered"]  # of light field maps alone
OPENGL = ["fragment, paper passes", "fragment, combined passes", "compute", *STREAMED]
SUMS = ["error", "gradient", "diagonal", "gauss-newton", "d'Hd", "third", "fourth"]
REPETITIONS = 2


def children_of(process):
    """Its child processes, once there are some."""
    while True:
        with open(f"/proc/{process}/task/{process}/children", encoding="ascii") as file:
            children = [int(child) for child in file.read().split()]
        if children:
            return children
        time.sleep(0.01)


def pairs(devices):
    """Problems and the devices that there are for each."""
    return [(p, d) for p in PROBLEMS for d in devices if p != "ornament" or d not in STREAMED]


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Bench(ProgramTest):
    def run_bench(self, *more, folder, **options):
        """The one run that it leaves."""
        scratch = self.root / "scratch"
        scratch.mkdir(exist_ok=True)
        result = self.good("--scale", "smoke", "-o", folder, *more, environment={"TMPDIR": str(scratch)}, **options)
        self.assertEqual(list(scratch.iterdir()), [], "its datasets are gone")
        runs = list((self.root / folder / "bench").glob("*/*/run.json"))
        self.assertEqual(len(runs), 1)
        return runs[0].parent, json.loads(runs[0].read_text()), result

    def run_all(self, crashes):
        """--all into all.tar, where one part crashes as it begins. The run of `bench` in it, and what was said."""
        before = set(self.root.iterdir())
        with subprocess.Popen([TRAVELS, "--all", "--scale", "smoke", "--repetitions", str(REPETITIONS), "--minutes", "60",
                               "-o", "all.tar"], cwd=self.root, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as process:
            said = []
            for line in process.stderr:
                said.append(line)
                if line.endswith(f": {crashes}\n"):
                    (child,) = children_of(process.pid)
                    os.kill(child, signal.SIGSEGV)
            shown = process.stdout.read()
        self.assertEqual(process.returncode, 1, said)
        self.assertEqual(set(self.root.iterdir()) - before, {self.root / "all.tar"}, "its datasets are gone")
        with tarfile.open(self.root / "all.tar") as archive:
            archive.extractall(self.root / "all")
        (run,) = (self.root / "all/results/bench").glob("*/*/run.json")
        return run.parent, json.loads(run.read_text()), subprocess.CompletedProcess([], 1, shown, "".join(said))

    def cpu_devices(self, record):
        return ["cpu"] + (["cpu, 1 thread"] if record["threads"] > 1 else [])

    def test_every_device_agrees_and_is_timed(self):
        run, record, result = self.run_all(crashes="scaling")
        self.assertRegex(result.stdout, r"(?m)^scaling +\d+ +crashed \(Segmentation fault\)$")
        measured = ["fig8_time", "fig10_utilization", "streaming", "passes"]
        for part in ["bench", *measured]:
            self.assertRegex(result.stdout, rf"(?m)^{part} +\d+ +measured$")
        self.assertEqual({path.parents[2].name for path in (self.root / "all/results").glob("*/*/*/run.json")},
                         {"bench", *measured})
        # The archive is read as it is.
        self.assertIn("SAME", self.good("compare", "all.tar", "all/results", program=RADIAFIT).stdout)
        devices = self.cpu_devices(record) + OPENGL
        self.check_record(run, record, devices)
        self.check_agreement(run, devices)
        self.check_times(run, record, devices)
        self.check_summary(run, record)
        for device in devices:
            self.assertIn(device, result.stdout)
        told = json.loads(self.good("compare", run, run, "--json", program=RADIAFIT).stdout)
        self.assertLessEqual(set(told["verdicts"]), {"SAME", "UNCLEAR"})

    def check_record(self, run, record, devices):
        self.assertEqual((record["program"], record["profile"], record["standard"]), ("bench", "smoke", False))
        self.assertEqual(record["config"]["devices"], devices)
        self.assertEqual(record["config"]["repetitions"], REPETITIONS)
        self.assertEqual([dataset["name"] for dataset in record["datasets"]], PROBLEMS)
        for dataset in record["datasets"]:
            self.assertRegex(dataset["source"], "^radiafit generate .* --scale smoke --seed 1\\b")
        self.assertTrue(record["gl"]["renderer"])
        self.assertEqual(sorted(record["files"]), sorted(path.name for path in run.glob("*.csv")))
        scenes = read_rows(run / "scenes.csv")
        self.assertEqual([row["problem"] for row in scenes], PROBLEMS)
        self.assertTrue(all(int(value) > 0 for row in scenes for key, value in row.items() if key != "problem"))

    def check_agreement(self, run, devices):
        rows = read_rows(run / "agreement.csv")
        expected = [(p, d, q) for p, d in pairs(devices) for q in ["samples", *SUMS, "fit"]]
        self.assertEqual([(row["problem"], row["device"], row["quantity"]) for row in rows], expected)
        for row in rows:
            self.assertEqual(row["agrees"], "1", row)
            self.assertLessEqual(float(row["difference"]), float(row["tolerance"]), row)
            rounded = row["problem"] != "ornament" or row["quantity"] in SUMS[:5]  # texels have no third and fourth sum
            if row["quantity"] in SUMS and rounded:
                self.assertGreater(float(row["difference"]), 0, row)

    def check_times(self, run, record, devices):
        def passes(device):
            return ["gradient", "line", "iteration"] + (["distribution"] if device == "cpu" else [])

        rows = read_rows(run / "rows.csv")
        expected = {(p, d, q, str(r)) for p, d in pairs(devices) for q in passes(d) for r in range(REPETITIONS)}
        self.assertEqual({(row["problem"], row["device"], row["pass"], row["repetition"]) for row in rows}, expected)
        self.assertEqual(len(rows), len(expected))
        for row in rows:
            self.assertGreater(float(row["seconds"]), 0)
            self.assertLess(float(row["streaming_s"]), float(row["seconds"]))
            streams = row["device"].startswith("fragment") or row["device"] in STREAMED
            self.assertEqual(float(row["streaming_s"]) > 0, streams, row)
        peaks = read_rows(run / "peaks.csv")
        for device in devices:
            found = {row["peak"] for row in peaks if row["device"] == device}
            self.assertEqual(found, {"operations", "bytes"} | ({"reads"} if device.startswith("fragment") else set()))
        self.assertTrue(all(float(row["per_second"]) > 1e6 for row in peaks))

    def check_summary(self, run, record):
        rows = read_rows(run / "rows.csv")
        peaks = read_rows(run / "peaks.csv")
        scenes = {row["problem"]: row for row in read_rows(run / "scenes.csv")}
        for row in read_rows(run / "summary.csv"):
            key = ("problem", "device", "pass")
            seconds = [float(r["seconds"]) for r in rows if [r[k] for k in key] == [row[k] for k in key]]
            self.assertEqual(int(row["repetitions"]), REPETITIONS)
            middle = float(row["seconds"])
            self.assertTrue(math.isclose(middle, statistics.median(seconds), rel_tol=1e-3), row)
            self.assertEqual((row["low_s"], row["high_s"]), ("", ""), "three tell no interval")
            scene = scenes[row["problem"]]
            self.assertTrue(math.isclose(float(row["ms_per_image"]), 1e3 * middle / int(scene["images"]), rel_tol=1e-3))
            counted = int(scene["samples"]) * (1 if row["problem"] == "ornament" else 3)
            self.assertTrue(math.isclose(float(row["ns_per_sample"]), 1e9 * middle / counted, rel_tol=1e-3))
            declared = row["device"].startswith("fragment") or row["pass"] in ("gradient", "line")
            for what in ("operations", "bytes"):
                told = declared and (what == "operations" or row["device"] not in STREAMED)
                self.assertEqual(row[what] != "", told, row)
                if not told:
                    continue
                rates = [float(r["per_second"]) for r in peaks if (r["device"], r["peak"]) == (row["device"], what)]
                shares = [float(row[what]) / s / rate for s, rate in zip(seconds, rates)]
                self.assertTrue(math.isclose(float(row[what + "_share"]), statistics.median(shares), rel_tol=1e-3), row)
            self.assertEqual(row["renderer"], record["gl"]["renderer"] if row["device"] in OPENGL
                             else f"cpu, {record['threads']} threads")

    def test_devices_that_are_wrong_or_do_not_run_are_not_timed(self):
        """Of a device's passes one is off by a ten thousandth, of another one does not compile."""
        shaders, folder = self.root / "shaders", self.root / "wrong"
        shutil.copytree(CHECKOUT / "shaders", shaders)
        for name, factor in (("tile_texels.comp", "1.0001"), ("tile_pixels.comp", "none")):
            text = (shaders / "compute" / name).read_text()
            wrong = text.replace("+= lfm_gradient_surface(", f"+= {factor} * lfm_gradient_surface(")
            self.assertNotEqual(text, wrong)
            (shaders / "compute" / name).write_text(wrong)
        result = self.run_program("--scale", "smoke", "--device", "compute", "--repetitions", 1, "-o", folder,
                                  environment={"RADIAFIT_SHADERS": str(shaders)})
        self.assertEqual(result.returncode, 1, result.stderr)
        for problem in ("star", "bust"):
            self.assertRegex(result.stderr, f"compute on {problem} disagrees .* not timed: gradient off by [0-9.]+e-0[45] ")
            self.assertRegex(result.stderr, f"redistributing on {problem} does not run and is not timed: .*tile_pixels.comp")
        (run,) = folder.glob("bench/*/*")
        rows = [row for row in read_rows(run / "agreement.csv") if row["agrees"] == "0"]
        refused = {(problem, device) for problem in ("star", "bust") for device in ("compute", STREAMED[0])}
        self.assertEqual({(row["problem"], row["device"]) for row in rows}, refused)
        self.assertEqual({row["device"] for row in rows if row["quantity"] == "run"}, {STREAMED[0]})
        timed = {(row["problem"], row["device"]) for row in read_rows(run / "rows.csv")}
        self.assertEqual(timed, set(pairs(["compute", *STREAMED])) - refused)

    def test_intervals_from_six_repetitions_on(self):
        run, record, _ = self.run_bench("--device", "cpu", "--repetitions", 6, "--threads", 1, folder="cpu")
        self.assertEqual(self.cpu_devices(record), ["cpu"])
        self.assertNotIn("gl", record)
        self.assertEqual({row["device"] for row in read_rows(run / "rows.csv")}, {"cpu"})
        for row in read_rows(run / "summary.csv"):
            self.assertLessEqual(float(row["low_s"]), float(row["seconds"]))
            self.assertLessEqual(float(row["seconds"]), float(row["high_s"]))

    def test_lists_devices(self):
        said = self.good("--list").stdout
        self.assertRegex(said, "^cpu: [0-9]+ threads\n")
        self.assertRegex(said, "(?m)^--gpu 0: .*OpenGL 4")
        self.assertIn("--platform osmesa: ", said)

    def test_refuses_in_one_line(self):
        (self.root / "file").write_text("")
        for arguments, says in [
            (["--gpu", "99"], ["--gpu 99 is out of range", "`radiafit-bench --list`"]),
            (["--gpu", "1", "--platform", "osmesa"], ["--gpu", "--platform osmesa has one device"]),
            (["--gpu", "one"], ["--gpu", "'one'", "--list"]),
            (["--device", "cpu,gpu"], ["--device 'gpu'", "cpu, fragment, compute"]),
            (["--device", "cpu", "--gpu", "0"], ["--gpu", "leave"]),
            (["--scale", "huge"], ["--scale 'huge'", "smoke, standard, paper"]),
            (["--platform", "glx"], ["--platform 'glx'", "egl"]),
            (["--repetitions", "0"], ["--repetitions = 0", "from 1"]),
            (["--output", "file"], ["file"]),
            (["--device", "cpu", "-o", ""], ["--output", "folder"]),
            (["--repetition", "3"], ["'--repetition'", "--repetitions"]),
            (["smoke"], ["'smoke'", "--help"]),
            (["--all", "-o", "rows"], ["--output rows", ".tar"]),
            (["--replace", "-o", "rows"], ["--replace is of --all"]),
            (["--all", "--device", "cpu"], ["--device", "leave it out"]),
            (["--minutes", "0"], ["--minutes = 0", "from 0.01"]),
        ]:
            with self.subTest(arguments=arguments):
                self.refused(*arguments, says=says)

    def test_names_the_cure_where_no_driver_offers_opengl(self):
        empty = self.root / "empty"
        empty.mkdir()
        self.refused(says=["--platform osmesa", "install"],
                     environment={"__EGL_VENDOR_LIBRARY_DIRS": str(empty), "__EGL_VENDOR_LIBRARY_FILENAMES": ""})


if __name__ == "__main__":
    Bench.program, RADIAFIT, CHECKOUT, TRAVELS = take_arguments(4)
    unittest.main()
