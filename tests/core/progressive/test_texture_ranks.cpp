// Deviations on the texture against what they stand for: points all over the new triangles, looked up in the old ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/progressive/collapse/collapse_metric.h"
#include "core/progressive/collapse/texture_ranks.h"
#include "core/progressive/collapse/uv_star.h"
#include "tests/test_meshes.h"

namespace lodestone::progressive {
namespace {

// A terrain with its own coordinates as those of the texture, shifted at random, on a lattice if there is one: there
// triangles are turned over or have no area. To the right of a seam that ends in the middle they are others.
IndexedMesh textured_terrain(std::uint32_t n, float shift, float lattice, bool with_seam) {
  IndexedMesh mesh = test::terrain_mesh(n);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> any(-shift, shift);
  const auto on_lattice = [&](float x) { return lattice > 0 ? std::round(x / lattice) * lattice : x; };
  for (const Vec3f p : mesh.positions)
    mesh.wedges.uv.push_back({on_lattice(p.x + any(random)), on_lattice(p.y + any(random))});
  if (!with_seam) return mesh;
  const std::size_t count = mesh.positions.size();
  std::vector<Id> right(count, no_id);
  for (Id v = 0; v < count; ++v) mesh.wedges.vertex.push_back(v);
  for (Triangle& t : mesh.triangles) {
    const float x = mesh.positions[t.v[0]].x + mesh.positions[t.v[1]].x + mesh.positions[t.v[2]].x;
    if (x < 1.5f) continue;
    for (Id& v : t.v) {
      if (std::abs(mesh.positions[v].x - 0.5f) > 1e-3f || mesh.positions[v].y > 0.52f) continue;
      if (right[v] == no_id) {
        right[v] = static_cast<Id>(mesh.positions.size());
        mesh.positions.push_back(Vec3f{mesh.positions[v]});
        mesh.wedges.vertex.push_back(v);
        mesh.wedges.uv.push_back({mesh.wedges.uv[v].x + 0.01f, mesh.wedges.uv[v].y});
      }
      v = right[v];
    }
  }
  return mesh;
}

struct Surface {
  explicit Surface(IndexedMesh input) : mesh(std::move(input)), rings(mesh) {
    rings.list_corners();
    rings.make_rings(0, mesh.positions.size(), arena);
    rings.cut_open();
    metric = make_parametric_metric(rings, mesh);
    metric->start(0, rings.vertex_count());
  }
  [[nodiscard]] Vec2f uv(Id wedge) const { return mesh.wedges.uv[rings.source_of(wedge)]; }
  [[nodiscard]] Vec3d position(Id wedge) const { return to_double(mesh.positions[rings.source_of(wedge)]); }

  IndexedMesh mesh;
  RingMesh rings;
  RingArena arena;
  std::unique_ptr<CollapseMetric> metric;
};

struct Place {
  double u, v;
  Vec3d at;
};
using Face = std::array<Place, 3>;

double area(const Place& a, const Place& b, const Place& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

// The triangles of a wedge, those that are kept; with another wedge in its place, if it is given.
std::vector<Face> faces(const Surface& s, const Collapse& c, Id wedge, Id other) {
  std::vector<Face> out;
  const Ring& ring = s.rings.ring(c.vertex);
  for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
    const Id a = ring.ids[k], b = ring.ids[ring.next(k)];
    if (s.rings.has_wedges() && ring.wedge(k) != wedge) continue;
    if (other != wedge && (a == c.target || b == c.target)) continue;
    const auto place = [&](Id w) { return Place{s.uv(w).x, s.uv(w).y, s.position(w)}; };
    out.push_back({place(other), place(s.rings.wedge_of(a, b)), place(s.rings.wedge_of(b, c.vertex))});
  }
  return out;
}

// The largest distance between a grid of points of the new triangles and the old ones; negative if one is outside.
double sampled_deviation(const std::vector<Face>& before, const std::vector<Face>& after) {
  constexpr int steps = 40;
  double most = 0;
  for (const auto& [a, b, c] : after)
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const double x = i / double{steps}, y = j / double{steps}, z = 1 - x - y;
        const Place p{x * a.u + y * b.u + z * c.u, x * a.v + y * b.v + z * c.v, x * a.at + y * b.at + z * c.at};
        double closest = 1e9;
        for (const auto& [d, e, f] : before) {
          const double whole = area(d, e, f), wd = area(p, e, f) / whole, we = area(d, p, f) / whole, wf = 1 - wd - we;
          if (std::min({wd, we, wf}) > -1e-6)
            closest = std::min(closest, length(wd * d.at + we * e.at + wf * f.at - p.at));
        }
        if (closest > 1e8) return -1;
        most = std::max(most, closest);
      }
  return most;
}

struct Counts {
  int compared = 0, turned = 0, crowded = 0, on_seams = 0;
};

// Every collapse of a vertex, one by one.
void compare(const Surface& s, Id v, Counts& counts, bool by_samples) {
  TextureRanks texture(s.rings, s.metric->texture_points());
  const Ring& ring = s.rings.ring(v);
  for (std::uint32_t k = 0; k < ring.size; ++k) {
    Collapse c{.vertex = v, .target = ring.ids[k]};
    const bool follows = s.rings.follows_wedges(c);
    if (ring.open != 0 && !follows) continue;  // never asked for
    const auto found = texture.cheapest(v, std::uint64_t{1} << k, [](std::uint32_t) { return true; });
    const bool turned = follows && turns_texture(s.rings, s.mesh.wedges.uv, c);
    ASSERT_EQ(std::isfinite(found.rank), follows && !turned) << v << " into " << c.target;
    counts.turned += turned ? 1 : 0, counts.crowded += ring.size > 8 ? 1 : 0;
    counts.on_seams += follows && c.wedge[0] != c.wedge[1] ? 1 : 0;
    if (!follows || turned || !by_samples) continue;
    double expected =
        sampled_deviation(faces(s, c, c.wedge[0], c.wedge[0]), faces(s, c, c.wedge[0], c.wedge_target[0]));
    if (c.wedge[1] != c.wedge[0]) {
      const double other =
          sampled_deviation(faces(s, c, c.wedge[1], c.wedge[1]), faces(s, c, c.wedge[1], c.wedge_target[1]));
      expected = other < 0 ? other : std::max(expected, other);
    }
    if (expected < 0) continue;  // along a border that is not straight
    const double way = length(s.position(c.target) - s.position(v));
    ASSERT_GT(found.rank, expected - 1e-5) << v << " into " << c.target;
    // Along a border or seam that is not straight the vertex may be outside the new triangles.
    if (ring.open == 0 && c.wedge[0] == c.wedge[1]) {
      ASSERT_LT(found.rank, expected + 0.06 * way) << v << " into " << c.target;
    }
    ++counts.compared;
  }
}

TEST(TextureRanks, AreTheLargestDistancesOfSamples) {
  for (const bool with_seam : {false, true}) {
    Surface s(textured_terrain(20, 0.004f, 0, with_seam));
    Counts counts;
    std::mt19937 random(1);
    for (int step = 0; step < 400; ++step) {
      const auto v = static_cast<Id>(random() % s.mesh.positions.size());
      const Ring& ring = s.rings.ring(v);
      if (ring.size < 2) continue;
      compare(s, v, counts, step % 2 == 0);
      Collapse c{.vertex = v, .target = ring.ids[random() % ring.size]};
      if (s.rings.allows(c) && !turns_texture(s.rings, s.mesh.wedges.uv, c)) (void)s.rings.apply(c, s.arena);
    }
    EXPECT_GT(counts.compared, 200);
    EXPECT_GT(counts.crowded, 50);
    EXPECT_EQ(counts.on_seams > 0, with_seam);
  }
}

// Areas that are zero, or too small for the signs of 32-bit floats to be right, are decided exactly.
TEST(TextureRanks, TurnNoTriangleOver) {
  for (const float lattice : {0.0f, 1 / 64.0f, 1e-7f})
    for (const bool with_seam : {false, true}) {
      const Surface s(textured_terrain(30, lattice > 1e-3f ? 0.02f : 0.03f, lattice, with_seam));
      Counts counts;
      for (Id v = 0; v < s.rings.vertex_count(); ++v)
        if (s.rings.is_used(v)) compare(s, v, counts, false);
      EXPECT_GT(counts.turned, 1000);
    }
}

TEST(TextureRanks, RefusesCrowdedFans) {
  constexpr std::uint32_t spokes = 80;
  IndexedMesh mesh;
  mesh.positions.push_back({0.5f, 0.5f, 0});
  for (std::uint32_t k = 0; k < spokes; ++k) {
    const double angle = 6.283185307179586 * k / spokes;
    mesh.positions.push_back(to_float(Vec3d{0.5 + 0.5 * std::cos(angle), 0.5 + 0.5 * std::sin(angle), 0}));
    mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % spokes});
  }
  for (const Vec3f p : mesh.positions) mesh.wedges.uv.push_back({p.x, p.y});
  const Surface s(std::move(mesh));
  TextureFan fan;
  EXPECT_FALSE(fill_whole_fan(fan, s.metric->texture_points(), s.rings, 0));
  EXPECT_FALSE(fill_fan(fan, s.metric->texture_points(), s.rings, 0, 0));
}

}  // namespace
}  // namespace lodestone::progressive
