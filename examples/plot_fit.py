#!/usr/bin/env python3
"""Fits a model to a dataset and plots what came of it: a held-out photograph, the fit's picture of it, four times the
error, and how the error is spread over problems and images. Run it cell by cell in a notebook, or as it is:

    PYTHONPATH=build/release/python examples/plot_fit.py DATASET PICTURE.png [OPTION=VALUE ...]
"""
# %% What is fitted, and with which options of `radiafit fit` (docs/options.md).
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import radiafit

if len(sys.argv) < 3:
    sys.exit(__doc__)
folder, picture = sys.argv[1:3]
options = dict(argument.split("=", 1) for argument in sys.argv[3:])

# %% The dataset: photographs are read from disk as they are looked at.
dataset = radiafit.Dataset(folder)
view = dataset.held_out[0]
print(f"{dataset.name}: {len(dataset.views)} views, {len(dataset.vertices)} vertices; {dataset.views[view].name} is held out")

# %% The fit, and what it is worth on photographs that it has not seen.
fit = radiafit.fit(dataset, **options)
figures = fit.judge("held_out")
print(f"{fit.description}: {figures['psnr']:.2f} dB held out, {figures['baseline']['psnr']:.2f} dB by its baseline")

# %% Side by side: as stored, in the photograph's exposure.
def srgb(linear):
    return np.where(linear < 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


stored = np.asarray(dataset.image(view), dtype=float)
if stored.dtype.kind != "f" or dataset.encoding[0] == "u":
    stored = stored / np.iinfo(dataset.image(view).dtype).max
photograph = stored if dataset.encoding.endswith("srgb") else srgb(stored)
seen = fit.render(view)
shown = srgb(seen[..., :3] / np.array(dataset.views[view].gain))
inside = seen[..., 3:] == 1

# %% What gnuplot draws: three pictures, two histograms, and which images are explained worst.
def quoted(text):
    return "'" + text.replace("'", "''") + "'"


def histogram(values):
    """A line for each bin: its middle, how many values it has."""
    counts, edges = np.histogram(values, bins=60)
    return "".join(f"{middle} {count}\n" for middle, count in zip((edges[1:] + edges[:-1]) / 2, counts))


seen_problems = fit.samples > 0
rms = np.sqrt(2 * fit.error[seen_problems] / fit.samples[seen_problems])
per_image = sorted(figures["per_image"], key=lambda image: image["psnr"])
title = f"{dataset.name}: {fit.description}; {figures['psnr']:.2f} dB held out, baseline {figures['baseline']['psnr']:.2f} dB"
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    for name, pixels in (("photograph", photograph), ("fit", shown), ("error", 4 * np.abs(shown - photograph) * inside)):
        (folder / name).write_bytes(np.uint8(255 * np.clip(pixels, 0, 1) + 0.5).tobytes())
    (folder / "rms").write_text(histogram(np.log10(rms[rms > 0])))
    (folder / "samples").write_text(histogram(fit.samples))
    (folder / "images").write_text("".join(f'{image["psnr"]} "{image["name"]}"\n' for image in per_image))
    pixels = f"binary array=({photograph.shape[1]},{photograph.shape[0]}) flipy format='%uchar' with rgbimage notitle"
    script = f"""
        set terminal pngcairo noenhanced size 1560,960 font 'DejaVu Sans,11'
        set output {quoted(str(pathlib.Path(picture).resolve()))}
        set multiplot layout 2,3 title {quoted(title)}
        set size ratio -1; set autoscale xfix; set autoscale yfix; unset tics; unset border
        set title {quoted(f"photograph {dataset.views[view].name}, held out")}; plot 'photograph' {pixels}
        set title 'the fit'; plot 'fit' {pixels}
        set title '4 x |error|, where the object fills the pixel'; plot 'error' {pixels}
        unset title; set size noratio; set autoscale; set yrange [0:*]
        set border 3; set xtics nomirror; set ytics nomirror; set style fill solid
        set xlabel "log10 of a problem's root mean square residual"; set ylabel 'problems'
        plot 'rms' with boxes notitle
        set xlabel 'samples of a problem'; set logscale y; set yrange [0.5:*]
        plot 'samples' with boxes notitle
        unset logscale; set xrange [0:*]; set yrange [-1:{len(per_image)}]; set xlabel 'PSNR of held-out images, dB'; unset ylabel
        plot 'images' using ($1 / 2):0:($1 / 2):(0.4):ytic(2) with boxxyerror notitle
    """
    subprocess.run(["gnuplot", "-d"], input=script, text=True, check=True, cwd=folder)
print(picture)
