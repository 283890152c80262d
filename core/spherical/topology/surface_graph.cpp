#include "core/spherical/topology/surface_graph.h"

#include <algorithm>
#include <tuple>

namespace lodestone::spherical {

SurfaceGraph::SurfaceGraph(const Surface& surface)
    : rows_(surface.positions.size()), last_cut_(rows_.size()), triangles_(static_cast<Id>(surface.triangles.size())) {
  const std::vector<Id> opposite = opposite_sides(surface.triangles, surface.positions.size());
  links_.reserve(opposite.size());
  faces_.reserve(opposite.size());
  std::vector<Id> any(rows_.size(), no_id);  // by vertex: a side that starts there
  for (Id side = static_cast<Id>(opposite.size()); side-- > 0;) any[start_of(surface.triangles, side)] = side;
  double sum = 0;
  for (Id v = 0; v < rows_.size(); ++v) {
    rows_[v].begin = static_cast<std::uint32_t>(links_.size());
    Id side = any[v];
    do {
      const Id to = end_of(surface.triangles, side);
      links_.push_back(
          {to & 0x7FFF'FFFFu, 0, static_cast<float>(length(surface.positions[v] - surface.positions[to]))});
      sum += links_.back().length;
      greatest_length_ = std::max(greatest_length_, links_.back().length);
      faces_.push_back(side / 3);
      side = opposite[previous_side(side)];
    } while (side != any[v]);
    rows_[v].count = static_cast<std::uint32_t>(links_.size()) - rows_[v].begin;
  }
  labels_.resize(links_.size());
  mean_length_ = static_cast<float>(sum / static_cast<double>(links_.size()));
  genus_ = static_cast<Id>((4 + triangles_ - 2 * rows_.size()) / 4);  // V - 3/2 F + F = 2 - 2 genus
}

std::size_t SurfaceGraph::find(Id v, Id to) const {
  const std::span row = links(v);
  std::size_t k = 0;
  while (row[k].to != to) ++k;
  return k;
}

// The row of v keeps the links from `to` around to `from`, and the rest goes to a new row at the end; both have the two
// links of the loop.
void SurfaceGraph::split_row(Id v, Id from, Id to, Id left_cap) {
  const Row row = rows_[v];
  const std::size_t at_from = find(v, from), at_to = find(v, to);
  const auto append = [&](std::size_t first, std::size_t last, Id cap) {
    const auto begin = static_cast<std::uint32_t>(links_.size());
    for (std::size_t k = first;; k = (k + 1) % row.count) {
      const Link link = links_[row.begin + k];
      const std::uint64_t label = labels_[row.begin + k];
      const Id face_after = faces_[row.begin + k];
      links_.push_back(link);
      labels_.push_back(label);
      faces_.push_back(k == last ? cap : face_after);
      if (k == last) break;
    }
    return Row{begin, static_cast<std::uint32_t>(links_.size()) - begin};
  };
  rows_.push_back(append(at_from, at_to, left_cap + 1));
  // The left part is not longer than the old row: back into its place.
  const Row left = append(at_to, at_from, left_cap);
  std::copy_n(links_.begin() + left.begin, left.count, links_.begin() + row.begin);
  std::copy_n(labels_.begin() + left.begin, left.count, labels_.begin() + row.begin);
  std::copy_n(faces_.begin() + left.begin, left.count, faces_.begin() + row.begin);
  links_.resize(left.begin);
  labels_.resize(left.begin);
  faces_.resize(left.begin);
  rows_[v] = {row.begin, left.count};
  last_cut_[v] = cut_count() + 1;
  last_cut_.push_back(cut_count() + 1);
}

// True if the copy has the neighbour between its two links of the loop, whatever either is called by now.
bool SurfaceGraph::is_inside_copy(Id copy, Id neighbour, std::span<const Id> loop) const {
  const std::span row = links(copy);
  return std::any_of(row.begin() + 1, row.end() - 1,
                     [&](const Link& link) { return original(link.to, loop) == neighbour; });
}

void SurfaceGraph::cut(std::span<const Id> loop, Surface& surface) {
  const Id first_copy = vertex_count();
  const auto n = static_cast<Id>(loop.size());
  place_.resize(first_copy + n, no_id);
  for (Id k = 0; k < n; ++k) place_[loop[k]] = k;
  for (Id k = 0; k < n; ++k) split_row(loop[k], loop[(k + n - 1) % n], loop[(k + 1) % n], face_count());
  for (Id k = 0; k < n; ++k) {
    const Id copy = first_copy + k;
    std::span<Link> row = links(copy);
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      if (const Id f = face(copy, i); f < triangles_)
        std::replace(surface.triangles[f].v.begin(), surface.triangles[f].v.end(), loop[k], copy);
    row.front().set_to(first_copy + (k + n - 1) % n);
    row.back().set_to(first_copy + (k + 1) % n);
    for (Link& link : row.subspan(1, row.size() - 2)) {
      if (const Id j = place_[link.to]; j == no_id) {
        links(link.to)[find(link.to, loop[k])].set_to(copy);
      } else if (is_inside_copy(first_copy + j, loop[k], loop)) {
        link.set_to(first_copy + j);
      }
    }
    std::span<Link> left = links(loop[k]);
    for (Link& link : left.subspan(1, left.size() - 2))
      if (const Id j = place_[link.to]; j != no_id && is_inside_copy(first_copy + j, loop[k], loop))
        link.set_to(first_copy + j);
  }
  for (const Id v : loop) {
    place_[v] = no_id;
    surface.positions.push_back(surface.positions[v]);
    surface.source_vertex.push_back(surface.source_vertex[v]);
  }
  caps_ += 2;
  --genus_;
}

std::vector<std::vector<Id>> SurfaceGraph::cap_loops() const {
  std::vector<std::tuple<Id, Id, Id>> steps;  // cap, vertex, the next one
  for (Id v = 0; v < rows_.size(); ++v)
    for (std::size_t k = 0; k < rows_[v].count; ++k)
      if (const Id f = face(v, k); f >= triangles_) steps.emplace_back(f - triangles_, v, links(v)[k].to);
  std::sort(steps.begin(), steps.end());
  std::vector<std::vector<Id>> loops(caps_);
  for (auto begin = steps.begin(); begin != steps.end();) {
    const Id cap = std::get<0>(*begin);
    const auto end = std::find_if(begin, steps.end(), [&](const auto& step) { return std::get<0>(step) != cap; });
    const Id start = std::get<1>(*begin);
    Id v = start;
    do {
      loops[cap].push_back(v);
      v = std::get<2>(*std::lower_bound(begin, end, std::tuple<Id, Id, Id>(cap, v, 0)));
    } while (v != start);
    begin = end;
  }
  return loops;
}

}  // namespace lodestone::spherical
