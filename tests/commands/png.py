"""PNG files as `lodestone` writes them: 8-bit RGBA, no interlace."""

import struct
import zlib


class Picture(bytes):
    """Rows of RGB bytes; a failed comparison shows their hash."""

    def __repr__(self):
        return f"<picture of {len(self)} bytes, {zlib.crc32(self):08x}>"


def read_png(path):
    """(width, height, Picture)."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlace = struct.unpack(">IIBBBBB", body)
            assert (depth, colour, interlace) == (8, 6, 0), path
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    rows, stride = zlib.decompress(packed), 4 * width
    above, rgb = bytearray(stride), bytearray()
    for y in range(height):
        start = y * (stride + 1)
        above = unfiltered(rows[start], bytearray(rows[start + 1:start + 1 + stride]), above)
        pixels = bytearray(3 * width)
        for channel in range(3):
            pixels[channel::3] = above[channel::4]
        rgb += pixels
    return width, height, Picture(rgb)


def unfiltered(kind, row, above):
    """A row as it was before the filter of the PNG specification, section 9.2."""
    for i in range(len(row)) if kind else ():
        left = row[i - 4] if i >= 4 else 0
        if kind == 1:
            guess = left
        elif kind == 2:
            guess = above[i]
        elif kind == 3:
            guess = (left + above[i]) // 2
        else:
            corner = above[i - 4] if i >= 4 else 0
            p = left + above[i] - corner
            guess = min((abs(p - left), 0, left), (abs(p - above[i]), 1, above[i]), (abs(p - corner), 2, corner))[2]
        row[i] = (row[i] + guess) & 255
    return row
