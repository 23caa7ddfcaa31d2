#!/usr/bin/env python3
"""`radiafit generate ornament`: its options, what it says of itself, and that its images stream to disk.

Arguments: the program.
"""
import json
import resource
import struct
import unittest

from cli_fixture import ProgramTest, take_arguments


class Ornament(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("ornament", "set")

    def info(self, name):
        return json.loads(self.good("info", name, "--json").stdout)

    def test_what_it_says_of_itself(self):
        self.good(
            *("generate", "ornament", "--encoding", "u8-srgb", "--shading", "pixel", "--light", "near"),
            *("--read-noise", "0.01", "--shot-noise", "0.02", "-o", "camera"),
        )
        plain, camera = self.info("set"), self.info("camera")
        self.assertEqual((plain["light"], camera["light"]), ("distant", "near"))
        self.assertEqual(plain["encoding"], "u16-linear")
        self.assertEqual(plain["image_bytes"], 2 * camera["image_bytes"])
        self.assertTrue(plain["truth"] and camera["truth"])
        for text in ("no shadows", "no noise", "at their texels' centres"):
            self.assertIn(text, plain["description"])
        for text in ("near lamp", "noise of 0.01 plus 0.02 at white", "over their areas"):
            self.assertIn(text, camera["description"])
        for option in ("--encoding u8-srgb", "--shading pixel", "--light near", "--read-noise 0.01"):
            self.assertIn(option, camera["source"])
            self.assertNotIn(option, plain["source"])

    def test_files_read_without_this_program(self):
        """By docs/formats.md and the standard library alone."""
        folder = self.root / "set"
        truth = json.loads((folder / "truth.json").read_text())
        dataset = json.loads((folder / "dataset.json").read_text())
        texels = dataset["triangles"] * truth["side"] * (truth["side"] + 1) // 2
        self.assertEqual(truth["texels"], texels)
        self.assertEqual(dataset["normals"]["side"], truth["side"])
        materials = (folder / "truth_material.u8").read_bytes()
        self.assertEqual(len(materials), texels)
        parameters = list(struct.iter_unpack("<9f", (folder / "truth_parameters.f32").read_bytes()))
        self.assertEqual(len(parameters), texels)
        normals = list(struct.iter_unpack("<3f", (folder / "normals.f32").read_bytes()))
        self.assertEqual(len(normals), texels)
        self.assertTrue(all(abs(x * x + y * y + z * z - 1) < 1e-5 for x, y, z in normals))
        self.assertEqual([m["name"] for m in truth["materials"]], ["white", "gold", "green"])
        names = [m["parameters"] for m in truth["materials"]]
        for material, values in zip(materials, parameters):
            named = dict(zip(names[material], values))
            if truth["materials"][material]["model"] == "lafortune":
                self.assertEqual(max(abs(named["Cx"]), abs(named["Cz"])), 1)
        for view in dataset["views"]:
            self.assertEqual(set(view["light"]), {"direction", "intensity"})

    def test_images_stream_to_disk(self):
        """Memory hardly grows with the images: smoke's 12 MB of them, then 315 MB."""

        def peak_bytes():
            return 1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss

        arguments = ("generate", "ornament", "--encoding", "f32-linear", "--scale")
        self.good(*arguments, "smoke", "-o", "small")
        before = peak_bytes()
        self.good(*arguments, "standard", "-o", "large")
        images = self.info("large")["image_bytes"]
        self.assertGreater(images, 300e6)
        self.assertLess(peak_bytes() - before, images / 4)

    def test_no_light_field(self):
        for command in (("fit", "set", "--model", "lfm", "-o", "new"), ("plan", "set", "--model", "lfm")):
            self.refused(*command, says=("set", "lamp that moves", "import colmap"))

    def test_mistakes(self):
        self.refused("generate", "star", "--light", "near", "-o", "new", says=("leave these options out",))
        self.refused("generate", "ornament", "--shot-noise", "2", "-o", "set", says=("shot-noise = 2", "from 0 to 1"))
        self.refused("generate", "ornament", "--read-noise", "nan", "-o", "set", says=("read-noise = nan",))
        self.refused("generate", "ornament", "--encoding", "jpeg", "-o", "set", says=("encoding 'jpeg'", "u16-linear"))
        self.refused("generate", "ornament", "--shading", "ray", "-o", "set", says=("shading 'ray'", "texel"))


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
