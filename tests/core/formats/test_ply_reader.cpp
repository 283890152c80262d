#include <limits>
#include <string>

#include "tests/core/formats/io_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

constexpr auto ply = MeshFormat::ply;

const std::vector<Vec3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

std::string header(std::string_view format, std::string_view elements) {
  return "ply\nformat " + std::string(format) + " 1.0\ncomment made by a test\nobj_info none\n" +
         std::string(elements) + "end_header\n";
}

constexpr std::string_view plain_elements =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\n";

constexpr std::string_view plain_body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n";

TEST(Ply, Ascii) {
  const RawMesh mesh = read_bytes(header("ascii", plain_elements) + std::string(plain_body), ply);
  EXPECT_EQ(mesh.positions, corners);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 2, 1}}, {{0, 1, 3}}}));
  EXPECT_EQ(mesh.polygons_triangulated + mesh.faces_dropped, 0u);
}

TEST(Ply, LineEndsAndLineBreaksDoNotMatter) {
  const std::string text = header("ascii", plain_elements) + std::string(plain_body);
  const RawMesh expected = read_bytes(text, ply);
  for (const std::string_view line_end : {"\r\n", "\r", " \t\n"}) {
    std::string other;
    for (const char c : text) c == '\n' ? other += line_end : other += c;
    EXPECT_EQ(read_bytes(other, ply).triangles, expected.triangles);
  }
  const std::string one_line = header("ascii", plain_elements) + "0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3";
  EXPECT_EQ(read_bytes(one_line, ply).positions, corners);
}

// Every scalar type for coordinates and indices, in all three encodings, with properties to skip all around.
template <class Coordinate, class Count, class Index>
void expect_types(const std::string& coordinate, const std::string& count, const std::string& index) {
  const std::string elements = "element vertex 4\nproperty uchar red\nproperty " + coordinate + " y\nproperty " +
                               coordinate + " x\nproperty short flag\nproperty " + coordinate + " z\n" +
                               "element face 2\nproperty double quality\nproperty list " + count + " " + index +
                               " vertex_index\nproperty char flag\n";
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    Bytes bytes(header(order == std::endian::big ? "binary_big_endian" : "binary_little_endian", elements), order);
    for (const Vec3d p : corners) {
      bytes.put(std::uint8_t{200}).put(static_cast<Coordinate>(p.y)).put(static_cast<Coordinate>(p.x));
      bytes.put(std::int16_t{-7}).put(static_cast<Coordinate>(p.z));
    }
    for (const Triangle& t : {Triangle{{0, 2, 1}}, Triangle{{0, 1, 3}}}) {
      bytes.put(0.5).put(Count{3});
      for (const std::uint32_t id : t.v) bytes.put(static_cast<Index>(id));
      bytes.put(std::int8_t{-1});
    }
    const RawMesh mesh = read_bytes(bytes.str(), ply);
    EXPECT_EQ(mesh.positions, corners) << coordinate;
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 2, 1}}, {{0, 1, 3}}})) << count << " " << index;
  }
  const std::string ascii =
      header("ascii", elements) + "9 0 0 -7 0\n9 0 1 -7 0\n9 1 0 -7 0\n9 0 0 -7 1\n0.5 3 0 2 1 -1\n0.5 3 0 1 3 -1\n";
  EXPECT_EQ(read_bytes(ascii, ply).positions, corners);
}

TEST(Ply, AllScalarTypes) {
  expect_types<std::int8_t, std::int8_t, std::int8_t>("char", "char", "char");
  expect_types<std::uint8_t, std::uint8_t, std::uint8_t>("uint8", "uint8", "uint8");
  expect_types<std::int16_t, std::int16_t, std::int16_t>("short", "int16", "short");
  expect_types<std::uint16_t, std::uint16_t, std::uint16_t>("ushort", "ushort", "uint16");
  expect_types<std::int32_t, std::int32_t, std::int32_t>("int", "int32", "int32");
  expect_types<std::uint32_t, std::uint32_t, std::uint32_t>("uint32", "uint", "uint");
  expect_types<float, std::uint8_t, std::int32_t>("float32", "uchar", "int");
  expect_types<double, std::uint8_t, std::uint32_t>("double", "uchar", "uint32");
}

TEST(Ply, CoordinatesOfMixedTypes) {
  Bytes bytes(header("binary_big_endian",
                     "element vertex 3\nproperty double x\nproperty float y\nproperty short z\n"
                     "element face 1\nproperty list uchar int vertex_indices\n"),
              std::endian::big);
  for (int i = 0; i < 3; ++i)
    bytes.put(1e7 + i + 0.001).put(0.5f + static_cast<float>(i)).put(static_cast<std::int16_t>(-i));
  bytes.put(std::uint8_t{3}).put(0).put(1).put(2);
  EXPECT_EQ(read_bytes(bytes.str(), ply).positions,
            (std::vector<Vec3d>{{1e7 + 0.001, 0.5, 0}, {1e7 + 1 + 0.001, 1.5, -1}, {1e7 + 2 + 0.001, 2.5, -2}}));
}

TEST(Ply, PolygonsBecomeFansAndStubsAreCounted) {
  const std::string elements =
      "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 6\nproperty list uchar int vertex_indices\n";
  const std::vector<std::vector<int>> faces{{0, 1, 2}, {4, 3, 2, 1, 0}, {1, 2}, {}, {0, 1, 2, 3}, {2, 3, 4}};
  const std::vector<Triangle> expected{{{0, 1, 2}}, {{4, 3, 2}}, {{4, 2, 1}}, {{4, 1, 0}},
                                       {{0, 1, 2}}, {{0, 2, 3}}, {{2, 3, 4}}};
  Bytes binary(header("binary_little_endian", elements));
  std::string ascii = header("ascii", elements);
  for (int i = 0; i < 15; ++i) {
    binary.put(static_cast<float>(i));
    ascii += std::to_string(i) + " ";
  }
  for (const auto& face : faces) {
    binary.put(static_cast<std::uint8_t>(face.size()));
    ascii += "\n" + std::to_string(face.size());
    for (const int id : face) {
      binary.put(id);
      ascii += " " + std::to_string(id);
    }
  }
  for (const std::string& text : {binary.str(), ascii}) {
    const RawMesh mesh = read_bytes(text, ply);
    EXPECT_EQ(mesh.triangles, expected);
    EXPECT_EQ(mesh.polygons_triangulated, 2u);
    EXPECT_EQ(mesh.faces_dropped, 2u);
  }
}

TEST(Ply, StripsTurnEveryOtherTriangleAndRestart) {
  const std::string elements =
      "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\n";
  const RawMesh mesh =
      read_bytes(header("ascii", elements) + "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1\n9 0 1 2 3 -1 2 1 4 -1", ply);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{2, 1, 3}}, {{2, 1, 4}}}));
}

TEST(Ply, OtherElementsAndListsAnywhereAreSkipped) {
  const std::string elements =
      "element camera 2\nproperty list uchar float matrix\nproperty int id\n"
      "element nothing 1000000000000\n"
      "element vertex 3\nproperty list uchar short bones\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\n"
      "property list int uchar tags\nelement edge 1\nproperty int a\n";
  Bytes binary(header("binary_little_endian", elements));
  binary.put(std::uint8_t{2}).put(1.f).put(2.f).put(7).put(std::uint8_t{0}).put(8);
  for (int i = 0; i < 3; ++i) {
    binary.put(static_cast<std::uint8_t>(i));
    for (int k = 0; k < i; ++k) binary.put(std::int16_t{99});
    binary.put(static_cast<float>(i)).put(0.f).put(1.f);
  }
  binary.put(std::uint8_t{1}).put(0.f).put(std::uint8_t{3}).put(0).put(1).put(2).put(2).put(std::uint16_t{0}).put(5);
  const std::string ascii =
      header("ascii", elements) + "2 1 2 7\n0 8\n0 0 0 1\n1 99 1 0 1\n2 99 99 2 0 1\n" + "1 0 3 0 1 2 2 0 0\n5\n";
  for (const std::string& text : {binary.str(), ascii}) {
    const RawMesh mesh = read_bytes(text, ply);
    EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}}));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}}));
  }
}

TEST(Ply, FacesMayComeBeforeVertices) {
  const RawMesh mesh = read_bytes(header("ascii",
                                         "element face 1\nproperty list uchar int vertex_indices\n"
                                         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n") +
                                      "3 0 1 2 0 0 0 1 0 0 0 1 0",
                                  ply);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}}));
}

TEST(Ply, NonFiniteCoordinatesAreReadAsTheyAre) {
  const RawMesh mesh =
      read_bytes(header("ascii", plain_elements) +
                     "nan -inf 1e400\n-1.#IND 1.#QNAN 1.#INF\n+1.5 1e-400 INF\n0 0 1\n3 0 2 1\n3 0 1 3",
                 ply);
  EXPECT_TRUE(std::isnan(mesh.positions[0].x) && mesh.positions[0].y == -HUGE_VAL && mesh.positions[0].z == HUGE_VAL);
  EXPECT_TRUE(std::isnan(mesh.positions[1].x) && std::isnan(mesh.positions[1].y) && mesh.positions[1].z == HUGE_VAL);
  EXPECT_EQ(mesh.positions[2], (Vec3d{1.5, 0, HUGE_VAL}));
}

TEST(Ply, HeaderErrorsNameTheLine) {
  expect_error<InputError>("", ply, {"file: is empty"});
  expect_error<InputError>("plywood\n", ply, {"line 1", "'ply'"});
  expect_error<InputError>("ply\nformat ascii 1.0\n", ply, {"header does not end"});
  expect_error<InputError>("ply\nend_header\n", ply, {"no format"});
  expect_error<InputError>("ply\nformat text 1.0\n", ply, {"line 2", "'text'"});
  expect_error<UnsupportedError>("ply\nformat ascii 2.0\n", ply, {"file: line 2", "2.0"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement vertex\n", ply, {"line 3"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement vertex -4\n", ply, {"line 3", "negative"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n", ply, {"line 3"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement v 1\nelement v 2\n", ply, {"line 4", "twice"});
  expect_error<InputError>("ply\nformat ascii 1.0\nproperty float x\n", ply, {"line 3", "before the first element"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n", ply, {"line 4", "'real'"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement face 1\nproperty list float int v\n", ply, {"integer"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement vertex 1\nfoo\n", ply, {"line 4", "unknown keyword 'foo'"});
  expect_error<InputError>("ply\nformat ascii 1.0\nelement vertex 1\nproperty \x01\x02 x\n", ply, {"'\\x01\\x02'"});
  expect_error<InputError>(header("ascii", "element vertex 1\nproperty float x\nproperty float y\n") + "0 0    0", ply,
                           {"x, y and z"});
  expect_error<InputError>(
      header("ascii", "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n") + "0 0 0", ply,
      {"no triangle", "1 vertices"});
  expect_error<InputError>(header("ascii", "element face 1000000000000\n"), ply, {"vertex_indices"});
  expect_error<InputError>(header("ascii", "element face 1\nproperty list uchar float vertex_indices\n") + "1 0", ply,
                           {"not integers"});
}

TEST(Ply, UnknownWordsBeforeTheFirstElementAreForgottenComments) {
  const std::string text = "ply\nformat ascii 1.0\nCreated by hand\n" + std::string(plain_elements) + "end_header\n";
  EXPECT_EQ(read_bytes(text + std::string(plain_body), ply).positions, corners);
}

TEST(Ply, HugeDeclaredCountsAreRefusedBeforeMemoryIsAllocated) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    for (const std::string count : {"4000000000", "9223372036854775807"}) {
      expect_error<InputError>(
          header(format, "element vertex " + count + "\nproperty float x\nproperty float y\nproperty float z\n"), ply,
          {"declares " + count, "truncated"});
      expect_error<InputError>(
          header(format, "element face " + count + "\nproperty list uchar int vertex_indices\n") + "0123456789", ply,
          {"declares " + count, "truncated"});
    }
  }
  Bytes list(header("binary_little_endian",
                    "element junk 1\nproperty list uint double values\nelement vertex 0\nelement face 0\n"));
  list.put(0xFFFFFFFFu);
  expect_error<InputError>(list.str(), ply, {"'junk' 0", "ends"});
}

TEST(Ply, EveryTruncationIsAnError) {
  Bytes binary(header("binary_little_endian", plain_elements));
  for (const Vec3d p : corners)
    binary.put(static_cast<float>(p.x)).put(static_cast<float>(p.y)).put(static_cast<float>(p.z));
  for (const int id : {1, 3}) binary.put(std::uint8_t{3}).put(0).put(2).put(id);
  const std::string ascii = header("ascii", plain_elements) + std::string(plain_body.substr(0, plain_body.size() - 1));
  for (const std::string& whole : {binary.str(), ascii}) {
    EXPECT_EQ(read_bytes(whole, ply).triangles.size(), 2u);
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_THROW((void)read_bytes(std::string_view(whole).substr(0, size), ply), Error) << size;
  }
}

TEST(Ply, IndicesOutOfRangeNameTheFace) {
  const auto binary = [](int index) {
    Bytes bytes(header("binary_little_endian", plain_elements));
    for (int i = 0; i < 12; ++i) bytes.put(0.f);
    bytes.put(std::uint8_t{3}).put(0).put(1).put(2).put(std::uint8_t{3}).put(0).put(1).put(index);
    return bytes.str();
  };
  for (const int index : {4, -1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()})
    expect_error<InputError>(binary(index), ply, {"element 'face' 1 at byte", "index " + std::to_string(index)});
  const std::string ascii = header("ascii", plain_elements) + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n";
  expect_error<InputError>(ascii + "3 0 1 4\n", ply, {"line 17", "element 'face' 1", "index 4"});
  expect_error<InputError>(ascii + "3 0 1 -1\n", ply, {"line 17", "index -1"});
  expect_error<InputError>(ascii + "3 0 1 x\n", ply, {"line 17", "'x'"});
}

// A header that announces other values than follow: the message says what was expected where, and points at the header.
TEST(Ply, ValuesThatDoNotFitTheHeaderSayWhatWasExpectedWhere) {
  constexpr std::string_view hint = "; the element counts or properties of the header may be wrong";
  std::string fewer(plain_elements), more(plain_elements);
  fewer.replace(fewer.find("vertex 4"), 8, "vertex 3");
  more.replace(more.find("vertex 4"), 8, "vertex 6");
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n0.5 0.5 1\n3 0 2 1\n3 0 1 3\n";
  expect_error<InputError>(header("ascii", fewer) + body, ply,
                           {"file: line 15: element 'face' 0: expected the length of the list 'vertex_indices', found "
                            "'0.5'",
                            hint});
  expect_error<InputError>(header("ascii", more) + body, ply,
                           {"element 'face' 1: the file ends before element 1 of 2"});
  const std::string bad_x = header("ascii", plain_elements) + "0 0 0\n1 0 0\nx 1 0\n0.5 0.5 1\n3 0 2 1\n3 0 1 3\n";
  expect_error<InputError>(bad_x, ply, {"line 14: element 'vertex' 2: expected a number for 'x', found 'x'", hint});
  const std::string bad_index = header("ascii", plain_elements) + body + "3 0 1.5 3\n";
  expect_error<InputError>(std::string(bad_index).replace(bad_index.find("3 0 2"), 5, "3 0 ?"), ply,
                           {"element 'face' 0: expected an integer in the list 'vertex_indices', found '?'", hint});
}

TEST(Ply, ARealHeaderWithoutItsFacesIsBlamed) {
  LODESTONE_MODEL_OR_SKIP(path, "hard/issue623.ply");
  expect_error_of<InputError>([&] { return read_mesh(path); }, {"line 15", "element 'vertex' 0", "'vertex_indices'",
                                                                "'7.941797'", "header may be wrong"});
}

TEST(Ply, ListsOfNegativeLengthAreRefused) {
  const std::string elements =
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list char int vertex_indices\n";
  Bytes bytes(header("binary_little_endian", elements));
  bytes.put(0.f).put(0.f).put(0.f).put(std::int8_t{-3}).put(0).put(0).put(0);
  expect_error<InputError>(bytes.str(), ply, {"negative length"});
  expect_error<InputError>(header("ascii", elements) + "0 0 0 -3 0 0 0", ply, {"negative length"});
}

}  // namespace
}  // namespace lodestone
