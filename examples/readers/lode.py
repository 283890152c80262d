"""Reads a plain .lode file with numpy alone: all of its cells, and every level as one mesh. usage: lode.py FILE [LEVEL]

The bytes are those of docs/format.md. Checksums (XXH3, which Python lacks) are not checked, and materials are left out;
`lodestone` and its Python package check all of a file. Compressed files need the decoders of meshoptimizer: build such a
model without --compress to read it here.
"""

import sys

import numpy

U, F, D = "<u4", "<f4", "<f8"
HEADER = numpy.dtype([
    ("magic", "S8"), ("version", U), ("byte_order", U), ("record_bytes", U, 3), ("level_count", U), ("cell_count", "<u8"),
    ("payload_offset", "<u8"), ("payload_bytes", "<u8"), ("asset_bytes", "<u8"), ("checksums", "<u8", 2), ("origin", D, 3),
    ("scale", D), ("sigma0", F), ("simplifier", U), ("cell_triangles", U), ("features", "<u2"), ("lattice_bits", "u1"),
    ("up", "u1"), ("input_vertices", "<u8"), ("input_triangles", "<u8"), ("fingerprint", "<u8"), ("repairs", "<u8", 9)])
LEVEL = numpy.dtype([
    ("first_cell", U), ("cell_count", U), ("triangles", "<u8"), ("vertices", "<u8"), ("long_edges", "<u8"), ("reach", F, 2),
    ("diameter", F), ("error", F), ("max_edge", F), ("reserved", U)])
CELL = numpy.dtype([
    ("code", "<u8"), ("offset", "<u8"), ("checksum", "<u8"), ("parent", U), ("first_child", U), ("child_count", U),
    ("vertices", U), ("shared", U), ("triangles", U), ("lo", F, 3), ("hi", F, 3), ("max_displacement", F), ("error", F)])
COMPRESSED, UV, COLOURS, MATERIALS, SHORT_INDICES = 1, 4, 8, 16, 4096  # features that concern the payload
NO_PARENT = 0xffffffff


class Lode:
    """header, levels and cells are records with the names above; level 0 is the root."""

    def __init__(self, path):
        self.bytes = numpy.memmap(path, numpy.uint8, "r")
        self.header = self._array(0, HEADER, 1)[0]
        if self.header["magic"] != b"\x93LODE\r\n\x1a" or self.header["version"] != 1:
            raise ValueError(f"{path}: not a .lode file of version 1")
        if self.header["features"] & COMPRESSED:
            raise ValueError(f"{path}: compressed; build it without --compress")
        self.levels = self._array(HEADER.itemsize, LEVEL, self.header["level_count"])
        self.cells = self._array(HEADER.itemsize + self.levels.nbytes, CELL, self.header["cell_count"])

    def _array(self, offset, kind, count):
        size = int(count) * numpy.dtype(kind).itemsize
        return self.bytes[int(offset):int(offset) + size].view(kind)

    def cell(self, index):
        """The arrays of a cell: positions in the unit cube, parents into those of the parent cell, and so on."""
        record, features = self.cells[index], self.header["features"]
        n = int(record["vertices"])
        arrays, at = {}, int(record["offset"])
        short = bool(features & SHORT_INDICES)
        parents = ("parents", "<u2" if short else U, 1, n * (record["parent"] != NO_PARENT))
        for name, kind, width, count in (
                ("positions", F, 3, n), ("normals", "<i2", 2, n), *([] if short else [parents]),
                ("shared_ids", U, 1, record["shared"]), ("uv", F, 2, n * bool(features & UV)),
                ("colours", "u1", 4, n * bool(features & COLOURS)), ("materials", U, 1, n * bool(features & MATERIALS)),
                *([parents] if short else []), ("triangles", "<u2" if short else U, 3, record["triangles"])):
            values = self._array(at, kind, int(count) * width)
            arrays[name] = values.reshape(-1, width) if width > 1 else values
            at += values.nbytes
        arrays["normals"] = unpack_normals(arrays["normals"])
        return arrays

    def level(self, number):
        """(positions, triangles) of a level in the space of the model; vertices that several cells share are one."""
        level = self.levels[number]
        positions, keys, triangles, base = [], [], [], 0
        for index in range(level["first_cell"], level["first_cell"] + level["cell_count"]):
            cell = self.cell(index)
            n, shared = len(cell["positions"]), len(cell["shared_ids"])
            positions.append(cell["positions"])
            keys.append(numpy.arange(base, base + n) + (1 << 32))  # of vertices of this cell alone
            keys[-1][n - shared:] = cell["shared_ids"]  # these come last
            triangles.append(cell["triangles"].astype(numpy.int64) + base)
            base += n
        triangles = numpy.concatenate(triangles)
        used, corners = numpy.unique(numpy.concatenate(keys)[triangles], return_inverse=True)
        vertices = numpy.zeros(len(used), numpy.int64)
        vertices[corners.ravel()] = triangles.ravel()  # any of the copies: they have the same bits
        points = numpy.concatenate(positions)[vertices].astype(numpy.float64)
        return self.header["origin"] + self.header["scale"] * points, corners.reshape(-1, 3)


def unpack_normals(packed):
    """Unit vectors of octahedral coordinates."""
    xy = numpy.maximum(packed.astype(numpy.float64) / 32767, -1)
    z = 1 - numpy.abs(xy).sum(axis=1)
    fold = numpy.maximum(-z, 0)[:, None]
    normal = numpy.column_stack([xy - numpy.where(xy >= 0, fold, -fold), z])
    return normal / numpy.linalg.norm(normal, axis=1, keepdims=True)


if __name__ == "__main__":
    lode = Lode(sys.argv[1])
    for number in [int(sys.argv[2])] if sys.argv[2:] else range(len(lode.levels)):
        points, corners = lode.level(number)
        print(f"level {number}: {len(corners)} triangles, {len(points)} vertices, from {points.min(axis=0)} to {points.max(axis=0)}")
