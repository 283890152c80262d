"""Materials of glTF through every command that writes glTF. usage: FILE PROGRAM"""

import json
import math
import struct
import zlib

import command_case
from command_case import CommandCase


def png(size, pixel):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    rows = b"".join(b"\0" + bytes(v for x in range(size) for v in pixel(x, y)) for y in range(size))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def globe(material, images):
    """A sphere of 3,968 triangles under this material, as binary glTF."""
    n, m, positions, uv, ids = 64, 32, [], [], []
    for j in range(m + 1):
        for i in range(n + 1):
            a, b = 2 * math.pi * (i % n) / n, math.pi * j / m
            positions += [math.sin(b) * math.cos(a), math.cos(b), -math.sin(b) * math.sin(a)] if 0 < j < m else [
                0, math.cos(b), 0]
            uv += [i / n, j / m]
    for j in range(m):
        for i in range(n):
            a, b = j * (n + 1) + i, (j + 1) * (n + 1) + i
            ids += ([a, b, b + 1] if j < m - 1 else []) + ([a, b + 1, a + 1] if j > 0 else [])
    parts = [struct.pack(f"<{len(positions)}f", *positions), struct.pack(f"<{len(uv)}f", *uv),
             struct.pack(f"<{len(ids)}I", *ids), *images]
    binary, views = b"", []
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(part)})
        binary += part + bytes(-len(part) % 4)
    count = len(positions) // 3
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "buffers": [{"byteLength": len(binary)}], "bufferViews": views,
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
                       "min": [-1, -1, -1], "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5125, "count": len(ids), "type": "SCALAR"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "images": [{"bufferView": 3 + k, "mimeType": "image/png"} for k in range(len(images))],
        "samplers": [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 33071}],
        "textures": [{"source": k, "sampler": 0} for k in range(len(images))],
        "materials": [material]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return (b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" +
            text + struct.pack("<I", len(binary)) + b"BIN\0" + binary)


def document_of(path):
    data = path.read_bytes()
    return json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])


MATERIAL = {
    "name": "rich",
    "pbrMetallicRoughness": {"baseColorFactor": [1.0, 0.5, 0.25, 1.0], "baseColorTexture": {"index": 0},
                             "metallicFactor": 0.5, "roughnessFactor": 0.25, "metallicRoughnessTexture": {"index": 1}},
    "normalTexture": {"index": 2, "scale": 0.5},
    "occlusionTexture": {"index": 1, "strength": 0.75},
    "emissiveFactor": [0.5, 0.25, 1.0],
    "emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2.0, 2.0]}}},
    "alphaMode": "MASK",
    "alphaCutoff": 0.25,
    "doubleSided": True,
    "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatTexture": {"index": 1}},
                   "KHR_materials_ior": {"ior": 1.25}},
}
# Paths to the textureInfos of the material.
PLACES = [("pbrMetallicRoughness", "baseColorTexture"), ("pbrMetallicRoughness", "metallicRoughnessTexture"),
          ("normalTexture",), ("occlusionTexture",), ("emissiveTexture",),
          ("extensions", "KHR_materials_clearcoat", "clearcoatTexture")]


def taken_apart(material):
    """The material without its numbers of textures, and these in the order of PLACES."""
    material, numbers = json.loads(json.dumps(material)), []
    for place in PLACES:
        info = material
        for key in place:
            info = info[key]
        numbers.append(info.pop("index"))
    return material, numbers


class Materials(CommandCase):
    def setUp(self):
        super().setUp()
        images = [png(128, lambda x, y: (2 * x, 2 * y, 90)), png(128, lambda x, y: (200, 2 * x, 255 * (y // 16 % 2))),
                  png(128, lambda x, y: (128 + x // 8, 128, 255))]
        (self.folder / "globe.glb").write_bytes(globe(MATERIAL, images))
        self.lodestone("build", "globe.glb", "-o", "globe.lode", "--quiet", "--cell-triangles", 400, "--texture-levels")

    def expect_all(self, path):
        document = document_of(path)
        for material in document["materials"]:
            found, numbers = taken_apart(material)
            expected, sources = taken_apart(MATERIAL)
            self.assertEqual(found, expected, path)
            # Equal textures are one.
            self.assertEqual([numbers.index(n) for n in numbers], [sources.index(n) for n in sources], path)
        for sampler in document["samplers"]:
            self.assertEqual(sampler, {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 33071})

    def test_every_command_keeps_them(self):
        out = self.folder / "out"
        out.mkdir()
        self.assertTrue(self.results("verify", "globe.lode", "--input", "globe.glb")["valid"])
        self.lodestone("export", "globe.lode", "-o", "out/level.glb", "--quiet", "--level", 1)
        self.lodestone("progressive", "globe.glb", "-o", "out/progressive.glb", "--quiet")
        self.lodestone("progressive", "globe.glb", "-o", "wire.lpm", "--quiet")
        self.lodestone("lod", "wire.lpm", "--triangles", 2000, "-o", "out/wire.glb", "--quiet")
        self.lodestone("reconstruct", "globe.glb", "-o", "out/scan.glb", "--quiet", "--resolution", 64, "--attributes")
        self.lodestone("export", "globe.lode", "--tiles", "out/tiles", "--quiet")
        for path in out.rglob("*.glb"):
            self.expect_all(path)
        self.assertGreater(self.validate(out, known="MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"), 10)

    def test_spherical_draws_images_and_names_the_rest(self):
        warnings = self.results("spherical", "globe.glb", "-o", "sphere.glb", "--texture", 64)["warnings"]
        self.assertEqual(warnings, ["globe.glb: extensions with images of materials are left out"])
        [material] = document_of(self.folder / "sphere.glb")["materials"]
        self.assertEqual((material["alphaMode"], material["alphaCutoff"], material["doubleSided"]), ("MASK", 0.25, True))
        for drawn in ("occlusionTexture", "emissiveTexture", "normalTexture"):
            self.assertIn(drawn, material)
        for drawn in ("baseColorTexture", "metallicRoughnessTexture"):
            self.assertIn(drawn, material["pbrMetallicRoughness"])

    def test_meshes_without_one_are_no_metal(self):
        self.lodestone("generate", "sphere", "--triangles", 500, "-o", "sphere.ply", "--quiet")
        self.lodestone("build", "sphere.ply", "-o", "sphere.lode", "--quiet")
        self.lodestone("export", "sphere.lode", "-o", "sphere.glb", "--quiet")
        self.lodestone("progressive", "sphere.ply", "-o", "progressive.glb", "--quiet")
        for name in ("sphere.glb", "progressive.glb"):
            document = document_of(self.folder / name)
            self.assertEqual(document["materials"], [{"pbrMetallicRoughness": {"metallicFactor": 0}, "doubleSided": True}])
            self.assertEqual(document["meshes"][0]["primitives"][0]["material"], 0)


if __name__ == "__main__":
    command_case.main(__doc__)
