#!/usr/bin/env python3
"""A picture for readers: a held-out photograph, a baseline, a fit and four times its error, each panel labelled, with the
PSNR of that view, and a caption below. Of the sheet that `radiafit render` makes, scaled down, labelled by gnuplot.
Usage: labelled_sheet.py FIT OUTPUT.png CAPTION [--words WORDS] [--view I] [--beside FIT WORDS] [--panel PIXELS] [--replace]
--words: what the fit is called, default its model. --view: as render's. --beside: another fit of the dataset in the baseline's place.
--panel: width of a panel, at most what it is in the sheet. --replace: also where OUTPUT.png is there already.
$RADIAFIT is the program (default build/release/bin/radiafit)."""
import argparse
import itertools
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from png_rows import read_png, write_png

ROOT = pathlib.Path(__file__).resolve().parents[2]
RADIAFIT = os.environ.get("RADIAFIT", str(ROOT / "build/release/bin/radiafit"))
GAP = 4  # pixels between panels, in render's sheet and here
ABOVE, BELOW = 26, 24  # pixels for labels and for the caption

LINEAR = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in (i / 255 for i in range(256))]
STEPS = 4095
BYTES = [round(255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055)) for v in (i / STEPS for i in range(STEPS + 1))]

WORDS = {"lafortune": "Lafortune's model", "lambert": "Lambertian", "lfm": "light field map", "ptm": "polynomial texture map",
         "sg": "spherical Gaussians", "viewbasis": "view basis"}  # fmt: skip

GNUPLOT = """set terminal pngcairo size {width},{height} font 'DejaVu Sans,10' background 'white'
set output '{output}'
unset key; unset border; unset tics
set lmargin at screen 0; set rmargin at screen 1; set tmargin at screen 1; set bmargin at screen 0
set xrange [0:{width}]
set yrange [0:{height}]
{labels}
plot '{panels}' binary filetype=png origin=(0.5,{above_caption}) with rgbimage
"""


def run(*command):
    done = subprocess.run([RADIAFIT, *map(str, command)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr.strip() or f"radiafit {command[0]} failed")
    return done


def scaled(rows, left, width, panel):
    """The panel that begins at column `left`, `panel` pixels wide: means in linear light of the area of each, by sums up to
    its edges. As rows of bytes."""
    step = width / panel
    edges = [min(step * i, width - 1e-9) for i in range(panel + 1)]

    def across(row):
        """Of each channel, sums between the edges."""
        out = [0.0] * (3 * panel)
        for channel in range(3):
            light = [LINEAR[v] for v in row[3 * left + channel : 3 * (left + width) : 3]]
            sums = [0.0, *itertools.accumulate(light)]
            upto = [sums[int(x)] + (x - int(x)) * light[int(x)] for x in edges]
            out[channel::3] = [b - a for a, b in zip(upto, upto[1:])]
        return out

    narrow, out = [across(row) for row in rows], []
    for i in range(int(len(rows) / step)):
        total = [0.0] * (3 * panel)
        for y in range(int(step * i), min(len(rows), math.ceil(step * (i + 1)))):
            share = min(y + 1, step * (i + 1)) - max(y, step * i)
            total = [a + share * b for a, b in zip(total, narrow[y])]
        out.append(bytes(BYTES[min(STEPS, round(STEPS * s / step**2))] for s in total))
    return out


def model_of(fit):
    name = json.loads((pathlib.Path(fit) / "fit.json").read_text(encoding="utf-8"))["model"]
    return WORDS.get(name, name)


class Sheet:
    """One fit's sheet of a view: name, panels, and how well it and its baseline do."""

    def __init__(self, fit, view, folder):
        said = run("render", fit, *(() if view is None else ("--view", view)), "-o", folder / "view").stderr
        self.name, self.baseline = re.search(r"photograph (.*), ([^,]*), fit, 4 x \|error\|", said).groups()
        judged = json.loads(run("judge", fit, "--json").stdout)
        of_view = [image for image in judged["per_image"] if image["name"] == self.name]
        if not of_view:
            sys.exit(f"{fit}: {self.name} is not held out; choose another --view")
        self.psnr, self.baseline_psnr = of_view[0]["psnr"], of_view[0]["baseline_psnr"]
        _, _, self.rows = read_png(folder / "view_sheet.png")
        self.width = (len(self.rows[0]) // 3 - 3 * GAP) // 4

    def panel(self, i, width):
        return scaled(self.rows, i * (self.width + GAP), self.width, width)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    for name in ("fit", "output", "caption", "--words"):
        parser.add_argument(name)
    parser.add_argument("--view", type=int)
    parser.add_argument("--beside", nargs=2)
    parser.add_argument("--panel", type=int, default=270)
    parser.add_argument("--replace", action="store_true")
    given = parser.parse_args()
    if not given.replace and os.path.exists(given.output):
        print(f"{given.output}: is there already; --replace puts this one in its place, or choose another name", file=sys.stderr)
        sys.exit(2)
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        sheet = Sheet(given.fit, given.view, place)
        width = min(given.panel, sheet.width)
        panels = [sheet.panel(i, width) for i in range(4)]
        beside = f"{sheet.baseline}: {sheet.baseline_psnr:.1f} dB"
        if given.beside:
            other = Sheet(given.beside[0], given.view, place)
            if (other.name, other.width) != (sheet.name, sheet.width):
                sys.exit(f"{given.beside[0]} and {given.fit} show different views")
            panels[1], beside = other.panel(2, width), f"{given.beside[1]}: {other.psnr:.1f} dB"
        height = len(panels[0])
        rows = [(b"\xff" * 3 * GAP).join(parts) for parts in zip(*panels)]
        whole = len(rows[0]) // 3
        write_png(place / "panels.png", whole, 8, 2, rows)
        words = ("photograph, held out", beside, f"{given.words or model_of(given.fit)}: {sheet.psnr:.1f} dB", "four times its error")
        labels = [(word, (width + GAP) * i + width / 2, BELOW + height + ABOVE / 2) for i, word in enumerate(words)]
        labels.append((given.caption, whole / 2, BELOW / 2))
        lines = ("set label '{}' at {},{} center noenhanced".format(word.replace("'", "''"), x, y) for word, x, y in labels)
        output = pathlib.Path(given.output)
        script = GNUPLOT.format(width=whole, height=BELOW + height + ABOVE, output=output, labels="\n".join(lines),
                                panels=place / "panels.png", above_caption=BELOW + 0.5)  # fmt: skip
        subprocess.run(["gnuplot", "-d"], input=script, text=True, check=True)
    print(f"{output}: {sheet.name}")


main()
