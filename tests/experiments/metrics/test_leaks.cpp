// Leaks: none in what is closed, those of triangles that are missing, and every triangle at every pixel as the twin.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/base/error.h"
#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/drawn/drawn_mesh.h"
#include "experiments/metrics/drawn/screen.h"
#include "render/camera/camera.h"
#include "render/camera/view.h"
#include "render/position_map/rasterize_map.h"
#include "tests/experiments/metrics/crack_subject.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr ImageSize size{120, 90};

Screen screen_at(Vec3d eye, Vec3d target, double fov = 0.8) {
  const PlacedBounds bounds{{}, {{0, 0, 0}, {1, 1, 1}}};
  Camera camera;
  camera.position = eye;
  camera.target = target;
  camera.vertical_fov = fov;
  return {View(camera, std::span(&bounds, 1), size).projection({}), size};
}

Vec3d on_sphere(std::mt19937& random, double radius) {
  std::normal_distribution<double> normal;
  const Vec3d way{normal(random), normal(random), normal(random)};
  return Vec3d{0.5, 0.5, 0.5} + (radius / length(way)) * way;
}

LeakReport leaks(const DrawnMesh& mesh, const Screen& screen, const LeakConfig& config = {}) {
  const auto scheduler = make_serial_scheduler();
  return find_leaks(mesh.positions, mesh.triangles, screen, *scheduler, config);
}

// No bands, no clipping: for views with the whole mesh before the eye.
struct NaiveLeaks {
  std::uint64_t torn = 0, back_faces = 0, folded = 0, covered = 0;
};

NaiveLeaks naive_leaks(const DrawnMesh& mesh, const Screen& screen) {
  std::vector<SnappedVertex> at;
  for (const Vec3d p : mesh.positions) {
    const auto c = screen.to_clip(p);
    at.push_back({static_cast<std::int32_t>(std::nearbyint((1 + c[0] / c[3]) * 0.5 * size.width * 256)),
                  static_cast<std::int32_t>(std::nearbyint((1 - c[1] / c[3]) * 0.5 * size.height * 256)), c[2] / c[3]});
  }
  NaiveLeaks result;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      int sum = 0;
      std::map<std::pair<double, bool>, int> hits;  // by depth, faces before backs
      for (const Triangle& t : mesh.triangles) {
        const SnappedVertex &a = at[t.v[0]], &b = at[t.v[1]], &c = at[t.v[2]];
        const double turn = (double(b.x) - a.x) * (double(c.y) - a.y) - (double(b.y) - a.y) * (double(c.x) - a.x);
        double z = 0;
        if (turn == 0 || !TriangleCoverage(a, b, c).at(x * 256 + 128, y * 256 + 128, z)) continue;
        const bool back = turn > 0;
        sum += back ? -1 : 1;
        ++hits[{z, back}];
      }
      if (hits.empty()) continue;
      ++result.covered;
      const bool back = hits.begin()->first.second;
      result.torn += sum != 0;
      result.back_faces += sum != 0 && back;
      result.folded += sum == 0 && back;
    }
  return result;
}

void expect_twins_agree(const DrawnMesh& mesh, const Screen& screen) {
  const LeakReport fast = leaks(mesh, screen);
  const NaiveLeaks slow = naive_leaks(mesh, screen);
  EXPECT_EQ(fast.torn, slow.torn);
  EXPECT_EQ(fast.back_faces, slow.back_faces);
  EXPECT_EQ(fast.folded, slow.folded);
  EXPECT_EQ(fast.covered, slow.covered);
}

TEST(Leaks, NoneInClosedSurfacesFromAnywhere) {
  std::mt19937 random(1);
  for (const IndexedMesh& source : {sphere_mesh(14), torus_mesh(20), box_mesh(9)}) {
    const NaiveHierarchy built = naive_hierarchy(source, 3, 0.6f);
    const DrawnMesh mesh = finest_mesh(built.hierarchy);
    for (int i = 0; i < 30; ++i) {
      const Screen screen = screen_at(on_sphere(random, i % 3 == 0 ? 0.9 : 2.5), on_sphere(random, 0.2));
      const LeakReport report = leaks(mesh, screen);
      EXPECT_EQ(report.torn, 0u);
      EXPECT_EQ(report.leak_pixels(), 0u);
      EXPECT_GT(report.covered, 0u);
    }
  }
}

// From inside every ray leaves the surface once more than it enters it; part of it is behind the eye and beside it.
TEST(Leaks, NoneFromInside) {
  std::mt19937 random(2);
  const NaiveHierarchy built = naive_hierarchy(box_mesh(9), 2, 0.6f);
  const DrawnMesh mesh = finest_mesh(built.hierarchy);
  for (int i = 0; i < 20; ++i) {
    const LeakReport report = leaks(mesh, screen_at(on_sphere(random, 0.3), on_sphere(random, 0.9), 1.2));
    EXPECT_EQ(report.torn, 0u);
    EXPECT_EQ(report.leak_pixels(), 0u);
    EXPECT_EQ(report.covered, static_cast<std::uint64_t>(size.width * size.height));
  }
}

// Turned inside out it is the same surface.
TEST(Leaks, TheVolumeSaysWhatIsOutside) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(10), 2, 0.6f);
  DrawnMesh mesh = finest_mesh(built.hierarchy);
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 40);
  const Screen screen = screen_at({0.4, -1.5, 0.6}, {0.5, 0.5, 0.5});
  const LeakReport report = leaks(mesh, screen);
  for (Triangle& t : mesh.triangles) std::swap(t.v[0], t.v[1]);
  const LeakReport turned = leaks(mesh, screen);
  EXPECT_EQ(report.torn, turned.torn);
  EXPECT_EQ(report.back_faces, turned.back_faces);
  EXPECT_EQ(report.leaks, turned.leaks);
}

TEST(Leaks, EqualTheirSlowTwin) {
  std::mt19937 random(3);
  for (const IndexedMesh& source : {sphere_mesh(8), torus_mesh(12)}) {
    const NaiveHierarchy built = naive_hierarchy(source, 2, 0.6f);
    DrawnMesh mesh = finest_mesh(built.hierarchy);
    for (int i = 0; i < 3; ++i) {
      const Screen screen = screen_at(on_sphere(random, 1.6), on_sphere(random, 0.3));
      expect_twins_agree(mesh, screen);
      DrawnMesh torn = mesh;
      std::erase_if(torn.triangles, [&](const Triangle&) { return random() % 12 == 0; });
      expect_twins_agree(torn, screen);
      EXPECT_GT(leaks(torn, screen).back_faces, 0u);
    }
  }
}

// One triangle of a box is gone: a hole to the inside, where the back of the far side is seen.
TEST(Leaks, SeesAHole) {
  const NaiveHierarchy built = naive_hierarchy(box_mesh(1), 0, 0.6f);
  DrawnMesh mesh = finest_mesh(built.hierarchy);
  const Screen screen = screen_at({0.5, 0.5, 3}, {0.5, 0.5, 0.5});
  const std::uint64_t whole = leaks(mesh, screen).covered;
  // The first triangle that looks at the eye: half of the face of the box.
  const auto towards = std::find_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return mesh.positions[t.v[0]].z == 1 && mesh.positions[t.v[1]].z == 1 && mesh.positions[t.v[2]].z == 1;
  });
  ASSERT_NE(towards, mesh.triangles.end());
  mesh.triangles.erase(towards);
  const LeakReport report = leaks(mesh, screen);
  EXPECT_EQ(report.covered, whole);
  EXPECT_NEAR(static_cast<double>(report.back_faces), 0.5 * static_cast<double>(whole),
              0.02 * static_cast<double>(whole));
  EXPECT_EQ(report.torn, report.back_faces);
  EXPECT_EQ(static_cast<std::uint64_t>(std::count(report.leaks.begin(), report.leaks.end(), 1)), report.leak_pixels());
}

// Both triangles of a side of a box, and both of the side opposite.
void open_tunnel(DrawnMesh& mesh) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const auto all_at = [&](double z) {
      return std::all_of(t.v.begin(), t.v.end(), [&](std::uint32_t v) { return mesh.positions[v].z == z; });
    };
    return all_at(0) || all_at(1);
  });
}

TEST(Leaks, SeesTheBackgroundThroughTwoHoles) {
  const NaiveHierarchy built = naive_hierarchy(box_mesh(1), 0, 0.6f);
  DrawnMesh mesh = finest_mesh(built.hierarchy);
  const Screen screen = screen_at({0.5, 0.5, 3}, {0.5, 0.5, 0.5});
  const std::uint64_t whole = leaks(mesh, screen).covered;
  // The silhouette of the whole box, from what is covered.
  std::vector<float> depth;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto seen = [&](double px, double half) {
        return std::abs(px + 0.5 - half) < 0.5 * std::sqrt(static_cast<double>(whole));
      };
      depth.push_back(seen(x, size.width / 2.0) && seen(y, size.height / 2.0) ? 0.5f : 1.0f);
    }
  open_tunnel(mesh);
  const LeakReport report = leaks(mesh, screen, {.full_depth = depth, .silhouette_tolerance = 1});
  EXPECT_GT(report.background, whole / 4);  // the far side, smaller by perspective
  EXPECT_GT(report.back_faces, 0u);         // the four others, from inside
  EXPECT_EQ(report.outline, 0u);
  EXPECT_EQ(report.background + report.back_faces, report.leak_pixels());
  EXPECT_NEAR(static_cast<double>(report.leak_pixels()), static_cast<double>(whole), 0.02 * static_cast<double>(whole));
  EXPECT_EQ(static_cast<std::uint64_t>(std::count(report.leaks.begin(), report.leaks.end(), 1)), report.leak_pixels());
}

// Where nothing is torn, what is missing inside of the silhouette is a matter of the outline.
TEST(Leaks, TellsTheOutlineFromCracks) {
  const Screen screen = screen_at({0.5, 0.5, 3}, {0.5, 0.5, 0.5});
  std::vector<float> depth(static_cast<std::size_t>(size.width * size.height), 1);
  for (int y = 20; y < 60; ++y)
    for (int x = 30; x < 90; ++x) depth[static_cast<std::size_t>(y * size.width + x)] = 0.5f;
  const LeakReport none = leaks({{{0, 0, 9}}, {}}, screen, {.full_depth = depth, .silhouette_tolerance = 0});
  EXPECT_EQ(none.inside, 60u * 40u);
  EXPECT_EQ(none.outline, 60u * 40u);
  EXPECT_EQ(leaks({{{0, 0, 9}}, {}}, screen, {.full_depth = depth, .silhouette_tolerance = 3}).outline, 54u * 34u);
  const DrawnMesh mesh = finest_mesh(naive_hierarchy(box_mesh(1), 0, 0.6f).hierarchy);
  const LeakReport some = leaks(mesh, screen, {.full_depth = depth, .silhouette_tolerance = 0});
  EXPECT_GT(some.outline, 0u);
  EXPECT_LT(some.outline, 60u * 40u);
  EXPECT_EQ(some.torn, 0u);
  EXPECT_EQ(some.leak_pixels(), 0u);
}

// The proof in pixels: frames without residual edges have no torn pixel, and a crack as wide as a pixel has.
TEST(Leaks, AgreeWithTheCracksOfFrames) {
  Subject subject(sphere_mesh(16));
  const Hierarchy& h = subject.hierarchy();
  const float rho = greatest_reach(h, DistanceMetric::euclidean);
  std::uint64_t torn = 0, leaking = 0;
  for (const float share : {1.1f, 0.3f}) {
    const Radii radii = uniform_radii(h, DistanceMetric::euclidean, share * rho);
    for (const AdversarialView& view : adversarial_views(h, radii)) {
      const Frame frame = make_frame(h, radii, Blend::linear, view.viewpoint);
      const Vec3d eye = to_double(view.viewpoint);
      const Screen screen = screen_at(eye, to_double(h.cells[view.cell].positions[view.vertex]), 0.3);
      const LeakReport report = find_leaks(frame.context, frame.selection, screen, *subject.scheduler);
      if (subject.cracks(frame).open_edges == 0) {
        EXPECT_EQ(report.torn, 0u);
        EXPECT_EQ(report.leak_pixels(), 0u);
      }
      if (share > 1) {
        EXPECT_EQ(subject.cracks(frame).open_edges, 0u);
      }
      torn += report.torn;
      leaking += report.leak_pixels();
    }
  }
  EXPECT_GT(torn, 0u);
  EXPECT_GT(leaking, 0u);
}

TEST(Leaks, AreTheSameForAnyNumberOfWorkers) {
  const NaiveHierarchy built = naive_hierarchy(sphere_mesh(14), 3, 0.6f);
  DrawnMesh mesh = finest_mesh(built.hierarchy);
  std::mt19937 random(4);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random() % 9 == 0; });
  const Screen screen = screen_at({1.4, -0.2, 0.8}, {0.5, 0.5, 0.5});
  const LeakReport serial = leaks(mesh, screen);
  for (const int threads : {2, 5}) {
    const LeakReport report = find_leaks(mesh.positions, mesh.triangles, screen, *make_tbb_scheduler(threads));
    EXPECT_EQ(report.leaks, serial.leaks);
    EXPECT_EQ(report.torn, serial.torn);
  }
}

TEST(Leaks, RefusesAnotherPicture) {
  const Screen screen = screen_at({0.5, 0.5, 3}, {0.5, 0.5, 0.5});
  const std::vector<float> few(7, 0.5f), right(static_cast<std::size_t>(size.width * size.height), 0.5f);
  EXPECT_THROW((void)leaks({}, screen, {.full_depth = few}), InputError);
  EXPECT_THROW((void)leaks({}, screen, {.full_depth = right, .silhouette_tolerance = -1}), InputError);
  EXPECT_EQ(leaks({}, screen).covered, 0u);
}

}  // namespace
}  // namespace lodestone
