#!/usr/bin/env python3
"""`radiafit publish`: its pages in headless Chromium, beside what `radiafit render` draws of the same views and lamps.

Arguments: the program, the build folder. Exit status 77 (skipped) without Chromium, or where the program was built without the viewer."""
import json
import math
import re
import shutil
import sys
import unittest

from browser import Browser, chromium
from cli_fixture import ProgramTest, read_png, take_arguments
from exchange_fixture import write_dome, write_gloss
from npm_packages import installed

SIZES = ((1280, 800), (390, 844))  # a screen, a telephone
NEVER_LOADED = "window.createImageBitmap = () => new Promise(() => {});"
# Texts that stick out of the window, or of the box they are in; entries of the list of photographs that it is too narrow for.
CUT = """(() => {
    const cut = [], walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walk.nextNode()) {
        const text = walk.currentNode, element = text.parentElement;
        if (!text.data.trim() || element.matches("script, style, noscript, option, .unseen") || !element.checkVisibility()) continue;
        const range = document.createRange();
        range.selectNodeContents(text);
        const { left, right } = range.getBoundingClientRect(), box = element.closest("#panel section, #panel details, #panel header, label, button, .chip").getBoundingClientRect();
        if (left < Math.max(0, box.left) - 1 || right > Math.min(innerWidth, box.right) + 1) cut.push(text.data);
    }
    const list = document.getElementById("view"), style = getComputedStyle(list), pen = document.createElement("canvas").getContext("2d");
    pen.font = style.font;
    const room = list.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight) - 20;  // its arrow
    for (const { text } of list.options) if (pen.measureText(text).width > room) cut.push(text);
    return cut;
})()"""
AGREEMENT = 38  # dB: maps at 50 dB and more, and edges that a graphics chip's rasterizer decides otherwise


def psnr(a, b):
    squares = sum((x - y) ** 2 for x, y in zip(a, b))
    return math.inf if squares == 0 else 10 * math.log10(255**2 * len(a) / squares)


class Viewer(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.dataset("ornament")
        cls.good("fit", "star", "--solver", "mean", "-o", "plain")
        published = cls.run_program("publish", "plain", "--views", "1", "-o", "plain_page")
        if "built without the viewer" in published.stderr:
            print(f"skipped: {published.stderr.strip()}")
            raise unittest.SkipTest("no viewer")
        packages, missing = installed(cls.build)
        cls.axe = packages and (packages / "axe-core/axe.min.js").read_text()
        if missing:
            print(f"pages are not checked by axe-core: {missing}")
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.browser.errors.clear()

    def open(self, page, fragment, width, height):
        self.browser.size(width, height)
        self.browser.open(f"file://{self.root / page}#{fragment}")
        self.settle()

    def turn_to(self, fragment, width, height):
        """Another state of the page that is open."""
        self.browser.size(width, height)
        self.browser.evaluate(f"""new Promise((done) => {{
            window.addEventListener("hashchange", done, {{ once: true }});
            location.hash = "{fragment}&again=" + Math.random();
        }})""")
        self.settle()

    def settle(self):
        """The page has drawn its picture."""
        self.browser.wait_for("document.getElementById('picture')?.dataset.state === 'still' && !!window.radiafit_viewer")
        self.browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def page_data(self, page):
        text = (self.root / page / "data" / "page.js").read_text()
        return json.loads(re.fullmatch(r"window\.radiafit_page = (.*);\n", text, re.S)[1].replace("<\\/script", "</script"))

    def check_readable(self, page, fragment=""):
        """On a screen and on a telephone, everything unfolded: no text is cut, and axe-core finds neither weak contrast nor a control
        without a name."""
        self.open(page, fragment, *SIZES[0])
        self.check_reading_now(page)

    def check_reading_now(self, what):
        self.browser.evaluate("document.querySelectorAll('details').forEach((e) => (e.open = true))")
        for size in SIZES:
            self.browser.size(*size)
            self.assertEqual(self.browser.evaluate(CUT), [], (what, size))
        if not self.axe:
            return
        self.browser.evaluate(self.axe + "; 1")
        found = self.browser.evaluate("""axe.run({ resultTypes: ['violations'] }).then(({ violations }) =>
            violations.map((v) => `${v.id}: ${v.help}: ${v.nodes.map((n) => n.html + ' ' + n.failureSummary).join('; ')}`))""")
        self.assertEqual(found, [], what)

    def check_agreement(self, data, *render, fragment="", views=5, times=1):
        """Screenshots of some views of the page that is open, alone in the window, against `render`'s pictures of them; both so
        many times as large as the photographs."""
        self.assertGreaterEqual(len(data["views"]), views)
        for view in data["views"][:views]:
            width, height = times * view["camera"]["width"], times * view["camera"]["height"]
            self.turn_to(f"view={view['number']}&bare{fragment}", width, height)
            size = ("--size", f"{width}x{height}") if times > 1 else ()
            self.good("render", "fit", "--view", view["number"], *size, *render, "--replace", "-o", "picture")
            rendered = read_png(self.root / "picture.png")
            self.assertGreater(max(rendered[2]), 60)
            shot = self.browser.picture(lambda shot: shot[:2] == rendered[:2] and psnr(shot[2], rendered[2]) > AGREEMENT)
            self.assertEqual(shot[:2], rendered[:2])
            self.assertGreater(psnr(shot[2], rendered[2]), AGREEMENT, f"view {view['number']} {fragment}")
        self.assertEqual(self.browser.errors, [])

    def check_family(self, dataset, *options, views=5, times=1):
        """A fit's page, left open, and what is in it."""
        self.good("fit", dataset, *options, "--replace", "-o", "fit")
        said = self.good("publish", "fit", "--replace", "-o", "page").stderr
        self.assertIn("page's pictures against the fit's", said)
        data = self.page_data("page")
        self.assertGreater(data["scores"]["fidelity"] or math.inf, 45)
        self.assertLess(abs(data["scores"]["psnr"] - data["scores"]["shown_psnr"]), 0.2)
        self.open("page/index.html", "bare", 64, 64)
        self.check_agreement(data, views=views, times=times)
        return data

    def test_light_field_map(self):
        self.check_family("star", "--model", "lfm", "--terms", "2", "--covariance")
        shown = [self.browser.picture()[2]]
        for meaning in ("samples", "residual", "uncertainty"):
            self.turn_to(f"bare&known={meaning}", 64, 64)
            shown.append(self.browser.picture(lambda shot: psnr(shot[2], shown[-1]) < 30)[2])
        for one, other in ((0, 1), (1, 2), (2, 3), (1, 3)):
            self.assertLess(psnr(shown[one], shown[other]), 30, f"pictures {one} and {other} are the same")
        self.check_readable("page/index.html", "known=uncertainty&layout=wipe&show=photograph")

    def test_light_field_map_with_linear_look_up(self):
        self.check_family("star", "--model", "lfm", "--terms", "1", "--surface", "linear", views=3)

    def test_nearest_look_up_and_own_sides(self):
        self.check_family("star", "--model", "lfm", "--terms", "1", "--view", "nearest", "--texels-per-pixel", "1", views=3)

    def test_spherical_gaussians(self):
        self.check_family("star", "--model", "sg")
        self.check_readable("page/index.html", "show=error")

    def test_view_basis(self):
        data = self.check_family("star", "--model", "viewbasis", "--blocks", "8")
        nothing = "0" * len(data["model"]["terms"])
        self.turn_to(f"bare&terms={nothing}", 64, 64)
        self.assertLess(max(self.browser.picture(lambda shot: max(shot[2]) < 3)[2]), 3, "a model without any of its parts is black")
        self.check_readable("page/index.html", "layout=beside&show=baseline")

    def test_reflectance_and_lamps(self):
        # Its pixels are what their centres see: in small pictures those on outlines, where rasterizers differ, would count too much.
        data = self.check_family("ornament", "--model", "lafortune", times=4)
        for lamp in ("0.3,0.2,0.9", "0.2,-1,0.1"):  # amid the photographs', and where the fit fades
            self.check_agreement(data, "--light", lamp, fragment=f"&lamp={lamp}&intensity=1", views=2, times=4)

        self.check_readable("page/index.html", "lamp=0.2,-1,0.1")

    def test_light_basis(self):
        data = self.check_family("ornament", "--model", "lightbasis", "--numbers", "9", times=4)  # for outlines, as above
        self.assertIn("half_length", data["model"]["uniforms"])
        for lamp in ("0.3,0.2,0.9", "0.2,-1,0.1"):  # amid the photographs', and beyond them
            self.check_agreement(data, "--light", lamp, fragment=f"&lamp={lamp}&intensity=1", views=2, times=4)
        self.check_enhanced(data, "0.3,0.2,0.9", times=4)

    def test_light_basis_of_lamps_and_views(self):
        """Of a mesh and upon a model; and of a grid, where the first view's camera is beyond those that were fitted."""
        self.check_family("ornament", "--model", "lightbasis", "--numbers", "6", "--underneath", "lafortune", views=2, times=4)
        write_gloss(self.root / "gloss-images", 60, 40, 48)
        images = self.root / "gloss-images"
        self.good("import", "lights", "--images", images / "images", "--light-positions", images / "lamps.txt", "--camera-positions",
                  images / "eyes.txt", "--intensities", images / "intensities.txt", "--sample-width", "60", "--normals", "flat", "-o", "gloss")
        data = self.check_family("gloss", "--model", "lightbasis", "--numbers", "9", views=6)
        self.assertIn("half_length", data["model"]["uniforms"])
        self.check_agreement(data, "--light", "0.3,0.2,0.9", fragment="&lamp=0.3,0.2,0.9&intensity=1", views=2)

    RELIEF = (96, 72)

    def relief(self):
        if not (self.root / "relief").exists():
            write_dome(self.root / "dome", *self.RELIEF, 24)
            self.good("import", "lights", "--images", "dome/images", "--lights", "dome/lights.lp", "--normals", "flat", "-o", "relief")
        return "relief"

    def test_light_basis_upon_a_model(self):
        data = self.check_family(self.relief(), "--model", "lightbasis", "--numbers", "6", "--underneath", "lafortune")
        for lamp in ("0.3,0.2,0.9", "0.8,-0.58,0.12"):  # amid the photographs', and where the model underneath fades
            self.check_agreement(data, "--light", lamp, fragment=f"&lamp={lamp}&intensity=1", views=1)
        self.assertEqual(len(data["model"]["terms"]), 1 + 6 + 2)

    def test_single_file_controls_and_compared_pictures(self):
        self.good("fit", "ornament", "--model", "lambert", "-o", "lambert")
        self.good("publish", "lambert", "--single-file", "--views", "2", "--title", "A <vase>", "--caption", "From “below”.",
                  "--credit", "Photographs: N. N.", "--licence", "CC BY 4.0", "--scale", "2 cm", "-o", "one.html")
        self.assertIn("radiafit-page", (self.root / "one.html").read_text()[:4000])
        self.open("one.html", "", 390, 844)
        state = lambda what: self.browser.evaluate(f"radiafit_viewer.state.{what}")
        text = lambda name: self.browser.evaluate(f"document.getElementById('{name}').textContent")
        self.assertEqual((self.browser.evaluate("document.title"), text("title"), text("about")), ("A <vase>", "A <vase>", "From “below”."))
        self.assertEqual(text("terms_of_use"), "Photographs: N. N.\nLicence: CC BY 4.0")
        self.check_scale(0.02)
        lamp, score = (self.browser.evaluate(f"document.getElementById('{name}').getBoundingClientRect().top") for name in ("lamp", "score"))
        self.assertLess(lamp, score, "on a telephone the lamp comes first")
        self.assertLess(lamp, 844, "and without scrolling")
        fit = self.browser.picture(lambda shot: max(shot[2]) > 60)
        for layout, show in (("alone", "photograph"), ("wipe", "photograph"), ("beside", "baseline"), ("alone", "error")):
            self.browser.evaluate(f"radiafit_viewer.act.layout('{layout}'); radiafit_viewer.act.show('{show}')")
            self.settle()
            changes = lambda shot: psnr(shot[2], fit[2]) < 60
            self.assertTrue(changes(self.browser.picture(changes)), f"{layout} {show} changes nothing")
        self.browser.evaluate("radiafit_viewer.act.layout('alone'); radiafit_viewer.act.show('fit')")

        # Keys: around the object, its photographs, the lamp.
        self.browser.evaluate("document.getElementById('picture').focus()")
        self.key("ArrowLeft")
        first = state("view")
        self.assertIsNotNone(state("pose"))
        self.assertFalse(self.browser.evaluate("document.getElementById('return').hidden"))
        self.key("]")
        self.assertIsNone(state("pose"))
        self.assertEqual(state("view"), (first + 1) % 4)
        self.browser.evaluate("document.getElementById('lamp').focus()")
        self.key("ArrowRight")
        self.assertIsNotNone(state("lamp"))

        # Raking light stays as low above the picture, whatever turns; H adds highlights, and the address tells both.
        height = lambda: self.browser.evaluate("""{
            const { state, stage } = radiafit_viewer, { forward } = stage.pose();
            -state.lamp.reduce((sum, x, i) => sum + x * forward[i], 0); }""")
        for key in ("r", "ArrowRight", "ArrowUp", "h"):
            self.key(key)
            self.assertAlmostEqual(height(), math.sin(math.radians(15)), places=6)
        self.browser.evaluate("radiafit_viewer.act.turn(40, 10)")
        self.assertAlmostEqual(height(), math.sin(math.radians(15)), places=6)
        self.assertEqual(state("enhance"), 1)
        self.browser.wait_for("location.hash.includes('raking') && location.hash.includes('enhance=1')")
        self.key("h")
        self.browser.evaluate("radiafit_viewer.act.own_lamp()")
        self.assertEqual((state("enhance"), state("raking"), state("lamp")), (0, False, None))

        # Touch: one finger turns, two zoom.
        self.touch([[100, 200]], [[140, 200]])
        self.assertIsNotNone(state("pose"))
        self.touch([[150, 200], [200, 200]], [[100, 200], [250, 200]])
        self.assertGreater(state("zoom"), 1.5)
        self.assertEqual(self.browser.errors, [])

    def check_scale(self, unit_metres):
        """The bar is as long as it says, at the middle of the surface, which at twice the zoom has twice as many pixels."""
        told = lambda: self.browser.evaluate("""(() => {
            const { stage, state } = radiafit_viewer, { surface, views } = radiafit_page;
            const camera = views[state.view].camera, r = camera.rotation, c = surface.centre;
            const depth = r[6] * c[0] + r[7] * c[1] + r[8] * c[2] + camera.translation[2];
            const perUnit = surface.grid ? 1 / Math.hypot(...surface.grid.right) : camera.fx / depth;
            return [document.getElementById("scale_bar").getBoundingClientRect().width, document.getElementById("scale_text").textContent,
                    stage.frame_in(stage.areas()[1]).scale * perUnit];
        })()""")
        for zoom in (1, 2):
            self.browser.evaluate(f"radiafit_viewer.state.zoom = {zoom}; radiafit_viewer.stage.change(false); radiafit_viewer.act.known('colour')")
            width, text, per_unit = told()
            number, unit = text.split()
            metres = float(number) * {"km": 1e3, "m": 1, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6}[unit]
            self.assertAlmostEqual(width / (metres / unit_metres * per_unit), 1, delta=0.02, msg=f"{text} at {zoom}")
            self.assertIn(number[0], "125")
            self.assertTrue(25 < width < 131, width)
        self.browser.evaluate("radiafit_viewer.act.fit()")
        self.settle()

    def test_enhancement_and_raking_light_over_a_grid(self):
        """Of a flat grid, whose normals the page has from the fit."""
        width, height = self.RELIEF
        self.good("fit", self.relief(), "--model", "lightbasis", "--numbers", "9", "-o", "grid")
        self.good("publish", "grid", "--views", "1", "--scale", "1mm", "-o", "grid_page")
        data = self.page_data("grid_page")
        self.assertIn("fit_normal", [one["name"] for one in data["maps"]])
        self.open("grid_page/index.html", "bare", width, height)

        def check(fragment, picture, *render):
            self.turn_to(f"bare&intensity=1&{fragment}", width, height)
            self.good("render", "grid", *render)
            rendered = read_png(self.root / picture)
            shot = self.browser.picture(lambda shot: shot[:2] == rendered[:2] and psnr(shot[2], rendered[2]) > AGREEMENT)
            self.assertGreater(psnr(shot[2], rendered[2]), AGREEMENT, fragment)
            return shot[2]

        lamp = "0.3,0.2,0.9"
        plain = check(f"lamp={lamp}", "plain.png", "--light", lamp, "-o", "plain")
        enhanced = check(f"lamp={lamp}&enhance=1", "one.png", "--light", lamp, "--enhance", "specular", "-o", "one")
        self.assertLess(psnr(plain, enhanced), 30)
        # From straight above the button takes the lamp to the upper left, and a key from there by an eighth of the circle.
        self.turn_to("bare&intensity=1&lamp=0,0,1", width, height)
        self.browser.evaluate("document.getElementById('raking').click()")
        lamp = self.browser.evaluate("radiafit_viewer.state.lamp.join()")
        check(f"lamp={lamp}&raking", "raking/raking_315_top_left.png", "--raking", "15", "-o", "raking")
        self.browser.evaluate("radiafit_viewer.act.turn(75, 0)")
        lamp = self.browser.evaluate("radiafit_viewer.state.lamp.join()")
        check(f"lamp={lamp}&raking", "raking/raking_000_top.png", "--raking", "15", "-o", "raking")

        # Magnified, it has no steps of its texels' size: neighbours differ within what was a texel, too.
        self.turn_to("bare", 4 * width, 4 * height)
        shot = self.browser.picture(lambda shot: shot[:2] == (4 * width, 4 * height) and max(shot[2]) > 60)
        row = 3 * 4 * width
        pairs = [(shot[2][at], shot[2][at + 3]) for y in range(8, 4 * height - 8) for at in range(y * row + 24, (y + 1) * row - 27, 3)]
        pairs = [pair for pair in pairs if max(pair) > 60]
        self.assertGreater(sum(a != b for a, b in pairs) / len(pairs), 0.35)  # at most a fourth of them, if texels were squares
        self.check_readable("grid_page/index.html", "raking&lamp=0.9,0.3,0.2")
        self.check_scale(0.001)
        self.assertEqual(self.browser.errors, [])

    def check_enhanced(self, data, lamp, times=1):
        """Highlights as `render` adds them, which are to be seen; none at a strength of 0."""
        fragment = f"&lamp={lamp}&intensity=1"
        self.check_agreement(data, "--light", lamp, "--enhance", "specular", fragment=f"{fragment}&enhance=1", views=1, times=times)
        enhanced = self.browser.picture()
        self.check_agreement(data, "--light", lamp, fragment=f"{fragment}&enhance=0", views=1, times=times)
        self.assertLess(psnr(self.browser.picture()[2], enhanced[2]), 30)

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.browser.call("Input.dispatchKeyEvent", type=kind, key=key)

    def touch(self, begin, end):
        points = lambda places: [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(places)]
        self.browser.call("Input.dispatchTouchEvent", type="touchStart", touchPoints=points(begin))
        self.browser.call("Input.dispatchTouchEvent", type="touchMove", touchPoints=points(end))
        self.browser.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def test_every_control_has_a_name(self):
        self.open("plain_page/index.html", "", 1280, 800)
        nameless = self.browser.evaluate("""[...document.querySelectorAll('button, select, input, [tabindex]')].filter((e) =>
            !(e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.textContent.trim() ||
              e.labels?.length)).map((e) => e.outerHTML)""")
        self.assertEqual(nameless, [])
        self.assertTrue(self.browser.evaluate("document.getElementById('lamp_section').hidden"))  # it keeps its light
        self.assertEqual(self.browser.errors, [])

    def test_a_picture_and_all_words_before_anything_is_loaded(self):
        """In place, as the model is drawn there later."""
        self.good("publish", "plain", "--views", "1", "--single-file", "-o", "plain.html")
        camera = self.page_data("plain_page")["views"][0]["camera"]
        self.addCleanup(self.browser.call, "Emulation.setEmulatedMedia", features=[])
        for page, scheme in (("plain_page/index.html", "light"), ("plain.html", "dark")):
            self.browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
            script = self.browser.call("Page.addScriptToEvaluateOnNewDocument", source=NEVER_LOADED)["identifier"]
            for fragment in ("", "bare"):
                self.browser.open(f"file://{self.root / page}#{fragment}")
                self.browser.wait_for("!!window.radiafit_viewer && document.getElementById('first_picture').complete")
                if fragment == "":
                    self.assertFalse(self.browser.evaluate("document.getElementById('loading').hidden"))
                    self.check_reading_now(page)
                    words = self.browser.evaluate("document.getElementById('panel').innerText")
            self.browser.size(camera["width"], camera["height"])
            first = self.browser.picture(lambda shot: shot[0] == camera["width"] and max(shot[2]) > 60)
            self.browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
            self.open(page, "", *SIZES[-1])
            self.browser.evaluate("document.querySelectorAll('details').forEach((e) => (e.open = true))")
            self.assertEqual(self.browser.evaluate("document.getElementById('panel').innerText"), words)
            self.open(page, "bare", camera["width"], camera["height"])
            drawn = self.browser.picture(lambda shot: shot[:2] == first[:2] and psnr(shot[2], first[2]) > 25)
            self.assertGreater(psnr(drawn[2], first[2]), 25, page)
        self.assertEqual(self.browser.errors, [])

    def test_an_address_that_asks_for_what_there_is_not(self):
        self.open("plain_page/index.html", "show=gloss&view=99&colour=red&lamp=0,0,1&zoom", 1280, 800)
        said = self.browser.evaluate("document.getElementById('status').textContent")
        self.assertIn("The address asks for what this page does not have: show=gloss, view=99, colour=red, lamp=0,0,1, zoom.", said)
        self.assertEqual(self.browser.evaluate("radiafit_viewer.state.view"), self.page_data("plain_page")["first_view"])
        self.assertEqual(self.browser.errors, [])

    def test_long_names_of_photographs(self):
        """Are not cut in the list, and stand whole below it."""
        shutil.copytree(self.root / "plain_page", self.root / "long_names")
        script = self.root / "long_names/data/page.js"
        script.write_text(re.sub(r'("name": ?")view_', r"\1Museum/2026-11-28 A very long name, of which only the end differs ", script.read_text()))
        self.open("long_names/index.html", "", *SIZES[0])
        self.assertIn("A very long name", self.browser.evaluate("document.getElementById('view_text').textContent"))
        names = self.browser.evaluate("[...document.getElementById('view').options].map((o) => o.text)")
        self.assertEqual(len(set(names)), len(names))
        self.check_reading_now("long names")

    def test_without_webgl(self):
        script = self.browser.call("Page.addScriptToEvaluateOnNewDocument",
                                   source="HTMLCanvasElement.prototype.getContext = () => null;")["identifier"]
        self.browser.open(f"file://{self.root}/plain_page/index.html")
        self.browser.wait_for("document.getElementById('picture')?.dataset.state === 'failed'")
        self.browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
        self.assertIn("WebGL 2", self.browser.evaluate("document.getElementById('loading_text').textContent"))

    def test_a_device_that_is_lost_and_comes_back(self):
        self.open("plain_page/index.html", "", 320, 240)
        self.browser.evaluate("""{
            window.before = true;
            window.lose = document.getElementById('picture').getContext('webgl2').getExtension('WEBGL_lose_context');
            lose.loseContext(); }""")
        self.browser.wait_for("document.getElementById('picture').dataset.state === 'failed'")
        self.assertIn("device was lost", self.browser.evaluate("document.getElementById('loading_text').textContent"))
        self.browser.evaluate("lose.restoreContext()")
        self.browser.wait_for("!window.before && document.getElementById('picture')?.dataset.state === 'still'")

    def test_more_layers_than_the_device_draws(self):
        script = self.browser.call("Page.addScriptToEvaluateOnNewDocument", source="""
            const get = WebGL2RenderingContext.prototype.getParameter;
            WebGL2RenderingContext.prototype.getParameter = function (name) { return name === this.MAX_ARRAY_TEXTURE_LAYERS ? 1 : get.call(this, name); };
            """)["identifier"]
        self.good("fit", "star", "--model", "lfm", "--terms", "2", "-o", "two_terms")
        self.good("publish", "two_terms", "--views", "1", "-o", "two_terms_page")
        self.browser.open(f"file://{self.root}/two_terms_page/index.html")
        self.browser.wait_for("document.getElementById('picture')?.dataset.state === 'failed'")
        self.browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
        self.assertIn("at most 1", self.browser.evaluate("document.getElementById('loading_text').textContent"))

    def test_what_stands_there(self):
        self.good("publish", "plain", "--views", "1", "-o", "again")
        self.good("publish", "plain", "--views", "1", "-o", "again")
        (self.root / "again" / "notes.txt").write_text("mine")
        self.refused("publish", "plain", "-o", "again", says=("again", "notes.txt", "no part of a page"))
        (self.root / "letter.html").write_text("<p>mine</p>")
        self.refused("publish", "plain", "--single-file", "-o", "letter.html", says=("letter.html", "no page"))
        self.refused("publish", "plain", "-o", "star", says=("star", "no page"))
        self.refused("publish", "star", "-o", "new", says=("star/fit.json", "no such file"))
        self.refused("publish", "plain", "--megabytes", "0.6", "-o", "new", says=("the page would have", "--megabytes"))


if __name__ == "__main__":
    Viewer.program, Viewer.build = take_arguments(2)
    if not chromium():
        print("skipped: chromium is absent (scripts/install-packages.sh installs it)")
        sys.exit(77)
    ran = unittest.main(exit=False).result
    sys.exit(77 if ran.wasSuccessful() and ran.testsRun == 0 else not ran.wasSuccessful())
