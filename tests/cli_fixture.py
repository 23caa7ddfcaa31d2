"""What the tests of the programs share: running them, and captures written by hand. Standard library only."""
import hashlib
import itertools
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib


# Programs in the background of a shell ignore SIGINT, and so would all that they start: here it is taken, as in front.
signal.signal(signal.SIGINT, signal.default_int_handler)

# What many tests begin with: made once for all of them by the test `datasets` (shared_datasets.py) in the folder that
# RADIAFIT_DATASETS names.
SHARED = {"star": ("star",), "ornament": ("ornament",), "ornament-f32": ("ornament", "--encoding", "f32-linear")}


def take_arguments(count):
    """The first `count` arguments of the test's command line: programs and folders. The rest is unittest's."""
    if len(sys.argv) <= count:
        sys.exit(f"usage: {sys.argv[0]} needs {count} arguments; CTest gives them")
    taken = [pathlib.Path(a).resolve() for a in sys.argv[1 : 1 + count]]
    del sys.argv[1 : 1 + count]
    return taken


DIGESTS = {}  # of files as they were, by what every write to one changes


def digest(path):
    status = path.stat()
    version = (status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
    if version not in DIGESTS:
        DIGESTS[version] = hashlib.sha1(path.read_bytes()).hexdigest()
    return DIGESTS[version]


def snapshot(folder):
    """Every file below `folder` with a digest of its bytes, every folder with None."""
    return {str(path.relative_to(folder)): digest(path) if path.is_file() else None for path in folder.rglob("*")}


def complaints(stderr):
    """Its lines, without those that say what a command needs, and what it chose."""
    return [line for line in stderr.splitlines() if not re.match("(fit|solve|import|generate|depths) needs about |chosen by the data: ", line)]


def python_with(module):
    """An interpreter that has the module: this one, or the system's, for which Debian packages modules; None: neither."""
    for python in (sys.executable, "/usr/bin/python3"):
        if shutil.which(python) and subprocess.run([python, "-c", f"import {module}"], stderr=subprocess.DEVNULL).returncode == 0:
            return python
    return None


class ProgramTest(unittest.TestCase):
    """Programs run in `root`, a temporary folder that the tests of a class share."""

    program = None

    @classmethod
    def setUpClass(cls):
        cls.root = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-cli-"))
        cls.addClassCleanup(shutil.rmtree, cls.root)

    @classmethod
    def run_program(cls, *arguments, environment=None, program=None, preexec_fn=None, cwd=None):
        return subprocess.run(
            [str(program or cls.program), *map(str, arguments)],
            cwd=cwd or cls.root,
            env={**os.environ, **(environment or {})},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            preexec_fn=preexec_fn,
        )

    @classmethod
    def good(cls, *arguments, **options):
        result = cls.run_program(*arguments, **options)
        if result.returncode != 0:
            raise AssertionError(f"{arguments}: status {result.returncode}: {result.stderr}")
        return result

    @classmethod
    def compiler_with(cls, option):
        """A C++ compiler for CXX that is told `option` last: one that optimizes less is quicker."""
        path = cls.root / f"compiler{option}"
        path.write_text(f'#!/bin/sh\nexec {os.environ.get("CXX") or "c++"} "$@" {option}\n')
        path.chmod(0o755)
        return str(path)

    @classmethod
    def dataset(cls, shared, name=None, **options):
        """One of SHARED in root, by default under its shape's name: a copy, or made here if no test made it before."""
        shape, made = SHARED[shared][0], os.environ.get("RADIAFIT_DATASETS")
        if made:
            shutil.copytree(pathlib.Path(made, shared), cls.root / (name or shape))
        else:
            cls.good("generate", *SHARED[shared], "-o", name or shape, **options)

    def refused(self, *arguments, says, **options):
        """The user's mistake: status 2, one line with all of `says`, nothing on standard output, and not a file or
        folder made, changed or lost."""
        before = snapshot(self.root)
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(len(complaints(result.stderr)), 1, result.stderr)
        self.assertTrue(result.stderr.endswith("\n"))
        for text in says:
            self.assertIn(text, result.stderr)
        self.assertEqual(before, snapshot(self.root))

    @classmethod
    def flat_sample(cls, name, count=12, size=8, noise=()):
        """A packed grid under lamps: pixel (x, y) has albedo (x + 1) / 10 in red. The images `noise` show none of it."""
        random_bytes = random.Random(7).randbytes
        folder = cls.root / name
        folder.mkdir()
        lights = []
        for i in range(count):
            angle, z = 2 * math.pi * i / count, 0.4 + 0.55 * i / (count - 1)
            r = math.sqrt(1 - z * z)
            lights.append((r * math.cos(angle), r * math.sin(angle), z))
            pixels = [min(255, round(255 * z * albedo)) for y in range(size) for x in range(size)
                      for albedo in ((x + 1) / 10, 0.5, (y + 1) / 10)]
            write_png(folder / f"{i:02}.png", size, size, random_bytes(len(pixels)) if i in noise else bytes(pixels))
        (cls.root / f"{name}.txt").write_text("".join(f"{x} {y} {z}\n" for x, y, z in lights))
        cls.good("import", "lights", "--images", name, "--lights", f"{name}.txt", "--transfer", "linear", "-o",
                 f"{name}-set")
        return f"{name}-set"


def write_png(path, width, height, rgb, depth=8):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    stride = 3 * width * depth // 8
    rows = b"".join(b"\0" + rgb[stride * y : stride * (y + 1)] for y in range(height))
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, 2, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


def read_png(png):
    """Width, height and bytes of an 8-bit RGB image without interlacing; an alpha channel is left out. png: a path or bytes."""
    width, height, form, rows = png_rows(png)
    if form not in ((8, 2), (8, 6)):
        raise AssertionError(f"{png if isinstance(png, pathlib.Path) else 'PNG'}: not plain 8-bit RGB: {form}")
    return width, height, b"".join(row if form[1] == 2 else bytes(value for i, value in enumerate(row) if i % 4 < 3) for row in rows)


def read_grey16(path):
    """Width, height and numbers of a 16-bit grey image without interlacing."""
    width, height, form, rows = png_rows(path)
    if form != (16, 0):
        raise AssertionError(f"{path}: not 16-bit grey: {form}")
    return width, height, [value for row in rows for value in struct.unpack(f">{width}H", row)]


def png_rows(png):
    """Width, height, (bits, kind of colour) and rows of bytes."""
    data = png if isinstance(png, bytes) else png.read_bytes()
    at, packed = 8, b""
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, *form, packing, filtering, interlaced = struct.unpack(">IIBBBBB", body)
            assert (packing, filtering, interlaced) == (0, 0, 0), "PNG: interlaced, or of another kind"
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    apart = {0: 1, 2: 3, 4: 2, 6: 4}[form[1]] * form[0] // 8  # bytes to the pixel on the left
    raw, stride, rows = zlib.decompress(packed), apart * width, []
    above = bytes(stride)
    for y in range(height):
        above = unfiltered(raw[y * (stride + 1)], raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)], above, apart)
        rows.append(above)
    return width, height, tuple(form), rows


def unfiltered(method, row, above, apart):
    """A row of a PNG, of which the file has differences: to the pixel on the left, `apart` bytes before; to the row above; ..."""
    if method == 0:
        return row
    if method == 1:
        out = bytearray(len(row))
        for channel in range(apart):
            out[channel::apart] = bytes(x & 255 for x in itertools.accumulate(row[channel::apart]))
        return bytes(out)
    if method == 2:
        return bytes((x + b) & 255 for x, b in zip(row, above))
    out = bytearray(apart) + row  # as if there were a black pixel on the left
    if method == 3:
        for i, b in enumerate(above, apart):
            out[i] = (out[i] + ((out[i - apart] + b) >> 1)) & 255
    else:
        for i, (b, c) in enumerate(zip(above, bytes(apart) + above), apart):
            a = out[i - apart]
            from_a, from_b, from_c = abs(b - c), abs(a - c), abs(a + b - 2 * c)
            if from_a <= from_b and from_a <= from_c:
                out[i] = (out[i] + a) & 255
            else:
                out[i] = (out[i] + (b if from_b <= from_c else c)) & 255
    return bytes(out[apart:])


def quaternion(r):
    """(w, x, y, z) of a rotation's rows; the largest component is found first, so nothing cancels."""
    squares = [
        1 + r[0][0] + r[1][1] + r[2][2],
        1 + r[0][0] - r[1][1] - r[2][2],
        1 - r[0][0] + r[1][1] - r[2][2],
        1 - r[0][0] - r[1][1] + r[2][2],
    ]
    largest = squares.index(max(squares))
    s = 2 * math.sqrt(squares[largest])
    x, y, z = r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]
    xy, xz, yz = r[0][1] + r[1][0], r[0][2] + r[2][0], r[1][2] + r[2][1]
    return [v / s for v in ([s * s / 4, x, y, z], [x, s * s / 4, xy, xz], [y, xy, s * s / 4, yz], [z, xz, yz, s * s / 4])[largest]]


def write_capture(dataset, out):
    """A u8-srgb dataset without masks, taken apart into what `radiafit import colmap` reads: PNGs, a text model, a mesh."""
    description = json.loads((dataset / "dataset.json").read_text())
    pixels = (dataset / "images.bin").read_bytes()
    (out / "images").mkdir(parents=True)
    (out / "sparse").mkdir()
    shutil.copy(dataset / "mesh.ply", out / "mesh.ply")
    cameras, images = ["# CAMERA_ID MODEL WIDTH HEIGHT PARAMS"], ["# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME"]
    for i, view in enumerate(description["views"], 1):
        c, at = view["camera"], view["pixel_offset"]
        name = view["name"] + ".png"
        write_png(out / "images" / name, c["width"], c["height"], pixels[at : at + 3 * c["width"] * c["height"]])
        pinhole = " ".join(repr(c[key]) for key in ("fx", "fy", "cx", "cy"))
        cameras.append(f"{i} PINHOLE {c['width']} {c['height']} {pinhole}")
        pose = [*quaternion(c["cam_from_world_rotation"]), *c["cam_from_world_translation"]]
        images += [f"{i} {' '.join(map(repr, pose))} {i} {name}", ""]
    (out / "sparse" / "cameras.txt").write_text("\n".join(cameras) + "\n")
    (out / "sparse" / "images.txt").write_text("\n".join(images) + "\n")


def surface_points(dataset):
    """Vertices of a dataset's mesh and centres of its triangles, as a calibration has points: each with its track, those views,
    counted from 1, whose cameras it faces, three at least."""
    header, body = (dataset / "mesh.ply").read_bytes().split(b"end_header\n", 1)
    count, triangles = (int(re.search(rb"element %s (\d+)" % kind, header)[1]) for kind in (b"vertex", b"face"))
    vertices = [struct.unpack_from("<3f", body, 12 * i) for i in range(count)]
    normals = [[0.0] * 3 for _ in vertices]
    for i in range(triangles):
        corners = struct.unpack_from("<3I", body, 12 * count + 13 * i + 1)
        a, b, c = (vertices[k] for k in corners)
        u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
        for axis, n in enumerate((u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])):
            for k in corners:
                normals[k][axis] += n
        vertices.append([(x + y + z) / 3 for x, y, z in zip(a, b, c)])
        normals.append([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
    centres = []
    for view in json.loads((dataset / "dataset.json").read_text())["views"]:
        r, t = view["camera"]["cam_from_world_rotation"], view["camera"]["cam_from_world_translation"]
        centres.append([-sum(r[k][i] * t[k] for k in range(3)) for i in range(3)])
    points = []
    for p, n in zip(vertices, normals):
        track = []
        for i, centre in enumerate(centres, 1):
            d = [c - x for c, x in zip(centre, p)]
            if sum(a * b for a, b in zip(d, n)) > 0.5 * math.dist(centre, p) * math.hypot(*n):
                track.append(i)
        if len(track) >= 3:
            points.append((p, track))
    return points


def write_points(dataset, sparse):
    """These points, in a text model that write_capture wrote of the dataset."""
    lines = [f"{id} {' '.join(map(repr, at))} 9 9 9 0.4 " + " ".join(f"{image} {id}" for image in track)
             for id, (at, track) in enumerate(surface_points(dataset))]  # fmt: skip
    (sparse / "points3D.txt").write_text("\n".join(lines) + "\n")
