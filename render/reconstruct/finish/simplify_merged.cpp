#include "render/reconstruct/finish/simplify_merged.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/base/sort_unique.h"
#include "core/hierarchy/construct/block_wedges.h"
#include "core/mesh/raw_mesh.h"
#include "core/simplify/simplifiers.h"
#include "render/reconstruct/finish/surface_walk.h"

namespace lodestone {
namespace {

// The part of the mesh in a cube. Wedges are the vertices if the mesh has no others.
struct Cube {
  std::size_t first = 0, last = 0;  // in the order of the triangles
  std::size_t target = 0;
  std::vector<std::uint32_t> wedge{};  // of the mesh, ascending; those of the cube are numbered by their place in it
  std::vector<std::uint8_t> locked{};
  std::vector<Vec3f> position{};
  std::vector<Triangle> triangles{};
};

// A wedge that is not where it was, and a triangle of the mesh that had it.
struct Moved {
  std::uint32_t wedge = 0, triangle = 0;
};

struct Tools {
  std::unique_ptr<Simplifier> simplifier = make_simplifier("quadric");
  BlockWedges block;
};

std::uint8_t mix(std::uint8_t a, std::uint8_t b, std::uint8_t c, const Vec3f& w) {
  const float sum = w.x * static_cast<float>(a) + w.y * static_cast<float>(b) + w.z * static_cast<float>(c);
  return static_cast<std::uint8_t>(std::clamp(sum + 0.5f, 0.0f, 255.0f));
}

class MergedSimplifier {
 public:
  MergedSimplifier(MergedMesh& mesh, RawWedges& wedges, const SimplifyMergedConfig& config, Scheduler& scheduler)
      : m_(mesh), w_(wedges), config_(config), scheduler_(scheduler), tools_(static_cast<std::size_t>(workers())) {
    if (w_.empty()) return;
    one_each_ = w_.corners.empty();
    if (one_each_) w_.corners = m_.triangles;
    vertex_.resize(wedge_count());
    for (std::size_t t = 0; t < m_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) vertex_[w_.corners[t].v[k]] = m_.triangles[t].v[k];
  }

  void run() {
    held_.assign(m_.position.size(), 0);
    for (int pass = 0; pass < 4 && m_.triangles.size() > config_.triangles; ++pass) {
      const std::size_t before = m_.triangles.size();
      simplify_cubes(pass);
      drop_degenerate();
      if (pass > 0 && before - m_.triangles.size() < before / 1000) break;
    }
    compact();
  }

 private:
  [[nodiscard]] int workers() const { return std::max(scheduler_.workers(), 1); }
  [[nodiscard]] bool has_wedges() const { return !w_.corners.empty(); }
  [[nodiscard]] std::size_t wedge_count() const {
    return has_wedges() ? std::max({w_.uv.size(), w_.normal.size(), w_.colour.size()}) : m_.position.size();
  }
  [[nodiscard]] std::uint32_t vertex_of(std::uint32_t wedge) const { return has_wedges() ? vertex_[wedge] : wedge; }
  [[nodiscard]] const std::vector<Triangle>& corners() const { return has_wedges() ? w_.corners : m_.triangles; }

  void simplify_cubes(int pass) {
    cut(pass);
    lock_shared();
    set_targets(pass);
    wedge_parent_.resize(wedge_count());
    std::iota(wedge_parent_.begin(), wedge_parent_.end(), 0u);
    vertex_parent_.resize(m_.position.size());
    std::iota(vertex_parent_.begin(), vertex_parent_.end(), 0u);
    std::vector<std::vector<Moved>> moved(cubes_.size());
    const std::vector<Vec3f> before = has_wedges() ? wedge_positions() : std::vector<Vec3f>{};
    scheduler_.for_chunks(cubes_.size(), 1, [&](ChunkRange range) {
      Tools& tools = tools_[static_cast<std::size_t>(scheduler_.worker_index())];
      take_out(cubes_[range.index]);
      simplify(cubes_[range.index], tools, moved[range.index]);
      cubes_[range.index] = {};
    });
    if (has_wedges()) move_values(before, moved);
  }

  // Sorts the triangles by the cube that holds their barycentre.
  void cut(int pass) {
    const auto count = static_cast<double>(m_.triangles.size());
    // A surface goes through about 2.5 m^2 cubes of a lattice of m^3.
    const int side = std::max(
        1, static_cast<int>(
               std::sqrt(count / (2.5 * static_cast<double>(std::max<std::size_t>(config_.cube_triangles, 1))))));
    const int cells = side + (pass % 2);
    const float shift = pass % 2 == 0 ? 0.0f : 0.5f;
    std::vector<std::uint32_t> cube_of(m_.triangles.size());
    scheduler_.for_chunks(m_.triangles.size(), 1 << 15, [&](ChunkRange range) {
      for (std::size_t t = range.begin; t < range.end; ++t) {
        const auto& v = m_.triangles[t].v;
        const Vec3f middle = (1.0f / 3) * (m_.position[v[0]] + m_.position[v[1]] + m_.position[v[2]]);
        const auto along = [&](float x) {
          return static_cast<std::uint32_t>(
              std::clamp(static_cast<int>(std::floor(x * static_cast<float>(side) + shift)), 0, cells - 1));
        };
        const auto c = static_cast<std::uint32_t>(cells);
        cube_of[t] = (along(middle.z) * c + along(middle.y)) * c + along(middle.x);
      }
    });
    const auto all =
        static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells);
    std::vector<std::size_t> first(all + 1, 0);
    for (const std::uint32_t c : cube_of) ++first[c + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    cubes_.clear();
    for (std::size_t c = 0; c < all; ++c)
      if (first[c] < first[c + 1]) cubes_.push_back({first[c], first[c + 1]});
    order_.resize(m_.triangles.size());
    for (std::uint32_t t = 0; t < cube_of.size(); ++t) order_[first[cube_of[t]]++] = t;
  }

  // A vertex that several cubes use is kept.
  void lock_shared() {
    constexpr std::uint32_t none = 0xFFFF'FFFFu;
    std::vector<std::uint32_t> user(m_.position.size(), none);
    was_held_ = std::exchange(held_, std::vector<std::uint8_t>(m_.position.size(), 0));
    for (std::uint32_t c = 0; c < cubes_.size(); ++c)
      for (std::size_t k = cubes_[c].first; k < cubes_[c].last; ++k)
        for (const std::uint32_t v : m_.triangles[order_[k]].v) {
          if (user[v] != none && user[v] != c) held_[v] = 1;
          user[v] = c;
        }
  }

  // In the first pass all cubes are simplified by the same ratio, as if locked vertices could be removed. The remaining
  // excess is removed in the second pass where vertices were locked.
  void set_targets(int pass) {
    const auto count = static_cast<double>(m_.triangles.size()), share = static_cast<double>(config_.triangles) / count;
    std::vector<double> weight(cubes_.size());
    scheduler_.for_chunks(cubes_.size(), 1, [&](ChunkRange range) {
      const Cube& cube = cubes_[range.index];
      // A vertex has six corners of triangles around it.
      double held = 0;
      for (std::size_t k = cube.first; k < cube.last; ++k)
        for (const std::uint32_t v : m_.triangles[order_[k]].v)
          held += pass == 0 ? held_[v] : was_held_[v] && !held_[v];
      weight[range.index] = pass == 0 ? held / 3 : held / 6 + 1e-3 * static_cast<double>(cube.last - cube.first);
    });
    const double sum = std::max(std::accumulate(weight.begin(), weight.end(), 0.0), 1e-9);
    for (std::size_t c = 0; c < cubes_.size(); ++c) {
      const auto own = static_cast<double>(cubes_[c].last - cubes_[c].first);
      const double target = pass == 0 ? share * own + (1 - share) * weight[c]
                                      : own - (count - static_cast<double>(config_.triangles)) * weight[c] / sum;
      cubes_[c].target = static_cast<std::size_t>(std::clamp(std::round(target), 0.0, own));
    }
  }

  void take_out(Cube& cube) const {
    const std::vector<Triangle>& all = corners();
    cube.wedge.reserve(3 * (cube.last - cube.first));
    for (std::size_t k = cube.first; k < cube.last; ++k)
      cube.wedge.insert(cube.wedge.end(), all[order_[k]].v.begin(), all[order_[k]].v.end());
    sort_unique(cube.wedge);
    const auto local = [&](std::uint32_t wedge) {
      return static_cast<std::uint32_t>(std::lower_bound(cube.wedge.begin(), cube.wedge.end(), wedge) -
                                        cube.wedge.begin());
    };
    for (std::size_t k = cube.first; k < cube.last; ++k) {
      const auto& v = all[order_[k]].v;
      cube.triangles.push_back({{local(v[0]), local(v[1]), local(v[2])}});
    }
    for (const std::uint32_t w : cube.wedge) {
      cube.position.push_back(m_.position[vertex_of(w)]);
      cube.locked.push_back(held_[vertex_of(w)]);
    }
  }

  void simplify(const Cube& cube, Tools& tools, std::vector<Moved>& moved) {
    if (!has_wedges()) {
      SimplifyInput input{cube.position, cube.triangles, cube.locked, config_.farthest, cube.target};
      return put_back(cube, tools.simplifier->simplify(input));
    }
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t w : cube.wedge) vertices.push_back(vertex_[w]);
    std::vector<std::uint8_t> locked = cube.locked;
    tools.block.weld(vertices, cube.position, cube.triangles, locked);
    put_back(cube, tools.block.simplify(*tools.simplifier, config_.farthest, cube.target, 0));
    for (const BlockWedges::Moved& m : tools.block.moved())
      moved.push_back({cube.wedge[m.wedge], order_[cube.first + m.triangle]});
  }

  // No other cube has the vertices that are written to.
  void put_back(const Cube& cube, const SimplifyResult& result) {
    for (std::size_t k = 0; k < cube.wedge.size(); ++k) {
      if (cube.locked[k]) continue;
      const std::uint32_t from = cube.wedge[k], to = cube.wedge[result.parent[k]];
      wedge_parent_[from] = to;
      vertex_parent_[vertex_of(from)] = vertex_of(to);
      if (from == to) m_.position[vertex_of(from)] = result.positions[k];
    }
  }

  [[nodiscard]] std::vector<Vec3f> wedge_positions() const {
    std::vector<Vec3f> positions;
    positions.reserve(vertex_.size());
    for (const std::uint32_t v : vertex_) positions.push_back(m_.position[v]);
    return positions;
  }

  // A vertex takes the values of its new place in the finer triangles, which may lie beyond those that were around it.
  // All values are read before any is written.
  void move_values(const std::vector<Vec3f>& before, const std::vector<std::vector<Moved>>& moved) {
    const SurfaceWalk walk(before, w_.corners);
    RawWedges from;
    from.uv = w_.uv, from.normal = w_.normal, from.colour = w_.colour;
    scheduler_.for_chunks(moved.size(), 1, [&](ChunkRange range) {
      for (const Moved& m : moved[range.index]) {
        const SurfaceWalk::Place place = walk.find(TriangleId(m.triangle), to_double(m_.position[vertex_[m.wedge]]));
        put_value(from, place, m.wedge);
      }
    });
  }

  void put_value(const RawWedges& from, const SurfaceWalk::Place& place, std::uint32_t to) {
    const auto& c = w_.corners[place.triangle].v;
    const Vec3f s = to_float({place.share[0], place.share[1], place.share[2]});
    if (!from.uv.empty()) {
      const Vec2f &p = from.uv[c[0]], &q = from.uv[c[1]], &r = from.uv[c[2]];
      w_.uv[to] = {s.x * p.x + s.y * q.x + s.z * r.x, s.x * p.y + s.y * q.y + s.z * r.y};
    }
    if (!from.normal.empty())
      w_.normal[to] =
          unit_normal(to_double(s.x * from.normal[c[0]] + s.y * from.normal[c[1]] + s.z * from.normal[c[2]]));
    if (!from.colour.empty()) {
      const Rgba8 &p = from.colour[c[0]], &q = from.colour[c[1]], &r = from.colour[c[2]];
      w_.colour[to] = {mix(p.r, q.r, r.r, s), mix(p.g, q.g, r.g, s), mix(p.b, q.b, r.b, s), mix(p.a, q.a, r.a, s)};
    }
  }

  void drop_degenerate() {
    std::size_t left = 0;
    for (std::size_t t = 0; t < m_.triangles.size(); ++t) {
      Triangle image = m_.triangles[t];
      for (std::uint32_t& v : image.v) v = vertex_parent_[v];
      if (is_degenerate(image)) continue;
      if (has_wedges())
        for (std::size_t k = 0; k < 3; ++k) w_.corners[left].v[k] = wedge_parent_[w_.corners[t].v[k]];
      if (!w_.material.empty()) w_.material[left] = w_.material[t];
      m_.triangles[left++] = image;
    }
    m_.triangles.resize(left);
    if (has_wedges()) w_.corners.resize(left);
    if (!w_.material.empty()) w_.material.resize(left);
  }

  // Removes unused vertices and wedges; the others keep their order.
  void compact() {
    const auto number = [](std::vector<Triangle>& triangles, std::size_t count) {
      std::vector<std::uint8_t> used(count, 0);
      for (const Triangle& t : triangles)
        for (const std::uint32_t v : t.v) used[v] = 1;
      std::vector<std::uint32_t> at(count, 0), kept;
      for (std::uint32_t v = 0; v < count; ++v)
        if (used[v]) at[v] = static_cast<std::uint32_t>(kept.size()), kept.push_back(v);
      for (Triangle& t : triangles)
        for (std::uint32_t& v : t.v) v = at[v];
      return kept;
    };
    const auto pick = [](auto& values, const std::vector<std::uint32_t>& kept) {
      if (values.empty()) return;
      for (std::size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
      values.resize(kept.size());
    };
    const std::vector<std::uint32_t> vertices = number(m_.triangles, m_.position.size());
    pick(m_.position, vertices), pick(m_.normal, vertices), pick(m_.view, vertices);
    pick(m_.pixel, vertices), pick(m_.feature, vertices);
    if (!has_wedges()) return;
    const std::vector<std::uint32_t> wedges = number(w_.corners, wedge_count());
    pick(w_.uv, wedges), pick(w_.normal, wedges), pick(w_.colour, wedges);
    if (one_each_) w_.corners.clear();
  }

  MergedMesh& m_;
  RawWedges& w_;
  const SimplifyMergedConfig& config_;
  Scheduler& scheduler_;
  std::vector<Tools> tools_;           // of each worker
  bool one_each_ = false;              // every vertex has one wedge, of the same number
  std::vector<std::uint32_t> vertex_;  // of each wedge; empty without wedges
  std::vector<std::uint32_t> order_;   // triangles, cube by cube
  std::vector<Cube> cubes_;
  std::vector<std::uint8_t> held_, was_held_;                // vertices, in this pass and in the one before
  std::vector<std::uint32_t> vertex_parent_, wedge_parent_;  // of this pass
};

}  // namespace

void simplify_merged(MergedMesh& mesh, RawWedges& wedges, const SimplifyMergedConfig& config, Scheduler& scheduler) {
  if (mesh.triangles.size() <= config.triangles) return;
  MergedSimplifier(mesh, wedges, config, scheduler).run();
}

}  // namespace lodestone
