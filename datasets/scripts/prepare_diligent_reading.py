#!/usr/bin/env python3
"""Makes the capture diligent_reading from its public original: pixels, mask and normals are cropped, none is changed.
Usage: prepare_diligent_reading.py READING CAPTURE
READING: dataset/readingPNG of the repository that datasets/captures.md names; CAPTURE: a folder to make.
Its images are stored uncompressed, so that they have the same bytes wherever they are made."""
import pathlib
import shutil
import struct
import sys
import zlib

from png_rows import read_png, write_png

X0, Y0, WIDTH, HEIGHT = 196, 127, 219, 232  # the mask's bounding box and 8 pixels around it


def crop_png(source, target):
    depth, colour, rows = read_png(source, Y0 + HEIGHT)
    pixel = (3 if colour == 2 else 1) * depth // 8
    write_png(target, WIDTH, depth, colour, [row[X0 * pixel : (X0 + WIDTH) * pixel] for row in rows[Y0:]])


def read_doubles(path, name):
    """(sizes, values in MATLAB's order, the first index fastest) of a matrix of doubles in a MATLAB file, version 5."""
    data = path.read_bytes()

    def elements(data, at):
        while at + 8 <= len(data):
            kind, size = struct.unpack_from("<II", data, at)
            if kind >> 16:  # four bytes at most stand in the head itself
                yield kind & 0xFFFF, data[at + 4 : at + 4 + (kind >> 16)]
                at += 8
            else:
                yield kind, data[at + 8 : at + 8 + size]
                at += 8 + (size if kind == 15 else (size + 7) // 8 * 8)

    for kind, body in elements(data, 128):
        for kind, matrix in elements(zlib.decompress(body), 0) if kind == 15 else [(kind, body)]:
            parts = list(elements(matrix, 0)) if kind == 14 else []
            if len(parts) > 3 and parts[2][1].decode() == name and parts[3][0] == 9:
                sizes = struct.unpack(f"<{len(parts[1][1]) // 4}i", parts[1][1])
                return sizes, struct.unpack(f"<{len(parts[3][1]) // 8}d", parts[3][1])
    sys.exit(f"{path}: no matrix {name} of doubles")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, target = map(pathlib.Path, sys.argv[1:])
    (target / "images").mkdir(parents=True)
    for name in ("filenames.txt", "light_directions.txt", "light_intensities.txt"):
        shutil.copyfile(source / name, target / name)
    crop_png(source / "mask.png", target / "mask.png")
    for name in (source / "filenames.txt").read_text(encoding="ascii").split():
        crop_png(source / name, target / "images" / name)
    (height, width, channels), normals = read_doubles(source / "Normal_gt.mat", "Normal_gt")
    with open(target / "normal_gt.pfm", "wb") as pfm:
        pfm.write(f"PF\n{WIDTH} {HEIGHT}\n-1.0\n".encode())
        for y in reversed(range(Y0, Y0 + HEIGHT)):
            row = [normals[(c * width + x) * height + y] for x in range(X0, X0 + WIDTH) for c in range(channels)]
            pfm.write(struct.pack(f"<{len(row)}f", *row))


main()
