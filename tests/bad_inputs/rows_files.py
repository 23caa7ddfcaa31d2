"""Places: outputs that may not be written, and what stands where a file or a folder belongs."""
from bad_inputs.damage import copied, field, fifo, folder, link, loop, remove, unreadable, write

rows = []
colmap = "import colmap --model photos/text --images photos/images --mesh photos/mesh.obj"
lights = "import lights --images lit/images --lights lit/lights.txt"
makers = ("generate star", "fit tiny --iterations 1", colmap, lights, "fit flat --model lambert")
long = "n" * 300

# Outputs
for command in makers:
    rows += [
        (f"{command} -o photos/mesh.obj/new", None, 2, "photos/mesh.obj/new"),
        (f"{command} -o /proc/new", None, 2, "/proc/new"),
        (f"{command} -o {long}", None, 2, long),
        (f"{command} -o photos/mesh.obj", None, 2, "photos/mesh.obj: a file is there"),
        (f"{command} -o photos", None, 2, "photos: ", "choose another name"),
        (f"{command} -o around/new", loop("around"), 2, "around"),
    ]
for command in ("generate star", colmap, lights):
    rows += [
        (f"{command} -o fit", None, 2, "fit: holds ", "choose another name"),
        (f"{command} -o tiny", write("tiny/notes.txt", "mine"), 2, "tiny: holds notes.txt, which is no part of a dataset"),
        (f"{command} -o tiny", remove("tiny/dataset.json"), 2, "tiny: not a dataset, it has no dataset.json"),
        (f"{command} -o tiny", None, 2, "tiny: is there already, made by radiafit import colmap", "--replace puts this one in its place"),
        (f"{command} -o tiny --replace", None, 0, "dataset "),
    ]
for command in ("fit tiny --iterations 1", "fit flat --model lambert"):
    rows += [
        (f"{command} -o flat", None, 2, "flat: not a fit, it has no fit.json", "choose another name"),
        (f"{command} -o fit", write("fit/notes.txt", "mine"), 2, "fit: holds notes.txt, which is no part of a fit"),
        (f"{command} -o fit", write("fit/fit.json", "{}"), 2, "fit: holds ", "which is no part of a fit"),
        (f"{command} -o fit", write("fit/fit.json", "no JSON"), 2, "fit: holds ", "which is no part of a fit"),
        (f"{command} -o fit", None, 2, "fit: is there already, made by `radiafit fit tiny --terms 1 ", "--replace puts this one in its place"),
        (f"{command} -o fit --replace", None, 0, "see fit"),
    ]
for more in ("", "--turntable 1"):
    rows += [
        (f"render fit {more} -o photos/mesh.obj/new", None, 2, "photos/mesh.obj", "choose a writable folder"),
        (f"render fit {more} -o /proc/below/new", None, 2, "/proc/below", "choose a writable folder"),
        (f"render fit {more} -o below/{long}", None, 2, long),
        (f"render fit {more} -o around/new", loop("around"), 2, "around"),
    ]
rows += [
    # What failed before leaves the earlier output as it was.
    ("fit tiny -o fit --replace", field("tiny/dataset.json", "views[0].gain", 0), 2, "must be above 0"),
    (f"{colmap} -o tiny --replace", write("photos/mesh.obj", ""), 2, "photos/mesh.obj: empty mesh"),
    (f"{lights} -o flat --replace", write("lit/images/3.png", ""), 2, "lit/images/3.png: "),
    (f"{colmap} -o deep/below/new", write("photos/images/2.png", "x"), 2, "photos/images/2.png: neither PNG, JPEG, TIFF, OpenEXR"),
]

# Links that lead round
for command, path, *words in (
    ("info around", "around", "around"), ("fit around -o new", "around", "around"), ("plan around", "around", "around"),
    ("judge around", "around", "around"), ("render around -o new", "around", "around"), ("publish around -o new", "around", "around"),
    ("info tiny", "tiny/dataset.json", "tiny"), ("info tiny", "tiny/images.bin", "tiny/images.bin"),
    ("info tiny", "tiny/mesh.ply", "tiny/mesh.ply"), ("info flat", "flat/normals.f32", "flat/normals.f32"),
    ("judge fit", "fit/fit.json", "fit/fit.json"), ("judge fit", "fit/view_term0.exr", "fit/view_term0.exr"),
    (f"{colmap} -o new", "photos/text", "photos/text"), (f"{colmap} -o new", "photos/images", "photos/images"),
    (f"{colmap} -o new", "photos/mesh.obj", "photos/mesh.obj"), (f"{colmap} -o new", "photos/images/1.png", "photos/images/1.png"),
    (f"{colmap} -o new", "photos/text/cameras.txt", "photos/text"),
    (f"{colmap} --masks photos/masks -o new", "photos/masks", "photos/masks"),
    (f"{colmap} --gains photos/gains.txt -o new", "photos/gains.txt", "photos/gains.txt"),
    (f"{lights} -o new", "lit/images", "lit/images"), (f"{lights} -o new", "lit/lights.txt", "lit/lights.txt"),
    (f"{lights} --mask lit/mask.png -o new", "lit/mask.png", "lit/mask.png"),
    ("fit tiny --solver two-step --records around -o new", "around", "around"),
):  # fmt: skip
    rows.append((command, loop(path), 2, *words))

# Names that are too long
for command in (f"info {long}", f"fit {long} -o new", f"plan {long}", f"judge {long}", f"render {long} -o new", f"judge fit --dataset {long}",
                f"import colmap --model {long} --images photos/images --mesh photos/mesh.obj -o new",
                f"import colmap --model photos/text --images {long} --mesh photos/mesh.obj -o new",
                f"import colmap --model photos/text --images photos/images --mesh {long} -o new",
                f"import lights --images {long} --lights lit/lights.txt -o new", f"import lights --images lit/images --lights {long} -o new",
                f"{lights} --mask {long} -o new", f"{colmap} --gains {long} -o new", f"{colmap} --holdout {long} -o new",
                f"fit tiny --solver two-step --records {long} -o new"):  # fmt: skip
    rows.append((command, None, 2, "nnnn"))

# Names that a terminal would act on
for command, *words in (
    (r"info 'a\x1b[31mb'", "a\\x1b[31mb: no such folder"), (r"fit 'a\nb' -o new", "a\\nb: no such folder"),
    (r"judge '\x07'", "\\x07: no such folder"), (r"fit tiny --solver 'a\x1b]0;b' -o new", "solver 'a\\x1b]0;b' does not exist"),
    (r"fit tiny '--a\x1bb' -o new", "option '--a\\x1bb' does not exist"), (r"'ge\nnerate'", "command 'ge\\nnerate' does not exist"),
    (r"generate 'st\x7far' -o new", 'unknown shape "st\\x7far"'), (r"generate 'st\xffar' -o new", 'unknown shape "st\\xff'),
    (r"fit tiny --terms '1\n2' -o new", "terms = '1\\n2': choose"),
):  # fmt: skip
    command = command.encode().decode("unicode_escape").encode("latin-1").decode("utf-8", "surrogateescape")
    rows.append((command, None, 2, *words))
rows += [
    ("info tiny", field("tiny/dataset.json", "encoding", "u8\n\x1b[2J"), 2, '"encoding" is "u8\\n\\x1b[2J"'),
    ("info tiny", field("tiny/dataset.json", "name", "a\x1b[2Jb\nc"), 0, "dataset a\\x1b[2Jb\\nc: "),
    ("info tiny", field("tiny/dataset.json", "description", "a\x1bb"), 0, "a\\x1bb"),
    ("info fit", field("fit/fit.json", "dataset.name", "a\x1bb"), 0, "fit of a\\x1bb"),
    ("info tiny", field("tiny/dataset.json", "views[0].name", "a\nb\x1b"), 0, "3 views"),
]

# Files that nobody may read
for command, path in (
    ("info tiny", "tiny/dataset.json"), ("info tiny", "tiny/images.bin"), ("info tiny", "tiny/mesh.ply"), ("info flat", "flat/normals.f32"),
    ("info tiny", "tiny"), ("info fit", "fit/fit.json"), ("judge fit", "fit/fit.json"), ("info fit", "fit/problems.exr"), ("info fit", "fit"),
    ("judge fit", "fit"), ("judge fit", "tiny"), (f"{colmap} -o new", "photos/text"), (f"{colmap} -o new", "photos/text/cameras.txt"),
    (f"{colmap} -o new", "photos/images"), (f"{colmap} -o new", "photos/images/1.png"), (f"{colmap} -o new", "photos/mesh.obj"),
    (f"{lights} -o new", "lit/images"), (f"{lights} -o new", "lit/lights.txt"), (f"{lights} -o new", "lit/images/2.png"),
):  # fmt: skip
    rows.append((command, unreadable(path), 2, path))

# Pipes: nobody waits for somebody to write
for command, path in (
    ("info pipe", "pipe"), ("fit pipe -o new", "pipe"), ("plan pipe", "pipe"), ("judge pipe", "pipe"), ("render pipe -o new", "pipe"),
    ("info tiny", "tiny/dataset.json"), ("info tiny", "tiny/images.bin"), ("info tiny", "tiny/mesh.ply"), ("info flat", "flat/normals.f32"),
    ("judge fit", "fit/fit.json"), ("judge fit", "fit/view_term0.exr"), ("info fit", "fit/mesh.ply"),
    ("judge orbfit", "orb/truth.json"), ("judge orbfit", "orb/truth_material.u8"),
    (f"{colmap} -o new", "photos/text/cameras.txt"), (f"{colmap} -o new", "photos/mesh.obj"), (f"{colmap} -o new", "photos/images/1.png"),
    (f"{colmap} --masks photos/masks -o new", "photos/masks/1.png"), (f"{colmap} --gains photos/gains.txt -o new", "photos/gains.txt"),
    (f"{colmap} --holdout pipe -o new", "pipe"), (f"{lights} -o new", "lit/lights.txt"), (f"{lights} -o new", "lit/images/0.png"),
    (f"{lights} --mask lit/mask.png -o new", "lit/mask.png"), (f"{lights} --normals lit/normals.pfm -o new", "lit/normals.pfm"),
    ("fit tiny --solver two-step --records pipe -o new", "pipe"),
    ("fit tiny --solver two-step --iterations 1 --records records -o new", "records/records.json"),
    ("fit tiny --solver two-step --iterations 1 --records records -o new", "records/records.bin"),
    ("fig9_error --config pipe --profile smoke", "pipe"),
    ("fit tiny -o pipe", "pipe"), ("generate star -o pipe", "pipe"), ("render fit -o pipe/new", "pipe"), ("publish fit -o pipe", "pipe"), ("publish pipe -o new", "pipe"), ("render fit --turntable 1 -o pipe", "pipe"),
):  # fmt: skip
    rows.append((command, fifo(path), 2, "lit/" if command.startswith(f"{lights} -o") else path))
rows.append(("render fit -o fit/view_term0.exr", None, 2, "fit/view_term0"))
rows.append(("render flatfit -o flatfit/rho_d.exr", None, 2, "flatfit/rho_d"))
