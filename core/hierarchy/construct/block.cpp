// Merges, simplifies and splits one block.
//
// Based on the hierarchy of li2023 (child-parent relation with a displacement bound on a cubic grid); different from it
// in that blocks are shifted from level to level, that vertices on block borders are known exactly (UsageBox) and that
// the result does not depend on the worker that runs it.
#include "core/hierarchy/construct/block.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/hierarchy/construct/moved_attributes.h"
#include "core/math/round_up.h"

namespace lodestone {
namespace {

// One triangle of `kept` is kept per level, and at least this share of the vertices that may move. In a block with many
// locked vertices (a corner cut off the surface) a quarter of the triangles would leave hardly any of the others, and
// the largest errors of the level. A larger share would exceed a quarter in ordinary blocks: 0.25 stores 1.351 times
// the sphere, 0.2 1.329.
struct Shares {
  std::size_t kept;
  double min;
};
constexpr Shares quarters{4, 0.2}, halves{2, 0.45};

class BlockBuilder {
 public:
  BlockBuilder(const BlockInput& input, BlockScratch& scratch)
      : block_(input.block),
        parent_level_(input.parent_level),
        cells_(input.cells),
        parents_(input.parents),
        sigma0_(input.sigma0),
        grids_(input.grids),
        attributes_(input.attributes),
        lattice_(input.lattice),
        s_(scratch) {}

  void merge() {
    clear();
    for_each_cell([&](const CellBuild& cell) { append_cell(cell); });
    s_.locked.assign(s_.positions.size(), 0);
    s_.usage_of.resize(s_.positions.size());
    for (std::uint32_t k = 0; k < s_.shared.size(); ++k) {
      s_.locked[s_.shared[k]] = !s_.usage[k].inside(block_.range);
      s_.usage_of[s_.shared[k]] = k;
    }
    if (attributes_.wedges) weld_wedges();
  }

  const SimplifyResult& simplify(Simplifier& simplifier) {
    const float bound = displacement_bound(sigma0_, grids_.of(block_.level));
    const auto [kept_share, min_share] = grids_.halves ? halves : quarters;
    const std::size_t target = s_.triangles.size() / kept_share;
    if (!attributes_.wedges)
      return simplifier.simplify(
          {s_.positions, s_.triangles, s_.locked, bound, target, {}, {}, lattice_, {}, min_share});
    const SimplifyResult& result = s_.wedges.simplify(simplifier, bound, target, min_share, lattice_);
    interpolate_attributes({s_.wedges.moved(), s_.triangles, s_.uv, s_.colours});
    return result;
  }

  void split(const SimplifyResult& result) {
    s_.errors.begin(result, s_.triangles);
    gather_members(result);
    if (attributes_.wedges) join_uses();
    begin_normals();
    std::size_t vertex = 0;
    for (std::size_t i = 0; i < block_.parents.size(); ++i)
      make_parent(result, block_.parents[i], members_of(i), vertex);
    s_.coarse_normals.finish();
  }

 private:
  template <class Visit>
  void for_each_child(CellRank parent, const Visit& visit) {
    for (CellRank c = parent_level_.first_child[parent]; c < parent_level_.first_child[parent + 1]; ++c)
      visit(cells_[c]);
  }
  template <class Visit>
  void for_each_cell(const Visit& visit) {
    for (const CellRank parent : block_.parents) for_each_child(parent, visit);
  }

  void clear() {
    std::size_t vertices = 0, shared = 0, triangles = 0;
    for_each_cell([&](const CellBuild& cell) {
      vertices += cell.vertex_count();
      shared += cell.slab.shared_ids.size();
      triangles += cell.triangles.size();
    });
    for_each_in_scratch([](auto& array) { array.clear(); });
    s_.positions.reserve(vertices);
    s_.normals.reserve(vertices);
    s_.ids.reserve(vertices);
    s_.triangles.reserve(triangles);
    s_.block_id.reserve(vertices);
    s_.shared_ids.clear(shared);
  }

  template <class Visit>
  void for_each_in_scratch(const Visit& visit) {
    visit(s_.positions), visit(s_.normals), visit(s_.ids), visit(s_.triangles), visit(s_.block_id);
    visit(s_.uv), visit(s_.colours), visit(s_.materials), visit(s_.vertex_ids);
    visit(s_.shared), visit(s_.usage);
  }

  // Appends a cell's own vertices, and its shared ones unless an earlier cell has added them.
  void append_cell(const CellBuild& cell) {
    const std::size_t first = s_.block_id.size(), own = cell.first_shared();
    const auto base = static_cast<std::uint32_t>(s_.positions.size());
    const auto append = [own](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(own));
    };
    append(s_.positions, cell.slab.positions);
    append(s_.normals, cell.slab.normals);
    append(s_.ids, cell.ids);
    if (attributes_.wedges) append(s_.vertex_ids, cell.vertex_ids);
    if (attributes_.uv) append(s_.uv, cell.slab.uv);
    if (attributes_.colours) append(s_.colours, cell.slab.colours);
    if (attributes_.materials) append(s_.materials, cell.slab.materials);
    s_.block_id.resize(first + cell.vertex_count());
    std::uint32_t* const block_id = s_.block_id.data() + first;
    for (std::uint32_t i = 0; i < own; ++i) block_id[i] = base + i;
    for (std::size_t k = 0; k < cell.slab.shared_ids.size(); ++k) block_id[own + k] = append_shared(cell, k);
    const std::size_t first_triangle = s_.triangles.size();
    s_.triangles.resize(first_triangle + cell.triangles.size());
    Triangle* to = s_.triangles.data() + first_triangle;
    for (const Triangle& t : cell.triangles) *to++ = {{block_id[t.v[0]], block_id[t.v[1]], block_id[t.v[2]]}};
  }

  // Block id of a cell's k-th shared vertex, which is added if it is new.
  std::uint32_t append_shared(const CellBuild& cell, std::size_t k) {
    const std::uint32_t index = s_.shared_ids.number(cell.slab.shared_ids[k]);
    if (index == s_.shared.size()) {
      const std::size_t i = cell.first_shared() + k;
      s_.shared.push_back(static_cast<std::uint32_t>(s_.positions.size()));
      s_.usage.push_back(cell.usage[k]);
      s_.positions.push_back(cell.slab.positions[i]);
      s_.normals.push_back(cell.slab.normals[i]);
      s_.ids.push_back(cell.ids[i]);
      if (attributes_.wedges) s_.vertex_ids.push_back(cell.vertex_ids[i]);
      if (attributes_.uv) s_.uv.push_back(cell.slab.uv[i]);
      if (attributes_.colours) s_.colours.push_back(cell.slab.colours[i]);
      if (attributes_.materials) s_.materials.push_back(cell.slab.materials[i]);
    } else {
      s_.usage[index].extend(cell.usage[k]);
    }
    return s_.shared[index];
  }

  // The usage of a wedge is that of all wedges of its vertex.
  void weld_wedges() {
    s_.wedges.weld(s_.vertex_ids, s_.positions, s_.triangles, s_.locked);
    const std::span<const std::uint32_t> vertex = s_.wedges.vertex();
    s_.vertex_usage.assign(s_.wedges.vertices(), UsageBox{});
    for (std::size_t k = 0; k < s_.shared.size(); ++k) s_.vertex_usage[vertex[s_.shared[k]]].extend(s_.usage[k]);
    for (std::size_t k = 0; k < s_.shared.size(); ++k) s_.usage[k] = s_.vertex_usage[vertex[s_.shared[k]]];
  }
  void join_uses() {
    const std::span<const std::uint32_t> vertex = s_.wedges.vertex();
    s_.vertex_used_by.assign(s_.wedges.vertices(), 0);
    const auto members = std::span(s_.members).first(member_end_[block_.parents.size() - 1]);
    for (const std::uint32_t p : members) s_.vertex_used_by[vertex[p]] |= s_.used_by[p];
    for (const std::uint32_t p : members) s_.used_by[p] = s_.vertex_used_by[vertex[p]];
  }

  // Lists the survivors that each parent cell uses, in order of appearance, and for each survivor which of the at most
  // 64 parents use it. Without a branch, since new survivors are unpredictable: writes at most one item too many.
  void gather_members(const SimplifyResult& result) {
    s_.used_by.assign(s_.positions.size(), 0);
    if (s_.members.size() <= s_.block_id.size()) s_.members.resize(s_.block_id.size() + 1);
    s_.local.resize(s_.positions.size());
    const std::uint32_t* block_id = s_.block_id.data();
    std::uint64_t* const used_by = s_.used_by.data();
    std::uint32_t* const members = s_.members.data();
    std::size_t count = 0;
    for (std::size_t i = 0; i < block_.parents.size(); ++i) {
      for_each_child(block_.parents[i], [&](const CellBuild& child) {
        for (const std::uint32_t* end = block_id + child.vertex_count(); block_id != end; ++block_id) {
          const std::uint32_t p = result.parent[*block_id];
          const std::uint64_t known = used_by[p];
          used_by[p] = known | std::uint64_t{1} << i;
          members[count] = p;
          count += ~known >> i & 1;
        }
      });
      member_end_[i] = count;
    }
  }

  // Survivors that the i-th parent uses.
  [[nodiscard]] std::span<const std::uint32_t> members_of(std::size_t i) const {
    const std::size_t first = i > 0 ? member_end_[i - 1] : 0;
    return std::span(s_.members).subspan(first, member_end_[i] - first);
  }

  // True if another cell of the parents' level uses the survivor: one of this block, or one of another block.
  [[nodiscard]] bool becomes_shared(std::uint32_t survivor) const {
    return s_.locked[survivor] || (s_.used_by[survivor] & (s_.used_by[survivor] - 1)) != 0;
  }

  // Every copy gets the box of all cells that are known to use the survivor: the copies go to different blocks of the
  // next level, and each must know that the vertex is used beyond its own.
  [[nodiscard]] UsageBox parent_usage(std::uint32_t survivor) const {
    UsageBox box;
    for (std::uint64_t bits = s_.used_by[survivor]; bits != 0; bits &= bits - 1)
      box.extend(parent_level_.codes[block_.parents[static_cast<std::size_t>(std::countr_zero(bits))]].coord());
    if (!s_.locked[survivor]) return box;
    const UsageBox& below = s_.usage[s_.usage_of[survivor]];
    box.extend(grids_.keeps_cells(block_.level) ? below : below.parent());
    return box;
  }

  void make_parent(const SimplifyResult& result, CellRank rank, std::span<const std::uint32_t> members,
                   std::size_t& vertex) {
    CellBuild& parent = parents_[rank];
    const std::size_t shared = number_members(members);
    parent.vertex_errors.assign(members.size(), 0);
    std::size_t triangles = 0;
    for_each_child(rank, [&](const CellBuild& child) { triangles += child.triangles.size(); });
    if (s_.kept.size() <= triangles) s_.kept.resize(triangles + 1);
    std::size_t kept = 0;
    for_each_child(rank, [&](CellBuild& child) {
      link_child(result, child, parent, vertex);
      kept = keep_triangles(child, kept);
      vertex += child.vertex_count();
    });
    parent.slab.allocate(members.size(), shared, kept, attributes_);
    std::copy_n(s_.kept.begin(), kept, parent.slab.triangles.begin());
    parent.triangles = parent.slab.triangles;
    fill_vertices(result, members, parent);
    fill_border_errors(parent);
    if (attributes_.wedges) fill_attributes(members, parent);
    for_each_child(rank, [&](CellBuild& child) {
      parent.bounds.extend(child.bounds);
      child.release_transient();
    });
    s_.normal_sums.assign(members.size(), Float4{});
    measure_cell(parent, grids_.of(block_.level - 1), sigma0_, s_.normal_sums);
    s_.coarse_normals.add({parent.slab.normals, s_.normal_sums, parent.slab.positions, parent.triangles,
                           s_.local_vertex, s_.shared_members});
  }

  // Local ids of the members: in their order, shared ones last. Returns the number of those.
  std::size_t number_members(std::span<const std::uint32_t> members) {
    s_.shared_members.clear();
    for (const std::uint32_t p : members)
      if (becomes_shared(p)) s_.shared_members.push_back(p);
    const std::size_t shared = s_.shared_members.size();
    std::uint32_t next_own = 0, next_shared = static_cast<std::uint32_t>(members.size() - shared);
    for (const std::uint32_t p : members) s_.local[p] = becomes_shared(p) ? next_shared++ : next_own++;
    if (attributes_.wedges) {
      s_.local_vertex.resize(members.size());
      for (const std::uint32_t p : members) s_.local_vertex[s_.local[p]] = s_.wedges.vertex()[p];
    }
    return shared;
  }

  // Stores P of the child's vertices, and the distance by which it moves them.
  void link_child(const SimplifyResult& result, CellBuild& child, CellBuild& parent, std::size_t first_vertex) {
    const auto block_id = std::span<const std::uint32_t>(s_.block_id).subspan(first_vertex, child.vertex_count());
    double farthest2 = 0;
    for (std::size_t i = 0; i < child.vertex_count(); ++i) {
      const std::uint32_t p = result.parent[block_id[i]];
      child.slab.parents[i] = s_.local[p];
      const Vec3d moved = to_double(result.positions[p]) - to_double(child.slab.positions[i]);
      farthest2 = std::max(farthest2, dot(moved, moved));
    }
    child.max_displacement = float_above(std::sqrt(farthest2));
    s_.errors.add(child, block_id, parent);
  }

  // Appends the child's triangles under P, by the parent's local ids, to the `kept` ones; degenerate ones are dropped,
  // again without a branch. Returns the new number of triangles.
  std::size_t keep_triangles(const CellBuild& child, std::size_t kept) {
    const std::span<const std::uint32_t> parents = child.slab.parents;
    Triangle* const to = s_.kept.data();
    const bool wedges = attributes_.wedges;
    for (const Triangle& t : child.triangles) {
      const Triangle image{{parents[t.v[0]], parents[t.v[1]], parents[t.v[2]]}};
      to[kept] = image;
      const auto& v = wedges ? by_vertex(image).v : image.v;
      kept += std::size_t{v[0] != v[1]} & std::size_t{v[1] != v[2]} & std::size_t{v[2] != v[0]};
    }
    return kept;
  }
  [[nodiscard]] Triangle by_vertex(const Triangle& t) const {
    return {{s_.local_vertex[t.v[0]], s_.local_vertex[t.v[1]], s_.local_vertex[t.v[2]]}};
  }

  void fill_vertices(const SimplifyResult& result, std::span<const std::uint32_t> members, CellBuild& parent) {
    parent.ids.resize(members.size());
    parent.usage.resize(parent.slab.shared_ids.size());
    const std::size_t first_shared = parent.first_shared();
    for (const std::uint32_t p : members) {
      const std::uint32_t i = s_.local[p];
      parent.slab.positions[i] = result.positions[p];
      parent.slab.normals[i] = s_.normals[p];
      parent.ids[i] = s_.ids[p];
      parent.bounds.extend(result.positions[p]);
      if (i < first_shared) continue;
      parent.usage[i - first_shared] = parent_usage(p);
      parent.slab.shared_ids[i - first_shared] = s_.ids[p];
    }
  }

  // Normals of locked vertices remain: other blocks have triangles at them, too. Their turn comes on the next level.
  void begin_normals() {
    BlockNormals::Block block{s_.locked, {}, 0};
    if (attributes_.wedges) block.vertex = s_.wedges.vertex(), block.vertices = s_.wedges.vertices();
    s_.coarse_normals.begin(block);
  }

  // Groups triangles by material, for drawing.
  void fill_attributes(std::span<const std::uint32_t> members, CellBuild& parent) {
    parent.vertex_ids.resize(members.size());
    for (const std::uint32_t p : members) {
      const std::uint32_t i = s_.local[p];
      parent.vertex_ids[i] = s_.vertex_ids[p];
      if (attributes_.uv) parent.slab.uv[i] = s_.uv[p];
      if (attributes_.colours) parent.slab.colours[i] = s_.colours[p];
      if (attributes_.materials) parent.slab.materials[i] = s_.materials[p];
    }
    sort_by_material(parent);
  }

  const Block& block_;
  const LevelCells& parent_level_;
  std::span<CellBuild> cells_, parents_;
  float sigma0_;
  LevelGrids grids_;
  AttributeSet attributes_;
  Lattice lattice_;
  BlockScratch& s_;
  std::array<std::size_t, most_parents> member_end_{};  // of each parent's members
};

}  // namespace

void build_block(const BlockInput& input, Simplifier& simplifier, BlockScratch& scratch) {
  BlockBuilder builder(input, scratch);
  builder.merge();
  builder.split(builder.simplify(simplifier));
}

}  // namespace lodestone
