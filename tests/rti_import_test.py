#!/usr/bin/env python3
"""`radiafit import rti`: another program's file becomes a fit that is rendered, judged and published; and what `export rti` writes
comes back as it was. Argument: the program."""
import json
import math
import unittest

from cli_fixture import ProgramTest, read_png, take_arguments
from exchange_fixture import hsh_file, psnr, ptm_file, write_dome

SIDES = (48, 36)
LAMPS = ((0, 0), (0.3, 0.2), (-0.5, 0.1), (0.1, -0.6), (0.4, -0.4))


def direction(x, y):
    return f"{x},{y},{math.sqrt(1 - x * x - y * y)}"


class RtiImport(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_dome(cls.root / "dome", *SIDES, 40)
        for name, more in (("relief", ("--normals", "flat")), ("shaped", ())):
            cls.good("import", "lights", "--images", "dome/images", "--lights", "dome/lights.lp", *more, "-o", name)

    def picture(self, fit, lamp):
        self.good("render", fit, "--light", direction(*lamp), "--replace", "-o", "picture")
        return read_png(self.root / "picture.png")[2]

    def judged(self, fit):
        return json.loads(self.good("judge", fit, "--json").stdout)

    def test_a_polynomial_texture_map(self):
        width, height, scale, bias = 12, 8, (1, 1, 1, 1, 1, 1), (160, 160, 128, 127, 127, 0)
        pixels = [[130 + x, 120 + 2 * y, 128 - x, 140 + 5 * x, 127 - 6 * y, 180 + x + y] for y in range(height) for x in range(width)]
        paint = [(250 - 10 * x, 120 + 9 * y, 30 + 11 * x) for y in range(height) for x in range(width)]
        (self.root / "a.ptm").write_bytes(ptm_file(width, scale, bias, pixels, paint))
        self.good("import", "rti", "a.ptm", "-o", "ptm-fit")
        for x, y in LAMPS:
            functions = (x * x, y * y, x * y, x, y, 1)
            shown = bytearray()
            for numbers, colours in zip(pixels, paint):
                light = sum(f * s * (n - b) for f, s, n, b in zip(functions, scale, numbers, bias))
                shown += bytes(round(min(255, max(0, light * c / 255))) for c in colours)
            rendered = self.picture("ptm-fit", (x, y))
            self.assertLessEqual(max(abs(a - b) for a, b in zip(rendered, shown, strict=True)), 1, (x, y))
        self.assertIn("no photographs", json.loads((self.root / "ptm-fit-lamps/dataset.json").read_text())["description"])
        self.assertGreater(self.judged("ptm-fit")["psnr"], 50)  # its images were rounded to bytes
        self.good("import", "rti", "a.ptm", "--replace", "-o", "ptm-fit")  # again, over itself
        published = self.run_program("publish", "ptm-fit", "--replace", "-o", "page")
        if "built without the viewer" not in published.stderr:
            self.assertEqual(published.returncode, 0, published.stderr)

    def test_hemispherical_harmonics(self):
        """The first two functions alone: 1 / root 2 pi, and the one that grows towards +x; rows from the top."""
        width, height = 8, 6
        scale, bias = (2, 0.5, 1, 1), (0.1, -0.1, 0, 0)
        pixels = [[(60 + 20 * c + x, 5 * y, 0, 0) for c in range(3)] for y in range(height) for x in range(width)]
        (self.root / "a.rti").write_bytes(hsh_file(width, scale, bias, pixels))
        self.good("import", "rti", "a.rti", "-o", "hsh-fit")
        for x, y in LAMPS:
            z = math.sqrt(1 - x * x - y * y)
            first = 1 / math.sqrt(2 * math.pi)
            second = math.sqrt(6 / math.pi) * math.cos(math.atan2(y, x)) * math.sqrt(z - z * z)
            shown = bytearray()
            for a, b, *_ in (channel for pixel in pixels for channel in pixel):
                value = first * (a / 255 * scale[0] + bias[0]) + second * (b / 255 * scale[1] + bias[1])
                shown.append(round(255 * min(1, max(0, value))))
            rendered = self.picture("hsh-fit", (x, y))
            self.assertLessEqual(max(abs(a - b) for a, b in zip(rendered, shown, strict=True)), 1, (x, y))

    def check_return(self, name, basis, dataset, least, lost, *fit):
        """least: dB of agreement under every lamp; lost: dB of the judge's, by the export's least squares for one."""
        self.good("fit", dataset, *fit, "-o", name)
        self.good("export", "rti", name, "--basis", basis, "-o", f"{name}-rti")
        self.good("import", "rti", f"{name}-rti", "--dataset", dataset, "-o", f"{name}-back")
        for lamp in LAMPS:
            agreement = psnr(self.picture(f"{name}-back", lamp), self.picture(name, lamp))
            print(f"{name}, lamp {lamp}: {agreement:.1f} dB")
            self.assertGreater(agreement, least)
        before, after = (self.judged(fit)["inside"]["psnr"] for fit in (name, f"{name}-back"))
        print(f"{name}, held-out images amid the others: {before:.2f} dB, back {after:.2f} dB")
        self.assertGreater(after, before - lost)

    def test_our_own_export_comes_back(self):
        self.check_return("ours-ptm", "ptm", "relief", 45, 2, "--model", "ptm", "--curve", "srgb")
        # the normals that photometric stereo found are no hindrance to a light basis
        self.check_return("ours-basis", "bilinear", "shaped", 40, 8, "--model", "lightbasis", "--numbers", "12")

    def test_normals_of_their_own(self):
        self.test_a_polynomial_texture_map()
        width, height = SIDES
        black = ptm_file(width, (1,) * 6, (0,) * 6, [(0,) * 6] * (width * height), [(0,) * 3] * (width * height))
        (self.root / "large.ptm").write_bytes(black)
        self.refused("import", "rti", "large.ptm", "--dataset", "shaped", "-o", "new", says=["shaped: ", "--normals flat"])
        self.refused("import", "rti", "a.ptm", "--dataset", "relief", "-o", "new", says=["relief: 48 x 36 texels", "12 x 8 pixels"])


if __name__ == "__main__":
    (RtiImport.program,) = take_arguments(1)
    unittest.main()
