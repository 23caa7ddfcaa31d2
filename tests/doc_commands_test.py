#!/usr/bin/env python3
"""Every command that README.md and docs/ print as a block works as printed, from top to bottom of its page, in a folder that has
what the page speaks of. A command that cannot run here stands in NOT_RUN with the reason, or the test fails.

    `radiafit …`                      run; commands of a page share its folder
    `radiafit COMMAND … [--OPTION]`   a synopsis: the command has such options
    `make TARGET VARIABLE=…`          the Makefile knows the target, and its head the variables

Arguments: the program, the checkout.
"""
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import unittest

from cli_fixture import ProgramTest, read_png, take_arguments, write_capture, write_png, write_points
from exchange_fixture import hsh_file, ptm_file

CHECKOUT = None

NOT_RUN = {  # what a block's line begins with: why
    "cmake ": "tests/install_test.py and python_module build and install",
    "scp ": "another machine", "ssh ": "another machine", "docker ": "another machine", "apptainer ": "another machine",
    "tar -xf results.tar ": "rows of another machine", "radiafit compare results/reference results.tar": "rows of another machine",
    "for n in 0 1; do ./radiafit-bench ": "several graphics chips",
    "datasets/scripts/capture.sh ": "tests/capture_script_test.py runs it",
    "parallel ": "a program of its own; the loop beside it runs",
    "PYTHONPATH=": "tests/python_module_test.py runs it",
    "build/release/experiments/fig7_convergence": "minutes; the smoke tests run every experiment, and its --set and --run",
    "build/release/experiments/claims": "tests/claims_test.py runs it over copies",
    "radiafit compare results/reference results ": "tests/compare_cli_test.py runs it over copies",
    "#": "a script's head",
}  # fmt: skip
# Blocks that are no commands: folders, formulas.
NO_COMMAND = re.compile(r"[A-Z]+/$|Σ over |\s|[a-z_]+(\.json|\.csv|\.bin)|.*[·=]\s.*sum|m_c = |y_c\(v\)|trace\.csv|E =|\|")


def commands_of(page):
    """Lines of the page's indented blocks, continued ones joined, without what stands behind them."""
    blocks, joined = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S), ""
    for line in blocks.splitlines():
        if not (joined or line.startswith("    ")):
            continue
        joined += line[4:] if not joined else line.strip()
        if joined.endswith("\\"):
            joined = joined[:-1]
            continue
        yield re.sub(r"\s+# .*", "", joined)
        joined = ""


class DocCommands(ProgramTest):
    def setUp(self):
        self.folder = self.root / self.id().rsplit(".", 1)[1]
        self.folder.mkdir()
        programs = self.root / "programs"
        if not programs.exists():
            programs.mkdir()
            (programs / "radiafit").symlink_to(self.program)
        self.environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "SLURM_ARRAY_TASK_ID": "1",
                            "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # fmt: skip

    def shell(self, command):
        done = subprocess.run(["bash", "-ec", command], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True)  # fmt: skip
        if command.startswith("radiafit publish ") and "built without the viewer" in done.stderr:
            return  # viewer_test.py is skipped there, too
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")

    def star(self):
        self.shell("radiafit generate star -o star")

    def photographs(self):
        """sparse, images, masks and a mesh, as COLMAP and a modeller leave them."""
        self.star()
        write_capture(self.folder / "star", self.folder / "capture")
        write_points(self.folder / "star", self.folder / "capture/sparse")
        for name in ("sparse", "images", "mesh.ply"):
            (self.folder / "capture" / name).rename(self.folder / name)
        (self.folder / "masks").mkdir()
        for image in (self.folder / "images").iterdir():
            width, height, _ = read_png(image)
            write_png(self.folder / "masks" / image.name, width, height, b"\xff" * (3 * width * height))
        vertices, faces = [], []
        data = (self.folder / "mesh.ply").read_bytes()
        header, body = data.split(b"end_header\n", 1)
        count = int(re.search(rb"element vertex (\d+)", header)[1])
        triangles = int(re.search(rb"element face (\d+)", header)[1])
        for i in range(count):
            vertices.append("v %r %r %r" % struct.unpack_from("<3f", body, 12 * i))
        for i in range(triangles):
            faces.append("f %d %d %d" % tuple(v + 1 for v in struct.unpack_from("<3I", body, 12 * count + 13 * i + 1)))
        (self.folder / "mesh.obj").write_text("\n".join(vertices + faces) + "\n")

    def dome(self, side=24):
        """images and lights.lp of a bumpy surface, its normals and a mask; lamps and cameras near a flat sample; a coin, packed and as
        other programs' files."""
        lamps = 24
        images = self.folder / "images"
        images.mkdir()
        lights, near = [], []
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
            write_png(images / f"{i:02}.png", side, side, bytes(rows))
            lights.append(f"images/{i:02}.png {light[0]} {light[1]} {light[2]}")
            near.append(f"{10 * light[0]} {10 * light[1]} {10 * light[2]}")
        (self.folder / "lights.lp").write_text("\n".join([str(lamps), *lights]) + "\n")
        (self.folder / "lamps.txt").write_text("\n".join(near) + "\n")
        (self.folder / "eyes.txt").write_text("0 0 20\n" * lamps)
        write_png(self.folder / "mask.png", side, side, b"\xff" * 3 * side * side)
        normals = [(0.3 * math.sin(x / 3), 0.3 * math.sin(y / 4), 1.0) for y in reversed(range(side)) for x in range(side)]
        body = b"".join(struct.pack("<3f", *(v / math.sqrt(sum(a * a for a in n)) for v in n)) for n in normals)
        (self.folder / "normals.pfm").write_bytes(f"PF\n{side} {side}\n-1\n".encode() + body)
        self.shell("radiafit import lights --images images --lights lights.lp --normals flat -o coin")
        grey = [(128, 128, 128, 140, 120, 200)] * side**2
        (self.folder / "coin.ptm").write_bytes(ptm_file(side, (1,) * 6, (128,) * 5 + (0,), grey, [(200, 150, 100)] * side**2))
        (self.folder / "coin.rti").write_bytes(hsh_file(side, (2, 1, 1, 1), (0,) * 4, [[(150, 20, 10, 5)] * 3] * side**2))

    def run_page(self, name):
        page, ran = CHECKOUT / name, 0
        makefile = (CHECKOUT / "Makefile").read_text()
        for command in commands_of(page):
            if any(command.startswith(beginning) for beginning in NOT_RUN):
                continue
            if make := re.match(r"make((?: \[?[\w=./-]+\]?)*)", command):
                for word in make[1].replace("[", "").replace("]", "").split():
                    variable = word.partition("=")[0] if "=" in word else None
                    known = rf"^#   .*\b{variable}=" if variable else rf"^{word}:"
                    self.assertRegex(makefile, re.compile(known, re.M), f"{name}: {command}")
            elif " [--" in command:  # a synopsis
                options = self.good(command.split()[1], "--help").stdout
                for option in re.findall(r"--[a-z-]+", command):
                    self.assertIn(option, options, f"{name}: {command}")
            elif command.startswith(("radiafit ", "mpirun ", "for ")):
                if command.startswith("mpirun ") and not shutil.which("mpirun"):
                    continue
                self.shell(command)
                ran += 1
            elif command.startswith("scripts/replicate/"):  # runs make experiments, which is tested elsewhere
                script = CHECKOUT / command.split()[0]
                self.assertTrue(os.access(script, os.X_OK), f"{name}: {command}")
                config = re.search(r"^replicate (\w+)", script.read_text(), re.M)[1]
                self.assertTrue((CHECKOUT / f"experiments/{config}.toml").exists(), f"{name}: {command}")
            elif not NO_COMMAND.match(command) and command:
                self.fail(f"{name}: how is this tested? {command}")
        return ran

    def test_every_page_is_tested(self):
        pages = {str(page.relative_to(CHECKOUT)) for page in [CHECKOUT / "README.md", *(CHECKOUT / "docs").glob("*.md")]}
        with_commands = {page for page in pages if any(c.startswith("radiafit ") and " [--" not in c and not c.startswith(tuple(NOT_RUN)) for c in commands_of(CHECKOUT / page))}
        self.assertLessEqual(with_commands, set(self.TESTED))

    TESTED = {"README.md": 5, "docs/captures.md": 9, "docs/rti.md": 7, "docs/formats.md": 4, "docs/problems.md": 2, "docs/solve.md": 5, "docs/scaling.md": 5, "docs/texel-models.md": 4, "docs/viewer.md": 5}

    def check_page(self, name):
        self.assertGreaterEqual(self.run_page(name), self.TESTED[name])

    def test_readme(self):
        self.photographs()
        self.check_page("README.md")

    def test_solve(self):
        (self.folder / "examples").symlink_to(CHECKOUT / "examples")
        self.check_page("docs/solve.md")

    def test_captures(self):
        self.photographs()
        self.check_page("docs/captures.md")

    def test_rti(self):
        self.dome()
        self.check_page("docs/rti.md")

    def test_formats(self):
        self.check_page("docs/formats.md")

    def test_problems(self):
        self.star()
        self.check_page("docs/problems.md")

    def test_scaling(self):
        self.dome(64)
        (self.folder / "coin").rename(self.folder / "star")  # fitted in a tenth of a second; parts_cli_test.py cuts meshes
        self.check_page("docs/scaling.md")

    def test_viewer(self):
        self.check_page("docs/viewer.md")

    def test_pages_of_make(self):
        for name in ("compare", "experiments", "report", "claims", "gpu", "results", "reliability"):
            self.run_page(f"docs/{name}.md")


if __name__ == "__main__":
    DocCommands.program, CHECKOUT = take_arguments(2)
    unittest.main()
