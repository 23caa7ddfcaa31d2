#!/usr/bin/env python3
"""The experiment `captures` over stand-ins of captures: synthetic datasets, and a flat sample under eight lamps.

Arguments: the experiment's program, the checkout, radiafit.
"""
import csv
import json
import math
import shutil
import unittest

from cli_fixture import ProgramTest, take_arguments, write_png

CHECKOUT = RADIAFIT = None


class Captures(ProgramTest):
    def setUp(self):
        for folder in ("datasets", "results"):
            shutil.rmtree(self.root / folder, ignore_errors=True)
        (self.root / "paper_figs").mkdir(exist_ok=True)
        (self.root / "experiments").mkdir(exist_ok=True)
        shutil.copy(CHECKOUT / "experiments/captures.toml", self.root / "experiments")

    def pack(self):
        self.dataset("star", "datasets/packed/cape", program=RADIAFIT)
        self.dataset("ornament", "datasets/packed/reading", program=RADIAFIT)
        (self.root / "flat").mkdir()
        lamps = []
        for i in range(8):
            z = 0.5 + 0.05 * i
            r = math.sqrt(1 - z * z)
            lamps.append((r * math.cos(i), r * math.sin(i), z))
            pixels = [round(255 * z * albedo) for y in range(8) for x in range(8) for albedo in (x / 8, 0.5, y / 8)]
            write_png(self.root / f"flat/{i}.png", 8, 8, bytes(pixels))
        (self.root / "lamps.txt").write_text("".join(f"{x} {y} {z}\n" for x, y, z in lamps))
        self.good("import", "lights", "--images", self.root / "flat", "--lights", "lamps.txt", "--transfer", "linear", "-o",
                  "datasets/packed/cards", program=RADIAFIT)

    def test_what_is_not_packed_is_named(self):
        told = self.good().stderr
        for name in ("cape", "reading", "cards"):
            self.assertIn(f"{name}: not packed in datasets/packed; datasets/captures.md says how to", told)
        self.assertIn("nothing to judge", told)
        self.assertFalse((self.root / "results").exists())

    def test_rows(self):
        self.pack()
        self.good("--profile", "smoke")
        (run,) = (self.root / "results/captures").glob("*/*")
        sources = [dataset["source"] for dataset in json.loads((run / "run.json").read_text())["datasets"]]
        self.assertIn(f"{self.root.name}/flat --lights lamps.txt", " ".join(sources))
        self.assertNotIn(str(self.root), " ".join(sources), "a place of this machine")
        rows = {}
        for name in ("captures", "images"):
            with open(run / f"{name}.csv", newline="", encoding="utf-8") as file:
                rows[name] = list(csv.DictReader(file))
        kinds = {(row["capture"], row["split"], row["method"]): row for row in rows["captures"]}
        self.assertEqual(len(kinds), len(rows["captures"]))
        self.assertEqual(len(kinds), 2 * 7 + 2 * 3 + 5)
        for key, row in kinds.items():
            images = [image for image in rows["images"] if (image["capture"], image["split"], image["method"]) == key]
            self.assertEqual(len(images), int(row["held_out"]))
            self.assertEqual(len({image["image"] for image in images}), len(images))
            self.assertEqual(sum(float(image["degrees_outside"]) >= 1 for image in images), int(row["outside"]))
            # Mean squared errors of images, by their pixels, make that of all.
            pixels = sum(int(image["pixels"]) for image in images)
            squares = sum(int(image["pixels"]) * 10 ** (-float(image["psnr_db"]) / 10) for image in images) / pixels
            self.assertAlmostEqual(float(row["psnr_db"]), -10 * math.log10(squares), delta=1e-3)
        held = {split: int(row["held_out"]) for (capture, split, _), row in kinds.items() if capture == "cards"}
        self.assertEqual(held, {"each alone": 8})
        spread = [row for (_, split, method), row in kinds.items() if split.startswith("spread")]
        self.assertTrue(spread)
        self.assertEqual({row["outside"] for row in spread}, {"0"}, "spread over the directions, each amid others")
        self.assertGreater(float(kinds["ornament", "every:8", "lafortune"]["psnr_db"]),
                           2 + float(kinds["ornament", "every:8", "Lambertian"]["psnr_db"]))
        self.assertIn("| capture", (self.root / "paper_figs/smoke/captures.md").read_text())


if __name__ == "__main__":
    ProgramTest.program, CHECKOUT, RADIAFIT = take_arguments(3)
    unittest.main()
