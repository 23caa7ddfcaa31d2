"""Whether a file is there to its last byte, by its format's own rules. Standard library only."""
import csv
import io
import json
import struct
import xml.etree.ElementTree
import zlib


class Cut(Exception):
    """Says what is missing or wrong."""


def need(condition, what):
    if not condition:
        raise Cut(what)


def check_png(data):
    """Every chunk's checksum, every row of pixels, and an end with nothing behind it."""
    need(data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG")
    at, packed, kind = 8, b"", b""
    while at < len(data):
        need(at + 12 <= len(data), "a chunk is cut")
        (length,), kind = struct.unpack_from(">I", data, at), data[at + 4 : at + 8]
        need(at + 12 + length <= len(data), f"chunk {kind} is cut")
        body = data[at + 8 : at + 8 + length]
        need(struct.unpack_from(">I", data, at + 8 + length)[0] == zlib.crc32(kind + body), f"checksum of {kind}")
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", body)
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
        if kind == b"IEND":
            break
    need(kind == b"IEND" and at == len(data), "no end, or something behind it")
    need(not interlaced, "interlaced, which nothing here writes")
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    need(len(zlib.decompress(packed)) == height * (1 + (width * channels * depth + 7) // 8), "rows are missing")


def exr_header(data):
    """Attributes by name, and where the line table begins."""
    need(data[:4] == b"\x76\x2f\x31\x01", "no EXR")
    attributes, at = {}, 8
    while data[at : at + 1] != b"\0":
        end = data.index(b"\0", at)
        kind_end = data.index(b"\0", end + 1)
        (size,) = struct.unpack_from("<I", data, kind_end + 1)
        attributes[data[at:end].decode()] = data[kind_end + 5 : kind_end + 5 + size]
        at = kind_end + 5 + size
    return attributes, at + 1


def exr_pixel_bytes(channels):
    """Of one pixel, all channels together."""
    at, total = 0, 0
    while channels[at : at + 1] != b"\0":
        at = channels.index(b"\0", at) + 1
        total += {0: 4, 1: 2, 2: 4}[struct.unpack_from("<I", channels, at)[0]]
        at += 16
    return total


def check_exr(data):
    """Scan lines packed by ZIP, 16 rows in a block: every block the line table names is there and unpacks to its size."""
    try:
        attributes, at = exr_header(data)
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        need(attributes["compression"] == b"\x03", "not packed by ZIP")
        row, blocks = exr_pixel_bytes(attributes["channels"]) * (x1 - x0 + 1), (y1 - y0) // 16 + 1
        end = at + 8 * blocks
        for i, place in enumerate(struct.unpack_from(f"<{blocks}Q", data, at)):
            y, size = struct.unpack_from("<iI", data, place)
            whole = row * min(16, y1 - y0 + 1 - 16 * i)
            body = data[place + 8 : place + 8 + size]
            need(place > 0 and y == y0 + 16 * i and len(body) == size, f"block {i} is missing or cut")
            need(size == whole or len(zlib.decompress(body)) == whole, f"block {i} is short")
            end = max(end, place + 8 + size)
        need(end == len(data), "something behind the last block")
    except (KeyError, ValueError, struct.error, zlib.error) as error:
        raise Cut(f"EXR: {error}") from error


def check_csv(data):
    need(data.endswith(b"\n"), "the last row has no end")
    widths = {len(row) for row in csv.reader(io.StringIO(data.decode()))}
    need(len(widths) == 1, "rows of unequal length")


def check_json(data):
    json.loads(data)


def check_svg(data):
    xml.etree.ElementTree.fromstring(data)


def check_text(data):
    need(data.endswith(b"\n"), "the last line has no end")


def check_jpeg(data):
    need(data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9", "no JPEG, or no end")


def check_glb(data):
    """Its length, and those of its two chunks."""
    need(len(data) >= 28 and data[:4] == b"glTF", "no GLB")
    (length,), (json_length,) = struct.unpack_from("<I", data, 8), struct.unpack_from("<I", data, 12)
    need(length == len(data), "another length than it says")
    json.loads(data[20 : 20 + json_length])
    need(28 + json_length + struct.unpack_from("<I", data, 20 + json_length)[0] == length, "its chunks are cut")


def check_html(data):
    need(data.rstrip().endswith(b"</html>"), "no end")


CHECKS = {".png": check_png, ".exr": check_exr, ".csv": check_csv, ".json": check_json, ".svg": check_svg, ".md": check_text,
          ".jpg": check_jpeg, ".glb": check_glb, ".html": check_html}


def check_whole(name, data):
    """Throws Cut. Formats without an inner end (pixels, records) are compared by their bytes alone."""
    for ending, check in CHECKS.items():
        if name.endswith(ending):
            try:
                need(data, "empty")
                check(data)
            except Cut:
                raise
            except Exception as error:  # whatever a library says of a cut file
                raise Cut(f"{type(error).__name__}: {error}") from error
