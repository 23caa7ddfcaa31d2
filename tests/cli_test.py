#!/usr/bin/env python3
"""`radiafit` from a dataset to a judged picture, through the program itself; figures are computed again from its files.

Arguments: the program.
"""
import csv
import json
import math
import random
import re
import resource
import shutil
import struct
import unittest

from cli_fixture import ProgramTest, read_png, take_arguments, write_capture, write_png


def strict_json(text):
    def refuse(name):
        raise AssertionError(f"{name} is no JSON")

    return json.loads(text, parse_constant=refuse)


class CommandLine(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.good("fit", "star", "--model", "lfm", "-o", "fit")

    def judge(self, fit, split="test"):
        result = self.good("judge", fit, "--json", "--split", split)
        self.assertEqual(result.stderr, "")
        return strict_json(result.stdout)

    def trace(self, fit):
        with open(self.root / fit / "trace.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def final_error(self, fit):
        return float(self.trace(fit)[-1]["error"])

    def assert_same_files(self, a, b, pattern):
        names = [sorted(p.name for p in (self.root / folder).glob(pattern)) for folder in (a, b)]
        self.assertTrue(names[0])
        self.assertEqual(*names)
        for name in names[0]:
            self.assertEqual((self.root / a / name).read_bytes(), (self.root / b / name).read_bytes(), f"{a}, {b}: {name}")


class Files(CommandLine):
    def test_what_generate_left(self):
        info = strict_json(self.good("info", "star", "--json").stdout)
        expected = {"kind": "dataset", "name": "star", "encoding": "u8-srgb", "triangles": 320, "views": 24, "held_out": 3,
                    "image_bytes": 24 * 64 * 64 * 3}  # the smoke scale: 24 photographs of 64 x 64  # fmt: skip
        self.assertEqual({key: info[key] for key in expected}, expected)
        header = (self.root / "star/mesh.ply").read_bytes().split(b"end_header")[0].decode()
        self.assertIn(f"element vertex {info['vertices']}\n", header)
        self.assertIn("320 triangles", self.good("info", "star").stdout)

    def test_plan_adds_up(self):
        tables = []
        compute = [["--engine", "compute", "--samples", samples, "--accumulate", accumulate]
                   for samples in ("cached", "redistributed") for accumulate in ("gather", "scatter-fixed", "scatter-float")]
        for engine in (["--engine", "cpu"], ["--engine", "fragment"], *compute):
            tables += self.good("plan", "star", *engine).stdout.split("\n\n")
        for table in filter(lambda text: "MB" in text, tables):
            rows = re.findall(r" (\d+\.\d\d)(?:  ([a-z, ]+))?$", table, re.MULTILINE)
            self.assertGreater(len(rows), 3, table)
            most = max(sum(float(megabytes) for megabytes, stages in rows[:-1] if not stages or stage in stages)
                       for stage in ("distributing", "solving", "writing"))  # fmt: skip
            # every row is rounded to 0.01
            self.assertAlmostEqual(most, float(rows[-1][0]), delta=0.005 * len(rows), msg=table)
        self.assertIn("seconds on this machine", "".join(tables))

    def test_needs_are_told_and_compared_with_what_is_free(self):
        told = re.compile(r"needs about [\d.]+ .B of memory \([\d.]+ .B free\) and [\d.]+ .B of disk for new \(")
        self.addCleanup(shutil.rmtree, self.root / "new", ignore_errors=True)
        for command in (["generate", "star"], ["fit", "star", "--iterations", "0"]):
            self.assertRegex(self.good(*command, "-o", "new").stderr, told)
            shutil.rmtree(self.root / "new")
        huge = ["fit", "star", "--terms", "16", "--surface-side", "64", "--view-side", "64"]
        limit = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 29, 1 << 29))}
        self.refused(*huge, "-o", "new", says=["fit needs about ", "choose smaller sizes", "--force"], **limit)
        forced = self.run_program(*huge, "--iterations", "0", "--force", "-o", "new", **limit)
        self.assertIn("warning: fit needs about ", forced.stderr)
        self.assertFalse((self.root / "new").exists())  # it went on, and memory did not suffice

    def test_what_fit_left(self):
        description = strict_json((self.root / "fit/fit.json").read_text())
        self.assertEqual(sorted([*description["files"], ".radiafit-made.json"]), sorted(p.name for p in (self.root / "fit").iterdir()))
        info = strict_json(self.good("info", "fit", "--json").stdout)
        vertices = strict_json(self.good("info", "star", "--json").stdout)["vertices"]
        self.assertEqual((info["kind"], info["problems"], sum(info["status"].values())), ("fit", 3 * vertices, 3 * vertices))
        rows = self.trace("fit")
        self.assertEqual([int(row["iteration"]) for row in rows], list(range(len(rows))))
        errors = [float(row["error"]) for row in rows]
        self.assertEqual(errors, sorted(errors, reverse=True))  # a trial that raises a problem's error is not taken
        self.assertLess(errors[-1], 0.1 * errors[0])

    def test_a_fit_replaces_an_earlier_one(self):
        self.good("fit", "star", "--terms", "2", "--iterations", "1", "-o", "again")
        self.good("fit", "star", "--terms", "1", "--iterations", "1", "--replace", "-o", "again/")
        names = sorted(p.name for p in (self.root / "again").iterdir())
        self.assertFalse([n for n in names if "term1" in n], names)
        self.assertFalse([p.name for p in self.root.iterdir() if p.name.startswith(".")])


class Judge(CommandLine):
    def test_pooled_figures_follow_from_each_image(self):
        for split, images in (("test", 3), ("train", 21)):
            figures = self.judge("fit", split)
            self.assertEqual((figures["split"], figures["images"], figures["not_finite"]), (split, images, 0))
            pixels = sum(view["pixels"] for view in figures["per_image"])
            self.assertEqual(pixels, figures["pixels"])
            squares = sum(view["pixels"] * 10 ** (-view["psnr"] / 10) for view in figures["per_image"]) / pixels
            self.assertAlmostEqual(figures["psnr"], -10 * math.log10(squares), places=6)
            absolute = sum(view["pixels"] * view["ape"] for view in figures["per_image"]) / pixels
            self.assertAlmostEqual(figures["ape"], absolute, places=6)
            self.assertGreater(figures["psnr"], figures["baseline"]["psnr"] + 0.5)
            self.assertLess(figures["ape"], figures["baseline"]["ape"])

    def test_the_picture_has_the_error_that_was_judged(self):
        self.good("render", "fit", "--view", "0", "-o", "pictures/view.png")
        self.assertEqual(sorted(p.name for p in (self.root / "pictures").iterdir()), ["view.exr", "view.png", "view_sheet.png"])
        exr = (self.root / "pictures/view.exr").read_bytes()
        self.assertEqual(struct.unpack_from("<I", exr)[0], 20000630)  # the magic number of the OpenEXR file layout
        self.assertEqual(read_png(self.root / "pictures/view.png")[:2], (64, 64))

        width, height, sheet = read_png(self.root / "pictures/view_sheet.png")
        pictures = [[], [], [], []]  # photograph, mean colour per texel, fit, 4 x |error|
        self.assertEqual((width, height), (4 * 64 + 3 * 4, 64))
        for y in range(height):
            for i, picture in enumerate(pictures):
                at = 3 * (y * width + i * (64 + 4))
                picture.extend(sheet[at : at + 3 * 64])
        view = strict_json((self.root / "star/dataset.json").read_text())["views"][0]
        stored = (self.root / "star/images.bin").read_bytes()[view["pixel_offset"] :][: 3 * 64 * 64]
        self.assertEqual(bytes(pictures[0]), stored)

        judged = self.judge("fit")["per_image"][0]
        self.assertEqual(judged["name"], view["name"])
        # The fourth picture is black where nothing is judged; where it is black inside, there is no error to add.
        error = sum(abs(a - b) for a, b, shown in zip(pictures[2], stored, pictures[3]) if shown)
        # the other pictures' bytes are rounded
        self.assertAlmostEqual(error / (3 * judged["pixels"]), judged["ape"], delta=0.5)

    def test_turntable(self):
        self.good("render", "fit", "--turntable", "2", "-o", "turns")
        frames = [read_png(self.root / f"turns/turn00{i}.png") for i in range(2)]
        self.assertEqual([frame[:2] for frame in frames], [(64, 64)] * 2)
        for frame in frames:
            self.assertGreater(sum(1 for v in frame[2] if v), 64 * 64 // 4)
        self.assertNotEqual(frames[0][2], frames[1][2])

    def test_all_held_out_views(self):
        self.good("render", "fit", "--all", "held-out", "-o", "held")
        dataset = strict_json((self.root / "star/dataset.json").read_text(encoding="utf-8"))
        held_out = [i for i, view in enumerate(dataset["views"]) if view["held_out"]]
        names = sorted(p.name for p in (self.root / "held").glob("[!.]*"))
        self.assertEqual(names, sorted(f"view{i:04d}{end}" for i in held_out for end in (".exr", ".png", "_sheet.png")))
        self.good("render", "fit", "--view", str(held_out[1]), "-o", "one")
        for end in (".png", "_sheet.png"):
            self.assertEqual(read_png(self.root / f"held/view{held_out[1]:04d}{end}"), read_png(self.root / f"one{end}"))

    def test_modes_and_the_trivial_baseline(self):
        self.good("fit", "star", "--mode", "paper", "-o", "paper")
        self.good("fit", "star", "--solver", "mean", "-o", "mean")
        self.assertGreater(self.judge("paper")["psnr"], self.judge("mean")["psnr"])
        mean = self.judge("mean")
        for key, value in mean["baseline"].items():
            self.assertAlmostEqual(mean[key], value, places=9)


class Defaults(CommandLine):
    def fitted(self, *options):
        """What fit.json says of a fit with these options, and what was said while it ran."""
        said = self.good("fit", "star", *options, "--replace", "-o", "chosen").stderr
        return strict_json((self.root / "chosen/fit.json").read_text(encoding="utf-8")), said

    def test_the_data_choose_a_better_model(self):
        fit, said = self.fitted()
        self.assertEqual(fit["model"], "viewbasis")
        self.assertRegex(said, r"chosen by the data: --model viewbasis \(light that stays, a median of \d+ training views per texel\)")
        self.assertGreater(self.judge("chosen")["psnr"], self.judge("fit")["psnr"])
        self.assertIn("chosen by the data: --model viewbasis (", self.good("plan", "star").stdout)

    def test_options_choose_the_model_that_takes_them(self):
        for options, model in ((["--iterations", "1"], "lfm"), (["--lobes", "1"], "sg")):
            fit, said = self.fitted(*options)
            self.assertEqual(fit["model"], model, options)
            self.assertNotIn("chosen by the data", said)

    def test_light_field_maps_beside_their_papers(self):
        self.good("fit", "star", "--terms", "3", "--lambda-view", "0.1", "-o", "named")
        self.assert_same_files("fit", "named", "*.exr")
        fit, _ = self.fitted("--model", "lfm", "--terms", "1", "--lambda-view", "1e-3")
        self.assertGreater(self.judge("fit")["psnr"], self.judge("chosen")["psnr"] + 0.5)
        fit, _ = self.fitted("--mode", "paper", "--iterations", "1")
        self.assertEqual(fit["options"]["terms"], 1)
        self.assertAlmostEqual(fit["options"]["lambda_view"], 1e-3)

    def test_says_how_a_fit_ended(self):
        _, said = self.fitted("--iterations", "4")
        lowered = re.search(r"\(all 4 iterations used, the last lowered the error by (\S+) %\)", said)[1]
        errors = [float(row["error"]) for row in self.trace("chosen")]
        self.assertAlmostEqual(float(lowered) / 100, 1 - errors[-1] / errors[-2], delta=0.06 * float(lowered) / 100)
        self.assertIn("ran all iterations that were asked for", self.good("info", "chosen").stdout)


class Outliers(CommandLine):
    def test_an_image_of_noise_is_named_and_left_out(self):
        dataset = strict_json((self.root / "star/dataset.json").read_text(encoding="utf-8"))
        train = [view["name"] for view in dataset["views"] if not view["held_out"]]
        self.good("fit", "star", "-o", "left", "--leave-out", f"{train[3]},{train[7]}", "--solver", "mean")
        options = strict_json((self.root / "left/fit.json").read_text(encoding="utf-8"))["options"]
        self.assertEqual(options["leave_out"], f"{train[3]},{train[7]}")
        self.assertEqual(self.judge("left", "train")["images"], len(train))
        # No image of the star stands out: the fit is that of all.
        result = self.good("fit", "star", "-o", "all", "--leave-out-outliers", "--solver", "mean")
        self.assertIn("no training image stands out", result.stderr)
        self.good("fit", "star", "-o", "plain", "--solver", "mean")
        self.assert_same_files("all", "plain", "*.exr")
        self.assertEqual(self.judge("all")["outliers"], [])

    def test_images_worst_first(self):
        lines = self.good("judge", "fit", "--split", "train", "--per-image").stdout.splitlines()
        first = next(i for i, line in enumerate(lines) if line.startswith("PSNR, dB"))
        figures = [float(line.split()[0]) for line in lines[first + 1 :]]
        self.assertEqual(figures, sorted(figures))
        self.assertEqual(len(figures), self.judge("fit", "train")["images"])

    def test_beside_models_that_keep_every_photograph(self):
        figures = strict_json(self.good("judge", "fit", "--beside", "lumigraph", "--beside", "gaussian-process", "--json").stdout)
        for name in ("lumigraph", "gaussian-process"):
            self.assertGreater(figures["beside"][name]["psnr"], figures["baseline"]["psnr"], name)


class Tune(CommandLine):
    def test_tells_a_fit_that_runs(self):
        quick = ("--seconds", "1", "--model", "lfm", "--terms", "1")
        result = self.good("tune", "star", "--seconds", "1")
        command = result.stdout.splitlines()[-1].split()
        self.assertEqual(command[:3], ["radiafit", "fit", "star"])
        self.good(*command[1:])
        told = strict_json(self.good("tune", "star", *quick, "--json").stdout)
        tried = told["tried"]
        self.assertEqual([t["psnr"] for t in tried], sorted((t["psnr"] for t in tried), reverse=True))
        # Costs: a light field map of one term has an even number of numbers a channel, and four bytes each.
        recommended = [t for t in tried if t["options"] == told["recommended"]]
        self.assertEqual(len(recommended), 1)
        self.assertLessEqual(recommended[0]["numbers"], tried[0]["numbers"])
        for t in tried:
            self.assertEqual((t["bytes"], t["numbers"] % 3), (4 * t["numbers"], 0))
            self.assertGreater(min(t["seconds"], t["judge_seconds"], t["page_seconds"]), 0)
        for t in told["left_out"]:
            self.assertNotIn(t["options"], [other["options"] for other in tried])
        # What is left out for want of time, and what for options that are given, is said; the command is what is recommended.
        text = self.good("tune", "star", *quick).stdout
        self.assertRegex(text, r"left out for want of time: --model lfm .*--seconds \d+ would try|more seconds would try nothing else")
        self.assertRegex(text, r"models that do not take all options given: .*viewbasis")
        # What it tells is what a fit without the same views is worth on them.
        every = re.search(r"one in (\d+) training views", result.stdout)[1]
        self.good("fit", "star", *tried[0]["options"].split(), "--validation", every, "-o", "validated")
        self.assertAlmostEqual(self.judge("validated", "validation")["psnr"], tried[0]["psnr"], places=3)

    def test_leaves_options_that_are_given_as_they_are(self):
        given = ("--model", "lfm", "--terms", "2", "--deflate")
        result = self.good("tune", "star", *given, "--seconds", "2", "--json")
        tried = [t["options"] for t in strict_json(result.stdout)["tried"]]
        self.assertGreater(len(tried), 1)
        for options in tried:
            self.assertTrue(options.startswith("--model lfm "), options)
            self.assertIn("--terms 2 ", options)
            self.assertIn("--deflate", options)


class Import(CommandLine):
    def test_a_capture_fits_as_well_as_the_dataset_it_was_made_from(self):
        write_capture(self.root / "star", self.root / "capture")
        colmap = ["--model", "capture/sparse", "--images", "capture/images", "--mesh", "capture/mesh.ply"]
        self.good("import", "colmap", *colmap, "-o", "packed")
        info = strict_json(self.good("info", "packed", "--json").stdout)
        self.assertEqual((info["views"], info["held_out"], info["triangles"]), (24, 3, 320))
        self.good("fit", "packed", "--model", "lfm", "-o", "packed_fit")
        for split in ("test", "train"):
            mine, its = self.judge("packed_fit", split), self.judge("fit", split)
            self.assertEqual(mine["pixels"], its["pixels"])
            # the cameras went through a quaternion, so a pixel on an edge may change its texel
            self.assertAlmostEqual(mine["psnr"], its["psnr"], delta=0.05)


    def test_images_that_show_something_else_are_named(self):
        write_capture(self.root / "star", self.root / "spoilt")
        colmap = ["--model", "spoilt/sparse", "--images", "spoilt/images", "--mesh", "spoilt/mesh.ply", "--holdout", "every:8"]
        quick = ("--seconds", "1", "--model", "lfm", "--terms", "1")
        self.assertNotIn("colours than", self.good("import", "colmap", *colmap, "-o", "clean").stderr)
        self.assertNotIn("look at", self.good("tune", "clean", *quick).stderr)
        names = sorted(p.name for p in (self.root / "spoilt/images").iterdir())
        noise = [names[3], names[10], names[20]]  # every eighth, from the first on, is held out
        for name in noise:
            width, height, rgb = read_png(self.root / "spoilt/images" / name)
            write_png(self.root / "spoilt/images" / name, width, height, random.Random(name).randbytes(len(rgb)))
        for command in (["import", "colmap", *colmap, "-o", "noisy"], ["tune", "noisy", *quick]):
            said = re.search(r"warning: (?:look at )?(.*): (?:even|show other colours).*--leave-out-outliers", self.good(*command).stderr)
            self.assertEqual(said[1].split(", "), noise)


    def test_says_whether_gains_are_needed(self):
        write_capture(self.root / "star", self.root / "exposed")
        colmap = ["import", "colmap", "--model", "exposed/sparse", "--images", "exposed/images", "--mesh", "exposed/mesh.ply", "--replace", "-o", "gained"]
        self.assertNotIn("gains are", self.good(*colmap, "--gains", "none").stderr)
        # One exposure for all: what is estimated is the gloss.
        said = self.good(*colmap).stderr
        self.assertRegex(said, r"gains are not needed, and none are applied: they would (raise|lower) the error of photographs left out by \S+ %")
        self.assertEqual({view.get("gain", 1) for view in self.views("gained")}, {1})
        said = self.good(*colmap, "--gains", "estimate").stderr
        self.assertRegex(said, r"gains are not needed: they \S+ the error of photographs left out by \S+ %; --gains none does (better|as well)")
        # Exposures as of an automatic camera, with a white balance of its own: bytes of sRGB are light to the power 1 / 2.2.
        for i, path in enumerate(sorted((self.root / "exposed/images").iterdir())):
            exposure, balance = (0.5, 1, 0.7)[i % 3], (1, 0.5)[i % 2]
            factors = [(exposure * c) ** (1 / 2.2) for c in (1, balance, balance**2)]
            width, height, rgb = read_png(path)
            write_png(path, width, height, bytes(round(v * factors[k % 3]) for k, v in enumerate(rgb)))
        said = self.good(*colmap).stderr
        found = re.search(r"gains are needed, and applied: they lower the error of photographs left out by (\S+) %; --gains per-channel would lower it by (\S+) %$", said, re.M)
        self.assertGreater(float(found[1]), 10)
        self.assertGreater(float(found[2]), float(found[1]) + 2)
        applied = [view["gain"] for view in self.views("gained")]
        self.good(*colmap, "--gains", "estimate")
        self.assertEqual(applied, [view["gain"] for view in self.views("gained")])
        said = self.good(*colmap, "--gains", "per-channel").stderr
        found = re.search(r"gains are needed: they lower .* by (\S+) %; one gain for all channels would lower .* by (\S+) %$", said, re.M)
        self.assertGreater(float(found[1]), float(found[2]) + 2)

    def views(self, dataset):
        return json.loads((self.root / dataset / "dataset.json").read_text())["views"]


class Engines(CommandLine):
    def test_fragment_agrees_with_cpu_on_the_same_distribution(self):
        common = ["fit", "star", "--mode", "paper", "--iterations", "3"]
        self.good(*common, "--engine", "cpu", "--distributor", "gl", "-o", "cpu")
        expected = self.final_error("cpu")
        for passes in ("paper", "r300", "combined"):
            self.good(*common, "--engine", "fragment", "--passes", passes, "-o", passes)
            # float sums in another order, amplified by three steps of the line search
            self.assertLess(abs(self.final_error(passes) / expected - 1), 1e-3, passes)
            self.assertAlmostEqual(self.judge(passes)["psnr"], self.judge("cpu")["psnr"], delta=0.05)

    def test_same_bits_twice(self):
        for engine in ("cpu", "fragment", "compute"):
            for i in (1, 2):
                self.good("fit", "star", "--engine", engine, "--iterations", "2", "--threads", i, "-o", f"{engine}{i}")
            self.good("fit", "star", "--engine", engine, "--iterations", "2", "--threads", "2", "-o", f"{engine}3")
            self.assert_same_files(f"{engine}1", f"{engine}2", "*.exr")
            self.assert_same_files(f"{engine}2", f"{engine}3", "*.exr")

    def test_compute_in_every_way(self):
        def fitted(name, *options):
            told = self.good("fit", "star", "--engine", "compute", "--terms", "1", "--iterations", "4", *options, "-o", name).stderr
            accumulation = json.loads((self.root / name / "fit.json").read_text())["times_s"]["accumulation"]
            self.assertIn(accumulation, told)
            return accumulation, self.final_error(name)

        self.assertEqual(fitted("gathered")[0], "gathered sums")
        expected = self.final_error("gathered")
        # Each way of either choice once: tests/compute has all of them together.
        for samples, accumulate, told in (
            ("cached", "gather", "gathered sums"),
            ("cached", "scatter-float", "scattered sums of floats, by "),
            ("redistributed", "gather", "gathered sums"),
            ("redistributed", "scatter-fixed", "scattered sums in 64-bit fixed point"),
        ):
            name, options = f"{samples}-{accumulate}", ("--samples", samples, "--accumulate", accumulate)
            accumulation, error = fitted(name, *options)
            self.assertTrue(accumulation.startswith(told), accumulation)
            # OpenGL's rasterizer and the CPU's give some texels other pixels
            self.assertLess(abs(error / expected - 1), 1e-3 if samples == "cached" else 0.01, name)
            if accumulate != "scatter-float":
                fitted(name + "-again", *options)
                self.assert_same_files(name, name + "-again", "*.exr")
        for source in ("disk", "device"):
            fitted(source, "--samples", "redistributed", "--source", source)
            self.assert_same_files(source, "redistributed-gather", "*.exr")

    def test_egl_and_osmesa_alike(self):
        for context in ("egl", "osmesa"):
            self.good("fit", "star", "--engine", "fragment", "--context", context, "--terms", "1", "--iterations", "2", "-o", context)
        self.assert_same_files("egl", "osmesa", "*.exr")

    def test_generate_gives_the_same_bits_for_any_threads(self):
        for threads in (1, 2):
            self.good("generate", "bust", "--threads", threads, "-o", f"bust{threads}")
        self.assert_same_files("bust1", "bust2", "*")

    def test_devices(self):
        listed = self.good("devices").stdout
        self.assertIn("cpu: ", listed)
        self.assertRegex(listed, r"(egl --device \d+|osmesa): .*OpenGL 4\.")

    def test_help_and_version(self):
        self.assertRegex(self.good("--version").stdout, r"^radiafit \d+\.\d+\.\d+ \(")
        for command in ("fit", "judge", "import", "render", "plan", "info", "generate", "devices"):
            self.assertIn(f"  {command} ", self.good("--help").stdout)
            self.assertIn("Usage", self.good(command, "--help").stdout)


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
