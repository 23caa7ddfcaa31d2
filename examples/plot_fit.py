#!/usr/bin/env python3
"""Fits a model to a dataset and plots what came of it: a held-out photograph, the fit's picture of it, four times the
error, and how the error is spread over problems and images. Run it cell by cell in a notebook, or as it is:

    PYTHONPATH=build/release/python examples/plot_fit.py DATASET PICTURE.png [OPTION=VALUE ...]
"""
# %% What is fitted, and with which options of `radiafit fit` (docs/options.md).
import sys

import matplotlib

if __name__ == "__main__" and "ipykernel" not in sys.modules:
    matplotlib.use("Agg")
import matplotlib.pyplot as plt
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

figure, axes = plt.subplots(2, 3, figsize=(13, 8), constrained_layout=True)
for axis, pixels, title in (
    (axes[0, 0], photograph, f"photograph {dataset.views[view].name}, held out"),
    (axes[0, 1], shown, "the fit"),
    (axes[0, 2], 4 * np.abs(shown - photograph) * inside, "4 x |error|, where the object fills the pixel"),
):
    axis.imshow(np.clip(pixels, 0, 1))
    axis.set_title(title)
    axis.set_axis_off()

# %% Problems: how large their errors are, and how many samples each has.
seen_problems = fit.samples > 0
rms = np.sqrt(2 * fit.error[seen_problems] / fit.samples[seen_problems])
axes[1, 0].hist(np.log10(rms[rms > 0]), bins=60)
axes[1, 0].set(xlabel="log10 of a problem's root mean square residual", ylabel="problems")
axes[1, 1].hist(fit.samples, bins=60)
axes[1, 1].set(xlabel="samples of a problem", ylabel="problems", yscale="log")

# %% Images: which are explained worst.
per_image = sorted(figures["per_image"], key=lambda image: image["psnr"])
axes[1, 2].barh([image["name"] for image in per_image], [image["psnr"] for image in per_image])
axes[1, 2].set(xlabel="PSNR of held-out images, dB")
figure.suptitle(f"{dataset.name}: {fit.description}; {figures['psnr']:.2f} dB held out, "
                f"baseline {figures['baseline']['psnr']:.2f} dB")
figure.savefig(picture, dpi=120)
print(picture)
