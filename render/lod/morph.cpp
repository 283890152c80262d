#include "render/lod/morph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/hierarchy/model/signatures.h"
#include "render/lod/limits.h"

namespace lodestone {

float morph_lambda(const MorphContext& context, int level, Vec3f w) {
  const auto l = static_cast<std::size_t>(level);
  const float begin = context.radii->band_begin[l], end = context.radii->band_end[l];
  const float d = limited_distance(context.radii->metric, context.viewpoint, w, context.limits);
  // At the root begin is infinite. An inadmissible band is empty, and begin == end is the place of its step.
  if (d < begin || (d <= begin && begin < end)) return 1;
  if (d >= end) return 0;
  return 1 - blend_share(context.blend, (d - begin) / (end - begin));
}

namespace {

// The lambda that all vertices of a signature share: 0 where one of their parents' cells is not refined, 1 where one of
// their own is, and in between by what is missing to either.
template <class Distance>
float signature_lambda(const MorphContext& context, int level, const Signatures::Users& users,
                       const Distance& distance_of) {
  const Radii& radii = *context.radii;
  const float stale = radii.delta * context.hierarchy->cell_size(level);
  const auto within = [&](CellId cell, float radius) { return radius - distance_of(cell); };
  float parents = std::numeric_limits<float>::infinity(), own = -parents;
  for (const CellId cell : users.parents) parents = std::min(parents, within(cell, radii.by_cell[cell] - 2 * stale));
  if (parents <= 0) return 0;
  for (const CellId cell : users.cells) own = std::max(own, within(cell, radii.by_cell[cell] + stale));
  if (own >= 0) return 1;
  return 1 - blend_share(context.blend, -own / (parents - own));
}

// With the limits that a signature of the cell may be near to, in `near`.
MorphContext context_near(const MorphContext& frame, CellId cell, std::vector<DetailLimit>& near) {
  MorphContext context = frame;
  if (frame.limits.empty()) return context;
  const Signatures& signatures = *frame.radii->signatures;
  Box3f all;  // parents' boxes hold those of the cells
  for (const std::uint32_t signature : signatures.of(cell))
    for (const CellId parent : signatures.users(signature).parents) all.extend(frame.hierarchy->cells[parent].bounds);
  near.clear();
  limits_near(frame.radii->metric, frame.viewpoint, all, frame.limits, near);
  context.limits = near;
  return context;
}

float distance_of_cell(const MorphContext& context, CellId cell) {
  return limited_distance(context.radii->metric, context.viewpoint, context.hierarchy->cells[cell].bounds,
                          context.limits);
}

float signature_lambda(const MorphContext& context, int level, const Signatures::Users& users) {
  return signature_lambda(context, level, users, [&](CellId cell) { return distance_of_cell(context, cell); });
}

// The ends are the stored normals themselves, like those of the positions: an exchange of cells changes no pixel.
Vec3f blend_normals(float lambda, PackedNormal own, PackedNormal parent) {
  if (lambda >= 1) return unpack_normal(own);
  const Vec3f coarser = unpack_normal(parent);
  if (lambda <= 0) return coarser;
  const Vec3f sum = lambda * unpack_normal(own) + (1 - lambda) * coarser;
  const float norm2 = dot(sum, sum);
  return norm2 > 1e-12f ? (1 / std::sqrt(norm2)) * sum : coarser;
}

// Calls body(i, lambda, vertex of the parent cell that P maps i to); at the root lambda is 1 and the last one i itself.
template <class Body>
void for_each_vertex(const MorphContext& frame, CellId cell, const Body& body) {
  const Cell& c = frame.hierarchy->cells[cell];
  const int level = frame.hierarchy->level_of(cell);
  if (level > 0 && !frame.radii->by_cell.empty()) {
    std::vector<float> lambdas;
    adaptive_lambdas(frame, cell, lambdas);
    const std::span<const std::uint8_t> places = signature_places(frame, cell);
    const std::size_t first = c.positions.size() - places.size();
    for (std::uint32_t i = 0; i < c.positions.size(); ++i)
      body(i, lambdas[i < first ? 0 : places[i - first]], c.parents[i]);
    return;
  }
  MorphContext context = frame;
  std::vector<DetailLimit> near;
  limits_near(frame.radii->metric, frame.viewpoint, c.bounds, frame.limits, near);
  context.limits = near;
  for (std::uint32_t i = 0; i < c.positions.size(); ++i) {
    if (level == 0) {
      body(i, 1.0f, i);
    } else {
      body(i, morph_lambda(context, level, c.positions[i]), c.parents[i]);
    }
  }
}

const Cell& parent_of(const MorphContext& context, const Cell& cell) {
  return cell.parent == no_cell ? cell : context.hierarchy->cells[cell.parent];
}

}  // namespace

Vec3f blend_positions(float lambda, Vec3f w, Vec3f parent) {
  if (lambda >= 1) return w;
  if (lambda <= 0) return parent;
  return lambda * w + (1 - lambda) * parent;
}

float vertex_lambda(const MorphContext& context, CellId cell, VertexId vertex) {
  const Cell& c = context.hierarchy->cells[cell];
  const int level = context.hierarchy->level_of(cell);
  if (level == 0) return 1;
  if (context.radii->by_cell.empty()) return morph_lambda(context, level, c.positions[vertex]);
  if (!context.radii->signatures) return 1;
  const Signatures& signatures = *context.radii->signatures;
  const std::uint32_t first = c.first_shared();
  const std::size_t place = vertex < first ? 0 : signatures.places(cell)[vertex - first];
  return signature_lambda(context, level, signatures.users(signatures.of(cell)[place]));
}

void adaptive_lambdas(const MorphContext& frame, CellId cell, std::vector<float>& out) {
  if (!frame.radii->signatures) return out.assign(1, 1);
  const Signatures& signatures = *frame.radii->signatures;
  const int level = frame.hierarchy->level_of(cell);
  std::vector<DetailLimit> near;
  const MorphContext context = context_near(frame, cell, near);
  out.clear();
  for (const std::uint32_t signature : signatures.of(cell))
    out.push_back(signature_lambda(context, level, signatures.users(signature)));
}

void FrameLambdas::begin(const MorphContext& context) {
  for (const std::uint32_t signature : found_) lambdas_[signature] = -1;
  for (const CellId cell : measured_) distances_[cell] = -1;
  found_.clear();
  measured_.clear();
  context_ = context;
  if (!context.radii->signatures) return;
  lambdas_.resize(context.radii->signatures->count(), -1);
  distances_.resize(context.hierarchy->cells.size(), -1);
}

void FrameLambdas::append(CellId cell, std::vector<float>& out) {
  if (!context_.radii->signatures) return out.push_back(1);
  const Signatures& signatures = *context_.radii->signatures;
  const int level = context_.hierarchy->level_of(cell);
  const MorphContext context = context_near(context_, cell, near_);
  const auto distance_of = [&](CellId c) {
    if (distances_[c] < 0) {
      distances_[c] = distance_of_cell(context, c);
      measured_.push_back(c);
    }
    return distances_[c];
  };
  for (const std::uint32_t signature : signatures.of(cell)) {
    float& lambda = lambdas_[signature];
    if (lambda < 0) {
      lambda = signature_lambda(context, level, signatures.users(signature), distance_of);
      found_.push_back(signature);
    }
    out.push_back(lambda);
  }
}

std::span<const std::uint8_t> signature_places(const MorphContext& context, CellId cell) {
  if (!context.radii->signatures) return {};
  return context.radii->signatures->places(cell);
}

Vec3f morph_position(const MorphContext& context, int level, Vec3f w, Vec3f parent_position) {
  return blend_positions(morph_lambda(context, level, w), w, parent_position);
}

void morph_cell(const MorphContext& context, CellId cell, std::span<Vec3f> out) {
  const Cell& c = context.hierarchy->cells[cell];
  assert(out.size() == c.positions.size());
  const Cell& coarser = parent_of(context, c);
  for_each_vertex(context, cell, [&](std::uint32_t i, float lambda, std::uint32_t parent) {
    out[i] = blend_positions(lambda, c.positions[i], coarser.positions[parent]);
  });
}

void morph_cell_normals(const MorphContext& context, CellId cell, std::span<Vec3f> out) {
  const Cell& c = context.hierarchy->cells[cell];
  assert(out.size() == c.normals.size());
  const Cell& coarser = parent_of(context, c);
  for_each_vertex(context, cell, [&](std::uint32_t i, float lambda, std::uint32_t parent) {
    out[i] = blend_normals(lambda, c.normals[i], coarser.normals[parent]);
  });
}

void morph_cell_vertices(const MorphContext& context, CellId cell, std::span<MorphedVertex> out) {
  const Cell& c = context.hierarchy->cells[cell];
  assert(out.size() == c.positions.size());
  const Cell& coarser = parent_of(context, c);
  for_each_vertex(context, cell, [&](std::uint32_t i, float lambda, std::uint32_t parent) {
    out[i] = {blend_positions(lambda, c.positions[i], coarser.positions[parent]),
              blend_normals(lambda, c.normals[i], coarser.normals[parent])};
  });
}

MorphedVertex morph_vertex(const MorphContext& context, CellId cell, VertexId vertex) {
  const Cell& c = context.hierarchy->cells[cell];
  if (c.parent == no_cell) return {c.positions[vertex], unpack_normal(c.normals[vertex])};
  const Cell& coarser = parent_of(context, c);
  const std::uint32_t parent = c.parents[vertex];
  const float lambda = vertex_lambda(context, cell, vertex);
  return {blend_positions(lambda, c.positions[vertex], coarser.positions[parent]),
          blend_normals(lambda, c.normals[vertex], coarser.normals[parent])};
}

}  // namespace lodestone
