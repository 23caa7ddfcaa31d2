#!/usr/bin/env python3
"""What the pages of fits are worth in this machine's headless Chromium: megabytes, dB against `radiafit render` at held-out
views, what the console said, frames per second while the object turns or the lamp moves, 800 x 600 pixels, and seconds from opening the page,
as a folder and as one file, to its first picture and to the model's.

    python3 -B tests/measure_page.py RADIAFIT FIT... [--keep FOLDER]

A row for each fit. --keep: pages and screenshots go there, else they are thrown away: held-out views alone, and the page as a
screen and a telephone have it, loading and loaded. Nothing passes or fails here: what must
hold is in viewer_test.py."""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile

from browser import Browser
from cli_fixture import read_png
from viewer_test import NEVER_LOADED, SIZES, psnr

VIEWS, LONGER_SIDE, SECONDS = 5, 800, 5

TURN = """new Promise((done) => {
    const { stage, act } = radiafit_viewer, begin = performance.now(), first = stage.frames;
    const step = () => {
        const passed = performance.now() - begin;
        if (passed > %d) done((1000 * (stage.frames - first)) / passed);
        else { act.turn(2, 0.3); requestAnimationFrame(step); }
    };
    step();
})""" % (1000 * SECONDS)


def settled(browser):
    browser.wait_for("document.getElementById('picture')?.dataset.state === 'still' && !!window.radiafit_viewer", 300)


def crops_of(fit):
    """Where in its photograph each view's part begins, which the page shows: `render` draws the whole."""
    dataset = fit / json.loads((fit / "fit.json").read_text())["dataset"]["path"]
    return [view.get("crop", {"x0": 0, "y0": 0}) for view in json.loads((dataset / "dataset.json").read_text())["views"]]


def cropped(picture, crop, width, height):
    whole, _, rgb = picture
    starts = (3 * ((crop["y0"] + y) * whole + crop["x0"]) for y in range(height))
    return b"".join(rgb[start : start + 3 * width] for start in starts)


def run(program, *words, **more):
    return subprocess.run([program, *map(str, words)], check=True, capture_output=True, text=True, **more)


def waited(browser, page):
    """Seconds from opening a page to its first picture, and to the model's."""
    browser.size(*SIZES[0])
    browser.open(page.as_uri())
    settled(browser)
    paint = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime"
    return [round(browser.evaluate(what) / 1000, 2) for what in (paint, "radiafit_viewer.stage.drawn_first")]


def keep_screenshots(browser, page, folder):
    for name, script in (("loading", NEVER_LOADED), ("loaded", "")):
        number = browser.call("Page.addScriptToEvaluateOnNewDocument", source=script)["identifier"]
        for width, height in SIZES:
            browser.size(width, height)
            browser.open(page.as_uri())
            browser.wait_for("!!window.radiafit_viewer && document.getElementById('first_picture').complete")
            if not script:
                settled(browser)
            (folder / f"{name}_{width}.png").write_bytes(browser.screenshot()[1])
        browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=number)


def measure(program, fit, folder):
    page = folder / "page"
    run(program, "publish", fit, "-o", page)
    run(program, "publish", fit, "--single-file", "-o", folder / "page.html")
    text = (page / "data" / "page.js").read_text()
    data = json.loads(re.fullmatch(r"window\.radiafit_page = (.*);\n", text, re.S)[1].replace("<\\/script", "</script"))
    weight = sum(path.stat().st_size for path in page.rglob("*") if path.is_file())
    held_out = [view for view in data["views"] if view["held_out"]][:VIEWS] or data["views"][:VIEWS]
    agreement, crops = [], crops_of(fit)
    with Browser() as browser:
        for view in held_out:
            width, height = view["camera"]["width"], view["camera"]["height"]
            size = []
            # A grid is drawn pixel by pixel, and small pictures are mostly outlines.
            if not data["surface"].get("grid") and max(width, height) < LONGER_SIDE / 2:
                scale = LONGER_SIDE / max(width, height)
                width, height = round(scale * width), round(scale * height)
                size = ["--size", f"{width}x{height}"]
            browser.size(width, height)
            browser.open(f"{(page / 'index.html').as_uri()}#view={view['number']}&bare")
            settled(browser)
            (_, _, shown), png = browser.screenshot()
            (folder / f"view_{view['number']}.png").write_bytes(png)
            picture = folder / f"render_{view['number']}"
            run(program, "render", fit, "--view", view["number"], *size, "-o", picture)
            rendered = read_png(picture.with_suffix(".png"))
            agreement.append(psnr(shown, rendered[2] if size else cropped(rendered, crops[view["number"]], width, height)))
        browser.size(800, 600)
        browser.open(f"{(page / 'index.html').as_uri()}#view={held_out[0]['number']}&bare")
        settled(browser)
        frames = browser.evaluate(TURN)
        seconds = {place.name: waited(browser, place) for place in (page / "index.html", folder / "page.html")}
        keep_screenshots(browser, page / "index.html", folder)
        errors = browser.errors
    scores = data["scores"]
    return {"fit": str(fit), "megabytes": round(weight / 1e6, 1), "of maps, dB": scores["fidelity"],
            "held out by the fit, dB": scores["psnr"], "by the page, dB": scores["shown_psnr"],
            "against render, dB": [round(value, 1) for value in agreement], "frames per second": round(frames, 1), "seconds to the first picture, the model's": seconds,
            "the console said": errors}  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("fits", nargs="+", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path)
    arguments = parser.parse_args()
    for fit in arguments.fits:
        with tempfile.TemporaryDirectory(prefix="radiafit-page-") as temporary:
            folder = arguments.keep / fit.name if arguments.keep else pathlib.Path(temporary)
            folder.mkdir(parents=True, exist_ok=True)
            print(json.dumps(measure(arguments.program.resolve(), fit.resolve(), folder.resolve())), flush=True)


if __name__ == "__main__":
    main()
