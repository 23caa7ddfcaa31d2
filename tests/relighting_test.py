#!/usr/bin/env python3
"""The experiment `relighting` over a made capture: a flat sample under lamps, beside another program's pictures of it.

Arguments: the experiment's program, the checkout, radiafit.
"""
import csv
import math
import shutil
import unittest

from cli_fixture import ProgramTest, take_arguments, write_png

CHECKOUT = RADIAFIT = None


class Relighting(ProgramTest):
    def setUp(self):
        for folder in ("datasets", "results", "flat", "fit", "pictures"):
            shutil.rmtree(self.root / folder, ignore_errors=True)
        (self.root / "paper_figs").mkdir(exist_ok=True)
        (self.root / "experiments").mkdir(exist_ok=True)
        shutil.copy(CHECKOUT / "experiments/relighting.toml", self.root / "experiments")

    def pack(self):
        """Stored values that are a polynomial of the lamp's direction."""
        (self.root / "flat").mkdir()
        lamps = []
        for i in range(24):
            z = 0.3 + 0.65 * (i * 0.618 % 1)
            r = math.sqrt(1 - z * z)
            x, y = r * math.cos(2.4 * i), r * math.sin(2.4 * i)
            lamps.append((x, y, z))
            pixels = [round(255 * (0.5 + 0.2 * column / 8 * x - 0.3 * row / 8 * y * y + 0.1 * c * x * y))
                      for row in range(8) for column in range(8) for c in range(3)]
            write_png(self.root / f"flat/{i:02}.png", 8, 8, bytes(pixels))
        (self.root / "lamps.txt").write_text("".join(f"{x} {y} {z}\n" for x, y, z in lamps))
        self.good("import", "lights", "--images", self.root / "flat", "--lights", "lamps.txt", "--normals", "flat", "--holdout",
                  "every:6", "-o", "datasets/packed/neural_dome", program=RADIAFIT)

    def rows(self):
        (run,) = (self.root / "results/relighting").glob("*/*")
        with open(run / "relighting.csv", newline="", encoding="utf-8") as file:
            return {row["method"]: row for row in csv.DictReader(file)}

    def test_what_is_not_packed_is_named(self):
        told = self.good("--profile", "smoke").stderr
        self.assertIn("neural_dome: not packed in datasets/packed; datasets/captures.md says how to", told)
        self.assertIn("nothing to judge", told)
        self.assertFalse((self.root / "results").exists())

    def test_a_program_that_shows_a_fit_scores_as_the_fit(self):
        self.pack()
        self.good("fit", "datasets/packed/neural_dome", "--model", "ptm", "--curve", "srgb", "-o", "fit", program=RADIAFIT)
        self.good("render", "fit", "--all", "held-out", "-o", "datasets/renders/neural_dome/other", program=RADIAFIT)
        self.good("--profile", "smoke", "--set", 'fits=["what fit chooses:", "polynomial: --model ptm --curve srgb"]')
        rows = self.rows()
        self.assertEqual(set(rows), {"what fit chooses", "polynomial", "what tune recommends within 1 s", "other"})
        ours, other = rows["polynomial"], rows["other"]
        self.assertEqual((ours["numbers"], ours["training"], ours["held_out"]), ("18", "20", "4"))
        self.assertEqual((other["numbers"], other["made"], other["seconds"]), ("", "", ""))
        for figure in ("psnr_db", "mean_image_psnr_db", "ape"):
            self.assertEqual(other[figure], ours[figure])
        self.assertGreater(float(ours["psnr_db"]), 50, "the model is the truth, but for rounding")
        self.assertGreaterEqual(float(rows["what fit chooses"]["psnr_db"]), float(ours["psnr_db"]) - 0.2)
        (table,) = (self.root / "results/relighting").glob("*/*/relighting.md")
        self.assertIn("| polynomial", table.read_text())

    def test_pictures_that_are_missing_are_refused(self):
        self.pack()
        (self.root / "datasets/renders/neural_dome/other").mkdir(parents=True)
        result = self.run_program("--profile", "smoke")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr.splitlines()[-1], "neural_dome/other: .*have no picture there")


if __name__ == "__main__":
    ProgramTest.program, CHECKOUT, RADIAFIT = take_arguments(3)
    unittest.main()
