#!/usr/bin/env python3
"""A finished result is never replaced without a word: each command that writes refuses what another one made, of other options or
of another input; the same command again says that it is done, in a second; and --replace replaces. Argument: the program."""
import json
import re
import shutil
import time
import unittest

from bad_inputs.fixtures import write_sets
from cli_fixture import ProgramTest, snapshot, take_arguments, write_capture, write_points
from exchange_fixture import ptm_file

# Name of the case: a command, and options of another whose output differs. OUT is what -o names.
COMMANDS = {
    "generate": ("generate star -o OUT", "--seed 7"),
    "import colmap": ("import colmap --model capture/sparse --images capture/images --mesh capture/mesh.ply -o OUT", "--holdout every:5"),
    "import lights": ("import lights --images flat --lights flat.txt --transfer linear -o OUT", "--holdout every:3"),
    "import rti": ("import rti a.ptm -o OUT", "--curve linear"),
    "fit": ("fit star --iterations 2 -o OUT", "--terms 2"),
    "merge": ("merge shard1 shard2 -o OUT", None),
    "capture depths": ("capture depths --model capture/sparse --images capture/images -o OUT", "--seed 2"),
    "capture cut-mesh": ("capture cut-mesh capture/mesh.ply --model capture/sparse --depths depths -o OUT.ply", "--region 0.9"),
    "capture preview": ("capture preview --model capture/sparse --images capture/images -o OUT.png", "--mesh capture/mesh.ply"),
    "capture masks": ("capture masks capture/mesh.ply --model capture/sparse -o OUT", "--inset 0"),
    "export problems": ("export problems star -o OUT", "--terms 2"),
    "export parameters": ("export parameters star-fit -o OUT", None),
    "export gltf": ("export gltf star-fit -o OUT.glb", "--without-maps"),
    "export rti": ("export rti flat-fit -o OUT", "--planes 9"),
    "export maps": ("export maps flat-fit -o OUT", "--normals fit"),
    "render": ("render star-fit -o OUT", "--view 0"),
    "render --light": ("render flat-fit --light 0,0,1 -o OUT", "--enhance specular"),
    "render --problems": ("render flat-fit --problems -o OUT", None),
    "render --turntable": ("render star-fit --turntable 3 -o OUT", "--size 40x30"),
    "render --all": ("render star-fit --all held-out -o OUT", "--size 40x30"),
    "render --raking": ("render flat-fit --raking 15 --directions 2 -o OUT", "--enhance specular"),
    "render --video": ("render star-fit --turntable 3 --video OUT.mp4", "--size 40x30"),
    "solve": ("solve lines.csv --model line.glsl --start slope=1,offset=0 -o OUT", "--fix offset"),
    "publish": ("publish star-fit -o OUT", "--views 2"),
    "publish --single-file": ("publish star-fit --single-file -o OUT.html", "--views 2"),
}


def versions(folder):
    """Which writing of every file stands there, whatever it holds."""
    return {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in folder.rglob("*")}


class Replace(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dataset("star")
        write_capture(cls.root / "star", cls.root / "capture")
        write_points(cls.root / "star", cls.root / "capture/sparse")
        cls.flat_sample("flat")
        grey = [(128, 128, 128, 140, 120, 200)] * 64
        (cls.root / "a.ptm").write_bytes(ptm_file(8, (1,) * 6, (128,) * 5 + (0,), grey, [(200, 150, 100)] * 64))
        cls.good("fit", "star", "--model", "lfm", "--iterations", 1, "-o", "star-fit")
        cls.good("fit", "flat-set", "--model", "lafortune", "-o", "flat-fit")
        cls.good("capture", "depths", "--model", "capture/sparse", "--images", "capture/images", "-o", "depths")
        write_sets(cls.root / "sets")
        for name in ("line.glsl", "lines.csv"):
            shutil.copy(cls.root / "sets" / name, cls.root)
        for i in (1, 2):
            cls.good("fit", "star", "--model", "lfm", "--iterations", 1, "--shard", f"{i}/2", "-o", f"shard{i}")

    def runs_here(self, name):
        """Whether what the command needs is on this machine; by its first run."""
        if name == "render --video" and not shutil.which("ffmpeg"):
            return False
        return not (name.startswith("publish") and "built without the viewer" in self.run_program(*"publish star-fit -o tried".split()).stderr)

    def another(self, words, more):
        """A command of the same kind whose output differs: by options, or of another input."""
        if more:
            return [*words, *more.split()]
        others = {"shard1": ["other1", "other2"], "shard2": [], "star-fit": ["other-fit"], "flat-fit": ["other-flat-fit"]}
        if not (self.root / "other-fit").exists():
            self.good("fit", "star", "--model", "lfm", "--iterations", 2, "-o", "other-fit")
            self.good("fit", "flat-set", "--model", "lambert", "-o", "other-flat-fit")
            for i in (1, 2):
                self.good("fit", "star", "--model", "lfm", "--iterations", 2, "--shard", f"{i}/2", "-o", f"other{i}")
        return [other for word in words for other in others.get(word, [word])]

    def check(self, name, folder):
        command, more = COMMANDS[name]
        words = command.replace("OUT", f"{folder}/out").split()
        place = self.root / folder
        place.mkdir()
        self.good(*words)
        made, written = snapshot(place), versions(place)

        start = time.monotonic()
        again = self.good(*words, "--threads", 1)
        self.assertLess(time.monotonic() - start, 1)
        self.assertEqual(len(again.stderr.splitlines()), 1, again.stderr)
        self.assertIn(f"{folder}/out", again.stderr)
        self.assertIn("done already, by this command on the same input; --replace does it again", again.stderr)
        self.assertEqual(written, versions(place), "nothing was written")

        other = self.another(words, more)
        self.refused(*other, says=[f"{folder}/out", "is there already, made by ", "--replace puts this one in its place, or choose another name"])
        self.assertEqual(written, versions(place), "nothing was written")

        self.good(*words, "--replace")
        self.assertTrue(set(written.items()) - set(versions(place).items()), "it was made again")
        self.assertEqual(made.keys(), snapshot(place).keys())
        self.good(*other, "--replace")
        self.assertNotEqual(made, snapshot(place))
        self.assertIn("done already", self.good(*other).stderr)
        self.refused(*words, says=["is there already"])

    def test_each_command(self):
        for number, name in enumerate(COMMANDS):
            with self.subTest(name):
                if self.runs_here(name):
                    self.check(name, f"place{number}")

    def test_every_command_that_writes_is_tested(self):
        """They are those that have --replace; and all that have --output have it."""
        found = set()
        for page in re.split(r"^\.SS ", self.good("options", "--man").stdout, flags=re.M)[1:]:
            text = page.replace("\\-", "-")
            name = text.splitlines()[0].removeprefix("radiafit ")
            self.assertEqual("\\fB--output\\fR" in text, "\\fB--replace\\fR" in text, name)
            if "\\fB--replace\\fR" in text:
                found.add(name)
        self.assertGreater(len(found), 10)
        tested = {name.split(" --")[0] for name in COMMANDS} | {"import transforms", "import llff"}
        self.assertEqual(found, tested)

    def test_other_kinds(self):
        """What other commands made, and what nobody made, stays even where it is to be replaced."""
        (self.root / "mine").mkdir()
        (self.root / "mine/notes.txt").write_text("mine")
        for command in ("generate star", "fit star", "export problems star", "export maps star-fit", "capture masks capture/mesh.ply --model capture/sparse",
                        "publish star-fit"):
            for more in ([], ["--replace"]):
                self.refused(*command.split(), "-o", "mine", *more, says=["mine: "])
                if not command.startswith("generate"):
                    self.refused(*command.split(), "-o", "star", *more, says=["star: "])
                self.refused(*command.split(), "-o", "star-fit" if command != "fit star" else "star", *more, says=["star"])
        self.refused(*"render star-fit --all held-out -o star-fit --replace".split(), says=["star-fit: is there already, made by `radiafit fit star"])

    def test_inputs(self):
        """The same input is one of the same contents, wherever it lies; a changed one is another."""
        shutil.copytree(self.root / "flat", self.root / "moved")
        lights = "--lights flat.txt --transfer linear -o of-images".split()
        self.good("import", "lights", "--images", "moved", *lights)
        shutil.copytree(self.root / "moved", self.root / "copied")
        self.assertIn("done already", self.good("import", "lights", "--images", "copied", *lights).stderr)
        shutil.copy(self.root / "moved/01.png", self.root / "moved/00.png")
        self.refused("import", "lights", "--images", "moved", *lights, says=["of-images: is there already", "of another input"])

        shutil.copytree(self.root / "star", self.root / "star-copy")
        fit = "--model lfm --iterations 1 -o of-star".split()
        self.good("fit", "star", *fit)
        self.assertIn("done already", self.good("fit", "star-copy", *fit, "--checkpoint", 7, "--resume").stderr)
        self.refused("fit", "flat-set", "--model", "lambert", "-o", "of-star", says=["made by `radiafit fit star --model lfm --iterations 1 -o of-star`"])

    def test_damaged_since(self):
        self.good(*"generate star -o damaged".split())
        (self.root / "damaged/images.bin").write_bytes(b"cut")
        self.refused(*"generate star -o damaged".split(), says=["damaged: is there already, made by this command, but changed since"])
        self.good(*"generate star -o damaged --replace".split())
        self.assertIn("done already", self.good(*"generate star -o damaged".split()).stderr)

    def test_json(self):
        """One object, also where all is there."""
        for command in ("generate star -o j-star", "fit star --model lfm --iterations 1 -o j-fit"):
            self.good(*command.split(), "--json")
            result = self.good(*command.split(), "--json")
            self.assertEqual(result.stderr, "")
            said = json.loads(result.stdout)
            self.assertTrue(said.get("kind") == "dataset" or said == {"done_already": "j-fit"}, said)

    def test_video_beside_pictures(self):
        """Of two outputs, one that is missing is made; the other may be written over, as the same command made it."""
        if not shutil.which("ffmpeg"):
            return
        command = "render star-fit --turntable 3 -o film".split()
        self.good(*command)
        self.good(*command, "--video", "film.mp4")
        self.assertIn("done already", self.good(*command, "--video", "film.mp4").stderr)

    def test_shards(self):
        """A shard goes on from what is there; another one is refused, and never removed."""
        shard = "fit star --model lfm --iterations 1 --shard 1/2 -o shard1".split()
        before = snapshot(self.root / "shard1")
        self.good(*shard)
        self.assertEqual(before, snapshot(self.root / "shard1"))
        self.refused(*shard, "--terms", 2, says=["shard1: holds ", "choose another folder"])
        self.refused(*shard, "--replace", says=["--replace is of whole fits", "remove its folder"])

    def test_tune_names_its_own(self):
        printed = self.good(*"tune star/ --seconds 1 --model lfm".split()).stdout.splitlines()[-1]
        self.assertTrue(printed.endswith(" -o star-tuned"), printed)


if __name__ == "__main__":
    Replace.program = take_arguments(1)[0]
    unittest.main()
