#include "parallel/spherical/surface_collapse.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/model/cell_code.h"
#include "core/spherical/parameterize/tetrahedron.h"
#include "core/spherical/surface.h"

namespace lodestone {
namespace {

using progressive::Ring;

constexpr std::size_t vertex_grain = 8192;

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
  throw InputError(describe({}, "map to the sphere", what, remedy));
}

// Throws the error that says why the surface cannot be mapped.
[[noreturn]] void refuse_kind(std::span<const Triangle> triangles, std::size_t vertices) {
  const spherical::SurfaceKind kind = spherical::kind_of(triangles, vertices);
  const auto count = [](std::uint64_t n, const char* what) { return std::to_string(n) + " " + what; };
  const std::string repair = "close and split it first (core/spherical/topology)";
  if (kind.degenerate > 0) refuse(count(kind.degenerate, "triangles have two equal corners"), repair);
  if (kind.unused > 0) refuse(count(kind.unused, "vertices belong to no triangle"), "leave them out");
  if (kind.open_edges > 0) refuse(count(kind.open_edges, "edges lack a triangle on one side or have several"), repair);
  if (kind.split_fans > 0) refuse(count(kind.split_fans, "vertices too few where parts touch in a point"), repair);
  if (kind.components != 1) refuse(count(kind.components, "components"), "map one at a time");
  if (kind.euler != 2) refuse("its genus is " + std::to_string((2 - kind.euler) / 2) + ", not 0", repair);
  refuse("it has fewer than four vertices", "leave it out");
}

void check_input(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v)
      if (v >= positions.size())
        refuse("a triangle has vertex " + std::to_string(v) + " of " + std::to_string(positions.size()), "");
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!is_finite(positions[v])) refuse("vertex " + std::to_string(v) + " is not finite", "leave it out");
  const auto degenerate = std::any_of(triangles.begin(), triangles.end(), is_degenerate);
  if (positions.size() < 4 || degenerate || triangles.size() + 4 != 2 * positions.size())
    refuse_kind(triangles, positions.size());
}

// Scaled into the unit cube, whatever the range.
std::vector<Vec3f> unit_positions(std::span<const Vec3d> positions) {
  Vec3d low = positions[0], high = positions[0];
  for (const Vec3d p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  // Halves, since the difference of two finite numbers may be infinite.
  const Vec3d half = 0.5 * high - 0.5 * low;
  const double extent = std::max({half.x, half.y, half.z});
  std::vector<Vec3f> unit(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3d from_low = 0.5 * positions[v] - 0.5 * low;
    const auto scaled = [&](double x) { return extent > 0 ? static_cast<float>(x / extent) : 0; };
    unit[v] = {scaled(from_low.x), scaled(from_low.y), scaled(from_low.z)};
  }
  return unit;
}

bool has_twice(const Ring& ring) {
  if (ring.size <= Ring::readable) {
    for (std::uint32_t k = 1; k < ring.size; ++k)
      if (std::find(ring.ids, ring.ids + k, ring.ids[k]) != ring.ids + k) return true;
    return false;
  }
  std::vector<progressive::Id> sorted(ring.ids, ring.ids + ring.size);
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

}  // namespace

SurfaceCollapse::SurfaceCollapse(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                 CollapseBy collapse_by, InstructionSet instructions, Scheduler& scheduler)
    : config_{.instructions = instructions}, scheduler_(scheduler) {
  check_input(positions, triangles);
  number(positions);
  mesh_.triangles.resize(triangles.size());
  scheduler.for_chunks(triangles.size(), vertex_grain, [&](ChunkRange c) {
    for (std::size_t t = c.begin; t < c.end; ++t)
      for (std::size_t k = 0; k < 3; ++k) mesh_.triangles[t].v[k] = numbers_[triangles[t].v[k]];
  });
  collapse_ = std::make_unique<RegionCollapse>(mesh_, config_, scheduler);
  check_rings(positions, triangles);
  if (collapse_by == CollapseBy::shape) collapse_->run();
  for (const progressive::CollapseRecord& record : collapse_->records())
    collapses_.push_back({record.vertex, collapse_->parents()[record.vertex], record.ring});
  const std::size_t before = collapses_.size();
  base_ = spherical::collapse_to_tetrahedron(rings(), collapses_, arena_);
  by_connectivity_ = collapses_.size() - before;
  if (base_.size() != 4) refuse_kind(triangles, positions.size());
}

// By Morton code of the position, then by number.
void SurfaceCollapse::number(std::span<const Vec3d> positions) {
  const std::vector<Vec3f> unit = unit_positions(positions);
  constexpr std::uint64_t places = 0xffff, parts = 4096, part_shift = 36;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(positions.size()), sorted(positions.size());
  const auto place = [](float x) { return static_cast<std::uint16_t>(x * static_cast<float>(places)); };
  scheduler_.for_chunks(unit.size(), vertex_grain, [&](ChunkRange c) {
    for (std::size_t v = c.begin; v < c.end; ++v)
      keys[v] = {CellCode::from({place(unit[v].x), place(unit[v].y), place(unit[v].z)}).morton,
                 static_cast<std::uint32_t>(v)};
  });
  std::vector<std::size_t> first(parts + 2, 0);
  for (const auto& key : keys) ++first[(key.first >> part_shift) + 2];
  for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
  for (const auto& key : keys) sorted[first[(key.first >> part_shift) + 1]++] = key;
  scheduler_.for_chunks(parts, 1, [&](ChunkRange c) {
    const auto begin = sorted.begin();
    std::sort(begin + static_cast<std::ptrdiff_t>(first[c.begin]), begin + static_cast<std::ptrdiff_t>(first[c.end]));
  });
  sources_.resize(unit.size()), numbers_.resize(unit.size()), mesh_.positions.resize(unit.size());
  scheduler_.for_chunks(unit.size(), vertex_grain, [&](ChunkRange c) {
    for (std::size_t v = c.begin; v < c.end; ++v) {
      sources_[v] = sorted[v].second;
      numbers_[sources_[v]] = static_cast<std::uint32_t>(v);
      mesh_.positions[v] = unit[sources_[v]];
    }
  });
}

// Every vertex has a closed fan of distinct neighbours.
void SurfaceCollapse::check_rings(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  std::atomic<bool> sound = rings().cut_vertices() == 0 && rings().cut_edges() == 0;
  scheduler_.for_chunks(positions.size(), vertex_grain, [&](ChunkRange c) {
    for (std::size_t v = c.begin; v < c.end; ++v) {
      const Ring& ring = rings().ring(static_cast<progressive::Id>(v));
      if (ring.open != 0 || ring.size < 3 || has_twice(ring)) sound = false;
    }
  });
  if (!sound) refuse_kind(triangles, positions.size());
}

}  // namespace lodestone
