#!/usr/bin/env python3
"""Bad input to `radiafit`: one line that names the file or option and the cure, status 2, earlier outputs untouched.

Arguments: the program.
"""
import json
import math
import re
import shutil
import struct
import unittest

from cli_fixture import ProgramTest, take_arguments, write_capture, write_png

OLD_GL = {"MESA_GL_VERSION_OVERRIDE": "3.3", "MESA_GLSL_VERSION_OVERRIDE": "330"}


class BadInput(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.good("generate", "star", "-o", "star")
        cls.good("fit", "star", "--iterations", "1", "-o", "fit")
        write_capture(cls.root / "star", cls.root / "capture")

    def copy(self, source, name):
        """A copy of a folder for one test to damage."""
        shutil.copytree(self.root / source, self.root / name)
        self.addCleanup(shutil.rmtree, self.root / name)
        return self.root / name


class Import(BadInput):
    def setUp(self):
        self.capture = self.copy("capture", "damaged")

    def refuses(self, *says, output="packed", mesh="mesh.ply"):
        self.refused(
            *("import", "colmap", "--model", "damaged/sparse", "--images", "damaged/images"),
            *("--mesh", f"damaged/{mesh}", "-o", output),
            says=says,
        )

    def replace(self, file, pattern, text):
        path = self.capture / file
        changed, count = re.subn(pattern, text, path.read_text(), count=1)
        self.assertEqual(count, 1, f"{pattern} is not in {path}")
        path.write_text(changed)

    def test_missing_image(self):
        (self.capture / "images/view_005.png").unlink()
        self.refuses("damaged/images/view_005.png: no such image", "images.txt", "check --images")

    def test_truncated_image_leaves_the_earlier_dataset(self):
        image = self.capture / "images/view_005.png"
        image.write_bytes(image.read_bytes()[:-200])
        for output in ("packed", "star", "deep/below/packed"):
            self.refuses("damaged/images/view_005.png: truncated or corrupt", "export it again", output=output)

    def test_image_size_against_calibration(self):
        write_png(self.capture / "images/view_005.png", 60, 64, bytes(3 * 60 * 64))
        self.refuses("damaged/images/view_005.png: 60 x 64 pixels", "cameras.txt calibrates 64 x 64", "give the undistorted")

    def test_empty_mesh(self):
        (self.capture / "bytes.ply").write_bytes(b"")
        self.refuses("damaged/bytes.ply: empty mesh", "export it again", mesh="bytes.ply")
        (self.capture / "points.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n")
        self.refuses("damaged/points.obj: ", "export", mesh="points.obj")
        (self.capture / "lines.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n")
        self.refuses("damaged/lines.obj: empty mesh", "export the surface", mesh="lines.obj")

    def test_mesh_that_no_camera_sees(self):
        (self.capture / "far.obj").write_text("v 0 0 9000\nv 1 0 9000\nv 0 1 9000\nf 1 2 3\n")
        self.refuses("damaged/far.obj: no camera", "bring it into the model's frame", mesh="far.obj")

    def test_missing_mesh(self):
        self.refuses("damaged/none.ply: no such mesh file", "check the path", mesh="none.ply")

    def test_nan_in_a_camera(self):
        self.replace("sparse/cameras.txt", r"(\n1 PINHOLE 64 64) \S+", r"\1 nan")
        self.refuses("damaged/sparse/cameras.txt:2: a parameter is 'nan', which is not finite", "mend the line")

    def test_nan_in_a_pose(self):
        self.replace("sparse/images.txt", r"(\n1) \S+", r"\1 nan")
        self.refuses("damaged/sparse/images.txt:2: QW is 'nan', which is not finite", "mend the line")

    def test_distorted_camera_model(self):
        self.replace("sparse/cameras.txt", r"\n1 PINHOLE .*", "\n1 SIMPLE_RADIAL 64 64 80 32 32 0.1")
        self.refuses("damaged/sparse/cameras.txt:2: camera model SIMPLE_RADIAL", "`colmap image_undistorter`")

    def test_no_model(self):
        (self.capture / "sparse/images.txt").unlink()
        self.refuses("damaged/sparse: no COLMAP model here", "--model takes the folder")

    def test_unwritable_output(self):
        for output in ("star/mesh.ply/packed", "/proc/packed"):
            self.refuses(f"cannot write {output}: ", "choose a writable folder", output=output)
        self.refuses("capture: holds ", "choose another name", output="capture")


class Lights(ProgramTest):
    """`import lights`: four images of 6 x 5 pixels under a lamp each."""

    def setUp(self):
        self.capture = self.root / "lit"
        (self.capture / "images").mkdir(parents=True)
        self.addCleanup(shutil.rmtree, self.capture)
        for i in range(4):
            write_png(self.capture / f"images/{i}.png", 6, 5, bytes(range(90)))
        (self.capture / "lights.txt").write_text("0 0 1\n0.6 0 0.8\n0 0.6 0.8\n-0.6 0 0.8\n")

    def arguments(self, *more, lights="lights.txt"):
        return ("import", "lights", "--images", "lit/images", "--lights", f"lit/{lights}", *more, "-o", "packed")

    def refuses(self, *says, more=(), lights="lights.txt"):
        self.refused(*self.arguments(*more, lights=lights), says=says)

    def write_pfm(self, name, width, height, values):
        head = f"PF\n{width} {height}\n-1.0\n".encode()
        (self.capture / name).write_bytes(head + struct.pack(f"<{3 * width * height}f", *values))

    def test_a_good_one_and_what_cannot_be_done_with_it(self):
        self.good(*self.arguments("--held-out", "every:2"))
        self.addCleanup(shutil.rmtree, self.root / "packed")
        info = json.loads(self.good("info", "packed", "--json").stdout)
        self.assertEqual((info["grid"]["width"], info["grid"]["height"], info["grid"]["usable"]), (6, 5, 30))
        self.assertEqual((info["views"], info["held_out"], info["light"]), (4, 2, "distant"))
        for command in (["fit", "packed", "-o", "new"], ["plan", "packed"]):
            self.refused(*command, says=["packed: a grid of texels", "made for reflectance models"])

    def test_counts(self):
        (self.capture / "images/3.png").unlink()
        self.refuses("lit/lights.txt: 4 lights, but lit/images holds 3 images", "one line per image")
        (self.capture / "dome.lp").write_text("3\n0.png 0 0 1\n1.png 0 0 1\n")
        self.refuses("lit/dome.lp: says 3 images, but lists 2", "mend", lights="dome.lp")

    def test_light_that_points_nowhere(self):
        (self.capture / "lights.txt").write_text("0 0 1\n0 0 0\n0 0.6 0.8\n-0.6 0 0.8\n")
        self.refuses("lit/lights.txt:2: the light's vector is 0 0 0", "calibrate it")

    def test_normals_of_another_size(self):
        self.write_pfm("normals.pfm", 5, 6, [0, 0, 1] * 30)
        more = ("--normals", "lit/normals.pfm")
        self.refuses("lit/normals.pfm: normals for 5 x 6 pixels, but the images have 6 x 5", "at their size", more=more)

    def test_depth(self):
        self.refuses("lit/images/0.png: has 8-bit channels, but --depth 16 was declared", more=("--depth", "16"))

    def test_pixels_that_are_not_finite(self):
        for i in range(4):
            (self.capture / f"images/{i}.png").unlink()
            self.write_pfm(f"images/{i}.pfm", 6, 5, [0.5] * 50 + [math.nan if i == 2 else 0.5] + [0.5] * 39)
        # Rows stand bottom to top: value 50 is in the third row from below, pixel 16 - 12 of it.
        self.refuses("lit/images/2.pfm: the pixel at column 4, row 2 is not finite", "repair the image")


class Datasets(BadInput):
    def test_folder_that_does_not_exist(self):
        for command in (["fit", "nowhere", "-o", "new"], ["plan", "nowhere"], ["info", "nowhere"]):
            self.refused(*command, says=["nowhere: no such folder", "generate or import"])

    def test_folder_that_is_no_dataset(self):
        self.refused("fit", "capture", "-o", "new", says=["capture: not a packed dataset", "generate or import"])
        self.refused("fit", "star/mesh.ply", "-o", "new", says=["star/mesh.ply: a dataset is a folder", "give the folder"])
        self.refused("info", "capture", says=["capture: neither a dataset nor a fit", "give a folder that radiafit"])
        self.refused("info", "star/mesh.ply", says=["star/mesh.ply: ", "this is a file", "give the folder"])

    def test_damaged_dataset(self):
        folder = self.copy("star", "damaged")
        images = folder / "images.bin"
        images.write_bytes(images.read_bytes()[:-1])
        for command in (["fit", "damaged", "-o", "new"], ["info", "damaged"]):
            self.refused(*command, says=["damaged/images.bin: ", "run radiafit generate or import again"])

    def edited(self, edit):
        folder = self.copy("star", "damaged")
        text = json.loads((folder / "dataset.json").read_text())
        for view in text["views"]:
            edit(view["camera"])
        (folder / "dataset.json").write_text(json.dumps(text))

    def test_camera_that_is_not_finite(self):
        self.edited(lambda camera: camera.update(fx=None))  # JSON's way to say NaN
        self.refused("fit", "damaged", "-o", "fit", says=['damaged/dataset.json: "views[0].camera.fx" is null', "again"])

    def test_mesh_that_no_camera_sees(self):
        self.edited(lambda camera: camera.update(cam_from_world_translation=[0, 0, -1000]))
        for engine in ("cpu", "fragment"):
            for output in ("new", "fit"):
                self.refused(
                    *("fit", "damaged", "--engine", engine, "-o", output),
                    says=["damaged: no training view sees the mesh", "check that mesh and calibration share one frame"],
                )

    def test_unwritable_output(self):
        for output in ("star/mesh.ply/fit", "/proc/fit"):
            self.refused("fit", "star", "-o", output, says=[f"cannot write {output}: ", "choose a writable folder"])
            says = [f"cannot write {output}: ", "choose a writable folder"]
            self.refused("generate", "star", "-o", output, says=says)
        for output in ("star/mesh.ply/r", "/proc/below/r"):
            for more in ([], ["--turntable", "1"]):
                self.refused("render", "fit", "-o", output, *more, says=["cannot write ", "choose a writable folder"])

    def test_outputs_of_others_stay(self):
        self.refused("fit", "star", "-o", "star", says=["star: not a fit", "choose another name"])
        self.refused("fit", "star", "-o", "star/mesh.ply", says=["star/mesh.ply: a file stands there", "choose another name"])
        self.refused("generate", "star", "-o", "fit", says=["fit: holds ", "choose another name"])


class Options(BadInput):
    def fit_refused(self, *arguments, says, **options):
        self.refused("fit", "star", *arguments, "-o", "fit", says=says, **options)

    def test_values_out_of_range(self):
        for option, value in (("--terms", "0"), ("--terms", "17"), ("--surface-side", "0"), ("--view-side", "0"),
                              ("--lambda-surface", "nan"), ("--lambda-view", "-1"), ("--mu", "inf"),
                              ("--iterations", "-1"), ("--stop-residual", "nan"), ("--stop-change", "-1"),
                              ("--device", "-2"), ("--threads", "5000"), ("--iterations", "many")):
            with self.subTest(option=option, value=value):
                self.fit_refused(option, value, says=[option.lstrip("-")])

    def test_names_that_do_not_exist(self):
        for option, value, nearest in (
            ("--engine", "foo", "cpu, fragment"), ("--solver", "strem", "nearest: stream"),
            ("--optimizer", "gc", "cg, sd"), ("--mode", "papers", "nearest: paper"),
            ("--passes", "combine", "nearest: combined"), ("--storage", "fp8", "nearest: fp"),
            ("--sums", "fp8", "nearest: fp"),
            ("--distributor", "gpu", "cpu, gl"), ("--source", "disc", "nearest: disk"),
            ("--view", "linear", "nearest: "), ("--space", "srgb", "stored, linear"), ("--context", "glx", "egl or osmesa"),
        ):  # fmt: skip
            with self.subTest(option=option):
                self.fit_refused(option, value, says=[f"'{value}'", nearest])

    def test_options_that_mean_nothing_to_a_solver(self):
        for solver, *option in (
            ("two-step", "--engine", "fragment"), ("two-step", "--passes", "paper"), ("two-step", "--source", "disk"),
            ("pca", "--deflate"), ("pca", "--optimizer", "sd"), ("pca", "--mu", "2"), ("pca", "--records", "r"),
            ("mean", "--terms", "3"), ("als", "--optimizer", "sd"), ("varpro", "--deflate"), ("ceres", "--record", "full"),
            ("stream", "--memory", "64M"), ("stream", "--ceres", "cgnr"), ("stream", "--passes", "paper"),
            ("stream", "--storage", "fp16"), ("stream", "--sums", "fp16"),
        ):
            self.fit_refused("--solver", solver, *option,
                             says=[f"{option[0]} means nothing to ", solver.replace("stream", "engine"), "leave it out"])
        self.fit_refused("--engine", "fragment", "--distributor", "gl", says=["--distributor", "engine fragment"])

    def test_unknown_option_and_missing_ones(self):
        self.fit_refused("--itterations", "3", says=["--itterations", "see radiafit --help"])
        self.refused("fit", "star", says=["--output is required", "see radiafit --help"])
        self.refused("import", "colmap", "-o", "new", says=["--model is required"])
        self.refused(says=["subcommand", "see radiafit --help"])
        self.refused("generate", "cube", "-o", "new", says=['"cube"', "star, bust and ornament"])
        self.refused("generate", "star", "--scale", "huge", "-o", "new", says=['"huge"', "smoke, standard and paper"])

    def test_device_out_of_range(self):
        for context in ("egl", "osmesa"):
            says = ["--device", "out of range", "radiafit devices"]
            self.fit_refused("--engine", "fragment", "--context", context, "--device", "99", says=says)

    def test_context_below_4_5(self):
        for arguments in (("--engine", "fragment"), ("--engine", "fragment", "--context", "osmesa"), ("--distributor", "gl")):
            says = ["offers OpenGL 3.3, but 4.5 core is needed", "update the driver, or choose another --context"]
            self.fit_refused(*arguments, says=says, environment=OLD_GL)


class Fits(BadInput):
    def test_fit_of_another_dataset(self):
        self.good("generate", "star", "--seed", "2", "-o", "other")
        self.addCleanup(shutil.rmtree, self.root / "other")
        for command in (["judge", "fit", "--dataset", "other"], ["judge", "fit", "--json", "--dataset", "other"]):
            self.refused(*command, says=["other: differs from the dataset that was fitted", "name the right folder"])

    def test_dataset_that_moved(self):
        moved = self.copy("fit", "moved")
        text = (moved / "fit.json").read_text().replace('"../star"', '"../gone"')
        (moved / "fit.json").write_text(text)
        for command in (["judge", "moved"], ["render", "moved", "-o", "picture"]):
            self.refused(*command, says=["gone: the dataset of this fit (star) is no longer there", "move it back"])

    def test_no_fit(self):
        for command in ("judge",), ("render", "-o", "picture"):
            self.refused(*command, "nowhere", says=["nowhere: no such folder", "radiafit fit writes one"])
            self.refused(*command, "star", says=["star/fit.json: no such file", "give a folder that radiafit fit wrote"])

    def test_damaged_map(self):
        damaged = self.copy("fit", "damaged")
        view = damaged / "view_term0.exr"
        view.write_bytes(view.read_bytes()[:-100])
        self.refused("judge", "damaged", says=["damaged/view_term0.exr: ", "write it again"])

    def test_options(self):
        self.refused("judge", "fit", "--split", "all", says=["split 'all'", "choose train, test or validation"])
        self.refused("render", "fit", "--view", "24", "-o", "picture", says=["--view 24", "0 to 23"])
        self.refused("render", "fit", "--turntable", "0", "-o", "picture", says=["--turntable", "range 1 to 10000"])

    def test_nothing_held_out(self):
        capture = "import colmap --model capture/sparse --images capture/images --mesh capture/mesh.ply"
        self.good(*capture.split(), "--holdout", "none", "-o", "whole")
        self.addCleanup(shutil.rmtree, self.root / "whole")
        self.good("fit", "whole", "--iterations", "1", "-o", "whole_fit")
        self.addCleanup(shutil.rmtree, self.root / "whole_fit")
        self.refused("judge", "whole_fit", says=["whole", "train"])


if __name__ == "__main__":
    (ProgramTest.program,) = take_arguments(1)
    unittest.main()
