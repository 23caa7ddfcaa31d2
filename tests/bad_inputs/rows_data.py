"""Packed datasets: dataset.json, images.bin, mesh.ply, normals.f32 and an ornament's truth."""
from bad_inputs.damage import GONE, append, cut, every_view, field, folder, patch, remove, replace, write

rows = []
again = "run radiafit generate or import again"
json, grid, lamps = "tiny/dataset.json", "flat/dataset.json", "orb/dataset.json"


def bad_field(file, place, values, *words, command="info {}"):
    """A row for each value of the field."""
    for value in values:
        rows.append((command.replace("{}", file.split("/")[0]), field(file, place, value), 2, f"{file}: ", *words))


# Every field: gone, of another type, out of range.
for place in ("format", "version", "name", "description", "source", "encoding", "images_bytes", "vertices", "triangles", "views"):
    bad_field(json, place, [GONE], f'"{place}" is missing', again)
for place in ("name", "held_out", "camera", "camera.width", "camera.height", "camera.fx", "camera.fy", "camera.cx", "camera.cy",
              "camera.cam_from_world_rotation", "camera.cam_from_world_translation", "gain", "pixel_offset", "mask_offset",
              "peak", "crop", "crop.full_height"):  # fmt: skip
    bad_field(json, f"views[1].{place}", [GONE], f'"views[1].{place}" is missing', again)
for place in ("grid.width", "grid.height", "grid.origin", "grid.right", "grid.down", "grid.normals", "views[0].light.intensity"):
    bad_field(grid, place, [GONE], f'"{place}" is missing', again)
bad_field(json, "format", ["radiafit-fit", ""], '"format" is "', 'not "radiafit-dataset"')
bad_field(json, "format", [1], '"format" must be a text')
bad_field(json, "version", [0, 99, 2**40], '"version" is ', "this program reads 1 to ")
bad_field(json, "version", ["1", 1.5], '"version" must be a whole number')
bad_field(json, "encoding", ["u8"], '"encoding" is "', "not one of u8-srgb, u8-linear, u16-linear, f16-linear, f32-linear")
bad_field(json, "vertices", [-4, "4"], '"vertices" must be a whole number, 0 or above')
bad_field(json, "triangles", [1e99, "2"], '"triangles" must be a whole number, 0 or above')
bad_field(json, "views", ["none"], '"views" must be a list')
bad_field(json, "views", [[]], '"views" is empty')
bad_field(json, "views[0]", [[], None], '"views[0]" must be an object')
bad_field(json, "views[2].name", [3], '"views[2].name" must be a text')
bad_field(json, "views[0].held_out", [0], '"views[0].held_out" must be true or false')
for place in ("camera.width", "crop.full_width"):
    bad_field(json, f"views[0].{place}", [0, 65537, 2**32 + 16], f'"views[0].{place}" is ', "outside [1, 65536]")
    bad_field(json, f"views[0].{place}", [16.5, None], f'"views[0].{place}" must be a whole number')
bad_field(json, "views[0].crop.x0", [65537, 2**63], '"views[0].crop.x0" is ', "outside [0, 65536]")
for place in ("camera.fx", "gain"):
    bad_field(json, f"views[0].{place}", [None], f'"views[0].{place}" is null: not a finite number')
    bad_field(json, f"views[0].{place}", ["1", [], {}], f'"views[0].{place}" must be a number')
bad_field(json, "views[0].camera.fx", [0, -20], "the focal lengths ", "must be positive pixels")
bad_field(json, "views[0].camera.cam_from_world_rotation", [1, [], [[1, 0, 0], [0, 1, 0]]], "must be 3 rows of 3 numbers")
bad_field(json, "views[0].camera.cam_from_world_rotation[1]", [[0, 1], 7], "must be 3 numbers")
bad_field(json, "views[0].camera.cam_from_world_rotation[1]", [[0, 1, 0], [0, 0, 0], [0, -2, 0]], "the rotation is not orthonormal and right-handed")
bad_field(json, "views[0].camera.cam_from_world_translation", [[0, 0], [0, 0, 0, 0], "0 0 4"], "must be 3 numbers")
bad_field(json, "views[0].camera.cam_from_world_translation[2]", [None], "is null: not a finite number")
bad_field(json, "views[0].gain", [0, -1], '"views[0].gain" must be above 0')
bad_field(json, "views[0].peak", [-1, 1e39], '"views[0].peak" must be finite and not below 0')
bad_field(json, "views[0].pixel_offset", [-4096, 0.5, None, "0"], '"views[0].pixel_offset" must be a whole number')
bad_field(json, "views[0].pixel_offset", [1, 4095], "not a multiple of 4096")
bad_field(json, "views[0].mask_offset", [-1, 0.5, "0"], '"views[0].mask_offset" must be a whole number')
bad_field(json, "views[0].camera.direction", [[0, 0, 1]], "a distant camera, which only a grid may have")
bad_field(json, "views[0].light", [{"direction": [0, 0, 1], "intensity": [1, 1, 1]}], "unlike view", "all must have one, or none")
bad_field(grid, "grid.width", [0, 65537], '"grid.width" is ', "outside [1, 65536]")
bad_field(grid, "grid.width", [5, 60], "has 6 x 5 pixels, but the grid ")
bad_field(grid, "grid.right", [[0, 0, 0], [1, -1, 0]], "the grid's steps right and down must be at right angles and longer than 0")
bad_field(grid, "grid.down", [[0, 1], "down"], '"grid.down" must be 3 numbers')
bad_field(grid, "grid.origin[0]", [None], "is null: not a finite number")
bad_field(grid, "grid.normals", [0, "yes"], '"grid.normals" must be true or false')
bad_field(grid, "views[0].camera.direction", [[0, 0, 2], [0, 0, 0]], "the direction to the camera has length ", "give a unit vector")
bad_field(grid, "views[1].light", [GONE], "has no light, unlike view", "all must have one, or none")
bad_field(grid, "views[0].light.direction", [[0, 0, 2], [0, 0, 0]], "the direction to the light has length ")
bad_field(grid, "views[0].light.direction", [GONE], "must have either a direction or a position")
bad_field(grid, "views[0].light.position", [[0, 0, 9]], "must have either a direction or a position")
bad_field(grid, "views[0].light.intensity", [[0, 0, 0]], "the light's intensity is 0 in every channel")
bad_field(grid, "views[0].light.intensity", [[-1, 1, 1], [1, 1e13, 1], [1e-13, 1, 1]], "the light's intensity is ", "in a channel; give 0, or 1e-12 to 1e+12")
bad_field(grid, "views[0].light.intensity", [1, [1, 1]], '"views[0].light.intensity" must be 3 numbers')
bad_field(lamps, "normals.side", [1, 0, 65537], '"normals.side" is ', "outside [2, 65536]")

# The text as a whole.
rows += [
    ("info tiny", cut(json, 0.5), 2, f"{json}: line ", "is not valid JSON", again),
    ("info tiny", cut(json, 0), 2, f"{json}: the file is empty"),
    ("info tiny", write(json, "[]"), 2, f"{json}: the text must be an object"),
    ("info tiny", write(json, "null"), 2, f"{json}: the text must be an object"),
    ("info tiny", write(json, "\xff\xfe\x00"), 2, f"{json}: "),
    ("info tiny", write(json, "[" * 100000), 2, f"{json}: "),
    ("info tiny", append(json, "x"), 2, f"{json}: line ", "is not valid JSON"),
    ("info tiny", replace(json, r'"gain":1\.0', '"gain":1e999'), 2, f"{json}: a number is too large"),
    ("info tiny", replace(json, r'"gain":1\.0', '"gain":nan'), 2, f"{json}: line ", "is not valid JSON"),
    ("info tiny", remove(json), 2, "tiny: neither a dataset nor a fit"),
    ("fit tiny -o new", remove(json), 2, "tiny: not a packed dataset, it has no dataset.json"),
    ("plan tiny", remove(json), 2, "tiny: not a packed dataset, it has no dataset.json"),
    ("fit tiny -o new", field(json, "views[0].camera.fx", None), 2, '"views[0].camera.fx" is null', again),
    ("plan tiny", field(json, "views[0].gain", [1, 1.1]), 2, '"views[0].gain" must be a number, or 3 numbers'),
    ("plan tiny", field(json, "views[0].gain", [1, 1.1, "red"]), 2, '"views[0].gain" must be a number'),
    ("plan tiny", field(json, "views[0].gain", [1, 1.1, 0]), 2, '"views[0].gain" must be above 0'),
    ("plan flat", field("flat/dataset.json", "views[0].gain", [1, 1.1, 1]), 2, '"views[0].gain" must be one number where there is a light'),
    ("plan tiny", field(json, "views[0].gain", 0), 2, '"views[0].gain" must be above 0'),
    ("judge fit", field(json, "views[0].gain", -1), 2, '"views[0].gain" must be above 0'),
    ("render fit -o new", field(json, "views[0].gain", -1), 2, '"views[0].gain" must be above 0'),
    ("info fit --dataset tiny", field(json, "views[0].gain", -1), 2, '"views[0].gain" must be above 0'),
    ("info tiny", field(json, "vertices", 5), 2, "tiny/mesh.ply: "),
    ("info tiny", field(json, "triangles", 3), 2, "tiny/mesh.ply: "),
    ("info tiny", field(json, "unheard_of", [1, 2]), 0, "3 views"),
    ("info tiny", field(json, "name", "a b"), 0, "dataset a b"),
]

# images.bin
for size in (0, 0.5, -1):
    for command in ("info tiny", "fit tiny -o new") if size in (0, -1) else ("info tiny",):
        rows.append((command, cut("tiny/images.bin", size), 2, "tiny/images.bin: ", again))
rows += [
    ("info tiny", append("tiny/images.bin", "x" * 4096), 2, "tiny/images.bin: ", again),
    ("info tiny", remove("tiny/images.bin"), 2, "tiny/images.bin: the file is missing or cannot be read", again),
    ("fit tiny -o new", remove("tiny/images.bin"), 2, "tiny/images.bin: the file is missing or cannot be read", again),
    ("info tiny", folder("tiny/images.bin"), 2, "tiny/images.bin: "),
    ("info tiny", field(json, "images_bytes", 1), 2, "tiny/images.bin: ", "dataset.json says 1"),
    ("info tiny", field(json, "images_bytes", 2**63), 2, "tiny/images.bin: "),
    ("info tiny", field(json, "views[2].pixel_offset", 4096 * 1000), 2, "tiny/images.bin: ", "but the file ends at ", again),
    ("info tiny", field(json, "views[0].pixel_offset", 2**64 - 4096), 2, "tiny/images.bin: ", "but the file ends at ", again),
    ("info tiny", field(json, "views[0].mask_offset", 2**62), 2, "tiny/images.bin: ", "but the file ends at ", again),
    ("info tiny", field(json, "views[0].camera.width", 4000), 2, "tiny/images.bin: ", "but the file ends at ", again),
]

# mesh.ply as a dataset has it
ply = "tiny/mesh.ply"
for size in (0, 0.02, 0.3, 0.6, -1):
    rows.append(("info tiny", cut(ply, size), 2, f"{ply}: ", again))
rows += [
    ("info tiny", remove(ply), 2, f"{ply}: the file is missing or cannot be read", again),
    ("fit tiny -o new", remove(ply), 2, f"{ply}: the file is missing or cannot be read", again),
    ("info tiny", folder(ply), 2, f"{ply}: "),
    ("info tiny", append(ply, "x"), 2, f"{ply}: 4 vertices and 2 triangles need ", "but the file has "),
    ("info tiny", replace(ply, "element vertex 4", "element vertex 5"), 2, f"{ply}: 5 vertices and 2 triangles need "),
    ("info tiny", replace(ply, "element vertex 4", "element vertex 4000000000"), 2, f"{ply}: 4000000000 vertices"),
    ("info tiny", replace(ply, "element vertex 4", "element vertex -4"), 2, f'{ply}: the PLY header counts "element vertex -4"'),
    ("info tiny", replace(ply, "element face 2", "element face 99999999999999999999"), 2, f"{ply}: the PLY header counts "),
    ("info tiny", replace(ply, "binary_little", "binary_big"), 2, f"{ply}: the PLY header has "),
    ("info tiny", replace(ply, "float x", "double x"), 2, f"{ply}: the PLY header has ", "float x"),
    ("info tiny", replace(ply, "ply", "plx"), 2, f"{ply}: the PLY header has "),
    ("info tiny", patch(ply, -4, b"\x04\0\0\0"), 2, f"{ply}: triangle 1 refers to vertex 4, but there are only 4"),
    ("info tiny", patch(ply, -4, b"\xff\xff\xff\xff"), 2, f"{ply}: triangle 1 refers to vertex 4294967295"),
    ("info tiny", patch(ply, -13, b"\x04"), 2, f"{ply}: face 1 has 4 corners, not 3"),
    ("info tiny", patch(ply, -26 - 4, b"\0\0\xc0\x7f"), 2, f"{ply}: the position of vertex 3 is not finite"),
    ("info tiny", patch(ply, -26 - 12, b"\0\0\x80\xff"), 2, f"{ply}: the position of vertex 3 is not finite"),
    ("fit tiny -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny --engine fragment -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny --solver two-step -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny --solver pca -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny --solver ceres -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny --solver als -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny --solver varpro -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny --solver mean -o new", every_view(json, "camera.cam_from_world_translation", [0, 0, -1000]), 2, "tiny: no training view sees the mesh"),
    ("fit tiny -o new", every_view(json, "held_out", True), 2, "tiny: no training view sees the mesh"),
]

# normals.f32 of a grid, and of an ornament
for size in (0, 0.5, -1):
    rows.append(("info flat", cut("flat/normals.f32", size), 2, "flat/normals.f32: the file has ", again))
    rows.append(("info orb", cut("orb/normals.f32", size), 2, "orb/normals.f32: the file has ", again))
rows += [
    ("info flat", remove("flat/normals.f32"), 2, "flat/normals.f32: the file is missing or cannot be read", again),
    ("info flat", append("flat/normals.f32", "xxxx"), 2, "flat/normals.f32: the file has "),
    ("info flat", patch("flat/normals.f32", 12, b"\0\0\xc0\x7f"), 2, "normal 1 is (nan, ", "neither 0 nor of unit length"),
    ("info flat", patch("flat/normals.f32", 8, b"\0\0\0\x40"), 2, "normal 0 is (0, 0, 2), neither 0 nor of unit length"),
    ("fit flat --model lambert -o new", patch("flat/normals.f32", 8, b"\0\0\0\x40"), 2, "neither 0 nor of unit length"),
    ("info orb", patch("orb/normals.f32", 0, bytes(12)), 2, "normal 0 is (0, 0, 0), not of unit length"),
    ("info orb", remove("orb/normals.f32"), 2, "orb/normals.f32: the file is missing or cannot be read", again),
    ("info orb", field(lamps, "normals.side", 3), 2, "orb/normals.f32: the file has "),
]

# truth: read by judge alone
truth = "run radiafit generate again"
for size in (0, 0.5, 0.98):
    rows.append(("judge orbfit", cut("orb/truth.json", size), 2, "orb/truth.json: a field is missing or of another type", truth))
    rows.append(("judge orbfit", cut("orb/truth_parameters.f32", size), 2, "orb/truth_parameters.f32: the file has ", truth))
    rows.append(("judge orbfit", cut("orb/truth_material.u8", size), 2, "orb/truth_material.u8: the file has ", truth))
for place, value in (("side", GONE), ("side", "six"), ("texels", -1), ("texels", "all"), ("exact", 1), ("materials", {"a": 1}),
                     ("materials[0].name", GONE), ("materials[0].model", 5), ("materials[0].parameters", "nine")):  # fmt: skip
    rows.append(("judge orbfit", field("orb/truth.json", place, value), 2, "orb/truth", truth))
rows += [
    ("judge orbfit", field("orb/truth.json", "format", "radiafit-fit"), 2, "orb/truth.json: not a radiafit-truth of version 1", truth),
    ("judge orbfit", field("orb/truth.json", "version", 2), 2, "orb/truth.json: not a radiafit-truth of version 1", truth),
    ("judge orbfit", field("orb/truth.json", "texels", 3), 2, "orb/truth_parameters.f32: the file has ", truth),
    ("judge orbfit", remove("orb/truth_parameters.f32"), 2, "orb/truth_parameters.f32: the file is missing", truth),
    ("judge orbfit", remove("orb/truth_material.u8"), 2, "orb/truth_material.u8: the file is missing", truth),
    ("judge orbfit", patch("orb/truth_material.u8", 5, b"\xff"), 2, "orb/truth_material.u8: material 255 of ", truth),
    ("judge orbfit", None, 0, "Lambertian"),
]

# What the files say against each other, and what is beyond any camera
for place, value in (("fx", 1e308), ("fx", 1e-300), ("fy", 1e12), ("cx", -1e300), ("cy", 1e100)):
    bad_field(json, f"views[0].camera.{place}", [value], 'view "0.png"', "calibrate it again")
bad_field(json, "views[0].camera.cam_from_world_translation[2]", [1e300], 'view "0.png"')
bad_field(json, "views[1].pixel_offset", [0], "overlaps")
bad_field(json, "views[1].mask_offset", [0], "view")
rows += [
    # One bit of any file is noticed by info, and by whoever reads an image.
    ("info tiny", patch("tiny/images.bin", 5, b"\xfe"), 2, "tiny/images.bin: ", "is not as it was written"),
    ("info tiny", patch("tiny/mesh.ply", -30, b"\x01"), 2, "tiny/mesh.ply: ", "is not as it was written"),
    ("info flat", patch("flat/images.bin", 5, b"\xfe"), 2, "flat/images.bin: ", "is not as it was written"),
    ("info flat", patch("flat/normals.f32", 0, b"\x01"), 2, "flat/normals.f32: ", "is not as it was written"),
    ("info orb", patch("orb/images.bin", 5000, b"\x11\x22"), 2, "orb/images.bin: ", "is not as it was written"),
    ("info floats", patch("floats/images.bin", 0, b"\0\0\xc0\x7f"), 2, "floats/images.bin: "),
    ("info floats", patch("floats/images.bin", 0, b"\0\0\x80\x7f"), 2, "floats/images.bin: "),
    ("fit floats --model lambert -o new", patch("floats/images.bin", 4096, b"\0\0\xc0\x7f"), 2, "floats/images.bin: "),
    ("fit floats --model lambert -o new", patch("floats/images.bin", 4096, b"\0\0\x80\x4f"), 2, "floats/images.bin: "),
    ("fit tiny -o new", patch("tiny/images.bin", 4096 + 5, b"\xfe"), 2, "tiny/images.bin: "),
]
