"""Good inputs that the rows damage: small, made once, copied for each row that names them."""
import base64
import json
import math
import shutil
import struct

from cli_fixture import quaternion, write_png

CONFIGS = "experiments"  # the fixture that holds the experiments' config files


def write_pfm(path, width, height, values):
    """Rows bottom to top, three values per pixel."""
    path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + struct.pack(f"<{3 * width * height}f", *values))


def tiff(width, height, data, kind=2):
    """An uncompressed TIFF of one strip, little-endian: kind 2 is RGB of 8 bits, 3 of floats."""
    bits, format = (8, 1) if kind == 2 else (32, 3)
    entries = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 3, 0), (259, 3, 1, 1), (262, 3, 1, 2), (273, 4, 1, 0),
               (277, 3, 1, 3), (278, 3, 1, height), (279, 4, 1, len(data)), (339, 3, 3, 0)]  # fmt: skip
    behind = 8 + 2 + 12 * len(entries) + 4
    offsets = {258: behind, 339: behind + 6, 273: behind + 12}
    table = b"".join(struct.pack("<HHII", t, k, n, offsets.get(t, v)) for t, k, n, v in entries)
    return (b"II*\0" + struct.pack("<I", 8) + struct.pack("<H", len(entries)) + table + bytes(4)
            + struct.pack("<6H", *[bits] * 3, *[format] * 3) + data)  # fmt: skip


def exr(width, height, values):
    """An uncompressed scan-line EXR with channels B, G and R of 32 bits; values: three per pixel, red first."""

    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data

    channel = b"".join(c + b"\0" + struct.pack("<IIII", 2, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = struct.pack("<II", 20000630, 2)
    head += attribute(b"channels", b"chlist", channel) + attribute(b"compression", b"compression", b"\0")
    head += attribute(b"dataWindow", b"box2i", window) + attribute(b"displayWindow", b"box2i", window)
    head += attribute(b"lineOrder", b"lineOrder", b"\0") + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", bytes(8)) + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
    head += b"\0"
    line = 8 + 12 * width
    at = len(head) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(at + y * line for y in range(height)))
    body = b""
    for y in range(height):
        row = values[3 * width * y : 3 * width * (y + 1)]
        body += struct.pack("<iI", y, 12 * width) + b"".join(struct.pack(f"<{width}f", *row[c::3]) for c in (2, 1, 0))
    return head + offsets + body


# A grey baseline JPEG of 6 x 5 pixels.
JPEG = base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABALDA4MChAODQ4SERATGCgaGBYWGDEjJR0oOjM9PDkzODdASFxOQERXRTc4UG1RV19iZ2hnPk1xeXBkeFxl"
    "Z2P/wAALCAAFAAYBAREA/8QAFAABAAAAAAAAAAAAAAAAAAAABP/EABkQAAEFAAAAAAAAAAAAAAAAAAACBAUTgf/aAAgBAQAAPwBcK2RTh//Z"
)


def write_binary_model(text, out):
    """The COLMAP model of a text folder, in binary files."""
    out.mkdir()
    cameras = [line.split() for line in (text / "cameras.txt").read_text().splitlines() if not line.startswith("#")]
    data = struct.pack("<Q", len(cameras))
    for id, _, width, height, *parameters in cameras:
        data += struct.pack("<IiQQ4d", int(id), 1, int(width), int(height), *map(float, parameters))
    (out / "cameras.bin").write_bytes(data)
    images = [line.split() for line in (text / "images.txt").read_text().splitlines() if line and line[0] != "#"]
    data = struct.pack("<Q", len(images))
    for id, *pose, camera, name in images:
        data += struct.pack("<I7dI", int(id), *map(float, pose), int(camera)) + name.encode() + b"\0" + struct.pack("<Q", 0)
    (out / "images.bin").write_bytes(data)


def write_lit(out):
    """What `import lights` reads: four images of 6 x 5 pixels under a lamp each, in several formats."""
    (out / "images").mkdir(parents=True)
    values = [(7 * i % 90 + 40) / 255 for i in range(90)]
    levels = bytes(int(255 * v) for v in values)
    for i in range(4):
        write_png(out / f"images/{i}.png", 6, 5, levels)
        for kind in ("pfm", "exr", "tif", "jpg"):
            (out / kind).mkdir(exist_ok=True)
        write_pfm(out / f"pfm/{i}.pfm", 6, 5, values)
        (out / f"exr/{i}.exr").write_bytes(exr(6, 5, values))
        (out / f"tif/{i}.tif").write_bytes(tiff(6, 5, levels))
        (out / f"jpg/{i}.jpg").write_bytes(JPEG)
    vectors = ["0 0 1", "0.6 0 0.8", "0 0.6 0.8", "-0.6 0 0.8"]
    (out / "lights.txt").write_text("\n".join(vectors) + "\n")
    (out / "places.txt").write_text("0 0 10\n5 0 8\n0 5 8\n-5 0 8\n")
    (out / "eyes.txt").write_text("0 0 12\n")
    (out / "names.txt").write_text("0.png\n1.png\n2.png\n3.png\n")
    (out / "intensities.txt").write_text("1 1 1\n")
    (out / "dome.lp").write_text("4\n" + "".join(f"{i}.png {v}\n" for i, v in enumerate(vectors)))
    write_png(out / "mask.png", 6, 5, b"\xff" * 90)
    write_pfm(out / "normals.pfm", 6, 5, [0, 0, 1] * 30)


def write_rti(out):
    """What `import rti` reads, of 6 x 5 pixels: .ptm of both kinds and of JPEG planes, .rti, relight's folders."""
    out.mkdir()
    head = "PTM_1.2\nPTM_FORMAT_{}\n6\n5\n2 2 2 2 2 2 \n160 160 160 127 127 0\n"
    values = bytes(7 * i % 90 + 100 for i in range(540))
    (out / "lrgb.ptm").write_bytes(head.format("LRGB").encode() + values[:270])
    (out / "rgb.ptm").write_bytes(head.format("RGB").encode() + values)
    lists = ["0 0 1" + 6 * " 0", "0" + 8 * " 0", "0" + 8 * " 0", "0 1 2 3 4 5 6 7 8", "-1 -1 0" + 6 * " -1",
             " ".join([str(len(JPEG))] * 9), "0 0 5" + 6 * " 0"]  # fmt: skip
    (out / "jpeg.ptm").write_bytes((head.format("JPEG_LRGB") + "90\n" + "\n".join(lists) + "\n").encode()
                                   + b"".join(JPEG + (b"\0\0\0\7z" if i == 2 else b"") for i in range(9)))
    floats = struct.pack("<8f", 1, 1, 1, 1, 0.2, -0.5, -0.5, -0.5)
    (out / "hsh.rti").write_bytes(b"#HSH1.2\r\n3\r\n6 5 3\r\n4 2 1\r\n" + floats + values[:360])
    info = {"width": 6, "height": 5, "format": "jpg", "type": "ptm", "colorspace": "lrgb", "nplanes": 9,
            "materials": [{"scale": [1.2] * 9, "bias": [0.1] * 9, "range": [300] * 9}]}  # fmt: skip
    bilinear = {**info, "type": "bilinear", "colorspace": "mrgb", "resolution": 2, "basis": [99] * 120}
    rbf = {**info, "type": "rbf", "colorspace": "mycc", "yccplanes": [3, 3, 3], "lights": [0, 0, 1, 0.6, 0, 0.8], "basis": [99] * 60}
    for name, text in (("lptm", info), ("bilinear", bilinear), ("rbf", rbf)):
        (out / name).mkdir()
        (out / name / "info.json").write_text(json.dumps(text))
        for i in range(3):
            (out / name / f"plane_{i}.jpg").write_bytes(JPEG)


def npy(descr, shape, data):
    """An array as numpy.save writes it."""
    header = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': ({', '.join(map(str, shape))}{',' if len(shape) == 1 else ''}), }}"
    header = header.ljust(117) + "\n"
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header.encode() + data


def write_sets(out):
    """What `solve` reads: a line's text, two sets of samples as a table, as arrays of one length and of several."""
    out.mkdir()
    (out / "line.glsl").write_text("// A line.\nstruct Terms { real x; };\nstruct Parameters { real slope, offset; };\nstruct Values { real y; };\n"
                                   "Values value(Parameters p, Terms t) {\n    return Values(p.slope * t.x + p.offset);\n}\n")  # fmt: skip
    (out / "lines.csv").write_text("problem,x,y\na,0,1\na,1,3\na,2,5.5\nb,0,-1\nb,1,0\nb,3,2\n")
    for name, count in (("even", 8), ("started", 8), ("ragged", 5)):
        (out / name).mkdir()
        samples = (2, 4) if count == 8 else (5,)
        (out / name / "terms.npy").write_bytes(npy("<f8", (*samples, 1), struct.pack(f"<{count}d", *(i % 4 for i in range(count)))))
        (out / name / "targets.npy").write_bytes(npy("<f8", samples, struct.pack(f"<{count}d", *(i * i for i in range(count)))))
    (out / "started/start.npy").write_bytes(npy("<f8", (2,), struct.pack("<2d", 1, 0)))
    (out / "ragged/offsets.npy").write_bytes(npy("<i8", (3,), struct.pack("<3q", 0, 2, 5)))


def write_other_calibrations(out):
    """The same cameras as a NeRF's transforms.json and as LLFF's poses_bounds.npy."""
    frames, rows = [], []
    for i, angle in enumerate((-0.3, 0, 0.3)):
        c, s = math.cos(angle), math.sin(angle)
        right, down, forward = (c, 0, -s), (0, -1, 0), (-s, 0, -c)
        eye = [-4 * f for f in forward]
        matrix = [[right[k], -down[k], -forward[k], eye[k]] for k in range(3)] + [[0, 0, 0, 1]]
        frames.append({"file_path": f"images/{i}", "transform_matrix": matrix})
        rows += [v for k in range(3) for v in (down[k], right[k], -forward[k], eye[k], (16, 16, 20)[k])] + [1, 9]
    (out / "transforms.json").write_text(json.dumps({"fl_x": 20, "w": 16, "h": 16, "frames": frames}))
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 17), }".ljust(117) + "\n"
    (out / "poses_bounds.npy").write_bytes(
        b"\x93NUMPY\x01\0" + struct.pack("<H", 118) + header.encode() + struct.pack("<51d", *rows))


def write_tiny(out):
    """What `import colmap` reads, by hand: two triangles, three photographs of 16 x 16 pixels."""
    (out / "images").mkdir(parents=True)
    (out / "masks").mkdir()
    (out / "text").mkdir()
    cameras, images = [], []
    for i, angle in enumerate((-0.3, 0, 0.3)):
        c, s = math.cos(angle), math.sin(angle)
        pose = quaternion([[c, 0, -s], [0, -1, 0], [-s, 0, -c]])
        cameras.append(f"{i + 1} PINHOLE 16 16 20 20 8 8")
        images += [f"{i + 1} {' '.join(map(repr, pose))} 0 0 4 {i + 1} {i}.png", ""]
        write_png(out / f"images/{i}.png", 16, 16, bytes((x * 11 + i) % 200 for x in range(768)))
        write_png(out / f"masks/{i}.png", 16, 16, b"\xff" * 768)
    (out / "text/cameras.txt").write_text("\n".join(cameras) + "\n")
    (out / "text/images.txt").write_text("\n".join(images) + "\n")
    write_binary_model(out / "text", out / "binary")
    write_other_calibrations(out)
    points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    (out / "mesh.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in points) + "f 1 2 3\nf 1 3 4\n")
    head = "ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    body = "".join(f"{x} {y} {z}\n" for x, y, z in points) + "3 0 1 2\n3 0 2 3\n"
    (out / "ascii.ply").write_text(head.format("ascii") + body)
    packed = b"".join(struct.pack("<3f", *p) for p in points)
    packed += struct.pack("<B3iB3i", 3, 0, 1, 2, 3, 0, 2, 3)
    (out / "binary.ply").write_bytes(head.format("binary_little_endian").encode() + packed)
    (out / "gains.txt").write_text("0.png 1\n1.png 1.1\n2.png 0.9\n")
    write_stereo(out)


def write_stereo(out):
    """What steps of `capture` read beside the model: 40 points on the square, all of them in every photograph; depth and
    normal maps of it, as `capture depths` writes them; masks of another size."""
    points = [(i % 8 / 4 - 0.9, i // 8 / 3 - 0.6, 0.0) for i in range(40)]
    lines, data = [], struct.pack("<Q", len(points))
    for i, point in enumerate(points):
        lines.append(f"{i} {' '.join(map(repr, point))} 9 9 9 0.5 " + " ".join(f"{image} {i}" for image in (1, 2, 3)))
        data += struct.pack("<Q3d3BdQ", i, *point, 9, 9, 9, 0.5, 3) + struct.pack("<6I", 1, i, 2, i, 3, i)
    (out / "text/points3D.txt").write_text("\n".join(lines) + "\n")
    (out / "binary/points3D.bin").write_bytes(data)
    (out / "stereo/depth_maps").mkdir(parents=True)
    (out / "stereo/normal_maps").mkdir()
    for i, angle in enumerate((-0.3, 0, 0.3)):
        normal = (-math.sin(angle), 0, -math.cos(angle))
        depths = [4 * normal[2] / (normal[0] * (x - 8) / 20 + normal[2]) for _ in range(16) for x in range(16)]
        (out / f"stereo/depth_maps/{i}.png.geometric.bin").write_bytes(b"16&16&1&" + struct.pack("<256f", *depths))
        normals = [v for v in normal for _ in range(256)]
        (out / f"stereo/normal_maps/{i}.png.geometric.bin").write_bytes(b"16&16&3&" + struct.pack("<768f", *normals))
    (out / "small-masks").mkdir()
    for i in range(3):
        write_png(out / f"small-masks/{i}.png", 8, 8, b"\xff" * 192)


def write_run(folder, experiment, file, rows, **record):
    """What an experiment leaves: its record, and one file of rows, the header first."""
    folder.mkdir(parents=True)
    record = {"program": experiment, "utc_start": "2024-01-01T00:00:00Z", "git_revision": "abc", "profile": "smoke",
              "compiler": "c", "cpu": "C", "cores": 2, "threads": 2, "config": {}} | record  # fmt: skip
    (folder / "run.json").write_text(json.dumps(record))
    (folder / file).write_text("".join(",".join(row) + "\n" for row in rows))


def write_runs(out):
    """Two runs of one experiment, one of another."""
    header = ["dataset", "method", "terms", "train_psnr_db", "seconds"]
    for name in ("a", "b"):
        write_run(out / name, "fig9_error", "errors.csv", [header, ["star", "mean", "1", "21.4", "0.1"], ["bust", "mean", "1", "22.5", "0.1"]])
    write_run(out / "other", "scaling", "slopes.csv", [["of", "engine", "slope"], ["bytes", "cpu", "1"]])


def write_stopped(run, folder):
    """What a fit of tiny, stopped, leaves: a part that is finished, and a journal that holds no block yet."""
    run("fit", "tiny", "--terms", "1", "--iterations", "1", "--shard", "1/1", "-o", folder.name)
    (part,) = folder.glob("part-*.bin")
    part.rename(folder / "part-a.bin")
    (folder / "whole.journal").write_text(json.loads((folder / "shard.json").read_text())["key"] + "\n")
    (folder / "shard.json").unlink()


PHOTOS = "--model photos/text --images photos/images --mesh photos/mesh.obj"
# A command, an output of it that is a fixture, and the options, or the command, of another output.
MADE = [
    ("generate ornament", "orb", "--seed 2"),
    (f"import colmap {PHOTOS} --holdout every:3", "tiny", f"import colmap {PHOTOS} --holdout none"),
    ("import transforms --model photos/transforms.json --mesh photos/mesh.obj", "made/nerf", "--holdout none"),
    ("import llff --model photos/poses_bounds.npy --mesh photos/mesh.obj", "made/llff", "--holdout none"),
    ("import lights --images lit/pfm --lights lit/lights.txt --holdout every:4", "floats", "import lights --images lit/pfm --lights lit/lights.txt"),
    ("import rti rti/lrgb.ptm --dataset flat", "made/rti", "--curve linear"),
    ("fit tiny --terms 1 --iterations 1", "fit", "fit tiny --terms 2 --iterations 1"),
    ("fit whole --iterations 1", "wholefit", "fit whole --iterations 2"),
    ("merge made/shard", "made/merged", "merge made/other-shard"),
    ("capture depths --model photos/text --images photos/images", "made/stereo", "--seed 2"),
    ("capture cut-mesh photos/mesh.obj --model photos/text --depths photos/stereo --support 0", "made/cut.ply", "--close 2"),
    ("capture preview --model photos/text --images photos/images", "made/preview.png", "--mesh photos/mesh.obj"),
    ("capture masks photos/mesh.obj --model photos/text", "made/masks", "--inset 1"),
    ("export problems tiny", "made/problems", "--terms 1"),
    ("export parameters fit", "made/parameters", "export parameters wholefit"),
    ("export gltf fit", "made/a.glb", "--without-maps"),
    ("export rti flatfit", "made/relight", "--quality 50"),
    ("export maps flatfit", "made/maps", "--normals fit"),
    ("render fit", "made/view", "--view 1"),
    ("render flatfit --problems", "made/ended", "render orbfit --problems"),
    ("render fit --turntable 1", "made/turns", "--size 9x9"),
    ("render wholefit --all train", "made/all", "--size 9x9"),
]
# A command, and an output of its kind that tells nothing: an older version's, or of a program without the viewer.
UNMADE = [
    ("publish fit", "made/page", "--replace"),
    ("publish fit --single-file", "made/page.html", "--replace"),
    ("export gltf fit", "made/old.glb", "--replace"),
    ("render fit", "made/old-view.png", "made/old-view.png: is there already", "--replace"),
    ("capture masks photos/mesh.obj --model photos/text", "made/page", "radiafit capture masks replaces only what it made: remove it"),
    ("capture cut-mesh photos/mesh.obj --model photos/text --depths photos/stereo", "made/page.html", "remove it"),
    ("export problems tiny", "made/page", "remove it"),
]


def write_unmade(out):
    page = '<meta name="generator" content="radiafit-page">'
    for folder in ("page", "shared"):
        (out / folder).mkdir(parents=True)
    (out / "page/index.html").write_text(page)
    (out / "page.html").write_text(page)
    (out / "old.glb").write_bytes(b'glTF {"asset":{"generator":"radiafit 0"}')
    (out / "old-view.png").write_bytes(b"radiafit_render")


# A fixture that a fit was made from must stand beside it.
NEEDS = {
    CONFIGS: ["paper_figs"],
    "fit": ["tiny"], "wholefit": ["whole"], "flatfit": ["flat"], "lightfit": ["flat"], "orbfit": ["orb"], "stopped.parts": ["tiny"], "records": ["tiny"], "texrecords": ["flat"],
    "made": ["tiny", "whole", "flat"],
}  # fmt: skip


def make(run, root, source):
    """All fixtures below `root`; run(command...) runs radiafit there, source is the checkout."""
    write_tiny(root / "photos")
    write_lit(root / "lit")
    write_rti(root / "rti")
    write_sets(root / "sets")
    write_runs(root / "runs")
    photos = ("import", "colmap", "--model", "photos/text", "--images", "photos/images", "--mesh", "photos/mesh.obj")
    run(*photos, "--holdout", "every:3", "-o", "tiny")
    run(*photos, "--holdout", "none", "-o", "whole")
    run("import", "lights", "--images", "lit/images", "--lights", "lit/lights.txt", "--normals", "lit/normals.pfm",
        "--holdout", "every:4", "-o", "flat")  # fmt: skip
    run("import", "lights", "--images", "lit/pfm", "--lights", "lit/lights.txt", "--holdout", "every:4", "-o", "floats")
    run("generate", "ornament", "-o", "orb")
    run("fit", "tiny", "--terms", "1", "--iterations", "1", "-o", "fit")
    run("fit", "whole", "--iterations", "1", "-o", "wholefit")
    run("fit", "tiny", "--iterations", "1", "--solver", "two-step", "--records", "records", "-o", "records-fit")
    shutil.rmtree(root / "records-fit")
    run("fit", "flat", "--model", "lafortune", "--solver", "two-step", "--records", "texrecords", "-o", "flatfit")
    run("fit", "flat", "--model", "lightbasis", "--numbers", "3", "-o", "lightfit")
    run("fit", "orb", "--model", "lambert", "-o", "orbfit")
    write_stopped(run, root / "stopped.parts")
    for name, terms in (("shard", 1), ("other-shard", 2)):
        run("fit", "tiny", "--terms", str(terms), "--iterations", "1", "--shard", "1/1", "-o", f"made/{name}")
    for command, output, _ in MADE:
        if output.startswith("made/"):
            run(*command.split(), "-o", output)
    write_unmade(root / "made")
    (root / CONFIGS).mkdir()
    for config in (source / "experiments").glob("*.toml"):
        shutil.copy(config, root / CONFIGS)
    (root / "paper_figs").mkdir()  # both make a checkout


def closure(names):
    """With what they need beside them."""
    out = set()
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name not in out:
            out.add(name)
            waiting += NEEDS.get(name, [])
    return out
