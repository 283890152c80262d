// Merging, simplifying and splitting one block.
//
// Based on the hierarchy of li2023 (child-parent relation with a displacement bound on a cubic grid); different from it
// in that blocks are shifted from level to level, that vertices on block borders are known exactly (UsageBox) and that
// nothing here depends on which worker runs it.
#include "core/hierarchy/block.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

constexpr std::uint32_t none = 0xffff'ffffu;
constexpr std::size_t kept_share = 4;  // one triangle of this many is kept per level

// Rounded towards larger values, except that zero stays zero.
float root_up(double squared) {
  return squared > 0 ? std::nextafter(static_cast<float>(std::sqrt(squared)), std::numeric_limits<float>::infinity())
                     : 0.0f;
}
float sum_up(float a, float b) { return b > 0 ? std::nextafter(a + b, std::numeric_limits<float>::infinity()) : a; }

class BlockBuilder {
 public:
  BlockBuilder(const Block& block, const LevelCells& parent_level, std::span<CellBuild> cells,
               std::span<CellBuild> parents, BlockScratch& scratch)
      : block_(block), parent_level_(parent_level), cells_(cells), parents_(parents), s_(scratch) {}

  void merge() {
    clear();
    for_each_cell([&](CellBuild& cell) { append_cell(cell); });
    s_.locked.resize(s_.positions.size());
    for (std::size_t v = 0; v < s_.positions.size(); ++v)
      s_.locked[v] = s_.shared[v] && !s_.usage[v].inside(block_.range);
  }

  const SimplifyResult& simplify(Simplifier& simplifier, float sigma0) {
    return simplifier.simplify({s_.positions, s_.triangles, s_.locked, displacement_bound(sigma0, block_.level),
                                s_.triangles.size() / kept_share});
  }

  void split(const SimplifyResult& result, float sigma0) {
    s_.images.resize(s_.triangles.size());
    for (std::size_t t = 0; t < s_.triangles.size(); ++t) {
      const auto& v = s_.triangles[t].v;
      s_.images[t] = {{result.parent[v[0]], result.parent[v[1]], result.parent[v[2]]}};
    }
    s_.surface.reset(s_.images, result.positions);
    count_uses(result);
    std::size_t first_vertex = 0, first_triangle = 0;
    for (std::size_t i = 0; i < block_.parents.size(); ++i)
      make_parent(result, block_.parents[i], static_cast<std::uint32_t>(i), sigma0, first_vertex, first_triangle);
  }

 private:
  template <class Visit>
  void for_each_cell(const Visit& visit) {
    for (const CellRank parent : block_.parents)
      for (CellRank c = parent_level_.first_child[parent]; c < parent_level_.first_child[parent + 1]; ++c)
        visit(cells_[c]);
  }

  void clear() {
    std::size_t vertices = 0, shared = 0, triangles = 0;
    for_each_cell([&](const CellBuild& cell) {
      vertices += cell.vertex_count();
      shared += cell.slab.shared_ids.size();
      triangles += cell.triangles.size();
    });
    s_.positions.clear();
    s_.normals.clear();
    s_.ids.clear();
    s_.usage.clear();
    s_.shared.clear();
    s_.triangles.clear();
    s_.block_id.clear();
    s_.positions.reserve(vertices);
    s_.triangles.reserve(triangles);
    const std::size_t slots = std::bit_ceil(2 * shared + 16);
    s_.table_keys.assign(slots, none);
    s_.table_values.resize(slots);
  }

  std::uint32_t append_vertex(const CellBuild& cell, std::size_t i) {
    s_.positions.push_back(cell.slab.positions[i]);
    s_.normals.push_back(cell.slab.normals[i]);
    s_.ids.push_back(cell.ids[i]);
    return static_cast<std::uint32_t>(s_.positions.size() - 1);
  }

  void append_cell(const CellBuild& cell) {
    const std::size_t first = s_.block_id.size(), own = cell.first_shared();
    s_.block_id.resize(first + cell.vertex_count());
    for (std::size_t i = 0; i < own; ++i) s_.block_id[first + i] = append_vertex(cell, i);
    s_.usage.resize(s_.positions.size());
    s_.shared.resize(s_.positions.size(), 0);
    for (std::size_t k = 0; k < cell.slab.shared_ids.size(); ++k) {
      std::uint32_t& known = find_shared(cell.slab.shared_ids[k]);
      if (known == none) {
        known = append_vertex(cell, own + k);
        s_.usage.emplace_back();
        s_.shared.push_back(1);
      }
      s_.usage[known].extend(cell.usage[k]);
      s_.block_id[first + own + k] = known;
    }
    for (const Triangle& t : cell.triangles)
      s_.triangles.push_back({{s_.block_id[first + t.v[0]], s_.block_id[first + t.v[1]], s_.block_id[first + t.v[2]]}});
  }

  // The value slot of a shared id; `none` when it is new.
  std::uint32_t& find_shared(std::uint32_t id) {
    const auto mask = static_cast<std::uint32_t>(s_.table_keys.size() - 1);
    std::uint32_t slot = (id * 0x9e37'79b9u) >> (32 - std::countr_zero(s_.table_keys.size()));
    while (s_.table_keys[slot] != id && s_.table_keys[slot] != none) slot = (slot + 1) & mask;
    if (s_.table_keys[slot] == none) {
      s_.table_keys[slot] = id;
      s_.table_values[slot] = none;
    }
    return s_.table_values[slot];
  }

  // How many parent cells of this block use each survivor, and which box they span. Every copy gets the whole box: the
  // copies go to different blocks of the next level, and each must know that the vertex is used beyond its own.
  void count_uses(const SimplifyResult& result) {
    s_.uses.assign(s_.positions.size(), 0);
    s_.parent_usage.assign(s_.positions.size(), UsageBox{});
    s_.stamp.assign(s_.positions.size(), none);
    std::size_t vertex = 0;
    for (std::uint32_t i = 0; i < block_.parents.size(); ++i) {
      for (CellRank c = parent_level_.first_child[block_.parents[i]];
           c < parent_level_.first_child[block_.parents[i] + 1]; ++c) {
        for (std::size_t end = vertex + cells_[c].vertex_count(); vertex < end; ++vertex) {
          const std::uint32_t p = result.parent[s_.block_id[vertex]];
          if (s_.stamp[p] == i) continue;
          s_.stamp[p] = i;
          ++s_.uses[p];
          s_.parent_usage[p].extend(parent_level_.codes[block_.parents[i]].coord());
        }
      }
    }
    s_.stamp.assign(s_.positions.size(), none);
    s_.local.resize(s_.positions.size());
  }

  // Used by another cell of the parents' level: by one of this block, or by one of a block that it is locked against.
  [[nodiscard]] bool becomes_shared(std::uint32_t survivor) const {
    return s_.locked[survivor] || s_.uses[survivor] > 1;
  }

  // The vertices P arrives at from the children, in order of appearance, shared ones last; `local` numbers them.
  std::size_t gather_members(const SimplifyResult& result, std::uint32_t stamp, std::size_t first, std::size_t end) {
    s_.members.clear();
    std::size_t shared = 0;
    for (std::size_t i = first; i < end; ++i) {
      const std::uint32_t p = result.parent[s_.block_id[i]];
      if (s_.stamp[p] == stamp) continue;
      s_.stamp[p] = stamp;
      s_.members.push_back(p);
      shared += becomes_shared(p);
    }
    std::stable_partition(s_.members.begin(), s_.members.end(), [&](std::uint32_t p) { return !becomes_shared(p); });
    for (std::size_t i = 0; i < s_.members.size(); ++i) s_.local[s_.members[i]] = static_cast<std::uint32_t>(i);
    return shared;
  }

  void make_parent(const SimplifyResult& result, CellRank rank, std::uint32_t stamp, float sigma0,
                   std::size_t& first_vertex, std::size_t& first_triangle) {
    std::size_t end_vertex = first_vertex, end_triangle = first_triangle;
    for (CellRank c = parent_level_.first_child[rank]; c < parent_level_.first_child[rank + 1]; ++c) {
      end_vertex += cells_[c].vertex_count();
      end_triangle += cells_[c].triangles.size();
    }
    const std::size_t shared = gather_members(result, stamp, first_vertex, end_vertex);
    CellBuild& parent = parents_[rank];
    allocate_parent(parent, shared, first_triangle, end_triangle);
    fill_vertices(result, parent);
    for (CellRank c = parent_level_.first_child[rank]; c < parent_level_.first_child[rank + 1]; ++c) {
      link_child(result, cells_[c], parent, first_vertex);
      first_vertex += cells_[c].vertex_count();
    }
    measure_cell(parent, block_.level - 1, sigma0);
    first_triangle = end_triangle;
  }

  void allocate_parent(CellBuild& parent, std::size_t shared, std::size_t first, std::size_t end) {
    std::size_t kept = 0;
    for (std::size_t t = first; t < end; ++t) kept += !is_degenerate(s_.images[t]);
    parent.slab.allocate(s_.members.size(), shared, kept);
    parent.triangles = parent.slab.triangles;
    std::size_t to = 0;
    for (std::size_t t = first; t < end; ++t) {
      const Triangle& coarse = s_.images[t];
      if (!is_degenerate(coarse))
        parent.triangles[to++] = {{s_.local[coarse.v[0]], s_.local[coarse.v[1]], s_.local[coarse.v[2]]}};
    }
  }

  void fill_vertices(const SimplifyResult& result, CellBuild& parent) {
    parent.ids.resize(s_.members.size());
    parent.usage.resize(parent.slab.shared_ids.size());
    const std::size_t first_shared = parent.first_shared();
    for (std::size_t i = 0; i < s_.members.size(); ++i) {
      const std::uint32_t p = s_.members[i];
      parent.slab.positions[i] = result.positions[p];
      parent.slab.normals[i] = s_.normals[p];
      parent.ids[i] = s_.ids[p];
      parent.bounds.extend(result.positions[p]);
      if (i < first_shared) continue;
      UsageBox& box = parent.usage[i - first_shared];
      box = s_.parent_usage[p];
      if (s_.locked[p]) box.extend(s_.usage[p].parent());
      parent.slab.shared_ids[i - first_shared] = s_.ids[p];
    }
  }

  void link_child(const SimplifyResult& result, CellBuild& child, CellBuild& parent, std::size_t first_vertex) {
    // Half of what the block has seen is the least distance that is told apart: most vertices are done after a glance.
    double farthest2 = 0, off_surface2 = off_surface2_ / 4;
    for (std::size_t i = 0; i < child.vertex_count(); ++i) {
      const std::uint32_t p = result.parent[s_.block_id[first_vertex + i]];
      child.slab.parents[i] = s_.local[p];
      const Vec3d moved = to_double(result.positions[p]) - to_double(child.slab.positions[i]);
      const double moved2 = dot(moved, moved);
      farthest2 = std::max(farthest2, moved2);
      if (moved2 > off_surface2) off_surface2 = s_.surface.farther(off_surface2, child.slab.positions[i], p);
    }
    off_surface2_ = std::max(off_surface2_, off_surface2);
    child.max_displacement = root_up(farthest2);
    parent.bounds.extend(child.bounds);
    parent.error = std::max(parent.error, sum_up(child.error, root_up(std::min(off_surface2, farthest2))));
    child.release_transient();
  }

  const Block& block_;
  const LevelCells& parent_level_;
  std::span<CellBuild> cells_, parents_;
  BlockScratch& s_;
  double off_surface2_ = 0;  // largest squared distance of a vertex so far from the coarse surface
};

}  // namespace

void build_block(const Block& block, const LevelCells& parent_level, std::span<CellBuild> cells,
                 std::span<CellBuild> parents, float sigma0, Simplifier& simplifier, BlockScratch& scratch) {
  BlockBuilder builder(block, parent_level, cells, parents, scratch);
  builder.merge();
  const SimplifyResult& result = builder.simplify(simplifier, sigma0);
  builder.split(result, sigma0);
}

}  // namespace lodestone
