"""PNG files as rows of bytes, by the standard library alone."""
import struct
import sys
import zlib


def read_png(path, count=None):
    """(bit depth, colour type, the first `count` rows of bytes, or all) of a PNG without interlacing or palette."""
    data = path.read_bytes()
    at, packed, head = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, colour, _, _, interlaced = head
    if interlaced or colour not in (0, 2) or depth not in (8, 16):
        sys.exit(f"{path}: not a PNG of 8 or 16 bits, grey or RGB, without interlacing")
    pixel = (3 if colour == 2 else 1) * depth // 8
    line, raw, rows = width * pixel, zlib.decompress(packed), []
    before = bytearray(line)
    for y in range(height if count is None else count):
        kind, row = raw[y * (line + 1)], bytearray(raw[y * (line + 1) + 1 : (y + 1) * (line + 1)])
        for i in range(line if kind else 0):
            left, up, corner = (row[i - pixel], before[i], before[i - pixel]) if i >= pixel else (0, before[i], 0)
            if kind == 1:
                row[i] = (row[i] + left) & 255
            elif kind == 2:
                row[i] = (row[i] + up) & 255
            elif kind == 3:
                row[i] = (row[i] + (left + up) // 2) & 255
            else:  # Paeth: whichever of the three is nearest to left + up - corner
                to_left, to_up, to_corner = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
                near = left if to_left <= to_up and to_left <= to_corner else up if to_up <= to_corner else corner
                row[i] = (row[i] + near) & 255
        rows.append(row)
        before = row
    return depth, colour, rows


def write_png(path, width, depth, colour, rows):
    """Uncompressed, so that it has the same bytes wherever it is made."""

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    raw = b"".join(b"\0" + bytes(row) for row in rows)
    blocks = [raw[i : i + 65535] for i in range(0, len(raw), 65535)]
    stored = b"".join(struct.pack("<BHH", block is blocks[-1], len(block), len(block) ^ 0xFFFF) + block for block in blocks)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), depth, colour, 0, 0, 0))
                     + chunk(b"IDAT", b"\x78\x01" + stored + struct.pack(">I", zlib.adler32(raw))) + chunk(b"IEND", b""))
