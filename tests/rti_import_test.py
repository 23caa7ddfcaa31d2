#!/usr/bin/env python3
"""`radiafit import rti`: another program's file becomes a fit that is rendered, judged and published; and what `export rti` writes
comes back as it was. Argument: the program."""
import json
import math
import struct
import unittest

from cli_fixture import ProgramTest, read_png, take_arguments
from exchange_fixture import psnr, write_dome

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
        self.good("render", fit, "--light", direction(*lamp), "-o", "picture")
        return read_png(self.root / "picture.png")[2]

    def judged(self, fit):
        return json.loads(self.good("judge", fit, "--json").stdout)

    def test_a_polynomial_texture_map(self):
        """Written by the format's description: rows from the bottom, value = scale (byte - bias) of x^2, y^2, xy, x, y, 1."""
        width, height, scale, bias = 12, 8, (1, 1, 1, 1, 1, 1), (160, 160, 128, 127, 127, 0)
        pixels = [[130 + x, 120 + 2 * y, 128 - x, 140 + 5 * x, 127 - 6 * y, 180 + x + y] for y in range(height) for x in range(width)]
        paint = [(250 - 10 * x, 120 + 9 * y, 30 + 11 * x) for y in range(height) for x in range(width)]
        rows = range(height - 1, -1, -1)
        data = b"".join(bytes(pixels[y * width + x]) for y in rows for x in range(width))
        data += b"".join(bytes(paint[y * width + x]) for y in rows for x in range(width))
        head = f"PTM_1.2\nPTM_FORMAT_LRGB\n{width}\n{height}\n{' '.join(map(str, scale))}\n{' '.join(map(str, bias))}\n"
        (self.root / "a.ptm").write_bytes(head.encode() + data)
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
        self.good("import", "rti", "a.ptm", "-o", "ptm-fit")  # again, over itself
        self.good("publish", "ptm-fit", "-o", "page")

    def test_hemispherical_harmonics(self):
        """The first two functions alone: 1 / root 2 pi, and the one that grows towards +x; rows from the top."""
        width, height = 8, 6
        scale, bias = (2, 0.5, 1, 1), (0.1, -0.1, 0, 0)
        data = bytearray()
        for y in range(height):
            for x in range(width):
                for c in range(3):
                    data += bytes((60 + 20 * c + x, 5 * y, 0, 0))
        head = f"#HSH1.2\n3\n{width} {height} 3\n4 2 1\n".encode() + struct.pack("<8f", *scale, *bias)
        (self.root / "a.rti").write_bytes(head + data)
        self.good("import", "rti", "a.rti", "-o", "hsh-fit")
        for x, y in LAMPS:
            z = math.sqrt(1 - x * x - y * y)
            first = 1 / math.sqrt(2 * math.pi)
            second = math.sqrt(6 / math.pi) * math.cos(math.atan2(y, x)) * math.sqrt(z - z * z)
            shown = bytearray()
            for i in range(0, len(data), 4):
                value = first * (data[i] / 255 * scale[0] + bias[0]) + second * (data[i + 1] / 255 * scale[1] + bias[1])
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
        head = f"PTM_1.2\nPTM_FORMAT_LRGB\n{width}\n{height}\n1 1 1 1 1 1\n0 0 0 0 0 0\n"
        (self.root / "large.ptm").write_bytes(head.encode() + bytes(9 * width * height))
        self.refused("import", "rti", "large.ptm", "--dataset", "shaped", "-o", "new", says=["shaped: ", "--normals flat"])
        self.refused("import", "rti", "a.ptm", "--dataset", "relief", "-o", "new", says=["relief: 48 x 36 texels", "12 x 8 pixels"])


if __name__ == "__main__":
    (RtiImport.program,) = take_arguments(1)
    unittest.main()
