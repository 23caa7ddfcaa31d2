#!/usr/bin/env python3
"""`radiafit export gltf`: Khronos' validator finds no error and no warning in the file of any family.

Arguments: the program, the build folder. Exit status 77 (skipped) without node, npm or npm's packages."""
import json
import pathlib
import subprocess
import sys
import unittest

from cli_fixture import ProgramTest, take_arguments
from exchange_fixture import write_dome
from npm_packages import installed

PACKAGES = None
WEB = pathlib.Path(__file__).resolve().parent / "web"


class Gltf(ProgramTest):
    def test_validator(self):
        self.dataset("star")
        self.dataset("ornament")
        write_dome(self.root / "dome", 20, 15, 24)
        for name, normals in (("relief", "flat"), ("bumps", None)):  # the latter by photometric stereo
            options = ["--normals", normals] if normals else []
            self.good("import", "lights", "--images", "dome/images", "--lights", "dome/lights.lp", *options, "-o", name)
        for dataset, model in (("star", "lfm"), ("star", "viewbasis"), ("star", "sg"), ("ornament", "lafortune"), ("ornament", "ptm"),
                               ("relief", "ptm"), ("bumps", "lafortune"), ("relief", "lightbasis"), ("ornament", "lightbasis")):  # fmt: skip
            blocks = ("--blocks", "8") if model == "viewbasis" else ()
            self.good("fit", dataset, "--model", model, *blocks, "-o", f"{dataset}_{model}")
            self.good("export", "gltf", f"{dataset}_{model}", "-o", f"{dataset}_{model}.glb")
            self.good("export", "gltf", f"{dataset}_{model}", "--without-maps", "-o", f"{dataset}_{model}_plain.glb")
        files = sorted(self.root.glob("*.glb"))
        self.assertEqual(len(files), 18)
        done = subprocess.run(["node", WEB / "validate.mjs", PACKAGES, *files], stdin=subprocess.DEVNULL, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        for file in files:
            issues = said[str(file)]
            serious = [m for m in issues["messages"] if m["severity"] < 2]
            self.assertEqual((issues["numErrors"], issues["numWarnings"]), (0, 0), f"{file.name}: {serious}")
            notes = {m["code"] for m in issues["messages"]}
            # What only `extras` names, a second set of texture coordinates among it, counts as unused.
            self.assertLessEqual(notes, {"UNUSED_OBJECT", "IMAGE_NPOT_DIMENSIONS"} if "plain" not in file.name else {"IMAGE_NPOT_DIMENSIONS"})

    def test_validator_sees_errors(self):
        """The test's own: a file with a vertex's normal cut short."""
        self.dataset("star", "star2")
        self.good("fit", "star2", "--solver", "mean", "-o", "mean")
        self.good("export", "gltf", "mean", "--without-maps", "-o", "good.glb")
        broken = self.root / "broken.glb"
        broken.write_bytes((self.root / "good.glb").read_bytes().replace(b'"NORMAL":1', b'"NORMAL":2', 1))
        done = subprocess.run(["node", WEB / "validate.mjs", PACKAGES, broken], stdin=subprocess.DEVNULL, capture_output=True, text=True)
        self.assertGreater(json.loads(done.stdout)[str(broken)]["numErrors"], 0)


if __name__ == "__main__":
    Gltf.program, build = take_arguments(2)
    PACKAGES, missing = installed(build)
    if not PACKAGES:
        print(f"skipped: {missing}")
        sys.exit(77)
    unittest.main()
