// OBJ, OFF, STL, Draco, and the choice among them.
#include <filesystem>
#include <fstream>
#include <string>

#include "core/files/text_scanner.h"
#include "tests/core/formats/io_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

constexpr auto obj = MeshFormat::obj;
constexpr auto ply = MeshFormat::ply;
constexpr auto off = MeshFormat::off;
constexpr auto stl = MeshFormat::stl;

TEST(TextScanner, SplitsLinesAndWords) {
  const std::string text = "  one\ttwo # comment\n\n#\nthree \\\n four\\\r\nfive\rsix";
  ByteReader input({text.data(), text.size()}, "file");
  TextScanner scan(input);
  EXPECT_EQ(scan.token(), "one");
  EXPECT_EQ(scan.token(), "two");
  EXPECT_EQ(scan.token(), "");
  EXPECT_EQ(scan.token_across_lines(), "three");
  EXPECT_EQ(scan.line(), 4u);
  EXPECT_EQ(scan.token(), "four");
  EXPECT_EQ(scan.token(), "five");
  EXPECT_EQ(scan.token(), "");
  EXPECT_TRUE(scan.next_line());
  EXPECT_EQ(scan.line(), 7u);
  EXPECT_EQ(scan.token(), "six");
  EXPECT_FALSE(scan.next_line());
  EXPECT_EQ(scan.token_across_lines(), "");
}

TEST(TextScanner, RefusesWordsWithoutEnd) {
  const std::string text = "v 1 2 " + std::string(10'000, '3');
  expect_error<InputError>(text, obj, {"line 1", "4096 characters"});
}

TEST(TextScanner, ParsesNumbers) {
  EXPECT_EQ(parse_number("1.5e3"), 1500);
  EXPECT_EQ(parse_number("+.5"), 0.5);
  EXPECT_EQ(parse_number("-7."), -7);
  for (const char* bad : {"", "+", "-", "1,5", "1.5x", "0x10", "++1", "+-1", "1.#", "e5"})
    EXPECT_EQ(parse_number(bad), std::nullopt) << bad;
  for (const char* bad : {"", "+", "1.0", "1e3", "99999999999999999999"}) EXPECT_EQ(parse_integer(bad), std::nullopt);
}

TEST(Obj, AllFormsOfCorners) {
  const RawMesh mesh = read_bytes(
      "# a comment\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0 0.5 0.5 0.5\nvt 0 0\nvn 0 0 1\n"
      "g part\nusemtl m\ns off\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 \\\n 3/1/1 # tail\nv 0 0 1\n"
      "f -4 -1 -2\nf 1 2 3 4\nl 1 2\np 1\nf 1 2\nf\n",
      obj);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh.triangles,
            (std::vector<Triangle>{
                {{0, 1, 2}}, {{0, 1, 2}}, {{0, 1, 2}}, {{0, 1, 2}}, {{0, 3, 2}}, {{0, 1, 2}}, {{0, 2, 3}}}));
  EXPECT_EQ(mesh.polygons_triangulated, 1u);
  EXPECT_EQ(mesh.faces_dropped, 2u);
}

TEST(Obj, FacesMayComeBeforeVertices) {
  EXPECT_EQ(read_bytes("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0", obj).triangles, (std::vector<Triangle>{{{0, 1, 2}}}));
}

TEST(Obj, ErrorsNameTheLine) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_error<InputError>("", obj, {"empty"});
  expect_error<InputError>("hello\n", obj, {"no triangle"});
  expect_error<InputError>(vertices + "f 1 2 0\n", obj, {"line 4", "index 0"});
  expect_error<InputError>(vertices + "f 1 2 4\nf 1 2 3\n", obj, {"line 4", "index 4", "3 vertices"});
  expect_error<InputError>(vertices + "f 1 2 9223372036854775807\n", obj, {"line 4"});
  expect_error<InputError>(vertices + "f 1 2 -9223372036854775808\n", obj, {"line 4"});
  expect_error<InputError>(vertices + "f 1 2 -4\n", obj, {"line 4", "-4"});
  expect_error<InputError>(vertices + "f 1 2 x\n", obj, {"line 4", "'x'"});
  expect_error<InputError>(vertices + "f 1 2 /3\n", obj, {"line 4"});
  expect_error<InputError>("v 0 0\n", obj, {"line 1", "z coordinate", "the end"});
  expect_error<InputError>("v 0 zero 0\n", obj, {"line 1", "y coordinate", "'zero'"});
}

TEST(Off, VariantsWithMoreThanPositions) {
  const std::vector<Vec3d> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  for (const std::string text :
       {"OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 2\n",
        "# first\nOFF 4 2\n\n0 0 0\n# between\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2 255 0 0\n3 1 3 2 0.5 0.5 0.5 1",
        "COFF\n4 2 5\n0 0 0 255 0 0 255\n1 0 0 1 1 1\n0 1 0\n1 1 0 7\n3 0 1 2\n3 1 3 2\n",
        "NOFF\n4 2 5\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n1 1 0 0 0 1\n3 0 1 2\n3 1 3 2\n",
        "STCNOFF\r\n4 2 5\r\n0 0 0 0\r\n1 0 0 0\r\n0 1 0 0\r\n1 1 0 0\r\n3 0 1 2\r\n3 1 3 2\r\n"}) {
    const RawMesh mesh = read_bytes(text, off);
    EXPECT_EQ(mesh.positions, positions) << text;
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{1, 3, 2}}})) << text;
  }
  const RawMesh polygons = read_bytes("OFF 4 3 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 3 2\n2 0 1\n0\n", off);
  EXPECT_EQ(polygons.triangles, (std::vector<Triangle>{{{0, 1, 3}}, {{0, 3, 2}}}));
  EXPECT_EQ(polygons.polygons_triangulated, 1u);
  EXPECT_EQ(polygons.faces_dropped, 2u);
}

TEST(Off, AttributesOfVertices) {
  const std::string faces = "3 0 1 2\n";
  const RawMesh all = read_bytes(
      "STCNOFF 3 1 0\n0 0 0 0 0 2 255 0 51 102 0.25 0.75\n1 0 0 0 3 0 0 0 0 255 1 1\n"
      "0 1 0 0 0 1 9 9 9 9 0 0\n" +
          faces,
      off);
  EXPECT_EQ(all.warnings, std::vector<std::string>{});
  EXPECT_EQ(all.wedges.normal, (std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(all.wedges.colour, (std::vector<Rgba8>{{255, 0, 51, 102}, {0, 0, 0, 255}, {9, 9, 9, 9}}));
  EXPECT_EQ(all.wedges.uv, (std::vector<Vec2f>{{0.25f, 0.25f}, {1, 0}, {0, 1}}));
  const RawMesh unit = read_bytes("COFF 3 1 0\n0 0 0 1 0 0.2\n1 0 0 0 0 0\n0 1 0 1 1 1\n" + faces, off);
  EXPECT_EQ(unit.wedges.colour, (std::vector<Rgba8>{{255, 0, 51, 255}, {0, 0, 0, 255}, {255, 255, 255, 255}}));
  EXPECT_TRUE(unit.wedges.uv.empty() && unit.wedges.normal.empty());
  const RawMesh whole = read_bytes("COFF 3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 0 0 1\n0 1 0 1 1 1 0\n" + faces, off);
  EXPECT_EQ(whole.wedges.colour[0], (Rgba8{255, 0, 0, 255})) << "nothing above 1: counts to 1";
  const RawMesh stoff = read_bytes("STOFF 3 1 0\n0 0 0 0 1\n1 0 0 1 1\n0 1 0 0 0\n" + faces, off);
  EXPECT_EQ(stoff.wedges.uv, (std::vector<Vec2f>{{0, 0}, {1, 0}, {0, 1}}));
}

TEST(Off, WhatIsMissingOrLeftOutIsAWarning) {
  const RawMesh mesh =
      read_bytes("COFF 4 2 0\n0 0 0 255 0 0\n1 0 0\n0 1 0 7\n1 1 0 1 2 x\n3 0 1 2 255 0 0\n3 1 3 2\n", off);
  EXPECT_EQ(mesh.wedges.colour, (std::vector<Rgba8>{{255, 0, 0, 255}, {}, {}, {}}));
  expect_warning(mesh, {"3 vertices lack attributes"});
  expect_warning(mesh, {"the colours of 1 faces are left out"});
  const RawMesh shape = read_bytes("COFF 3 1 0\n0 0 0 1 1 1\n1 0 0\n0 1 0\n3 0 1 2 7\n", off, {.attributes = false});
  EXPECT_TRUE(shape.wedges.empty() && shape.warnings.empty());
}

TEST(Off, ErrorsNameTheLine) {
  expect_error<InputError>("", off, {"empty"});
  expect_error<InputError>("FFO\n", off, {"line 1", "'FFO'"});
  expect_error<InputError>("XOFF\n", off, {"line 1", "'XOFF'"});
  expect_error<UnsupportedError>("4OFF\n", off, {"file: line 1", "three dimensions"});
  expect_error<UnsupportedError>("nOFF\n", off, {"three dimensions"});
  expect_error<UnsupportedError>("OFF BINARY\n", off, {"binary"});
  expect_error<InputError>("OFF\n", off, {"number of vertices", "the end"});
  expect_error<InputError>("OFF\n-1 1 0\n", off, {"line 2", "negative"});
  expect_error<InputError>("OFF\n353535235358 6 0\n0 0 0\n", off, {"line 2", "declares 353535235358", "truncated"});
  expect_error<InputError>("OFF\n1 9223372036854775807 0\n0 0 0\n", off, {"declares", "truncated"});
  expect_error<InputError>("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", off, {"line 6", "index 3"});
  expect_error<InputError>("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", off, {"line 6", "index -1"});
  expect_error<InputError>("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", off, {"line 4", "z coordinate"});
  expect_error<InputError>("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", off, {"line 6", "negative"});
  const std::string whole = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW((void)read_bytes(std::string_view(whole).substr(0, size), off), InputError) << size;
}

std::string binary_stl(std::string head, std::uint32_t declared, int facets) {
  head.resize(80, '\0');
  Bytes bytes(head);
  bytes.put(declared);
  for (int i = 0; i < facets; ++i) {
    for (const float normal : {0.f, 0.f, 1.f}) bytes.put(normal);
    for (int k = 0; k < 9; ++k) bytes.put(static_cast<float>(9 * i + k));
    bytes.put(std::uint16_t{0});
  }
  return bytes.str();
}

const std::string ascii_stl =
    "solid two words\n facet normal 0 0 1\n  outer loop\n   vertex 0 1 2\n   vertex 3 4 5\n   vertex 6 7 8\n"
    "  endloop\n endfacet\n FACET NORMAL nan nan nan\n  outer loop\n   vertex 9 10 11\n   vertex 12 13 14\n"
    "   vertex 15 16 17\n  endloop\n endfacet\nendsolid two words\n";

TEST(Stl, BinaryAndAsciiAreToldApartBySizeNotByTheWordSolid) {
  const RawMesh expected = read_bytes(ascii_stl, stl);
  EXPECT_EQ(expected.positions.size(), 6u);
  EXPECT_EQ(expected.positions[5], (Vec3d{15, 16, 17}));
  EXPECT_EQ(expected.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{3, 4, 5}}}));
  for (const std::string head : {"", "solid model", "solid \n"}) {
    const RawMesh mesh = read_bytes(binary_stl(head, 2, 2), stl);
    EXPECT_EQ(mesh.positions, expected.positions);
    EXPECT_EQ(mesh.triangles, expected.triangles);
  }
  EXPECT_EQ(read_bytes(binary_stl("x", 1, 2), stl).triangles.size(), 1u) << "trailing bytes are not facets";
}

TEST(Stl, SeveralSolidsAndPolygons) {
  const RawMesh mesh = read_bytes(ascii_stl + ascii_stl, stl);
  EXPECT_EQ(mesh.triangles.size(), 4u);
  const RawMesh quad = read_bytes(
      "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet\n"
      "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 endloop endfacet\nendsolid",
      stl);
  EXPECT_EQ(quad.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{0, 2, 3}}}));
  EXPECT_EQ(quad.polygons_triangulated, 1u);
  EXPECT_EQ(quad.faces_dropped, 1u);
}

TEST(MeshReaders, CutPolygonsWithinThemselves) {
  // An arrow, of which the fan from its first corner would leave the outline; then a square.
  const std::vector<Triangle> cut{{{3, 0, 1}}, {{3, 1, 2}}, {{0, 1, 2}}, {{0, 2, 3}}};
  const std::string vertices = "4 3 0\n0 0 0\n4 -3 0\n2 0 0\n9 0 0\n9 9 0\n0 9 0\n";
  const auto expect_cut = [&](const RawMesh& mesh) {
    std::vector<Triangle> triangles = mesh.triangles;
    ASSERT_EQ(triangles.size(), 4u);
    for (std::size_t t = 2; t < 4; ++t)
      for (std::uint32_t& v : triangles[t].v) v = v == 1 ? 0 : v - 3;
    EXPECT_EQ(triangles, cut);
    EXPECT_EQ(mesh.polygons_triangulated, 2u);
  };
  expect_cut(read_bytes("OFF 7 2 0\n" + vertices + "4 0 1 2 3\n4 1 4 5 6\n", off));
  expect_cut(read_bytes("f 1 2 3 4\nf 2 5 6 7\nv 4 3 0\nv 0 0 0\nv 4 -3 0\nv 2 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\n", obj));
  const std::string header = "ply\nformat ascii 1.0\n", last = "end_header\n";
  const std::string vertex = "element vertex 7\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 2\nproperty list uchar int vertex_indices\n", faces = "4 0 1 2 3\n4 1 4 5 6\n";
  expect_cut(read_bytes(header + vertex + face + last + vertices + faces, ply));
  expect_cut(read_bytes(header + face + vertex + last + faces + vertices, ply));
  const RawMesh mesh = read_bytes(
      "solid\nfacet normal 0 0 1 outer loop vertex 4 3 0 vertex 0 0 0 vertex 4 -3 0 vertex 2 0 0 endloop endfacet\n"
      "endsolid",
      stl);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{cut[0], cut[1]}));
}

TEST(Stl, Errors) {
  expect_error<InputError>("", stl, {"empty"});
  expect_error<InputError>("short", stl, {"84"});
  expect_error<InputError>(binary_stl("", 3, 2), stl, {"byte 80", "3 facets", "has 2"});
  expect_error<InputError>(binary_stl("solid", 3, 2), stl, {"byte 80", "3 facets"});
  expect_error<InputError>(binary_stl("", 0xFFFFFFFFu, 2), stl, {"truncated"});
  expect_error<InputError>(binary_stl("", 0, 0), stl, {"no triangle"});
  expect_error<InputError>("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n", stl, {"line 4", "'zero'"});
  expect_error<InputError>("solid x\nvertex 0 0 0\n", stl, {"line 2", "'vertex'"});
  expect_error<InputError>("solid x\nfacet normal 0 0 1\nouter ring\n", stl, {"line 3", "'loop'", "'ring'"});
  for (std::size_t size = 0; size + 20 < ascii_stl.size(); ++size)
    EXPECT_THROW((void)read_bytes(std::string_view(ascii_stl).substr(0, size), stl), InputError) << size;
}

TEST(Draco, DamagedFilesAreErrors) {
  expect_error<InputError>("", MeshFormat::draco, {"empty"});
  expect_error<InputError>("DRACO", MeshFormat::draco, {"file: cannot decode"});
  expect_error<InputError>("DRACO\x02\x02\x01\x01 nonsense", MeshFormat::draco, {"file"});
  // Counts that the bytes cannot hold: one face and 2^28 points; 2^28 vertices; 8 vertices and 2^28 faces.
  const auto bytes = [](int method, std::string_view counts) {
    const std::string head{"DRACO\x02\x02\x01", 8};
    return head + static_cast<char>(method) + std::string(2, '\0') + std::string(counts) + std::string(40, '\0');
  };
  using namespace std::string_view_literals;
  for (const std::string& crafted : {bytes(0, "\x01\x80\x80\x80\x80\x01"sv), bytes(1, "\0\x80\x80\x80\x80\x01\x01"sv),
                                     bytes(1, "\0\x08\x80\x80\x80\x80\x01"sv)})
    expect_error<InputError>(crafted, MeshFormat::draco, {"declares 268435456", "split the mesh"});
}

TEST(Draco, PositionsAreNotTruthValues) {
  // One face of three points, uncompressed; the type of the positions, and nine bytes.
  const auto triangle = [](char type) {
    std::string bytes("DRACO\x02\x02\x01\0\0\0\1\3\1\0\1\2\1\1\0", 20);
    bytes.push_back(type);
    return bytes.append("\3\0\0\0\2\0\0\0\2\0\0\0\2", 13);
  };
  EXPECT_EQ(read_bytes(triangle(2), MeshFormat::draco).triangles.size(), 1u);  // bytes
  expect_error<InputError>(triangle(11), MeshFormat::draco, {"value 0 of an attribute"});
}

TEST(Draco, ReadsTheVerticesOfTheEncoder) {
  LODESTONE_MODEL_OR_SKIP(path, "scans/komaba_01.drc");
  const RawMesh mesh = read_mesh(path);
  EXPECT_EQ(mesh.positions.size(), 1540806u);
  EXPECT_EQ(mesh.triangles.size(), 3024313u);
}

TEST(MeshFile, ChoosesByExtensionThenByContent) {
  const auto format = [](const char* name, const std::string& bytes) {
    ByteReader input({bytes.data(), bytes.size()}, name);
    return mesh_format(name, input);
  };
  EXPECT_EQ(format("a.PLY", ""), MeshFormat::ply);
  EXPECT_EQ(format("a.obj", "ply\n"), MeshFormat::obj);
  EXPECT_EQ(format("a.STL", ""), MeshFormat::stl);
  EXPECT_EQ(format("a.off", ""), MeshFormat::off);
  EXPECT_EQ(format("a.drc", ""), MeshFormat::draco);
  EXPECT_EQ(format("a.GLB", ""), MeshFormat::gltf);
  EXPECT_EQ(format("a.gltf", ""), MeshFormat::gltf);
  EXPECT_EQ(format("tileset.json", ""), MeshFormat::tileset);
  EXPECT_EQ(format("N01E001.hgt", ""), MeshFormat::hgt);
  EXPECT_EQ(format("a.asc", ""), MeshFormat::ascii_grid);
  EXPECT_EQ(format("a.mesh", "glTF\2"), MeshFormat::gltf);
  EXPECT_EQ(format("a", "ply\nformat"), MeshFormat::ply);
  EXPECT_EQ(format("a.mesh", "# x\nv 0 0 0\n"), MeshFormat::obj);
  EXPECT_EQ(format("a.mesh", ascii_stl), MeshFormat::stl);
  EXPECT_EQ(format("a.mesh", binary_stl("x", 2, 2)), MeshFormat::stl);
  EXPECT_EQ(format("a.mesh", "COFF\n1 1 1"), MeshFormat::off);
  EXPECT_EQ(format("a.mesh", "DRACO\x02"), MeshFormat::draco);
  EXPECT_EQ(format("a.ply", "\x93LODE\r\n"), MeshFormat::ply);
  EXPECT_THROW(format("a.mesh", "something else"), UnsupportedError);
  for (const std::string name : {"a.lode", "a"})
    expect_error_of<UnsupportedError>(
        [&] { return format(name.c_str(), "\x93LODE\r\n\x1a" + std::string(200, '\0')); },
        {name + ": is a hierarchy (.lode), not a mesh; give the mesh that it was built from"});
}

// Told by their first bytes whatever they are called, else by their name; a known content goes before a foreign name.
TEST(MeshFile, FilesOfOtherProgramsAreNamed) {
  const auto format = [](const std::string& name, std::string bytes) {
    bytes.resize(200);  // with zeros, as in a binary STL
    ByteReader input({bytes.data(), bytes.size()}, name);
    return mesh_format(name, input);
  };
  const auto refused = [&](const std::string& name, const std::string& bytes, const std::string& says) {
    expect_error_of<UnsupportedError>([&] { return format(name, bytes); }, {name + ": is a file of format " + says});
  };
  refused("a.FBX", "Kaydara FBX Binary  ", "FBX, which is not read; export a .glb, .obj or .ply");
  refused("a", "Kaydara FBX Binary  ", "FBX");
  refused("a.fbx", "; FBX 7.4.0 project file", "FBX");
  refused("cloud.las", "LASF", "LAS, which is not read; it holds points");
  refused("dem.tif", std::string("II*\0", 4), "TIFF, which is not read; convert its heights");
  refused("dem", std::string("MM\0*", 4), "TIFF");
  refused("part.stp", "text", "STEP, which is not read; mesh its surfaces");
  refused("a.stl.gz", "\x1f\x8b", "gzip, which is not read; unpack it");
  refused("a.xz", "\xfd\x37zXZ", "xz");
  refused("a.stl", "Kaydara FBX Binary  ", "FBX");
  refused("a.obj", "PK\3\4", "ZIP");
  const std::string whole = binary_stl("LASF, but a header may say anything", 2, 2);
  ByteReader facets({whole.data(), whole.size()}, "a.stl");
  EXPECT_EQ(mesh_format("a.stl", facets), MeshFormat::stl);
  const std::string_view text = "v 0 0 0\nv 1 0 0\n";
  ByteReader input({text.data(), text.size()}, "points.xyz");
  EXPECT_EQ(mesh_format("points.xyz", input), MeshFormat::obj);
}

// Numbers alone pass for the facets of a damaged STL; their count tells some of them.
TEST(MeshFile, BareHeightsOfAnUnknownNameNeedTheirGrid) {
  std::string heights(2 * 1201 * 1201, '\0');
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = static_cast<char>(i * 7);
  const auto format = [&](const std::string& name) {
    ByteReader input({heights.data(), heights.size()}, name);
    return mesh_format(name, input);
  };
  expect_error_of<UnsupportedError>([&] { return format("a.dem"); },
                                    {"a.dem", "--grid 1201x1201:i16be:90", "N49W124.hgt"});
  EXPECT_EQ(format("N49W124.hgt"), MeshFormat::hgt);
  heights.resize(5000);
  expect_error_of<UnsupportedError>([&] { return format("a.dem"); }, {"not of a known mesh format", "or give --grid"});
}

TEST(MeshFile, FilesThatCannotBeReadAreFileErrors) {
  expect_error_of<FileError>([] { return read_mesh("no/such/file.ply"); }, {"no/such/file.ply", "cannot open"});
  const TestFolder folder;
  expect_error_of<UnsupportedError>([&] { return read_mesh(folder.path()); },
                                    {folder.path().string(), "neither a tileset.json nor .hgt"});
}

// Through windows of a file much larger than one window, as through memory.
TEST(MeshFile, WindowsGiveTheSameAsMemory) {
  std::string text;
  for (int i = 0; i < 60'000; ++i) text += "v " + std::to_string(i) + " 0." + std::to_string(i) + " \\\n 1\n";
  for (int i = 0; i + 2 < 60'000; ++i) text += "f " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "/1 -1\n";
  ASSERT_GT(text.size(), ByteReader::max_window * 2);
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "windows.obj";
  std::ofstream(path, std::ios::binary) << text;
  const RawMesh from_file = read_mesh(path), from_memory = read_bytes(text, obj);
  std::filesystem::remove(path);
  EXPECT_EQ(from_file.positions, from_memory.positions);
  EXPECT_EQ(from_file.triangles, from_memory.triangles);
  EXPECT_EQ(from_file.positions[59'999], (Vec3d{59'999, 0.59999, 1}));
}

TEST(MeshFile, RealModelsHaveTheCountsOfTheirDataSheet) {
  LODESTONE_MODEL_OR_SKIP(igea, "scans/igea.ply");
  LODESTONE_MODEL_OR_SKIP(rangemap, "scans/rangemap_lato315.ply");
  LODESTONE_MODEL_OR_SKIP(spider, "hard/Spider_ascii.stl");
  LODESTONE_MODEL_OR_SKIP(camel, "cad/camelhead.off");
  LODESTONE_MODEL_OR_SKIP(skull, "scans/skull.obj");
  const auto counts = [](const std::filesystem::path& path) {
    const RawMesh mesh = read_mesh(path);
    return std::pair(mesh.positions.size(), mesh.triangles.size());
  };
  EXPECT_EQ(counts(igea), std::pair(134345ul, 268686ul));
  EXPECT_EQ(counts(rangemap), std::pair(62702ul, 120995ul));
  EXPECT_EQ(counts(spider), std::pair(3 * 1368ul, 1368ul));
  EXPECT_EQ(counts(camel), std::pair(11381ul, 22704ul));
  EXPECT_EQ(counts(skull), std::pair(49999ul, 100002ul));
}

}  // namespace
}  // namespace lodestone
