#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/mesh/clean.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "tests/expect_error.h"
#include "tests/test_bytes.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

void expect_same(const IndexedMesh& a, const IndexedMesh& b) {
  EXPECT_TRUE(test::same_bytes(a.positions, b.positions));
  EXPECT_TRUE(test::same_bytes(a.triangles, b.triangles));
  EXPECT_EQ(a.transform, b.transform);
  EXPECT_EQ(std::memcmp(&a.transform.origin, &b.transform.origin, sizeof(Vec3d)), 0);  // also the sign of zero
}

// Prepares with any number of workers, compares each with the serial twin, and returns the mesh.
IndexedMesh prepared(const RawMesh& raw, Repairs& repairs, Lattice lattice = {}) {
  const IndexedMesh expected = clean_mesh(raw, repairs, {}, lattice);
  for (const int threads : {0, 1, 2, 3, 7}) {
    const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
    Repairs counted;
    RawMesh copy = raw;
    expect_same(expected, prepare_mesh(std::move(copy), counted, *scheduler, {}, lattice));
    EXPECT_EQ(repairs, counted) << threads << " threads";
  }
  return expected;
}

// A tetrahedron that needs no repair, wound outwards.
RawMesh tetrahedron() {
  RawMesh raw;
  raw.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  raw.triangles = {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{2, 0, 3}}};
  return raw;
}

TEST(Prepare, SoundMeshStaysAsItIs) {
  Repairs repairs;
  const IndexedMesh mesh = prepared(tetrahedron(), repairs);
  EXPECT_EQ(repairs, Repairs{});
  EXPECT_EQ(mesh.triangles, tetrahedron().triangles);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh.transform, (Transform{{0, 0, 0}, 2}));
}

TEST(Prepare, DropsTrianglesWithNonFiniteCorners) {
  RawMesh raw = tetrahedron();
  raw.positions.push_back({nan, 0, 0});
  raw.positions.push_back({0, -infinity, 0});
  raw.triangles.insert(raw.triangles.begin(), {{0, 1, 4}});
  raw.triangles.push_back({{5, 1, 2}});
  Repairs repairs;
  const IndexedMesh mesh = prepared(raw, repairs);
  EXPECT_EQ(mesh.triangles, tetrahedron().triangles);
  EXPECT_EQ(repairs, (Repairs{.non_finite_triangles = 2, .unreferenced_vertices = 2}));
}

TEST(Prepare, BoxIsThatOfVerticesInUse) {
  RawMesh raw = tetrahedron();
  raw.positions.push_back({1e9, 1e9, 1e9});
  raw.positions.push_back({-1e9, 0, 0});
  raw.positions.push_back({nan, 0, 0});
  raw.triangles.push_back({{4, 0, 6}});  // goes, and vertex 4 with it
  Repairs repairs;
  EXPECT_EQ(prepared(raw, repairs).transform, (Transform{{0, 0, 0}, 2}));
  EXPECT_EQ(repairs, (Repairs{.non_finite_triangles = 1, .unreferenced_vertices = 3}));
}

TEST(Prepare, WeldsIntoTheFirstVertexOfEqualPosition) {
  RawMesh raw = tetrahedron();
  raw.positions.insert(raw.positions.begin(), {0, 0, 0});  // not in use: does not count as the first
  for (Triangle& t : raw.triangles)
    for (std::uint32_t& id : t.v) ++id;
  raw.positions.push_back({-0.0, 0, 0});       // 5 = 1, although of other bits
  raw.positions.push_back({2 - 1e-12, 0, 0});  // 6 = 2 in float32, after normalisation
  raw.triangles[1] = {{5, 6, 4}};
  Repairs repairs;
  const IndexedMesh mesh = prepared(raw, repairs);
  EXPECT_EQ(mesh.triangles, tetrahedron().triangles);
  EXPECT_EQ(repairs, (Repairs{.welded_vertices = 2, .unreferenced_vertices = 1}));
}

TEST(Prepare, DropsDegenerateAndDuplicateButNotTurnedOrFlatTriangles) {
  RawMesh raw = tetrahedron();
  raw.positions.push_back({1, 0, 0});
  raw.positions.push_back({2, 0, 0});
  raw.triangles.push_back({{1, 1, 2}});  // degenerate
  raw.triangles.push_back({{1, 5, 2}});  // degenerate after welding
  raw.triangles.push_back({{3, 1, 2}});  // the third one again, begun elsewhere
  raw.triangles.push_back({{1, 2, 3}});  // and again
  raw.triangles.push_back({{3, 2, 1}});  // turned over: kept
  raw.triangles.push_back({{0, 4, 1}});  // no area: kept
  Repairs repairs;
  const IndexedMesh mesh = prepared(raw, repairs);
  std::vector<Triangle> expected = tetrahedron().triangles;
  expected.push_back({{3, 2, 1}});
  expected.push_back({{0, 4, 1}});
  EXPECT_EQ(mesh.triangles, expected);
  EXPECT_EQ(repairs, (Repairs{.welded_vertices = 1, .degenerate_triangles = 2, .duplicate_triangles = 2}));
}

TEST(Prepare, PutsEveryVertexOnTheNearestPointOfTheLattice) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-3, 40);
  RawMesh raw;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    raw.positions.push_back({unit(random), unit(random), unit(random)});
    if (i % 3 == 2) raw.triangles.push_back({{i - 2, i - 1, i}});
  }
  for (const int bits : {4, 11, 24}) {
    Repairs repairs;
    const IndexedMesh mesh = prepared(raw, repairs, {bits});
    EXPECT_EQ(mesh.transform.lattice, Lattice{bits});
    for (const Vec3f p : mesh.positions) EXPECT_TRUE(mesh.transform.lattice.holds(p));
    if (bits < 24) continue;
    ASSERT_EQ(mesh.positions.size(), raw.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3d exact = (1 / mesh.transform.scale) * (raw.positions[i] - mesh.transform.origin);
      EXPECT_LE(length(exact - to_double(mesh.positions[i])), double{mesh.transform.lattice.error()});
    }
  }
}

TEST(Prepare, WeldsWhatMeetsOnTheLattice) {
  RawMesh raw = tetrahedron();
  raw.positions.push_back({0.1, 0, 0});  // 4: a sixteenth of the extent is 0.125
  raw.triangles.push_back({{0, 1, 4}});
  raw.triangles.push_back({{4, 1, 3}});  // the second one again, once welded
  Repairs repairs;
  EXPECT_EQ(prepared(raw, repairs, {4}).positions.size(), 5u);  // 0.1 is nearer to 0.125
  EXPECT_EQ(repairs, Repairs{});
  EXPECT_EQ(prepared(raw, repairs, {3}).triangles, tetrahedron().triangles);
  EXPECT_EQ(repairs, (Repairs{.welded_vertices = 1, .degenerate_triangles = 1, .duplicate_triangles = 1}));
}

TEST(Prepare, ChoosesALatticeFarFinerThanTheEdges) {
  for (const int n : {2, 40, 200}) {
    RawMesh raw;  // a flat sheet of n x n squares
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) raw.positions.push_back({10.0 * i / n, 10.0 * j / n, 0});
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) raw.triangles.push_back({{at(i, j), at(i + 1, j), at(i, j + 1)}});
    raw.positions.push_back({nan, 0, 0});
    raw.triangles.push_back({{0, 1, static_cast<std::uint32_t>(raw.positions.size() - 1)}});
    raw.triangles.push_back({{0, 0, 1}});
    Repairs repairs;
    const Lattice lattice = prepared(raw, repairs, {Lattice::automatic}).transform.lattice;
    EXPECT_EQ(lattice.bits, 16) << n;
    EXPECT_LE(lattice.step(), 1.0 / n / 256);
    raw.triangles.assign(20, raw.triangles[0]);  // and then one edge in twenty very short
    raw.positions.push_back(raw.positions[0] + Vec3d{1e-5, 0, 0});
    raw.triangles.push_back({{0, 1, static_cast<std::uint32_t>(raw.positions.size() - 1)}});
    raw.triangles.push_back(raw.triangles.back());
    raw.triangles.push_back(raw.triangles.back());
    raw.triangles.push_back(raw.triangles.back());
    EXPECT_GT(prepared(raw, repairs, {Lattice::automatic}).transform.lattice.bits, lattice.bits);
  }
  RawMesh point;
  point.positions.assign(3, {1, 1, 1});
  EXPECT_EQ(choose_lattice(point.positions, std::vector<Triangle>{{{0, 1, 2}}}, 1).bits, Lattice::most_bits);
}

TEST(Prepare, RefusesALatticeOutOfRange) {
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  for (const int bits : {-2, 25, 1000}) {
    EXPECT_THROW((void)clean_mesh(tetrahedron(), repairs, {}, {bits}), InputError);
    EXPECT_THROW((void)prepare_mesh(tetrahedron(), repairs, *scheduler, {}, {bits}), InputError);
  }
}

TEST(Prepare, HandsOnWhatTheReaderCounted) {
  RawMesh raw = tetrahedron();
  raw.polygons_triangulated = 3;
  raw.faces_dropped = 4;
  Repairs repairs;
  (void)prepared(raw, repairs);
  EXPECT_EQ(repairs, (Repairs{.polygons_triangulated = 3, .faces_dropped = 4}));
}

// Random soup on a coarse lattice: every kind of repair, many of each, in several chunks and buckets.
TEST(Prepare, EqualsItsTwinOnASoup) {
  std::mt19937 random(7);
  const auto below = [&random](std::uint32_t n) { return static_cast<std::uint32_t>(random()) % n; };
  RawMesh raw;
  raw.positions.resize(90'000);
  for (Vec3d& p : raw.positions) {
    p = {1e6 + below(30) * 0.1, below(30) * 0.1 - 3, -(below(30) * 0.1)};
    if (below(1000) == 0) p.y = nan;
  }
  raw.triangles.resize(200'000);
  for (Triangle& t : raw.triangles) {
    const std::uint32_t base = below(80'000);
    for (std::uint32_t& id : t.v) id = base + below(6);
  }
  for (int i = 0; i < 5000; ++i) raw.triangles[below(200'000)] = raw.triangles[below(200'000)];
  Repairs repairs;
  const IndexedMesh mesh = prepared(raw, repairs);
  EXPECT_GT(repairs.non_finite_triangles, 100u);
  EXPECT_GT(repairs.welded_vertices, 10'000u);
  EXPECT_GT(repairs.degenerate_triangles, 10'000u);
  EXPECT_GT(repairs.duplicate_triangles, 1000u);
  EXPECT_GT(repairs.unreferenced_vertices, 1000u);
  EXPECT_EQ(raw.positions.size(), mesh.positions.size() + repairs.welded_vertices + repairs.unreferenced_vertices);
  EXPECT_EQ(raw.triangles.size(), mesh.triangles.size() + repairs.non_finite_triangles + repairs.degenerate_triangles +
                                      repairs.duplicate_triangles);
}

// Checks the promises of IndexedMesh without the code that made it.
void expect_clean(const IndexedMesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    EXPECT_FALSE(is_degenerate(t));
    for (const std::uint32_t id : t.v) used.at(id) = 1;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
  Vec3f highest{};
  for (const Vec3f p : mesh.positions) {
    EXPECT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1 && p.z >= 0 && p.z <= 1);
    EXPECT_FALSE(std::signbit(p.x) || std::signbit(p.y) || std::signbit(p.z));
    highest = {std::max(highest.x, p.x), std::max(highest.y, p.y), std::max(highest.z, p.z)};
  }
  EXPECT_EQ(std::max({highest.x, highest.y, highest.z}), 1.0f);
}

TEST(Prepare, HardModelsBecomeCleanMeshesOrClearErrors) {
  LODESTONE_MODEL_OR_SKIP(folder, "hard");
  const auto scheduler = make_serial_scheduler();
  int meshes = 0, errors = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().filename().string());
    try {
      const RawMesh raw = load_mesh(entry.path(), *scheduler, {.attributes = false});
      Repairs repairs;
      expect_clean(prepared(raw, repairs));
      ++meshes;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(entry.path().filename().string()), std::string::npos) << error.what();
      ++errors;
    }
  }
  EXPECT_EQ(meshes, 20);
  EXPECT_EQ(errors, 7);  // three empty ones, OutOfMemory.off, fuzzed_header.ply, issue623.ply, malformed.obj
}

TEST(Prepare, RealRepairsAreThoseOnTheDataSheet) {
  LODESTONE_MODEL_OR_SKIP(bunny, "scans/stanford-bunny.obj");
  LODESTONE_MODEL_OR_SKIP(wuson, "hard/Wuson.ply");
  LODESTONE_MODEL_OR_SKIP(chair, "hard/chair_model.obj");
  Repairs repairs;
  EXPECT_EQ(prepared(read_mesh(bunny, {.attributes = false}), repairs).triangles.size(), 69451u);
  EXPECT_EQ(repairs.unreferenced_vertices, 1113u);
  (void)prepared(read_mesh(wuson, {.attributes = false}), repairs);
  EXPECT_EQ(repairs.welded_vertices, 9067u);
  (void)prepared(read_mesh(chair, {.attributes = false}), repairs);
  EXPECT_EQ(repairs.welded_vertices, 28u);
}

TEST(Prepare, OffsetsOfMillionsOfMetresKeepTheSurface) {
  LODESTONE_MODEL_OR_SKIP(terrain, "hard/bigtujunga_utm11n_double.ply");
  Repairs repairs;
  const IndexedMesh mesh = prepared(read_mesh(terrain, {.attributes = false}), repairs);
  EXPECT_EQ(repairs, Repairs{});
  const RawMesh raw = read_mesh(terrain);
  for (std::size_t i = 0; i < raw.positions.size(); i += 997) {
    const Vec3d difference = mesh.transform.to_model(mesh.positions[i]) - raw.positions[i];
    EXPECT_LT(length(difference), 6e-8 * mesh.transform.scale);
  }
}

TEST(Prepare, ErrorsSayWhyNothingIsLeft) {
  const auto scheduler = make_serial_scheduler();
  const auto refused = [&](const RawMesh& raw, const char* part) {  // by both, with the same message
    Repairs repairs;
    std::string serial;
    try {
      (void)clean_mesh(raw, repairs, "m.ply");
    } catch (const InputError& error) {
      serial = error.what();
    }
    expect_error_of<InputError>([&] { return prepare_mesh(RawMesh(raw), repairs, *scheduler, "m.ply"); },
                                {"m.ply: ", part, serial});
    EXPECT_NE(serial.find(part), std::string::npos) << serial;
  };
  refused({}, "no triangle is left");
  RawMesh raw = tetrahedron();
  for (Vec3d& p : raw.positions) p.z = nan;
  refused(raw, "4 with a corner that is not finite");
  for (Vec3d& p : raw.positions) p = {3, 3, 3};
  refused(raw, "4 with two equal vertices");
  raw.positions = {{-1e308, 0, 0}, {1e308, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  refused(raw, "too large or too small");
  raw.positions = {{0, 0, 0}, {1e-310, 0, 0}, {0, 1e-310, 0}, {0, 0, 1e-310}};
  refused(raw, "too large or too small");
}

}  // namespace
}  // namespace lodestone
