// The graph of clusters: every cut is the whole surface without a crack, and errors are what they say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/error.h"
#include "core/spatial/triangle_bvh.h"
#include "experiments/metrics/drawn/border.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/systems/cluster_dag/cluster_dag.h"
#include "experiments/systems/lod_system.h"
#include "experiments/systems/patch_proof.h"
#include "experiments/systems/system_flight.h"
#include "render/backends/make_renderer.h"
#include "tests/expect_error.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using namespace testing;

const IndexedMesh& mesh() {
  static const IndexedMesh made = test::torus_mesh(160, 80);
  return made;
}

const Hierarchy& torus() {
  static const test::NaiveHierarchy made = test::naive_hierarchy(mesh(), 4);
  return made.hierarchy;
}

std::vector<Cluster> dag_of(const IndexedMesh& surface, bool measured, Scheduler& scheduler) {
  return build_cluster_dag(surface.positions, surface.triangles, {.measured = measured}, scheduler);
}

std::vector<Cluster> dag(bool measured = false) { return dag_of(mesh(), measured, *make_tbb_scheduler(2)); }

DrawnMesh drawn(const std::vector<Cluster>& clusters, Vec3d viewpoint, double reach) {
  DrawnMesh all;
  for (const Cluster& cluster : clusters) {
    if (!is_drawn(cluster, viewpoint, reach)) continue;
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    for (const std::uint32_t v : cluster.vertices) all.positions.push_back(to_double(mesh().positions[v]));
    for (const Triangle& t : cluster.triangles)
      all.triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
  }
  return all;
}

// Viewpoints around and in the unit cube, and reaches from all detail to none.
template <class Visit>
void for_views(int count, const Visit& visit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1, 2), power(0, 5);
  for (int i = 0; i < count; ++i)
    visit(Vec3d{place(random), place(random), place(random)}, std::pow(10.0, power(random)));
}

TEST(ClusterDag, EveryCutIsClosed) {
  for (const bool measured : {false, true}) {
    const std::vector<Cluster> clusters = dag(measured);
    std::size_t least = mesh().triangles.size(), most = 0;
    for_views(60, [&](Vec3d viewpoint, double reach) {
      const DrawnMesh cut = drawn(clusters, viewpoint, reach);
      ASSERT_FALSE(cut.triangles.empty());
      EXPECT_TRUE(border_edges(cut.positions, cut.triangles).empty());
      least = std::min(least, cut.triangles.size()), most = std::max(most, cut.triangles.size());
    });
    EXPECT_LT(least, mesh().triangles.size() / 20);
    EXPECT_GT(most, mesh().triangles.size() / 2);
  }
}

TEST(ClusterDag, AllDetailIsTheSurfaceItself) {
  std::size_t triangles = 0;
  for (const Cluster& cluster : dag()) {
    if (cluster.own.error > 0) continue;
    EXPECT_TRUE(is_good_enough(cluster.own, {}, 1e30));
    if (cluster.step == 0) triangles += cluster.triangles.size();
  }
  EXPECT_EQ(triangles, mesh().triangles.size());
}

TEST(ClusterDag, BallsContainThoseBelow) {
  for (const Cluster& cluster : dag()) {
    EXPECT_GE(cluster.replaced.error, cluster.own.error);
    if (std::isinf(cluster.replaced.error)) continue;
    EXPECT_LE(length(cluster.own.centre - cluster.replaced.centre) + cluster.own.radius, cluster.replaced.radius);
    EXPECT_LE(cluster.triangles.size(), 128u);
    for (const std::uint32_t v : cluster.vertices)
      EXPECT_LE(length(to_double(mesh().positions[v]) - cluster.replaced.centre), cluster.replaced.radius + 1e-6);
  }
}

// By brute force over the whole surface, which bounds what each cut is off by.
TEST(ClusterDag, MeasuredErrorsAreDistances) {
  const std::vector<Cluster> clusters = dag(true);
  std::vector<Vec3d> places;
  for (const Vec3f p : mesh().positions) places.push_back(to_double(p));
  const TriangleBvh surface(places, mesh().triangles);
  for_views(12, [&](Vec3d viewpoint, double reach) {
    double promised = 0, off = 0;
    for (const Cluster& cluster : clusters)
      if (is_drawn(cluster, viewpoint, reach)) promised = std::max(promised, cluster.own.error);
    const DrawnMesh cut = drawn(clusters, viewpoint, reach);
    const TriangleBvh coarse(cut.positions, cut.triangles);
    for (const Vec3d p : places) off = std::max(off, std::sqrt(coarse.nearest(p).squared_distance));
    for (const Triangle& t : cut.triangles)
      off = std::max(
          off,
          std::sqrt(surface.nearest((1.0 / 3) * (cut.positions[t.v[0]] + cut.positions[t.v[1]] + cut.positions[t.v[2]]))
                        .squared_distance));
    EXPECT_LE(off, promised * (1 + 1e-9) + 3e-16);  // where the search for the nearest point ends
  });
}

TEST(ClusterDag, IsTheSameForAnyNumberOfThreads) {
  for (const bool measured : {false, true}) {
    const std::vector<Cluster> one = dag_of(mesh(), measured, *make_serial_scheduler()),
                               three = dag_of(mesh(), measured, *make_tbb_scheduler(3));
    ASSERT_EQ(one.size(), three.size());
    for (std::size_t c = 0; c < one.size(); ++c) {
      EXPECT_EQ(one[c].vertices, three[c].vertices);
      EXPECT_EQ(one[c].triangles, three[c].triangles);
      EXPECT_EQ(one[c].own.error, three[c].own.error);
    }
  }
}

TEST(ClusterDag, SurfacesOfFewTrianglesAreOneCluster) {
  EXPECT_TRUE(build_cluster_dag({}, {}, {}, *make_serial_scheduler()).empty());
  const std::vector<Vec3f> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> one{{{0, 1, 2}}};
  EXPECT_EQ(build_cluster_dag(corners, one, {}, *make_serial_scheduler()).size(), 1u);
}

TEST(PatchProof, SeesAClusterThatIsMissing) {
  const auto scheduler = make_serial_scheduler();
  DrawnMesh full;
  for (const Vec3f p : mesh().positions) full.positions.push_back(to_double(p));
  full.triangles = mesh().triangles;
  const PatchProof proof(full, 1e-6, *scheduler);
  const Screen screen({}, {16, 16});
  EXPECT_EQ(proof.measure({full, {}, {}}, screen, {}).open_edges, 0);
  DrawnMesh torn = full;
  torn.triangles.pop_back();
  EXPECT_EQ(proof.measure({torn, {}, {}}, screen, {}).open_edges, 3);
  const PatchProof expects_it(torn, 1e-6, *scheduler);
  EXPECT_EQ(expects_it.measure({torn, {}, {}}, screen, {}).open_edges, 0) << "the model has that border itself";
}

TEST(ClusterDagSystem, DrawsClosedSurfacesWithinAFewPixels) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene_of("torus"), {{&torus()}});
  SystemFlightConfig config;
  for (int i = 0; i < 5; ++i) config.cameras.push_back({{0.5 + 0.1 * i, -3 + 0.5 * i, 1.4}, {0.5, 0.5, 0.15}});
  config.view = view_config(view.scene(), {320, 240});
  config.view.radii.kappa0.reset();
  config.view.radii.pixel_error = 2;
  config.systems = {"cluster-dag", "cluster-dag-measured", "adaptive"};
  config.quality = {.with_flip = false, .with_ssim = false};
  config.screen = true;
  for (const SystemRow& row : fly_systems(view, *renderer, config, *scheduler)) {
    EXPECT_EQ(row.surface.value().open_edges, 0) << row.system;
    EXPECT_EQ(row.surface->torn_pixels.value(), 0) << row.system;
    EXPECT_GT(row.triangles, 0u);
    EXPECT_LT(row.screen_error.value(), row.system == "cluster-dag" ? 6 : 2) << row.system;
    EXPECT_EQ(row.shift_pixels.has_value(), row.frame > 0);
  }
  SystemPictures pictures(view, *renderer, *scheduler);
  EXPECT_GT(pictures.prepare("cluster-dag").seconds, 0);
  EXPECT_EQ(pictures.prepare("adaptive").seconds, 0);
  ViewConfig by_distance = config.view;
  by_distance.radii.kappa0 = 2.0f;
  expect_error_of<InputError>([&] { (void)pictures.draw("cluster-dag", config.cameras[0], by_distance); },
                              {"patches", "pixel error instead of kappa0"});
}

TEST(ClusterDagSystem, RefusesAttributes) {
  Hierarchy coloured = torus();
  coloured.attributes.colours = true;
  expect_error_of<InputError>([&] { (void)lod_system("cluster-dag").patches(coloured, *make_serial_scheduler()); },
                              {"cluster-dag", "positions and normals alone"});
}

}  // namespace
}  // namespace lodestone
