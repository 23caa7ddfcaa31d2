#!/usr/bin/env python3
"""`radiafit export gltf`, `rti` and `maps`, read back by what the formats' texts say, without our own readers.

Arguments: the program.
"""
import json
import math
import struct
import unittest

from cli_fixture import ProgramTest, read_grey16, read_png, take_arguments
from exchange_fixture import Glb, psnr, srgb, write_dome


def read_npy(path):
    """Shape and numbers of an array of little-endian float32."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<H", data, 8)
    header = eval(data[10 : 10 + length])  # a dictionary's literal, says the format
    assert header["descr"] == "<f4" and not header["fortran_order"], path
    return header["shape"], struct.unpack(f"<{math.prod(header['shape'])}f", data[10 + length :])


def cells(side):
    """(i, j) of a tile's texels in their order (docs/formats.md)."""
    return [(i, j) for j in range(side) for i in range(side - j)]


class Exchange(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        cls.dataset("ornament")
        cls.good("fit", "ornament", "--model", "lafortune", "-o", "lafortune")
        for model in ("sg", "viewbasis", "lfm"):
            cls.good("fit", "star", "--model", model, "--surface-side", "5", "-o", model)
        write_dome(cls.root / "dome", 40, 30, 32)
        cls.good("import", "lights", "--images", "dome/images", "--lights", "dome/lights.lp", "--normals", "flat", "-o", "relief")
        cls.good("fit", "relief", "--model", "ptm", "-o", "ptm")

    def exported(self, fit, *options):
        self.good("export", "gltf", fit, *options, "--replace", "-o", f"{fit}.glb")
        return Glb(self.root / f"{fit}.glb")

    def parameters(self, fit, array):
        self.good("export", "parameters", fit, "-o", f"{fit}_{array}")
        return read_npy(self.root / f"{fit}_{array}" / f"{array}.npy")

    def check_mesh(self, glb, dataset):
        """Triangles, normals and places in the textures, against the dataset's mesh."""
        data = (self.root / dataset / "mesh.ply").read_bytes()
        body = data.index(b"end_header\n") + 11
        description = json.loads((self.root / dataset / "dataset.json").read_text())
        vertices = [struct.unpack_from("<3f", data, body + 12 * i) for i in range(description["vertices"])]
        at = body + 12 * len(vertices)
        triangles = [struct.unpack_from("<3I", data, at + 13 * t + 1) for t in range(description["triangles"])]
        positions, normals = glb.vectors("POSITION"), glb.vectors("NORMAL")
        self.assertEqual(positions, [vertices[v] for triangle in triangles for v in triangle])
        for normal in normals:
            self.assertAlmostEqual(math.hypot(*normal), 1, delta=1e-5)
        for name in ("TEXCOORD_0", *(["TEXCOORD_1"] if "files" in glb.radiafit else [])):
            self.assertEqual(len(glb.vectors(name)), len(positions))
            for u, v in glb.vectors(name):
                self.assertTrue(0 <= u <= 1 and 0 <= v <= 1)

    def test_every_family(self):
        for fit, dataset, lobe in (("lafortune", "ornament", True), ("sg", "star", True), ("viewbasis", "star", False), ("lfm", "star", False)):
            with self.subTest(fit):
                glb = self.exported(fit)
                self.check_mesh(glb, dataset)
                self.assertEqual(glb.radiafit["model"], fit)
                self.assertEqual(glb.image("roughness") is not None, lobe)
                self.assertEqual("KHR_materials_unlit" in glb.material.get("extensions", {}), not lobe)
                width, height, colours = read_png(glb.image("base colour"))
                self.assertGreater(max(colours), 60)
                # The fit's own files, byte for byte.
                names = {path.name for path in (self.root / fit).iterdir() if path.suffix == ".exr"} | {"fit.json"}
                self.assertEqual({file["name"] for file in glb.radiafit["files"]}, names)
                for file in glb.radiafit["files"]:
                    self.assertEqual(glb.view(file["bufferView"]), (self.root / fit / file["name"]).read_bytes())
                plain = self.exported(fit, "--without-maps")
                self.assertNotIn("files", plain.radiafit)
                self.assertEqual(plain.image("base colour"), glb.image("base colour"))

    def test_textures_hold_what_the_texels_have(self):
        """Lafortune's texels are looked up by the nearest: each has a pixel of its own in the texture."""
        glb = self.exported("lafortune")
        side = json.loads((self.root / "lafortune/fit.json").read_text())["reflectance"]["surface_side"]
        (texels, *_), numbers = self.parameters("lafortune", "texels")
        stride, per_tile = len(numbers) // texels, side * (side + 1) // 2
        width, height, base = read_png(glb.image("base colour"))
        _, _, rough = read_png(glb.image("roughness"))
        own_width, own_height = self.layout(texels // per_tile, side)
        places, own = glb.vectors("TEXCOORD_0"), glb.vectors("TEXCOORD_1")
        worst = 0
        for t in range(0, texels // per_tile, 7):
            for local, (i, j) in enumerate(cells(side)):
                p = numbers[(t * per_tile + local) * stride : (t * per_tile + local + 1) * stride]
                x, y = self.pixel(places[3 * t : 3 * t + 3], (width, height), (i + 0.5) / side, (j + 0.5) / side)
                at = 3 * (y * width + x)
                worst = max(worst, *(abs(base[at + c] - 255 * srgb(min(1, p[c]))) for c in range(3)))
                expected = (2 * math.exp(p[8]) + 1) ** -0.25 if max(p[3:6]) >= 1 / 255 else 1
                worst = max(worst, abs(rough[at + 1] - 255 * expected))
                self.assertEqual((rough[at], rough[at + 2]), (0, 0))
                # Where docs/formats.md has the texel in the fit's own maps.
                x, y = self.pixel(own[3 * t : 3 * t + 3], (own_width, own_height), (i + 0.5) / side, (j + 0.5) / side)
                self.assertEqual((x, y), self.place(t, i, j, side, own_width))
        self.assertLess(worst, 0.51)  # of 255, by rounding to a byte

    @staticmethod
    def layout(triangles, side):
        rectangles = (triangles + 1) // 2
        per_row = math.ceil(math.sqrt(rectangles * (side + 1) / side))
        return per_row * side, -(-rectangles // per_row) * (side + 1)

    @staticmethod
    def place(triangle, i, j, side, width):
        per_row = width // side
        x, y = triangle // 2 % per_row * side, triangle // 2 // per_row * (side + 1)
        return (x + i, y + j) if triangle % 2 == 0 else (x + side - 1 - i, y + side - j)

    @staticmethod
    def pixel(corners, size, b1, b2):
        """The pixel at barycentric (b1, b2) of a triangle's place in a texture; half a texel in from a diagonal."""
        at = [s * (c0 + b1 * (c1 - c0) + b2 * (c2 - c0)) for c0, c1, c2, s in zip(*corners, size)]
        return tuple(math.floor(x) for x in at)

    def test_a_grid_is_a_rectangle(self):
        glb = self.exported("ptm")
        self.assertEqual(glb.json["accessors"][0]["count"], 6)
        least, most = glb.json["accessors"][0]["min"], glb.json["accessors"][0]["max"]
        grid = json.loads((self.root / "relief/dataset.json").read_text())["grid"]
        step = math.hypot(*grid["right"])
        self.assertAlmostEqual(most[0] - least[0], 40 * step, places=4)
        self.assertAlmostEqual(most[1] - least[1], 30 * step, places=4)
        width, height, colours = read_png(glb.image("base colour"))
        self.assertEqual((width, height), (40, 30))
        # The albedo of the relief's paint, of which 0.02 is light from everywhere.
        for x, y in ((3, 4), (20, 15), (36, 27)):
            paint = (0.75, 0.55 + 0.2 * math.sin((x + y) / 9), 0.35 + 0.2 * math.cos(x / 6))
            for c in range(3):
                self.assertAlmostEqual(colours[3 * (y * width + x) + c] / 255, srgb(paint[c] + 0.03), delta=0.06)

    def test_rti_says_what_it_holds(self):
        said = self.good("export", "rti", "ptm", "--basis", "ptm", "-o", "rti").stderr
        self.assertIn("rti/info.json: 40 x 30 pixels", said)
        self.assertEqual({path.name for path in (self.root / "rti").glob("[!.]*")}, {"info.json", *(f"plane_{k}.jpg" for k in range(6))})
        info = json.loads((self.root / "rti/info.json").read_text())
        for key, value in {"width": 40, "height": 30, "type": "ptm", "colorspace": "rgb", "nplanes": 18, "format": "jpg"}.items():
            self.assertEqual(info[key], value)
        (material,) = info["materials"]
        self.assertEqual((len(material["scale"]), len(material["bias"])), (18, 18))
        self.assertGreater(min(material["scale"]), 0)
        for k in range(6):
            data = (self.root / f"rti/plane_{k}.jpg").read_bytes()
            self.assertTrue(data.startswith(b"\xff\xd8") and data.endswith(b"\xff\xd9"))

    def test_rti_has_what_render_shows(self):
        """Our importer reads the planes as photographs, render hands out their pixels, and the formula is put together here."""
        self.good("export", "rti", "ptm", "--basis", "ptm", "-o", "planes")
        info = json.loads((self.root / "planes/info.json").read_text())
        scale, bias = info["materials"][0]["scale"], info["materials"][0]["bias"]
        (self.root / "planes_in").mkdir()
        for k in range(6):
            (self.root / f"planes_in/{k}.jpg").write_bytes((self.root / f"planes/plane_{k}.jpg").read_bytes())
        (self.root / "planes.txt").write_text("0 0 1\n" * 6)
        self.good("import", "lights", "--images", "planes_in", "--lights", "planes.txt", "--normals", "flat", "-o", "planes_packed")
        description = json.loads((self.root / "planes_packed/dataset.json").read_text())
        pixels = (self.root / "planes_packed/images.bin").read_bytes()
        planes = [pixels[v["pixel_offset"] : v["pixel_offset"] + 3 * 40 * 30] for v in description["views"]]
        for x, y in ((0.1, 0.2), (-0.4, 0.3), (0.0, -0.5)):
            z = math.sqrt(1 - x * x - y * y)
            self.good("render", "ptm", "--light", f"{x},{y},{z}", "--replace", "-o", "shown")
            rendered = read_png(self.root / "shown.png")[2]
            weights = (1, x, y, x * x, x * y, y * y)
            computed = [
                255 * min(1, max(0, sum(weights[k] * scale[3 * k + i % 3] * (planes[k][i] / 255 - bias[3 * k + i % 3]) for k in range(6))))
                for i in range(3 * 40 * 30)
            ]
            self.assertGreater(psnr(computed, rendered), 35)

    def exported_maps(self, fit, *options):
        """The names, and maps.json."""
        said = self.good("export", "maps", fit, *options, "--replace", "-o", "maps").stderr
        self.assertIn("maps: textures of", said)
        return {path.name for path in (self.root / "maps").glob("[!.]*")}, json.loads((self.root / "maps/maps.json").read_text())

    @staticmethod
    def names(*maps):
        return {"maps.json", *(f"{name}.{ending}" for name in maps for ending in ("png", "exr"))}

    def test_maps(self):
        names, about = self.exported_maps("lafortune")
        self.assertEqual(names, self.names("base_colour", "roughness", "normals"))
        self.assertEqual(about["base_colour"]["is_albedo"], True)
        self.assertEqual((about["normals"]["from"], about["normals"]["axes"]), ("fit", "the mesh's"))
        glb = self.exported("lafortune")
        self.assertEqual((self.root / "maps/base_colour.png").read_bytes(), glb.image("base colour"))
        self.assertEqual((self.root / "maps/roughness.png").read_bytes(), glb.image("roughness"))
        # The fit is shaded with the mesh's normals, which its lamps tell again; both maps are unit or empty.
        found = read_png(self.root / "maps/normals.png")[2]
        _, about = self.exported_maps("lafortune", "--normals", "dataset")
        self.assertEqual((about["normals"]["from"], about["normals"]["lamps"]), ("dataset", 0))
        given = read_png(self.root / "maps/normals.png")[2]
        angles = []
        for i in range(0, len(given), 3):
            a, b = ([value / 127.5 - 1 for value in map_[i : i + 3]] for map_ in (found, given))
            if math.hypot(*b) > 0.5:
                self.assertAlmostEqual(math.hypot(*a), 1, delta=0.02)
                angles.append(math.degrees(math.acos(min(1, sum(x * y for x, y in zip(a, b)) / math.hypot(*a) / math.hypot(*b)))))
        self.assertLess(sorted(angles)[len(angles) // 2], 1)
        names, about = self.exported_maps("sg")
        self.assertEqual(names, self.names("base_colour", "roughness"))
        self.assertEqual(about["base_colour"]["is_albedo"], False)
        names, _ = self.exported_maps("lfm", "--normals", "dataset")
        self.assertEqual(names, self.names("base_colour", "normals"))

    def test_a_reliefs_height(self):
        """The dome's relief is z = 1.25 cos(x / 5) - 1.75 cos(y / 7), y down."""
        self.good("fit", "relief", "--model", "lightbasis", "--numbers", "9", "-o", "basis")
        names, about = self.exported_maps("basis")
        self.assertEqual(names, self.names("base_colour", "normals", "height"))
        self.assertEqual((about["normals"]["from"], about["height"]["unit"], about["height"]["texel"]), ("fit", "pixel", [1, 1]))
        width, height, values = read_grey16(self.root / "maps/height.png")
        self.assertEqual((width, height, min(values), max(values)), (40, 30, 1, 65535))
        _, _, normals = read_png(self.root / "maps/normals.png")
        least, most = about["height"]["least"], about["height"]["most"]
        heights = [least + (value - 1) / 65534 * (most - least) for value in values]
        truth = [1.25 * math.cos(x / 5) - 1.75 * math.cos(y / 7) for y in range(height) for x in range(width)]
        self.assertAlmostEqual(sum(heights), 0, delta=0.01 * len(heights))
        mean, spread = sum(truth) / len(truth), max(truth) - min(truth)
        self.assertLess(max(abs(a - b + mean) for a, b in zip(heights, truth)), 0.04 * spread)
        for y in range(height):
            for x in range(width):
                n = [value / 127.5 - 1 for value in normals[3 * (y * width + x) : 3 * (y * width + x) + 3]]
                true = (0.25 * math.sin(x / 5), 0.25 * math.sin(y / 7), 1)
                cosine = sum(a * b for a, b in zip(n, true)) / math.hypot(*n) / math.hypot(*true)
                self.assertLess(math.degrees(math.acos(min(1, cosine))), 4)
        _, about = self.exported_maps("basis", "--normals", "dataset")
        self.assertEqual((about["height"]["least"], about["height"]["most"]), (0, 0))
        self.assertEqual(set(read_png(self.root / "maps/normals.png")[2]), {128, 255})

    def test_lamps_that_tell_no_normals(self):
        self.good("fit", self.flat_sample("two", count=2), "--model", "lambert", "-o", "twice-lit")
        self.refused("export", "maps", "twice-lit", "--normals", "fit", "-o", "new", says=("twice-lit: the lamps", "--normals dataset"))
        said = self.good("export", "maps", "twice-lit", "-o", "few").stderr
        self.assertIn("tell no normals: those of the dataset are written", said)
        self.assertEqual(json.loads((self.root / "few/maps.json").read_text())["normals"]["from"], "dataset")

    def test_what_stands_there(self):
        self.exported("ptm")
        self.exported("ptm")
        (self.root / "mine.glb").write_bytes(b"glTF of mine")
        self.refused("export", "gltf", "ptm", "-o", "mine.glb", says=("mine.glb", "no glTF file of radiafit"))
        self.refused("export", "gltf", "ptm", "-o", "mesh.obj", says=("mesh.obj", "ends in .glb"))
        self.refused("export", "rti", "ptm", "-o", "star", says=("star: holds ", "no part of an RTI export"))
        self.refused("export", "maps", "ptm", "-o", "star", says=("star: holds ", "no part of exported maps"))
        for _ in range(2):
            self.good("export", "maps", "ptm", "-o", "twice")
        (self.root / "twice/notes.txt").write_text("mine")
        self.refused("export", "maps", "ptm", "-o", "twice", says=("twice: holds notes.txt",))
        self.refused("export", "rti", "lafortune", "-o", "new", says=("has a mesh", "grid"))
        self.refused("export", "maps", "sg", "--normals", "fit", "-o", "new", says=("sg: its model keeps the light", "--normals dataset"))
        self.refused("export", "maps", "sg", "--normals", "mesh", "-o", "new", says=("normals 'mesh' does not exist", "fit, dataset"))
        self.refused("export", "rti", "sg", "-o", "new", says=("sg: its model keeps the light",))


if __name__ == "__main__":
    (Exchange.program,) = take_arguments(1)
    unittest.main()
