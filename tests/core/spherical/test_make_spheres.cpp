// Any mesh becomes spheres: generated ones, the hard ones, and real models.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/mesh/clean.h"
#include "core/mesh/solids.h"
#include "core/spherical/topology/make_spheres.h"
#include "parallel/clean/prepare.h"
#include "parallel/scheduler/scheduler.h"
#include "tests/test_data.h"
#include "tests/test_meshes.h"

namespace lodestone::spherical {
namespace {

void expect_spheres(const Spheres& spheres, const IndexedMesh& mesh) {
  std::vector<bool> seen(mesh.triangles.size());
  for (const Surface& surface : spheres.surfaces) {
    EXPECT_TRUE(is_sphere(surface));
    ASSERT_EQ(surface.source_vertex.size(), surface.positions.size());
    ASSERT_EQ(surface.source_triangle.size(), surface.triangles.size());
    for (const Id t : surface.source_triangle)
      if (t != no_source) seen[t] = true;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), false), 0);
  EXPECT_EQ(spheres.report.components, spheres.surfaces.size());
}

Spheres spheres_of(const IndexedMesh& mesh) {
  Spheres spheres = make_spheres(mesh);
  expect_spheres(spheres, mesh);
  return spheres;
}

IndexedMesh read(const std::filesystem::path& path) {
  Repairs repairs;
  const auto scheduler = make_serial_scheduler();
  return prepare_mesh(read_mesh(path), repairs, *scheduler, path.string());
}

TEST(MakeSpheres, NothingToDoNothingDone) {
  const IndexedMesh mesh = test::sphere_mesh(3);
  const Spheres spheres = spheres_of(mesh);
  ASSERT_EQ(spheres.surfaces.size(), 1u);
  EXPECT_EQ(spheres.surfaces[0].triangles, make_manifold(mesh).surface.triangles);
  EXPECT_EQ(spheres.report.boundary_loops + spheres.report.handles + spheres.report.greatest_genus, 0u);
  EXPECT_EQ(spheres.report.loops.total, 0);
}

TEST(MakeSpheres, NoTrianglesNoSpheres) { EXPECT_TRUE(make_spheres({}).surfaces.empty()); }

TEST(MakeSpheres, OneTriangleBecomesASphere) {
  const Spheres spheres = spheres_of(test::normalised({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}));
  EXPECT_EQ(spheres.report.boundary_loops, 1u);
  EXPECT_EQ(spheres.report.fill_triangles, 3u);
}

TEST(MakeSpheres, LengthsAreInModelUnits) {
  IndexedMesh mesh = test::torus_mesh(60, 30);  // radii 1 and 0.4 in a box of side 2.8
  const Spheres spheres = spheres_of(mesh);
  EXPECT_EQ(spheres.report.handles, 1u);
  EXPECT_EQ(spheres.report.greatest_genus, 1u);
  EXPECT_NEAR(spheres.report.loops.total, 2 * 3.14159 * 0.4, 0.02);
  EXPECT_EQ(spheres.report.loops.least, spheres.report.loops.greatest);
  EXPECT_GT(spheres.report.cap_triangles, 2 * 30u);
}

// A torus with a hole, a sheet and a ball.
TEST(MakeSpheres, EachComponentIsASphereOfItsOwn) {
  IndexedMesh mesh = test::torus_mesh(20, 12);
  mesh.triangles.pop_back();
  for (const IndexedMesh& other : {test::terrain_mesh(40), test::sphere_mesh(2)}) {
    const auto offset = static_cast<Id>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    for (const auto& [v] : other.triangles) mesh.triangles.push_back({{v[0] + offset, v[1] + offset, v[2] + offset}});
  }
  const Spheres spheres = spheres_of(mesh);
  EXPECT_EQ(spheres.report.components, 3u);
  EXPECT_EQ(spheres.report.boundary_loops, 2u);
  EXPECT_EQ(spheres.report.handles, 1u);
}

// Foam on any number of workers: components, and balls of one component, run side by side.
TEST(MakeSpheres, WorkersDoNotChangeTheResult) {
  const IndexedMesh mesh = foam(28, {6, -0.35});
  const Spheres serial = spheres_of(mesh);
  EXPECT_GT(serial.report.components, 5u);
  EXPECT_GT(serial.report.greatest_genus, 10u);
  for (const int threads : {1, 2, 5}) {
    const auto scheduler = make_tbb_scheduler(threads);
    const Runner runner{static_cast<std::size_t>(scheduler->workers()),
                        [&](std::size_t count, const Runner::Body& body) {
                          scheduler->for_chunks(count, 1, [&](ChunkRange range) {
                            body(range.begin, static_cast<std::size_t>(scheduler->worker_index()));
                          });
                        }};
    const Spheres spheres = make_spheres(mesh, {}, runner);
    ASSERT_EQ(spheres.surfaces.size(), serial.surfaces.size());
    for (std::size_t k = 0; k < serial.surfaces.size(); ++k) {
      EXPECT_EQ(spheres.surfaces[k].triangles, serial.surfaces[k].triangles);
      EXPECT_EQ(spheres.surfaces[k].positions, serial.surfaces[k].positions);
    }
    EXPECT_EQ(spheres.report.loops.total, serial.report.loops.total);
  }
}

struct Known {
  const char* model;
  std::uint64_t components, boundary_loops, handles;
};
void PrintTo(const Known& known, std::ostream* out) { *out << known.model; }

class MakeSpheresOf : public testing::TestWithParam<Known> {};

TEST_P(MakeSpheresOf, Model) {
  LODESTONE_MODEL_OR_SKIP(path, GetParam().model);
  const Spheres spheres = spheres_of(read(path));
  EXPECT_EQ(spheres.report.components, GetParam().components);
  EXPECT_EQ(spheres.report.boundary_loops, GetParam().boundary_loops);
  EXPECT_EQ(spheres.report.handles, GetParam().handles);
}

INSTANTIATE_TEST_SUITE_P(Models, MakeSpheresOf,
                         testing::Values(Known{"scans/skull.obj", 1, 0, 2}, Known{"cad/casting.off", 1, 0, 9},
                                         Known{"scans/stanford-bunny.obj", 1, 5, 0},
                                         Known{"scans/BrainMesh_ICBM152.ply", 2, 0, 0},
                                         Known{"textured/Hermes/Hermes.obj", 1, 0, 9},
                                         Known{"cad/thingi_88566.stl", 8, 0, 32}));

// Whatever can be read can be made spheres of.
TEST(MakeSpheres, HardMeshes) {
  LODESTONE_MODEL_OR_SKIP(folder, "hard");
  int meshes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    IndexedMesh mesh;
    try {
      mesh = read(entry.path());
    } catch (const Error&) {
      continue;
    }
    SCOPED_TRACE(entry.path());
    expect_spheres(make_spheres(mesh), mesh);
    ++meshes;
  }
  EXPECT_GT(meshes, 15);
}

}  // namespace
}  // namespace lodestone::spherical
