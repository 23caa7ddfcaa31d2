#!/usr/bin/env python3
"""datasets/scripts/capture.sh: from photographs and from an RTI folder to a page, what it says of bad input and of poor steps,
and that it goes on where it was stopped. COLMAP is played by a program that knows the cameras (fake_colmap.py): what is
tested is the script, and our steps between COLMAP's. Arguments: the program, the checkout.
"""
import json
import math
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import time
import unittest

from bad_inputs.fixtures import write_binary_model
from cli_fixture import ProgramTest, read_png, surface_points, take_arguments, write_capture, write_png

CHECKOUT = None
STEPS = "features matches cameras flat depths mesh masks dataset tune fit page".split()


def write_points(points, out):
    """A model's points3D.bin."""
    data = struct.pack("<Q", len(points))
    for id, (position, track) in enumerate(points, 1):
        data += struct.pack("<Q3d3BdQ", id, *position, 9, 9, 9, 0.4, len(track))
        data += b"".join(struct.pack("<2I", image, id) for image in track)
    out.write_bytes(data)


class TimeLeft(unittest.TestCase):
    """datasets/scripts/time_left.awk, on times that are made up."""

    EXPECTED = (("all", 67), ("all", 976), ("one", 20), ("all", 11), ("all", 570), ("all", 30), ("all", 48), ("clock", 300), ("all", 220), ("all", 60))
    CORES = 2

    def left(self, rows):
        text = "".join(" ".join(map(str, row)) + "\n" for row in rows)
        awk = ["awk", "-f", CHECKOUT / "datasets/scripts/time_left.awk", "-v", f"cores={self.CORES}"]
        return int(subprocess.run(awk, input=text, capture_output=True, text=True, check=True).stdout)

    def check(self, factors, waits, trusted):
        """Steps take `factors` of the processor time that was expected, and wait so many times as long for it. Estimates are compared
        from the first tenth of all on, in steps that `trusted` names."""
        steps = []  # wall, processor
        for (kind, expected), factor, wait in zip(self.EXPECTED, factors, waits):
            threads = self.CORES if kind == "all" else 1
            steps.append((expected, expected) if kind == "clock" else (wait * factor * expected / threads, factor * expected))
        total, before, compared = sum(wall for wall, _ in steps), 0, 0
        for now, (wall, processor) in enumerate(steps):
            for part in (0, 0.25, 0.5, 0.75):
                if now not in trusted or before + part * wall < 0.1 * total:
                    continue
                rows = [("done", *self.EXPECTED[i], round(w), round(p)) for i, (w, p) in enumerate(steps[:now])]
                rows.append(("now", *self.EXPECTED[now], round(part * wall), round(part * processor)))
                rows += [("coming", *step) for step in self.EXPECTED[now + 1 :]]
                truth = total - before - part * wall
                self.assertLess(abs(self.left(rows) / truth - 1), 0.3, (now, part, truth))
                compared += 1
            before += wall
        self.assertGreater(compared, 8)

    def test_a_step_that_waited_says_nothing_of_others(self):
        everywhere = range(len(self.EXPECTED))
        uneven = [1.3 * f for f in (1, 0.9, 1.2, 1, 1.1, 0.85, 1.1, 1, 0.95, 1.05)]  # on a slower machine
        self.check(uneven, [1] * 10, everywhere)
        for starved in (0, 1, 4):
            self.check(uneven, [28 if i == starved else 1 for i in everywhere], range(starved + 1, 10))
        self.check([0.5 * f for f in uneven], [1] * 10, range(1, 10))
        self.check(uneven, [2] * 10, range(4, 10))  # a machine that others use, too

    def test_what_is_left_is_never_nothing(self):
        late = [self.left([("now", kind, 100, used, used)]) for kind in ("all", "one", "clock") for used in (100, 900, 9000)]
        self.assertTrue(all(left > 0 for left in late), late)
        self.assertGreater(late[2], late[1])
        self.assertEqual(self.left([("now", "clock", 2, 2, 2)]), 1)


class CaptureScript(ProgramTest):
    done = []  # what the whole run said

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.script = CHECKOUT / "datasets/scripts/capture.sh"
        programs = cls.root / "programs"
        programs.mkdir()
        fake = programs / "colmap"
        fake.write_text(f"#!/bin/sh\nexec {sys.executable} -B {CHECKOUT / 'tests/fake_colmap.py'} \"$@\"\n")
        fake.chmod(0o755)
        cls.environment = {"RADIAFIT": str(cls.program), "RADIAFIT_SKIP_PACKAGES": "1", "FAKE_COLMAP": str(cls.root / "truth"),
                           "PATH": f"{programs}:{os.environ['PATH']}"}  # fmt: skip
        cls.dataset("star")
        write_capture(cls.root / "star", cls.root / "truth")
        write_binary_model(cls.root / "truth/sparse", cls.root / "truth/model")
        write_points(surface_points(cls.root / "star"), cls.root / "truth/model/points3D.bin")
        shutil.copytree(cls.root / "truth/images", cls.root / "photographs of a star")

    def capture(self, *arguments, **more):
        return self.run_program(*arguments, program=self.script, environment=self.environment | more)

    def captured(self, *arguments, **more):
        result = self.capture(*arguments, **more)
        if "built without the viewer" in result.stderr:
            self.skipTest("no viewer: the last step's page")
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def assert_refused(self, *arguments, says, **more):
        result = self.capture(*arguments, **more)
        self.assertEqual(result.returncode, 2, result.stderr)
        last = result.stderr.splitlines()[-1]
        self.assertTrue(last.startswith("capture.sh: "), result.stderr)
        for words in [says] if isinstance(says, str) else says:
            self.assertIn(words, result.stderr)

    def test_options_and_folders_are_checked(self):
        (self.root / "two").mkdir(exist_ok=True)
        (self.root / "two/a.LP").write_text("")
        (self.root / "two/b.lp").write_text("")
        (self.root / "empty").mkdir(exist_ok=True)
        (self.root / "nested").mkdir()
        os.symlink("../photographs of a star", self.root / "nested/jpgs")
        for folder in ("assembly-files", "jpeg-exports"):
            (self.root / "unlit" / folder).mkdir(parents=True)
            (self.root / "unphotographed" / folder).mkdir(parents=True)
        (self.root / "unphotographed/assembly-files/a.lp").write_text("1\na.png 0 0 1\n")
        photographs = "photographs of a star"
        for arguments, says in (
            ([], "give the folder of photographs and the folder to write"),
            (["--sizes", "3", photographs, "out"], "--sizes: no such option"),
            (["--size"], "--size takes a value"),
            (["--size", "big", photographs, "out"], "'big': --size, --seconds and --threads take whole numbers"),
            (["--until", "never", photographs, "out"], "--until never: choose features, matches"),
            (["nowhere", "out"], "nowhere: no such folder of photographs"),
            (["--masks", "nowhere", photographs, "out"], "nowhere: no such folder of masks"),
            (["--mesh", "nowhere", photographs, "out"], "nowhere: no such mesh"),
            (["empty", "out"], "0 photographs here, fewer than three"),
            (["nested", "out"], "nested/jpgs: give that folder"),
            (["unlit", "out"], "unlit/assembly-files: no light file (.lp) here"),
            (["unphotographed", "out"], "unphotographed/jpeg-exports: no photographs here"),
            (["two", "out"], "several light files (.lp): keep the one"),
            ([photographs, photographs + "/out"], "inside the folder of photographs: write elsewhere"),
        ):
            self.assert_refused(*arguments, says=says)
        self.assert_refused(photographs, "out", says="run make build", RADIAFIT="nowhere/radiafit")
        self.assertFalse((self.root / "out").exists())
        self.assertIn("--until STEP", self.captured("--help").stdout)

    def whole_run(self):
        """The folder of all steps, done once."""
        out = self.root / "whole run"
        if not self.done:
            self.done.append(self.captured("--seconds", "2", "photographs of a star", out))
        return out

    def test_photographs_to_a_page(self):
        out = self.whole_run()
        done = self.done[0]
        for number, step in enumerate(STEPS, 1):
            self.assertIn(f"[{number}/{len(STEPS)}] ", done.stderr)
            name, seconds, processor = (out / step / "seconds").read_text().split()
            self.assertEqual(name, step)
            self.assertGreaterEqual(int(seconds) + 1, 0)
            self.assertGreaterEqual(int(processor) + 1, 0)
        self.assertIn("photographs registered", done.stderr)
        self.assertIn("depth maps; of the pixels", done.stderr)
        self.assertIn("from the mesh in the median", done.stderr)
        self.assertRegex(done.stdout, r"\(test\): .*PSNR")
        self.assertIn("<html", (out / "page/index.html").read_text()[:400])
        self.assertFalse(list(out.glob("*.part")))
        # Masks are of the mesh; every photograph has one.
        masks, photographs = sorted((out / "masks/masks").glob("*.png")), sorted((out / "flat/large/images").iterdir())
        self.assertEqual([m.stem for m in masks], [p.stem for p in photographs])
        share = [sum(rgb[::3]) / 255 / (w * h) for w, h, rgb in map(read_png, masks)]
        self.assertTrue(all(0.02 < s < 0.98 for s in share), share)

        # The same again does nothing; another option is refused, or begins behind what it does not change.
        again = self.captured("--seconds", "2", "photographs of a star", out)
        self.assertEqual(again.stderr.count("done before"), len(STEPS))
        self.assertEqual(again.stdout, done.stdout)
        other = ("--seconds", "1", "--until", "tune", "photographs of a star", out)
        self.assert_refused(*other, says=["whole run/tune: is there already", "--replace puts this one in its place"])
        self.assertTrue((out / "page/index.html").exists())
        until = self.captured("--replace", *other)
        self.assertEqual(until.stderr.count("done before"), STEPS.index("tune"))

        # The user's own mesh in place of depths, and masks.
        masked = self.root / "masked"
        masked.mkdir()
        for mask in masks:
            shutil.copy(mask, masked / mask.name)
        mine = ("--seconds", "1", "--masks", masked, "--mesh", "truth/mesh.ply", "--until", "dataset", "photographs of a star")
        given = self.captured(*mine, self.root / "given")
        self.assertIn("mesh and masks agree on", given.stderr)
        self.assertFalse((self.root / "given/depths").exists())

    def test_a_page_is_as_large_as_it_must_be(self):
        small = self.root / "publishes little"
        small.write_text(f"""#!/bin/sh
case " $* " in *" publish "*--megabytes*) ;; *" publish "*) set -- "$@" --megabytes 0.1 ;; esac
exec {self.program} "$@"
""")
        small.chmod(0o755)
        out = self.root / "large page"
        shutil.copytree(self.whole_run(), out)
        shutil.rmtree(out / "page")
        self.captured("--seconds", "2", "photographs of a star", out, RADIAFIT=str(small))
        least = re.findall(r"the page would have ([0-9]+)[.0-9]* MB", (out / "page/log").read_text())
        self.assertEqual(len(least), 1)
        self.assertLess((out / "page/index.html").stat().st_size, (int(least[0]) + 1.1) * 1e6)  # whichever model a search came to

    def test_poor_outcomes_are_said(self):
        photographs = "photographs of a star"
        self.assert_refused(photographs, "poor", says=["only 2 of ", "take more photographs", "--go-on"], FAKE_COLMAP_KEEPS="2")
        self.assertTrue((self.root / "poor/cameras").is_dir())
        self.assert_refused(photographs, "none", says="no two photographs fit together: take more photographs", FAKE_COLMAP_KEEPS="0")
        self.assert_refused(photographs, "few", says="9 features are too few: photograph sharper", FAKE_COLMAP_FEATURES="9")
        self.captured("--go-on", "--until", "features", photographs, "few", FAKE_COLMAP_FEATURES="9")
        self.assert_refused(photographs, "killed", says="matches between photographs failed", FAKE_COLMAP_FAILS="exhaustive_matcher")
        (self.root / "far.obj").write_text("v 90 90 90\nv 91 90 90\nv 90 91 90\nf 1 2 3\n")
        self.assert_refused("--mesh", "far.obj", photographs, "far", says=["bring the mesh into the", "points.ply"])

    def test_goes_on_where_it_was_stopped(self):
        out = self.root / "stopped"
        command = [self.script, "--until", "flat", "photographs of a star", out]
        first = subprocess.Popen(command, cwd=self.root, env={**os.environ, **self.environment, "FAKE_COLMAP_WAITS": "exhaustive_matcher"},
                                 stderr=subprocess.PIPE, text=True)  # fmt: skip
        for _ in range(600):
            if (out / "matches.part/log").exists() and "matching" in (out / "matches.part/log").read_text():
                break
            time.sleep(0.1)
        self.assert_refused("photographs of a star", out, says="another run writes here")
        first.send_signal(signal.SIGTERM)
        self.assertEqual(first.wait(60), 130)
        self.assertIn("the same command goes on from here", first.communicate()[1])
        done = self.captured("--until", "flat", "photographs of a star", out)
        self.assertEqual(done.stderr.count("done before"), 1)
        self.assertTrue((out / "flat/large/images").is_dir())

    def test_images_under_lamps(self):
        side, lamps = 20, 20
        folder = self.root / "a dome"
        folder.mkdir()
        lines = []
        for i in range(lamps):
            z = 0.35 + 0.6 * (i + 0.5) / lamps
            angle, r = 2.4 * i, math.sqrt(1 - z * z)
            light = (r * math.cos(angle), r * math.sin(angle), z)
            rows = bytearray()
            for y in range(side):
                for x in range(side):
                    n = (0.3 * math.sin(x / 3), 0.3 * math.sin(y / 4), 1.0)
                    facing = max(0, sum(a * b for a, b in zip(n, light))) / math.sqrt(sum(a * a for a in n))
                    rows += bytes(int(250 * (albedo * facing) ** (1 / 2.2)) for albedo in (0.7, 0.5, 0.3))
            write_png(folder / f"Lamp {i:02}.PNG", side, side, bytes(rows))
            # As programs leave them: absolute names of another machine, relative ones, letter cases as they come.
            name = ("C:\\dome\\LAMP {:02}.png", "/home/me/dome/lamp {:02}.png", "Lamp {:02}.PNG", "./lamp {:02}.Png")[i % 4].format(i)
            lines.append(f"{name} {light[0]} {light[1]} {light[2]}")
        (folder / "Dome.LP").write_text("\r\n".join([str(lamps), *lines]) + "\r\n")
        done = self.captured("--seconds", "3", folder, "dome out", PATH=os.environ["PATH"])
        self.assertIn("[1/4] import", done.stderr)
        self.assertRegex(done.stdout, r"\(test\): .*PSNR")
        self.assertTrue((self.root / "dome out/page/index.html").exists())
        self.assertEqual(json.loads((self.root / "dome out/dataset/dataset/dataset.json").read_text())["views"][3]["name"][:7], "Lamp 03")
        # The surface is matte, and eight bits are few: what the data choose is worse than the baseline, which is said.
        dataset = self.root / "dome out/dataset/dataset"
        said = self.good("fit", dataset, "-o", "glossy").stderr
        self.assertRegex(said, r"warning: glossy: on 3 held-out images the Lambertian baseline is better: PSNR [\d.]+ against [\d.]+ dB; `radiafit tune`")
        self.assertNotIn("baseline", self.good("fit", dataset, "--model", "lafortune", "--replace", "-o", "glossy").stderr)
        # The same as Cultural Heritage Imaging lays its captures out.
        for file in list(folder.iterdir()):
            inside = folder / ("assembly-files" if file.suffix == ".LP" else "jpeg-exports")
            inside.mkdir(exist_ok=True)
            file.rename(inside / file.name)
        self.captured("--until", "dataset", folder, "dome again", PATH=os.environ["PATH"])
        first, again = (self.root / out / "dataset/dataset/images.bin" for out in ("dome out", "dome again"))
        self.assertEqual(first.read_bytes(), again.read_bytes())

    def test_lamps_by_a_sphere(self):
        """A matt surface, and a mirroring sphere on it."""
        width, height, radius, middle = 160, 120, 24, (40, 76)
        folder = self.root / "mirrored"
        folder.mkdir()
        lamps = []
        for i in range(8):
            z, angle = 0.5 + 0.05 * i, 2.4 * i
            lamps.append((math.sqrt(1 - z * z) * math.cos(angle), math.sqrt(1 - z * z) * math.sin(angle), z))

        def value(x, y, lamp):
            nx, ny = (x + 0.5 - middle[0]) / radius, (middle[1] - y - 0.5) / radius
            if nx * nx + ny * ny < 1:
                nz = math.sqrt(1 - nx * nx - ny * ny)
                mirrored = (2 * nz * nx, 2 * nz * ny, 2 * nz * nz - 1)
                return 1 if sum(a * b for a, b in zip(mirrored, lamp)) > math.cos(0.12) else 0.02
            normal = (0.3 * math.sin(x / 9), 0.3 * math.sin(y / 11), 1)
            return (0.3 + 0.1 * math.sin(x / 4) * math.cos(y / 5)) * max(0, sum(a * b for a, b in zip(normal, lamp)))

        for i, lamp in enumerate(lamps):
            grey = (int(255 * value(x, y, lamp) ** (1 / 2.2)) for y in range(height) for x in range(width))
            write_png(folder / f"{i}.png", width, height, bytes(v for g in grey for v in (g, g, g)))
        (folder / "old.lp").write_text("no light file that is read\n")
        circles = self.root / "circles.txt"
        circles.write_text(f"{middle[0] + 1} {middle[1] - 1} {radius + 1}\n")
        self.assert_refused("--spheres", "nowhere.txt", folder, "mirrored out", says="nowhere.txt: no such file of circles")
        done = self.captured("--spheres", "circles.txt", "--until", "dataset", folder, "mirrored out", PATH=os.environ["PATH"])
        self.assertIn("1 sphere, in pixels of the files at (", done.stderr)
        self.assertIn("directions of 8 lamps", done.stderr)
        views = json.loads((self.root / "mirrored out/dataset/dataset/dataset.json").read_text())["views"]
        for view, lamp in zip(views, lamps):
            off = math.acos(min(1, sum(a * b for a, b in zip(view["light"]["direction"], lamp))))
            self.assertLess(math.degrees(off), 2, view["name"])
        again = ("--spheres", circles, "--until", "dataset", folder, "mirrored out")
        self.assertIn("done before", self.captured(*again, PATH=os.environ["PATH"]).stderr)


if __name__ == "__main__":
    CaptureScript.program, CHECKOUT = take_arguments(2)
    unittest.main()
