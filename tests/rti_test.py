#!/usr/bin/env python3
"""`radiafit export rti`: OpenLIME's own loader and shaders, in headless Chromium, show it as `radiafit render` does under the same lamps.

OpenLIME is looked for in the folder that RADIAFIT_OPENLIME names, a copy of its repository or of its npm package; else it comes
from npm. Arguments: the program, the build folder. Exit status 77 (skipped) without it, or without Chromium."""
import functools
import http.server
import math
import os
import pathlib
import shutil
import subprocess
import sys
import threading
import unittest

from browser import Browser, chromium
from cli_fixture import ProgramTest, read_png, take_arguments
from exchange_fixture import psnr, write_dome
from npm_packages import npm

OPENLIME = "openlime@1.2.6"
AGREEMENT = 35  # dB
SIDES = (160, 120)
SCRIPT = None
PAGE = pathlib.Path(__file__).resolve().parent / "web/openlime.html"


def openlime_script(build):
    """OpenLIME as one script that defines `OpenLIME`, or None, and why there is none."""
    folder = build / "tests_openlime"
    given = os.environ.get("RADIAFIT_OPENLIME")
    if given:
        package = pathlib.Path(given)
    else:
        if not shutil.which("npm"):
            return None, "npm is absent (scripts/install-packages.sh installs it)"
        package = folder / "node_modules/openlime"
        if not package.exists():
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "package.json").write_text('{"private": true}\n')
            failed = npm(folder, "install", "--no-save", OPENLIME)
            if failed:
                return None, f"npm has no {OPENLIME}, and RADIAFIT_OPENLIME names no copy of it: {failed}"
    for name in ("dist/js/openlime.min.js", "dist/js/openlime.js"):
        if (package / name).exists():
            return (package / name).read_bytes(), None
    bundler = build / "src/tools/publish/viewer/node_modules/.bin/esbuild"
    if not (package / "src/LayerRTI.js").exists():
        return None, f"{package} has neither dist/js/openlime.js nor src/LayerRTI.js"
    if not bundler.exists():
        return None, "esbuild is absent, which is installed with the viewer of pages"
    entry = "".join(f'export * from "./src/{name}.js";\n' for name in ("Viewer", "Layer", "LayerRTI"))
    command = [bundler, "--bundle", "--format=iife", "--global-name=OpenLIME", "--log-level=error"]
    return subprocess.run(command, input=entry.encode(), cwd=package, capture_output=True, check=True).stdout, None


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Rti(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_dome(cls.root / "dome", *SIDES, 40)
        cls.good("import", "lights", "--images", "dome/images", "--lights", "dome/lights.lp", "--normals", "flat", "-o", "relief")
        (cls.root / "openlime.js").write_bytes(SCRIPT)
        shutil.copy(PAGE, cls.root / "index.html")
        handler = functools.partial(Quiet, directory=cls.root)
        cls.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=cls.server.serve_forever, daemon=True).start()
        cls.addClassCleanup(cls.server.shutdown)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def check_agreement(self, model, least, *export):
        if not (self.root / model).exists():
            self.good("fit", "relief", "--model", model, "-o", model)
        shutil.rmtree(self.root / f"rti_{model}", ignore_errors=True)
        self.good("export", "rti", model, *export, "-o", f"rti_{model}")
        self.browser.size(*SIDES)
        self.browser.open(f"http://127.0.0.1:{self.server.server_address[1]}/index.html?rti=rti_{model}")
        self.browser.wait_for("window.loaded === true")
        for x, y in ((0, 0), (0.3, 0.2), (-0.5, 0.1), (0.1, -0.6), (0.4, -0.4)):
            self.browser.evaluate(f"light({x}, {y})")
            self.good("render", model, "--light", f"{x},{y},{math.sqrt(1 - x * x - y * y)}", "--replace", "-o", "picture")
            rendered = read_png(self.root / "picture.png")[2]
            width, height, shown = self.browser.picture(lambda shot: shot[:2] == SIDES and psnr(shot[2], rendered) > least)
            self.assertEqual((width, height), SIDES)
            agreement = psnr(shown, rendered)
            print(f"{model}, lamp {x}, {y}: {agreement:.1f} dB")
            self.assertGreater(agreement, least)

    def test_polynomial_texture_map(self):
        self.check_agreement("ptm", AGREEMENT, "--basis", "ptm")

    def test_another_model(self):
        """sRGB of a cosine is steeper at the horizon than any polynomial of so few terms: it comes less close."""
        self.check_agreement("lambert", 25, "--basis", "ptm")

    def test_components(self):
        for model in ("lightbasis", "lafortune"):
            self.check_agreement(model, 40)


if __name__ == "__main__":
    Rti.program, build = take_arguments(2)
    if not chromium():
        print("skipped: chromium is absent (scripts/install-packages.sh installs it)")
        sys.exit(77)
    SCRIPT, missing = openlime_script(build)
    if not SCRIPT:
        print(f"skipped: {missing}")
        sys.exit(77)
    unittest.main()
