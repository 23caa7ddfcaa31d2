#!/usr/bin/env python3
"""`radiafit render`: the photograph's frame and exposure, sizes and backgrounds, turntables, and films by a stand-in for
ffmpeg.

Arguments: the program.
"""
import json
import math
import os
import struct
import unittest

from cli_fixture import ProgramTest, read_png, take_arguments, write_capture, write_png

# A film of the stand-in holds how it was called, and the names of its frames.
FFMPEG = r"""#!/bin/sh
case "$*" in *broken.mp4) echo "Unknown encoder" >&2; exit 3;; *empty.mp4) exit 0;; esac
for film; do :; done
frames=
while [ $# -gt 0 ]; do
    [ "$1" != -i ] || frames=$(dirname "$2" | sed 's/%%/%/g')
    echo "$1" >>"$film"
    shift
done
ls "$frames" >>"$film"
"""


def srgb_decode(v):
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def png_head(path):
    """Width, height, bits and colour type."""
    return struct.unpack(">IIBB", path.read_bytes()[16:26])


class Render(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        write_capture(cls.root / "star", cls.root / "photos")
        # The same photographs, told to have been exposed differently: those held out as well.
        names = sorted(p.name for p in (cls.root / "photos/images").iterdir())
        gains = "".join(f"{name} {(1, 2, 0.5)[i % 3]}\n" for i, name in enumerate(names))
        (cls.root / "gains.txt").write_text(gains)
        cls.good("import", "colmap", "--model", "photos/sparse", "--images", "photos/images", "--mesh", "photos/mesh.ply",
                 "--gains", "gains.txt", "-o", "exposed")  # fmt: skip
        cls.good("fit", "star", "--model", "lfm", "-o", "fit")
        cls.good("fit", "exposed", "--model", "lfm", "-o", "exposed-fit")
        tools = cls.root / "tools"
        tools.mkdir()
        (tools / "ffmpeg").write_text(FFMPEG)
        (tools / "ffmpeg").chmod(0o755)
        cls.with_ffmpeg = {"PATH": f"{tools}:{os.environ['PATH']}"}
        nothing = cls.root / "nothing"
        nothing.mkdir()
        cls.without_ffmpeg = {"PATH": str(nothing)}

    def views(self, dataset):
        return json.loads((self.root / dataset / "dataset.json").read_text(encoding="utf-8"))["views"]

    def test_a_view_has_the_exposure_of_its_photograph(self):
        judged = {}
        for split in ("train", "test"):
            result = self.good("judge", "exposed-fit", "--split", split, "--json")
            judged.update({image["name"]: image["gain"] for image in json.loads(result.stdout)["per_image"]})
        shown = 0
        for index, view in enumerate(self.views("exposed")[:9]):
            gain = judged[view["name"]]
            if not view["held_out"]:
                self.assertAlmostEqual(gain, view["gain"], places=6)
            self.good("render", "exposed-fit", "--view", index, "--pixel-points", "1", "--replace", "-o", "one")
            width, height, alone = read_png(self.root / "one.png")
            sheet_width, _, sheet = read_png(self.root / "one_sheet.png")
            camera, crop = view["camera"], view["crop"]
            self.assertEqual((width, height), (crop["full_width"], crop["full_height"]))
            self.assertEqual(sheet_width, 4 * camera["width"] + 12)
            for y in range(camera["height"]):
                for x in range(camera["width"]):
                    at = 3 * (y * sheet_width + 2 * (camera["width"] + 4) + x)
                    beside = sheet[at : at + 3]
                    at = 3 * ((y + crop["y0"]) * width + x + crop["x0"])
                    if any(beside):
                        shown += 1
                        self.assertLessEqual(max(abs(a - b) for a, b in zip(beside, alone[at : at + 3])), 1)
        self.assertGreater(shown, 5000)

    def test_sizes(self):
        self.good("render", "fit", "--view", "0", "--size", "128x256", "--pixel-points", "1", "-o", "large")
        width, height, large = read_png(self.root / "large.png")
        self.assertEqual((width, height), (128, 256))
        shown = [any(large[3 * i : 3 * i + 3]) for i in range(128 * 256)]
        self.good("render", "fit", "--view", "0", "--pixel-points", "1", "-o", "plain")
        plain = read_png(self.root / "plain.png")[2]
        before = sum(any(plain[3 * i : 3 * i + 3]) for i in range(64 * 64))
        self.assertAlmostEqual(sum(shown) / before, 4, delta=0.2)  # twice as wide and high, in the middle
        self.assertFalse(any(shown[: 128 * 64]) or any(shown[128 * 192 :]))

    def test_backgrounds(self):
        self.good("render", "fit", "--view", "0", "--background", "10,200,30", "-o", "green")
        self.assertEqual(read_png(self.root / "green.png")[2][:3], bytes((10, 200, 30)))
        self.good("render", "fit", "--view", "0", "--background", "transparent", "-o", "clear")
        self.assertEqual(png_head(self.root / "clear.png"), (64, 64, 8, 6))  # RGB with alpha
        exr = [(self.root / f"{name}.exr").read_bytes() for name in ("green", "clear")]
        self.assertEqual(*exr)

    def test_a_turntable_frames_the_object(self):
        said = self.good("render", "fit", "--turntable", "5", "--size", "90x60", "-o", "turns").stderr
        self.assertRegex(said, r"turntable: .*, never more than \d+ degrees from the direction of a training photograph")
        for i in range(5):
            width, height, frame = read_png(self.root / f"turns/turn00{i}.png")
            self.assertEqual((width, height), (90, 60))
            lit = [(i % 90, i // 90) for i in range(90 * 60) if any(frame[3 * i : 3 * i + 3])]
            for side, axis in ((90, 0), (60, 1)):
                self.assertGreaterEqual(min(p[axis] for p in lit), int(0.05 * side))
                self.assertLess(max(p[axis] for p in lit), math.ceil(0.95 * side))
            self.assertGreater(max(p[1] for p in lit) - min(p[1] for p in lit), 30)

    def test_films(self):
        film = self.root / "films/100%.mp4"
        self.good("render", "fit", "--turntable", "3", "--video", film, environment=self.with_ffmpeg)
        self.assertEqual([p.name for p in film.parent.iterdir()], [film.name])
        words = film.read_text().split("\n")
        self.assertEqual(words[-4:], ["00000.png", "00001.png", "00002.png", ""])
        self.assertIn("libx264", words)
        # Again, over the earlier one, with frames beside it; and one that can be transparent.
        self.good("render", "fit", "--turntable", "2", "--video", film, "-o", "frames", "--replace", environment=self.with_ffmpeg)
        self.assertEqual(film.read_text().split("\n")[-3:], ["00000.png", "00001.png", ""])
        self.assertEqual(len(list((self.root / "frames").glob("turn*"))), 4)
        self.good("render", "fit", "--turntable", "1", "--background", "transparent", "--video", "films/a.webm",
                  environment=self.with_ffmpeg)  # fmt: skip
        self.assertIn("yuva420p", (self.root / "films/a.webm").read_text())

    def test_films_that_cannot_be(self):
        turn = ("render", "fit", "--turntable", "2")
        self.refused(*turn, "--video", "a.mp4", says=["a.mp4", "apt-get install ffmpeg"], environment=self.without_ffmpeg)
        for name in ("a.avi", "a", ".mp4"):
            self.refused(*turn, "--video", name, says=[name, ".mp4 or .webm"], environment=self.with_ffmpeg)
        self.refused(*turn, "--video", "a.mp4", "--background", "transparent", says=["a.mp4", "choose .webm"],
                     environment=self.with_ffmpeg)  # fmt: skip
        self.refused(*turn, "--video", "broken.mp4", "-o", "no", says=["status 3", "Unknown encoder"], environment=self.with_ffmpeg)
        self.refused(*turn, "--video", "empty.mp4", says=["status 0", "no film"], environment=self.with_ffmpeg)
        (self.root / "mine.mp4").write_text("of my wedding")
        self.refused(*turn, "--video", "mine.mp4", says=["mine.mp4", "no picture of radiafit render"], environment=self.with_ffmpeg)
        self.refused("render", "fit", "--video", "a.mp4", says=["--video", "--turntable"], environment=self.with_ffmpeg)

    def test_over_a_grid_the_lamp_moves(self):
        """A flat white sample: each frame is as bright as its lamp is high, which is between those of the images."""
        (self.root / "flat").mkdir()
        heights, lights = [], []
        for i in range(16):
            angle, z = 2 * math.pi * i / 16, 0.6 + 0.3 * (i % 2)
            heights.append(z)
            lights.append(f"{math.sqrt(1 - z * z) * math.cos(angle)} {math.sqrt(1 - z * z) * math.sin(angle)} {z}\n")
            write_png(self.root / f"flat/{i:02}.png", 8, 8, bytes([round(255 * z * 0.8)] * 192))
        (self.root / "flat.txt").write_text("".join(lights))
        self.good("import", "lights", "--images", "flat", "--lights", "flat.txt", "--transfer", "linear", "-o", "flat-set")
        self.good("fit", "flat-set", "--model", "lambert", "-o", "flat-fit")
        said = self.good("render", "flat-fit", "--turntable", "6", "-o", "lamps").stderr
        self.assertIn("a full circle", said)
        self.assertIn("a training lamp", said)
        for i in range(6):
            bright = srgb_decode(read_png(self.root / f"lamps/turn00{i}.png")[2][0] / 255) / 0.8
            self.assertTrue(0.61 < bright < 0.89, bright)
        # Raking light: each lamp is where the picture's name says, as low as asked for; and a film of it.
        said = self.good("render", "flat-fit", "--raking", "15", "--directions", "4", "-o", "raking").stderr
        self.assertRegex(said, r"4 of 4 lamps lie beyond those that were fitted, by up to \d+ degrees: there the model guesses")
        up, along = math.sin(math.radians(15)), math.cos(math.radians(15))
        for name, x, y in (("000_top", 0, 1), ("090_right", 1, 0), ("180_bottom", 0, -1), ("270_left", -1, 0)):
            lamp = f"{along * x!r},{along * y!r},{up!r}"
            self.good("render", "flat-fit", "--light", lamp, "--replace", "-o", "one")
            self.assertEqual((self.root / f"raking/raking_{name}.exr").read_bytes(), (self.root / "one.exr").read_bytes())
            self.assertEqual(read_png(self.root / f"raking/raking_{name}.png"), read_png(self.root / "one.png"))
        self.assertEqual(len(list((self.root / "raking").glob("raking*"))), 8)
        film = ("--raking", "60", "--directions", "3", "--video", "raking.mp4")
        self.assertNotIn("beyond", self.good("render", "flat-fit", *film, environment=self.with_ffmpeg).stderr)
        self.assertEqual((self.root / "raking.mp4").read_text().split("\n")[-4:], ["00000.png", "00001.png", "00002.png", ""])

        # Enhanced: where lamp and camera stand alike, as much darker and brighter as asked for; no strength changes no bit.
        head_on = lambda *enhance: self.good("render", "flat-fit", "--light", "0,0,1", *enhance, "--replace", "-o", "one").stderr
        head_on()
        plain, shown = (self.root / "one.exr").read_bytes(), read_png(self.root / "one.png")[2]
        head_on("--enhance", "1,0,75")
        self.assertEqual((self.root / "one.exr").read_bytes(), plain)
        self.assertIn("specular enhancement: by normals found from the fit", head_on("--enhance", "0.25,0.5,40"))
        light = [srgb_decode(read_png(self.root / "one.png")[2][i] / 255) / srgb_decode(shown[i] / 255) for i in range(3)]
        for share in light:
            self.assertAlmostEqual(share, 0.75, delta=0.01)
        self.refused("render", "flat-fit", "--turntable", "2", "--light", "0,0,1", "-o", "no", says=["--light", "--turntable"])
        self.refused("render", "flat-fit", "--size", "9x9", "-o", "no", says=["--size", "a pixel per texel"])

    def test_far_from_the_photographs(self):
        """Fits without the views around some, judged on these; what the fit left out stays out."""
        training = [view["name"] for view in self.views("star") if not view["held_out"]]
        self.good("fit", "star", "--model", "viewbasis", "--rank", "2", "--leave-out", training[0], "-o", "far-fit")
        far = json.loads(self.good("judge", "far-fit", "--off-photographs", "--json").stdout)["off_photographs"]
        self.assertTrue(far)
        for row in far:
            self.assertIn(row["degrees"], (15, 25, 35))
            self.assertLess(row["views"] + row["fitted"], len(training))
            self.assertGreaterEqual(2 * row["fitted"], len(training) - 1)
            self.assertGreater(row["psnr"], 10)
        self.assertIn("degrees from all fitted views", self.good("judge", "far-fit", "--off-photographs").stdout)
        self.refused("judge", "--renders", "named", "--dataset", "star", "--off-photographs", says=["leave out"])

    def test_judging_pictures(self):
        """Our own pictures have the fit's own score; other programs' are taken by name, size and encoding, or refused."""
        score = lambda *arguments: json.loads(self.good("judge", *arguments, "--json").stdout)
        for fit, dataset in (("fit", "star"), ("exposed-fit", "exposed")):
            self.good("render", fit, "--all", "held-out", "-o", f"{fit}-pictures")
            own, pictures = score(fit), score("--renders", f"{fit}-pictures", "--dataset", dataset)
            for figure in ("psnr", "ape", "ssim"):
                self.assertAlmostEqual(own[figure], pictures[figure], places=5 if fit == "fit" else 3)
            self.assertEqual([image["name"] for image in own["per_image"]], [image["name"] for image in pictures["per_image"]])
            self.assertNotIn("baseline", pictures)

        # The bytes of the same pictures under the images' names: as good as bytes can be.
        views = json.loads((self.root / "star/dataset.json").read_text())["views"]
        held_out = [(i, view["name"]) for i, view in enumerate(views) if view.get("held_out")]
        (self.root / "named").mkdir()
        self.good("render", "fit", "--all", "held-out", "--background", "transparent", "-o", "clear")
        for number, name in held_out:
            (self.root / "named" / name).with_suffix(".png").write_bytes((self.root / f"clear/view{number:04}.png").read_bytes())
        self.assertAlmostEqual(score("--renders", "named", "--dataset", "star")["psnr"], score("fit")["psnr"], delta=0.05)
        self.assertRegex(self.good("judge", "--renders", "named", "--dataset", "star", "--per-image").stdout, r"views \(test\): PSNR")

        judge = ("judge", "--renders", "named", "--dataset", "star")
        first = (self.root / "named" / held_out[0][1]).with_suffix(".png")
        whole = first.read_bytes()
        first.rename(self.root / "kept.png")
        self.refused(*judge, says=["named: 1 of ", "have no picture", held_out[0][1]])
        write_png(first, 7, 5, bytes(3 * 7 * 5))
        self.refused(*judge, says=[first.name, "7 x 5 pixels", "render", held_out[0][1]])
        first.write_bytes(whole[:200])
        self.refused(*judge, says=[first.name])
        self.refused("judge", "--renders", "named", says=["--dataset"])
        self.refused("judge", "fit", "--renders", "named", "--dataset", "star", says=["no fit"])
        self.refused("judge", "--renders", "absent", "--dataset", "star", says=["absent", "no such folder"])
        self.refused(*judge, "--split", "validation", says=["--split"])
        self.refused("judge", says=["--renders"])


if __name__ == "__main__":
    (Render.program,) = take_arguments(1)
    unittest.main()
