"""Files of RTI by other programs: .ptm, .rti, relight's info.json, and the images that they were made of."""
from bad_inputs.damage import GONE, append, cut, field, folder, patch, remove, replace, write

rows = []
again = "copy it again from where it was made"
lrgb, rgb, jpeg, hsh = "rti/lrgb.ptm", "rti/rgb.ptm", "rti/jpeg.ptm", "rti/hsh.rti"
info, grid, lamps = "rti/lptm/info.json", "rti/bilinear/info.json", "rti/rbf/info.json"


def bad(path, damage, *words):
    rows.append((f"import rti {path} -o new", damage, 2, f"{path}: ", *words))


for path in (lrgb, rgb, jpeg, hsh, info, grid, lamps):
    rows.append((f"import rti {path} --dataset flat -o new", None, 0, "see new"))
rows += [
    ("import rti rti/lptm --dataset flat -o new", None, 0, "see new"),
    ("import rti rti -o new", None, 2, "rti/info.json"),
    ("import rti rti/none.ptm -o new", None, 2, "rti/none.ptm: "),
    ("import rti lit/mask.png -o new", None, 2, "lit/mask.png: neither a .ptm nor an .rti"),
    (f"import rti {lrgb} -o lit", None, 2, "lit: ", "choose another name"),
    (f"import rti {lrgb} -o new", folder("new-lamps/notes"), 2, "new-lamps: "),
    (f"import rti {lrgb} --dataset tiny -o new", None, 2, "tiny: ", "what lit it"),
    (f"import rti {lrgb} --dataset orb -o new", None, 2, "orb: has a mesh"),
    (f"import rti {lrgb} --dataset flat -o new", replace(lrgb, "\n6\n5\n", "\n5\n6\n"), 2, "flat: 6 x 5 texels", "at the same size"),
]

# Cut short, or another kind
for path in (lrgb, rgb, jpeg, hsh):
    for size in (0.2, 0.9, -1, 30):
        bad(path, cut(path, size), again)
    bad(path, write(path, ""), "neither a .ptm nor an .rti")
bad(lrgb, replace(lrgb, "PTM_1.2", "PTM_2.0"), "version 'PTM_2.0'")
for kind in ("PTM_FORMAT_LUM", "PTM_FORMAT_JPEGLS_RGB", "PTM_FORMAT_PTM_LUT"):
    bad(lrgb, replace(lrgb, "PTM_FORMAT_LRGB", kind), f"of format '{kind}'", "export it as one of these")

# Sizes and numbers
for text in ("0\n5", "-6\n5", "6.5\n5", "99999\n5", "six\n5", "nan\n5", "32768\n32768"):
    for path in (lrgb, rgb):
        bad(path, replace(path, "6\n5\n", f"{text}\n"), again)
for text in ("nan 2", "inf 2", "1e9 2", "2,2", "1e999 2"):
    bad(lrgb, replace(lrgb, "2 2 2 2 2 2", f"{text} 2 2 2 2"), again)
bad(lrgb, replace(lrgb, "127 0", "127 1e8"), again)
for path in (lrgb, rgb):
    bad(path, replace(path, "2 2 2 2 2 2", "0 0 0 0 0 0"), "each scale is 0", "export it again")
for line, text in (("0 1 2 3 4 5 6 7 8", "0 1 2 3 4 5 6 7 7"), ("0 1 2 3 4 5 6 7 8", "0 1 2 3 4 5 6 7 9"),
                   ("-1 -1 0", "-1 -1 2"), ("-1 -1 0", "-1 -1 8"), ("-1 -1 0", "-1 -1 9"), ("0 0 5 0", "0 0 -5 0")):  # fmt: skip
    bad(jpeg, replace(jpeg, line, text), again)
bad(jpeg, replace(jpeg, "90\n0 0 1 0 0 0 0 0 0\n0", "90\n0 0 1 0 0 0 0 0 0\n4"), "motion vectors", "without compression")
bad(jpeg, replace(jpeg, "6\n5\n", "5\n6\n"), "a plane has 6 x 5 pixels, not 5 x 6")
bad(jpeg, patch(jpeg, -20, b"\xff\xd8\xff\xd8"), "")
for text in ("0 5 3", "6 -5 3", "6 5 x", "40000 5 3", "32768 32768 3"):
    bad(hsh, replace(hsh, "6 5 3", text), again)
for kind, what in (("1", "polynomial"), ("4", "adaptive"), ("77", "unknown")):
    bad(hsh, replace(hsh, "\r\n3\r\n", f"\r\n{kind}\r\n"), f"kind {kind}", what, "only hemispherical harmonics")
for before, after in (("4 2 1", "5 2 1"), ("4 2 1", "25 2 1"), ("4 2 1", "4 1 1"), ("4 2 1", "4 2 4"), ("6 5 3", "6 5 1")):
    bad(hsh, replace(hsh, before, after), "only 3 channels")
bad(hsh, patch(hsh, 26, b"\0\0\x80\x7f"), "scale of inf", again)

# relight
for path in (info, grid, lamps):
    for size in (0, 0.3, -2):
        bad(path, cut(path, size), "neither a .ptm" if size == 0 else again)
    for place in ("width", "height", "type", "colorspace", "materials", "materials[0].scale", "materials[0].bias"):
        bad(path, field(path, place, GONE), again)
    for place, value in (("width", 0), ("height", -1), ("width", 1e9), ("width", "6"), ("width", 6.5), ("materials", []),
                         ("materials[0].scale[0]", "x"), ("materials[0].scale[0]", 1e30), ("materials[0].bias", [1]), ("type", 5)):  # fmt: skip
        bad(path, field(path, place, value), again)
    bad(path, field(path, "type", "sh"), "type sh in colour space", "build it as ptm or hsh")
    bad(path, field(path, "colorspace", "ycc"), "in colour space ycc", "build it as ptm or hsh")
for value in (0, -3, 1e9, 301, "9"):
    bad(info, field(info, "nplanes", value), again)
for place, value in (("resolution", 1), ("resolution", 9), ("resolution", 1e9), ("basis", [1]), ("basis[0]", None),
                     ("materials[0].range", GONE), ("materials[0].range[2]", 0), ("materials[0].range[2]", -1)):  # fmt: skip
    bad(grid, field(grid, place, value), again)
bad(grid, field(grid, "basis", GONE), "no basis, and no materials.bin", again)
for place, value in (("lights", [0, 0]), ("lights", []), ("lights", GONE), ("yccplanes", [3, 3]), ("yccplanes", [1, 3, 3]),
                     ("yccplanes", [1e9, 3, 3]), ("yccplanes", GONE), ("sigma", 0), ("sigma", "wide")):  # fmt: skip
    bad(lamps, field(lamps, place, value), again)
rows += [
    (f"import rti {info} -o new", field(info, "nplanes", 12), 2, f"{info}: ", again),
    (f"import rti {info} -o new", field(info, "colorprofile", "P3"), 2, f"{info}: ", "profile P3", "-I srgb"),
    (f"import rti {info} -o new", field(info, "colorprofile", 3), 2, f"{info}: ", again),
    (f"import rti {info} --curve root -o new", None, 2, "curve", "srgb", "linear"),
    (f"import rti {info} --curve linear -o new", None, 0, "see new"),
    (f"import rti {info} -o new", field(info, "width", 7), 2, "rti/lptm/plane_0.jpg: 6 x 5 pixels", "says 7 x 5", "take both from one folder"),
    (f"import rti {info} -o new", remove("rti/lptm/plane_0.jpg"), 2, "rti/lptm/plane_0.jpg: "),
    (f"import rti {info} -o new", remove("rti/lptm/plane_2.jpg"), 2, "rti/lptm/plane_2.jpg: "),
    (f"import rti {info} -o new", cut("rti/lptm/plane_1.jpg", 0.5), 2, "rti/lptm/plane_1.jpg: "),
    (f"import rti {info} -o new", append(info, "x"), 2, f"{info}: ", again),
    (f"import rti {info} -o new", write(info, "{" * 100000), 2, f"{info}: ", again),
]
