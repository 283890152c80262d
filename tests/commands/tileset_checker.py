"""A slow and obvious check of a tileset against the 3D Tiles 1.1 specification (OGC 22-025r4), as far as we write it:
explicit tiles with boxes and glTF content. It shares nothing with the program.

The public 3d-tiles-validator asks for the same structure; beyond it, this follows the geometry: content lies in its
box, and boxes in those of their parents.
"""

import itertools
import json
import math
import struct
import urllib.parse

TILE_KEYS = {"boundingVolume", "geometricError", "refine", "transform", "content", "children", "extras"}
TILESET_KEYS = {"asset", "geometricError", "root", "extras"}
IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]


class Wrong(Exception):
    """What is wrong, and where."""


def require(holds, place, what):
    if not holds:
        raise Wrong(f"{place}: {what}")


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def multiply(a, b):
    """Of 4 x 4 matrices by columns."""
    return [sum(a[4 * k + row] * b[4 * column + k] for k in range(4)) for column in range(4) for row in range(4)]


def transformed(matrix, point):
    return [sum(matrix[4 * k + row] * point[k] for k in range(3)) + matrix[12 + row] for row in range(3)]


class Box:
    """Centre and half axes, mutually perpendicular, in the coordinates that `matrix` leads to."""

    def __init__(self, numbers, matrix):
        self.centre = transformed(matrix, numbers[:3])
        self.axes = [[sum(matrix[4 * k + row] * numbers[i + k] for k in range(3)) for row in range(3)]
                     for i in (3, 6, 9)]

    def corners(self):
        for signs in itertools.product((-1, 1), repeat=3):
            yield [self.centre[row] + sum(s * axis[row] for s, axis in zip(signs, self.axes, strict=True))
                   for row in range(3)]

    def holds(self, point, slack):
        offset = [p - c for p, c in zip(point, self.centre, strict=True)]
        for axis in self.axes:
            square = sum(a * a for a in axis)
            along = sum(a * o for a, o in zip(axis, offset, strict=True))
            if abs(along) > square + slack * math.sqrt(square):
                return False
        return True


class Glb:
    """Positions in the coordinates of the scene, y up, and the triangles of all primitives."""

    def __init__(self, path):
        data = path.read_bytes()
        magic, version, size = struct.unpack_from("<4sII", data)
        require((magic, version, size) == (b"glTF", 2, len(data)), path, "header of a .glb file")
        length, kind = struct.unpack_from("<II", data, 12)
        require(kind == 0x4E4F534A, path, "first chunk is JSON")
        self.json = json.loads(data[20 : 20 + length])
        self.binary = data[20 + length + 8 :]
        self.path, self.points, self.triangles = path, [], 0
        for index in self.json["scenes"][self.json.get("scene", 0)]["nodes"]:
            self.add_node(self.json["nodes"][index])

    def add_node(self, node):
        require("children" not in node, self.path, "one node is all we write")
        matrix = node.get("matrix", IDENTITY)
        seen = {}  # primitives share their vertices
        for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
            accessor = primitive["attributes"]["POSITION"]
            if accessor not in seen:
                seen[accessor] = self.values(accessor, "f", 3)
                self.points += [transformed(matrix, p) for p in seen[accessor]]
            positions = seen[accessor]
            for name, components in (("NORMAL", 3), ("TEXCOORD_0", 2)):
                if name in primitive["attributes"]:
                    require(len(self.values(primitive["attributes"][name], "f", components)) == len(positions),
                            self.path, name)
            accessor = self.json["accessors"][primitive["indices"]]
            code = {5123: "H", 5125: "I"}[accessor["componentType"]]
            ids = [i for (i,) in self.values(primitive["indices"], code, 1)]
            require(len(ids) > 0 and len(ids) % 3 == 0 and max(ids) < len(positions), self.path, "indices")
            self.triangles += len(ids) // 3

    def values(self, index, code, components):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        values = struct.iter_unpack(f"<{components}{code}", self.binary[view.get("byteOffset", 0) :][: view["byteLength"]])
        values = list(values)
        require(len(values) == accessor["count"], self.path, f"accessor {index}")
        require(all(math.isfinite(x) for value in values for x in value), self.path, f"accessor {index} is finite")
        return values

    def images(self):
        return [self.path.parent / urllib.parse.unquote(image["uri"]) for image in self.json.get("images", [])
                if "uri" in image]


class Checker:
    def __init__(self, folder):
        self.folder = folder
        self.tiles = self.contents = self.leaves = self.triangles = self.leaf_triangles = self.tilesets = 0
        self.files = set()
        self.leaf_points = []  # in the coordinates of the root, before its own transform

    def check(self):
        path = self.folder / "tileset.json"
        root, error = self.tileset(path)
        require(self.transform(root, path)[:12] == IDENTITY[:12], path, "we move the root, and do nothing else")
        self.tile(root, path, IDENTITY, None, None, error, "root", is_root=True)
        found = {p for p in self.folder.rglob("*") if p.is_file()}
        require(found == self.files, self.folder, f"files that nothing refers to: {found - self.files}")
        return self

    def use(self, path):
        require(path.is_file(), path, "missing")
        self.files.add(path)

    def tileset(self, path):
        """Root tile and geometric error of a tileset file."""
        self.use(path)
        self.tilesets += 1
        document = json.loads(path.read_text())
        require(set(document) <= TILESET_KEYS, path, f"properties {set(document)}")
        require(document["asset"]["version"] == "1.1", path, "asset.version")
        require(is_number(document["geometricError"]) and document["geometricError"] >= 0, path, "geometricError")
        require(document["root"].get("refine") == "REPLACE", path, "root.refine")
        figures = document.get("extras", {}).get("lodestone", {})
        for thumbnail in figures.get("thumbnails", {}).values():
            self.use(path.parent / thumbnail)
        if "signatures" in figures:
            self.use(path.parent / figures["signatures"])
        return document["root"], document["geometricError"]

    def transform(self, tile, place):
        matrix = tile.get("transform", IDENTITY)
        require(len(matrix) == 16 and all(map(is_number, matrix)), place, "transform of 16 numbers")
        require([matrix[i] for i in (3, 7, 11, 15)] == [0, 0, 0, 1], place, "affine transform")
        return matrix

    def tile(self, tile, path, outer, parent_box, parent_slack, parent_error, place, is_root=False):
        where = f"{path}: {place}"
        require(set(tile) <= TILE_KEYS, where, f"properties {set(tile)}")
        error = tile.get("geometricError")
        require(is_number(error) and 0 <= error <= parent_error, where, f"geometricError {error}, {parent_error} above")
        require(tile.get("refine", "REPLACE") == "REPLACE", where, "refine")
        # Relative to the origin of the root, where the digits are.
        matrix = outer if is_root else multiply(outer, self.transform(tile, where))
        numbers = tile["boundingVolume"]["box"]
        require(set(tile["boundingVolume"]) == {"box"} and len(numbers) == 12 and all(map(is_number, numbers)), where,
                "box of 12 numbers")
        box = Box(numbers, matrix)
        require(all(any(axis) for axis in box.axes), where, "a box without an inside")
        slack = 1e-14 * max(abs(x) for corner in box.corners() for x in corner)
        if parent_box:
            require(all(parent_box.holds(corner, parent_slack) for corner in box.corners()), where, "outside its parent")
        children = tile.get("children")
        self.tiles += 1
        if "content" in tile:
            self.content(tile, path, matrix, box, slack, error, where)
        require(children is None or (isinstance(children, list) and children), where, "children")
        for i, child in enumerate(children or []):
            self.tile(child, path, matrix, box, slack, error, f"{place}.children[{i}]")

    def content(self, tile, path, matrix, box, slack, error, where):
        require(set(tile["content"]) == {"uri"}, where, "content.uri")
        uri = tile["content"]["uri"]
        require(not urllib.parse.urlsplit(uri).scheme and not uri.startswith("/"), where, "a relative uri")
        file = (path.parent / urllib.parse.unquote(uri)).resolve()
        if file.suffix == ".json":
            require("children" not in tile, where, "children beside an external tileset")
            root, external_error = self.tileset(file)
            require(external_error <= error, where, "error of an external tileset")
            self.tiles -= 1  # it stands for the root there
            self.tile(root, file, matrix, box, slack, external_error, "root")
            return
        self.use(file)
        glb = Glb(file)
        for image in glb.images():
            self.use(image.resolve())
        self.contents += 1
        self.triangles += glb.triangles
        points = [transformed(matrix, (x, -z, y)) for x, y, z in glb.points]  # tiles are z up
        require(all(box.holds(point, slack) for point in points), where, "content outside its box")
        if "children" not in tile:
            require(error == 0, where, "a leaf with an error")
            self.leaves += 1
            self.leaf_triangles += glb.triangles
            self.leaf_points += points


def check(folder):
    """Raises Wrong, or returns counts."""
    return Checker(folder.resolve()).check()
