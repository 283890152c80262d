#include "parallel/clean/prepare_wedges.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "parallel/clean/find_repeats.h"

namespace lodestone {
namespace {

constexpr std::size_t grain = std::size_t{1} << 16;
constexpr std::uint32_t none = 0xffff'ffffu;

std::uint64_t mixed(std::uint64_t h, std::uint64_t value) {
  h = (h ^ value) * 0x9e37'79b9'7f4a'7c15ull;
  return h ^ (h >> 29);
}
std::uint64_t bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) | std::uint64_t{std::bit_cast<std::uint32_t>(b)} << 32;
}

// Removes the items i without keep(i).
template <class T, class Keep>
void keep_if(std::vector<T>& items, const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (keep(i)) items[kept++] = items[i];
  items.resize(kept);
}

// items[from[i]] for each i.
template <class T>
std::vector<T> gathered(const std::vector<T>& items, const std::vector<std::uint32_t>& from, Scheduler& scheduler) {
  std::vector<T> out(items.empty() ? 0 : from.size());
  scheduler.for_chunks(out.size(), grain, [&](ChunkRange range) {
    for (std::size_t i = range.begin; i < range.end; ++i) out[i] = items[from[i]];
  });
  return out;
}

}  // namespace

void make_finite(RawWedges& wedges) {
  for (Vec2f& uv : wedges.uv)
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = {};
  for (Vec3f& n : wedges.normal)
    if (!is_finite(n)) n = {};
  for (Vec2f& uv : wedges.uv) uv = {uv.x + 0.0f, uv.y + 0.0f};
  for (Vec3f& n : wedges.normal) n = {n.x + 0.0f, n.y + 0.0f, n.z + 0.0f};
}

std::vector<std::uint32_t> give_materials(RawWedges& wedges, std::size_t& count) {
  constexpr std::uint32_t unknown = no_material - 1;
  std::vector<std::uint32_t> material(count, unknown);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;
  for (std::size_t t = 0; t < wedges.material.size(); ++t)
    for (std::uint32_t& w : wedges.corners[t].v) {
      const std::uint32_t of_triangle = wedges.material[t];
      if (material[w] == unknown) material[w] = of_triangle;
      if (material[w] == of_triangle) continue;
      const auto [at, is_new] = copies.try_emplace({w, of_triangle}, static_cast<std::uint32_t>(count));
      if (is_new) {
        if (!wedges.uv.empty()) wedges.uv.push_back(wedges.uv[w]);
        if (!wedges.colour.empty()) wedges.colour.push_back(wedges.colour[w]);
        if (!wedges.normal.empty()) wedges.normal.push_back(wedges.normal[w]);
        material.push_back(of_triangle);
        ++count;
      }
      w = at->second;
    }
  return material;
}

WedgePreparation::WedgePreparation(RawMesh& raw, Scheduler& scheduler)
    : scheduler_(scheduler), count_(wedge_count(raw)) {
  wedges_ = std::exchange(raw.wedges, {});
  materials_ = std::exchange(raw.materials, {});
  textures_ = std::exchange(raw.textures, {});
  if (!wedges_.material.empty() && count_ == 0) count_ = raw.positions.size();  // only materials
  if (count_ == 0) return;
  if (wedges_.corners.empty()) wedges_.corners = raw.triangles;
  make_finite(wedges_);
}

void WedgePreparation::compact(const std::vector<Triangle>& triangles) {
  if (count_ == 0) return;
  const auto is_kept = [&](std::size_t t) { return !is_degenerate(triangles[t]); };
  keep_if(wedges_.corners, is_kept);
  keep_if(wedges_.material, is_kept);
}

void WedgePreparation::attach(IndexedMesh& mesh) {
  if (count_ == 0) return;
  if (std::ranges::any_of(wedges_.material, [](std::uint32_t m) { return m != 0; }))
    material_ = give_materials(wedges_, count_);
  place_wedges(mesh);
  weld();
  number();
  WedgeAttributes& out = mesh.wedges;
  out.uv = gathered(wedges_.uv, kept_, scheduler_);
  out.colour = gathered(wedges_.colour, kept_, scheduler_);
  out.normal = gathered(wedges_.normal, kept_, scheduler_);
  out.material = gathered(material_, kept_, scheduler_);
  out.materials = std::move(materials_);
  out.textures = std::move(textures_);

  const std::vector<std::uint32_t> vertex = gathered(vertex_, kept_, scheduler_);
  std::vector<std::uint32_t> first(mesh.positions.size(), none);
  for (std::size_t w = vertex.size(); w-- > 0;) first[vertex[w]] = static_cast<std::uint32_t>(w);
  out.vertex = gathered(first, vertex, scheduler_);
  mesh.positions = gathered(mesh.positions, vertex, scheduler_);
  scheduler_.for_chunks(mesh.triangles.size(), grain, [&](ChunkRange range) {
    for (std::size_t t = range.begin; t < range.end; ++t)
      for (std::size_t k = 0; k < 3; ++k) mesh.triangles[t].v[k] = numbers_[wedges_.corners[t].v[k]];
  });
}

// Every wedge belongs to one vertex, so all writers of a place write the same value.
void WedgePreparation::place_wedges(const IndexedMesh& mesh) {
  vertex_.assign(count_, none);
  scheduler_.for_chunks(mesh.triangles.size(), grain, [&](ChunkRange range) {
    for (std::size_t t = range.begin; t < range.end; ++t)
      for (std::size_t k = 0; k < 3; ++k)
        std::atomic_ref(vertex_[wedges_.corners[t].v[k]]).store(mesh.triangles[t].v[k], std::memory_order_relaxed);
  });
}

std::uint64_t WedgePreparation::hash_of(std::size_t w) const {
  std::uint64_t h = mixed(0, vertex_[w]);
  if (!material_.empty()) h = mixed(h, material_[w]);
  if (!wedges_.uv.empty()) h = mixed(h, bits(wedges_.uv[w].x, wedges_.uv[w].y));
  if (!wedges_.colour.empty()) h = mixed(h, std::bit_cast<std::uint32_t>(wedges_.colour[w]));
  if (!wedges_.normal.empty()) {
    const Vec3f n = wedges_.normal[w];
    h = mixed(mixed(h, bits(n.x, n.y)), std::bit_cast<std::uint32_t>(n.z));
  }
  return mixed(h, 1);
}

bool WedgePreparation::equal(std::uint32_t a, std::uint32_t b) const {
  return vertex_[a] == vertex_[b] && (material_.empty() || material_[a] == material_[b]) &&
         (wedges_.uv.empty() || wedges_.uv[a] == wedges_.uv[b]) &&
         (wedges_.colour.empty() || wedges_.colour[a] == wedges_.colour[b]) &&
         (wedges_.normal.empty() || wedges_.normal[a] == wedges_.normal[b]);
}

void WedgePreparation::weld() {
  numbers_.resize(count_);
  for (std::uint32_t w = 0; w < count_; ++w) numbers_[w] = w;
  (void)find_repeats(
      count_, all_in_memory,
      [&](ChunkRange range, const auto& emit) {
        for (std::size_t w = range.begin; w < range.end; ++w)
          if (vertex_[w] != none) emit(w, hash_of(w));
      },
      [&](std::uint32_t a, std::uint32_t b) { return equal(a, b); },
      [&](std::uint32_t repeat, std::uint32_t first) { numbers_[repeat] = first; }, scheduler_);
}

// Representatives come before what they represent.
void WedgePreparation::number() {
  kept_.clear();
  for (std::uint32_t w = 0; w < count_; ++w) {
    if (vertex_[w] == none) continue;
    if (numbers_[w] == w) {
      numbers_[w] = static_cast<std::uint32_t>(kept_.size());
      kept_.push_back(w);
    } else {
      numbers_[w] = numbers_[numbers_[w]];
    }
  }
}

}  // namespace lodestone
