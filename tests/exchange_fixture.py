"""What tests of exported files share: a flat relief under a dome of lamps, glTF files taken apart, and PSNR. Standard library only."""
import json
import math
import struct

from cli_fixture import write_png


def psnr(a, b):
    squares = sum((x - y) ** 2 for x, y in zip(a, b, strict=True))
    return math.inf if squares == 0 else 10 * math.log10(255**2 * len(a) / squares)


def write_dome(out, width, height, lamps):
    """images and lights.lp of a coloured relief, matt and without shadows, under lamps from 20 to 85 degrees above it."""
    (out / "images").mkdir(parents=True)
    lights = []
    for i in range(lamps):
        z = math.sin(math.radians(20 + 65 * (i + 0.5) / lamps))
        angle, r = 2.4 * i, math.sqrt(1 - z * z)
        light = (r * math.cos(angle), r * math.sin(angle), z)
        rows = bytearray()
        for y in range(height):
            for x in range(width):
                n = (0.25 * math.sin(x / 5), 0.25 * math.sin(y / 7), 1.0)
                facing = max(0, sum(a * b for a, b in zip(n, light))) / math.sqrt(sum(a * a for a in n))
                paint = (0.75, 0.55 + 0.2 * math.sin((x + y) / 9), 0.35 + 0.2 * math.cos(x / 6))
                rows += bytes(round(255 * srgb(0.02 + albedo * facing)) for albedo in paint)
        write_png(out / "images" / f"{i:02}.png", width, height, bytes(rows))
        lights.append(f"{i:02}.png {light[0]} {light[1]} {light[2]}")
    (out / "lights.lp").write_text("\n".join([str(lamps), *lights]) + "\n")


def write_gloss(out, width, height, count):
    """images, lamps.txt and eyes.txt of a glossy sheet (Blinn), in each image from another place under a lamp at another. The first is
    taken from lower than all others."""
    (out / "images").mkdir(parents=True)
    lamps, eyes = [], []
    unit = lambda v: tuple(x / math.sqrt(sum(x * x for x in v)) for x in v)
    for i in range(count):
        place = lambda turn, tilt: tuple(4 * width * x for x in (math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn), math.cos(tilt)))
        lamps.append(place(2.4 * i, 0.9 * math.sqrt((i + 0.5) / count)))
        eyes.append(place(1.1 + 1.9 * i, 0.8 * math.sqrt((7 * i % count + 0.5) / count) if i else 1.1))
        rows = bytearray()
        for y in range(height):
            for x in range(width):
                at = (x + 0.5 - width / 2, height / 2 - y - 0.5, 0)
                to_lamp, to_eye = (unit([a - b for a, b in zip(place, at)]) for place in (lamps[-1], eyes[-1]))
                n = unit((0.2 * math.sin(x / 5), 0.2 * math.sin(y / 7), 1.0))
                half = unit([a + b for a, b in zip(to_lamp, to_eye)])
                facing = max(0, sum(a * b for a, b in zip(n, to_lamp)))
                light = 0.3 * max(0, sum(a * b for a, b in zip(n, half))) ** 20
                paint = (0.4, 0.3 + 0.1 * math.sin((x + y) / 9), 0.2)
                rows += bytes(min(255, round(255 * srgb(0.02 + albedo * facing + light))) for albedo in paint)
        write_png(out / "images" / f"{i:02}.png", width, height, bytes(rows))
    for name, places in (("lamps", lamps), ("eyes", eyes)):
        (out / f"{name}.txt").write_text("".join("{} {} {}\n".format(*place) for place in places))
    (out / "intensities.txt").write_text("{0} {0} {0}\n".format((4 * width) ** 2))


def srgb(linear):
    """IEC 61966-2-1."""
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def ptm_file(width, scale, bias, pixels, paint):
    """A polynomial texture map (LRGB) by its format's description: rows from the bottom; `pixels` has six bytes and `paint` three of each
    pixel, from the top left; value = scale (byte - bias) of x^2, y^2, xy, x, y, 1, times the paint."""
    height = len(pixels) // width
    head = f"PTM_1.2\nPTM_FORMAT_LRGB\n{width}\n{height}\n{' '.join(map(str, scale))}\n{' '.join(map(str, bias))}\n"
    upwards = [y * width + x for y in range(height - 1, -1, -1) for x in range(width)]
    return head.encode() + b"".join(bytes(plane[i]) for plane in (pixels, paint) for i in upwards)


def hsh_file(width, scale, bias, pixels):
    """Hemispherical harmonics in a byte each: of each pixel, from the top left, `pixels` has one row of terms for each channel;
    coefficient = byte / 255 scale + bias."""
    terms = len(scale)
    head = f"#HSH1.2\n3\n{width} {len(pixels) // width} 3\n{terms} {math.isqrt(terms)} 1\n".encode()
    return head + struct.pack(f"<{2 * terms}f", *scale, *bias) + b"".join(bytes(channel) for pixel in pixels for channel in pixel)


class Glb:
    """A GLB file by its specification, with `struct` and `json` alone."""

    def __init__(self, path):
        data = path.read_bytes()
        magic, version, length, json_length, json_kind = struct.unpack_from("<4sIII4s", data)
        assert (magic, version, length, json_kind) == (b"glTF", 2, len(data), b"JSON"), path
        self.json = json.loads(data[20 : 20 + json_length])
        at = 20 + json_length
        binary_length, binary_kind = struct.unpack_from("<I4s", data, at)
        assert binary_kind == b"BIN\0" and at + 8 + binary_length == len(data), path
        self.binary = data[at + 8 :]
        self.radiafit = self.json["extras"]["radiafit"]

    def view(self, number):
        view = self.json["bufferViews"][number]
        return self.binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]

    def vectors(self, attribute):
        accessor = self.json["accessors"][self.json["meshes"][0]["primitives"][0]["attributes"][attribute]]
        size = int(accessor["type"][3:])
        numbers = struct.unpack(f"<{size * accessor['count']}f", self.view(accessor["bufferView"]))
        return [numbers[i : i + size] for i in range(0, len(numbers), size)]

    def image(self, name):
        """The PNG's bytes, or None."""
        for image in self.json["images"]:
            if image["name"] == name:
                return self.view(image["bufferView"])
        return None

    @property
    def material(self):
        return self.json["materials"][0]
