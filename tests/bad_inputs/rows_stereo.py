"""What the steps of `capture` read: points of COLMAP models, photographs, depth maps, meshes and masks."""
from bad_inputs.damage import append, cut, fifo, folder, patch, remove, replace, write

rows = []


def check_model(model="text", more=""):
    return f"capture check-model photos/{model} --images photos/images {more}".strip()


def depths(more=""):
    return f"capture depths --model photos/text --images photos/images {more} -o new".replace("  ", " ")


def cut_mesh(more=""):
    return f"capture cut-mesh photos/mesh.obj --model photos/text --depths photos/stereo {more} -o new.ply".replace("  ", " ")


def masks(more=""):
    return f"capture masks photos/mesh.obj --model photos/text {more} -o new".replace("  ", " ")


def preview(more=""):
    return f"capture preview --model photos/text --images photos/images {more} -o new.png".replace("  ", " ")


def check_mesh(more=""):
    return f"capture check-mesh photos/mesh.obj --model photos/text {more}".strip()


# Points of a model
points, binary_points = "photos/text/points3D.txt", "photos/binary/points3D.bin"
for damage, *words in (
    (remove(points), f"{points}: no such file: take the whole model", "cameras without points do for an import"),
    (folder(points), f"{points}: "),
    (fifo(points), f"{points}: "),
    (write(points, ""), "photos/text: the model has no points to check its cameras by: take more photographs", "an import needs no points"),
    (write(points, "\x00\x01"), f"{points}: holds zero bytes, so it is no text"),
    (replace(points, "^0 ", "0 0 "), f"{points}:1: expected POINT3D_ID X Y Z R G B ERROR"),
    (replace(points, "9 9 9 0.5", "9 9 9 nan"), f"{points}:1: ERROR is 'nan', which is not finite"),
    (replace(points, "-0.9", "inf"), f"{points}:1: a coordinate is 'inf', which is not finite"),
    (replace(points, "-0.9", "left"), f"{points}:1: a coordinate is 'left', which is no number"),
    (replace(points, "0.5 1 0", "0.5 9 0"), f"{points}:1: a point is seen by image 9, which photos/text/images.txt does not hold"),
    (replace(points, "0.5 1 0", "0.5 -1 0"), f"{points}:1: IMAGE_ID is '-1', which is no whole number"),
    (replace(points, "0.5 1 0 2 0 3 0", "0.5"), f"{points}:1: a point has no track"),
    (replace("photos/text/images.txt", "^1 ", "5 "), f"{points}:1: a point is seen by image 1"),
):
    rows.append((check_model(), damage, 2, *words))
for size in (0, 4, 0.3, 0.7, -1):
    rows.append((check_model("binary"), cut(binary_points, size), 2, f"{binary_points}: truncated: "))
rows += [
    (check_model("binary"), append(binary_points, "x"), 2, f"{binary_points}: 1 bytes follow the last entry"),
    (check_model("binary"), patch(binary_points, 0, b"\xff" * 8), 2, f"{binary_points}: truncated: "),
    (check_model("binary"), patch(binary_points, 51, b"\xff" * 8), 2, f"{binary_points}: "),
    (check_model("binary"), patch(binary_points, 22, b"\xf0\x7f"), 2, f"{binary_points}: a point is not finite"),
    (check_model("binary"), remove(binary_points), 2, f"{binary_points}: no such file"),
    (check_model("binary"), None, 0, "3 of 3 photographs registered, 40 points"),
    (check_model(), None, 0, "mean reprojection error 0.50 pixels, mean track length 3.0"),
    (check_model(more="--json"), None, 0, '"registered": 3'),
    (check_model("nowhere"), None, 2, "photos/nowhere: no COLMAP model here"),
    ("capture check-model photos/text --images photos/nowhere", None, 2, "photos/nowhere: "),
    ("capture check-model photos/text", None, 2, "--images is required"),
    ("capture", None, 2, "--help"),
    ("capture check", None, 2, "--help"),
]

# Poor outcomes: what to do about them, and --go-on.
for damage, *words in (
    (replace(points, "(?m) 0.5 1", " 99 1"), "the mean reprojection error is 2.96 pixels, above 1.5: use one lens"),
    (replace(points, "(?s)\n20 .*", "\n"), "fewer than 30 points are seen by 0.png, 1.png, 2.png"),
    (write(points, "".join(f"{i} 0 0 {i} 9 9 9 0.5 1 {i} 2 {i}\n" for i in range(40))),
     "points are seen by 2.0 photographs in the mean, fewer than 3: take more photographs", "seen by 2.png"),
):  # fmt: skip
    rows.append((check_model(), damage, 2, *words, "--go-on goes on all the same"))
    rows.append((check_model(more="--go-on"), damage, 0, "3 of 3 photographs registered"))
rows.append((cut_mesh().replace("new.ply", "new.obj"), None, 2, "new.obj: name a file that ends in .ply"))
rows.append((cut_mesh().replace("new.ply", "new"), None, 2, "new: name a file that ends in .ply"))
rows.append((preview().replace("new.png", "new.jpg"), None, 2, "new.jpg: name a file that ends in .png"))
rows.append((check_mesh(), replace("photos/mesh.obj", "(?s)v.*?f", "v 9 9 9\nv 8 9 9\nv 9 8 9\nf"), 2, "photos/mesh.obj"))

# Depths
for damage, *words in (
    (remove("photos/images/1.png"), "photos/images/1.png: "),
    (write("photos/images/1.png", "no picture"), "photos/images/1.png: "),
    (cut("photos/images/1.png", 0.5), "photos/images/1.png: "),
    (replace("photos/text/cameras.txt", "16 16", "32 32"), "photos/images/0.png: 16 x 16 pixels, but photos/text/cameras.txt calibrates 32 x 32"),
    (replace(points, "(?s)\n5 .*", "\n"), "photos/text: no photograph shares points with two others: take photographs that overlap more"),
    (write("new", "x"), "new"),
):
    rows.append((depths(), damage, 2, *words))
for option, value, *words in (
    ("--sources", "1", "sources = "), ("--sources", "17", "sources = "), ("--agree", "0", "agree = "),
    ("--region", "0", "region = "), ("--region", "nan", "region = "), ("--most-cost", "3", "most-cost = "), ("--seed", "-1", "seed = "),
):  # fmt: skip
    rows.append((depths(f"{option} {value}"), None, 2, *words))
rows.append((depths(), None, 0, "3 depth maps"))

# Depth and normal maps
depth, normal = "photos/stereo/depth_maps/0.png.geometric.bin", "photos/stereo/normal_maps/0.png.geometric.bin"
for file, channels, size in ((depth, 1, 1024), (normal, 3, 3072)):
    again = "write the depth maps again"
    rows += [
        (cut_mesh(), remove(file), 2, f"{file}: "),
        (cut_mesh(), folder(file), 2, f"{file}: "),
        (cut_mesh(), write(file, ""), 2, f"{file}: does not begin with WIDTH&HEIGHT&CHANNELS&", again),
        (cut_mesh(), cut(file, -1), 2, f"{file}: holds {size - 1} bytes of values, not {size}", again),
        (cut_mesh(), append(file, "x"), 2, f"{file}: holds {size + 1} bytes of values, not {size}"),
        (cut_mesh(), patch(file, 0, b"61"), 2, f"{file}: its size is not 16 x 16 with {channels} channels, as calibrated"),
        (cut_mesh(), patch(file, 0, b"-1"), 2, f"{file}: "),
        (cut_mesh(), patch(file, 8, b"\0\0\xc0\x7f"), 2, f"{file}: "),
    ]
rows += [
    (cut_mesh(), patch(depth, 8, b"\0\0\x80\xbf"), 2, f"{depth}: pixel (0, 0) has depth -1"),
    (cut_mesh("--support 0"), None, 0, "2 triangles of 4 vertices; of the mesh's 4 are left out: 0 far away"),
    (cut_mesh("--support 4"), None, 2, "nothing of the mesh is left"),
    (cut_mesh("--support -1"), None, 2, "support = "),
    (cut_mesh("--close 1001"), None, 2, "close = "),
    (cut_mesh("--ground table"), None, 2, "ground", "'table'", "cut, keep, disc"),
    (cut_mesh("--support 0 --ground disc"), None, 0, "2 triangles of 4 vertices"),
    (cut_mesh("--masks photos/masks"), None, 2, "--images"),
    (cut_mesh("--masks photos/small-masks --images photos/images"), None, 2, "photos/small-masks/0.png: 8 x 8 pixels, but its photograph has 16 x 16"),
    (cut_mesh(), replace("photos/mesh.obj", "f 1 2 3", "f 1 2 9"), 2, "photos/mesh.obj:"),
]

# Masks, and what is held against a mesh
rows += [
    (masks(), None, 0),
    (masks("--inset -1"), None, 2, "inset = "),
    (masks(), write("new", "x"), 2, "new"),
    (masks(), replace("photos/text/images.txt", "1.png", "0.jpg"), 2, "photos/text/images.txt: two images would have the mask 0.png: rename one"),
    (masks(), replace("photos/text/images.txt", "1.png", "../1.png"), 2, "image '../1.png': its name leads out of the output folder: rename it"),
    (masks(), remove("photos/mesh.obj"), 2, "photos/mesh.obj: "),
    (check_mesh(), None, 0, "the mesh covers", "1 piece; 1 border"),
    (check_mesh("--json"), None, 0, '"median_distance"'),
    (check_mesh("--depths photos/nowhere"), None, 2, "photos/nowhere/depth_maps/0.png.geometric.bin: "),
    (check_mesh("--depths photos/stereo"), patch(depth, 8, b"\0\0\x80\xbf"), 2, f"{depth}: pixel (0, 0) has depth -1"),
    (check_mesh("--depths photos/stereo"), replace("photos/mesh.obj", "f 1 2 3\nf 1 3 4", "f 1 3 2\nf 1 4 3"), 2, "the photographs show the back of the mesh"),
    (preview(), None, 0),
    (preview("--mesh photos/mesh.obj"), None, 0),
    (preview("--mesh photos/nowhere.obj"), None, 2, "photos/nowhere.obj: "),
    (preview(), remove(points), 2, f"{points}: no such file"),
    (preview("--mesh photos/mesh.obj"), remove(points), 0),
    (preview(), remove("photos/images/0.png"), 2, "0.png"),
    (preview(), write("photos/images/0.png", "x"), 2, "photos/images/0.png: "),
    (preview(), folder("new.png"), 2, "new.png"),
    ("capture preview --model photos/text -o new.png", None, 2, "--images is required"),
    (check_mesh("--masks photos/masks --images photos/images"), None, 2, "mesh and masks agree on", "in masks white is the object"),
    (check_mesh("--masks photos/masks --images photos/images --go-on"), None, 0, "mesh and masks agree on"),
    (check_mesh("--masks photos/nowhere --images photos/images"), None, 2, "photos/nowhere: "),
    (check_mesh("--masks photos/masks"), None, 2, "--images"),
    (check_mesh(), write(points, "0 0 0 3 9 9 9 0.5 1 0 2 0 3 0\n"), 2, "of the mesh's diagonal away from it in the median", "--go-on"),
]
