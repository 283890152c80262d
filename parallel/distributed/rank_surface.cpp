#include "parallel/distributed/rank_surface.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/mesh/raw_mesh.h"
#include "parallel/distributed/messages/pieces.h"

namespace lodestone {
namespace {

// Materials and textures as bytes: as a file has them.
Message encode_surface(RawMesh& mesh) {
  Hierarchy assets;
  assets.materials = std::move(mesh.materials);
  assets.textures = std::move(mesh.textures);
  Message bytes = encode_assets(assets);
  bytes.push_back(std::byte{has_surfaces(assets)});
  return bytes;
}

RawMesh decode_surface(const Message& bytes, int rank) {
  const auto fail = [&](const char* fault) {
    throw Error("the materials of rank " + std::to_string(rank) + " have come damaged: " + fault);
  };
  if (bytes.empty()) fail("there are no bytes");
  Hierarchy assets;
  const std::uint16_t features = bytes.back() == std::byte{0} ? 0 : lode_surfaces;
  if (const char* fault = decode_assets(std::span(bytes).first(bytes.size() - 1), features, assets)) fail(fault);
  RawMesh mesh;
  mesh.materials = std::move(assets.materials);
  mesh.textures = std::move(assets.textures);
  return mesh;
}

// By rank, the bytes of each: at rank 0.
std::vector<Message> gather_at_first(const Message& own, Ranks& ranks) {
  constexpr std::size_t under_way = std::size_t{16} << 20;
  const std::size_t piece = std::max<std::size_t>(under_way / static_cast<std::size_t>(ranks.count()), 1 << 16);
  std::vector<Message> all(static_cast<std::size_t>(ranks.count()));
  for (std::size_t at = 0; ranks.any(at < own.size()); at = std::min(own.size(), at + piece)) {
    std::vector<Message> out(all.size());
    const auto some = std::span(own).subspan(at, std::min(piece, own.size() - at));
    out.front().assign(some.begin(), some.end());
    const std::vector<Message> in = ranks.exchange(std::move(out));
    for (std::size_t from = 0; from < in.size(); ++from)
      all[from].insert(all[from].end(), in[from].begin(), in[from].end());
  }
  return all;
}

// Appends the materials of a part to those of `all`; returns what the index of each has become.
std::vector<std::uint32_t> append_materials(RawMesh& all, RawMesh&& part, const std::string& name) {
  // As a mesh of one triangle for each of them, which append_mesh follows.
  part.triangles.resize(part.materials.size());
  part.wedges.material.resize(part.materials.size());
  std::iota(part.wedges.material.begin(), part.wedges.material.end(), 0u);
  const std::size_t before = all.triangles.size();
  append_mesh(all, std::move(part), name);
  std::vector<std::uint32_t> become(all.wedges.material.begin() + static_cast<std::ptrdiff_t>(before),
                                    all.wedges.material.end());
  all.triangles.clear(), all.wedges.material.clear();
  return become;
}

// Returns the new index of each of the own materials. Those of the first file remain as they are, equal or not.
std::vector<std::uint32_t> join_materials(RawMesh& own, RankSurface& out, const std::string& name, Ranks& ranks) {
  const std::size_t count = own.materials.size();
  std::vector<std::uint8_t> has_part = ranks.gather(std::uint8_t{!own.triangles.empty()});
  const auto first_part = static_cast<std::size_t>(std::ranges::find(has_part, 1) - has_part.begin());
  std::vector<Message> all = gather_at_first(encode_surface(own), ranks);
  ByRank<std::uint32_t> become = by_rank<std::uint32_t>(ranks);
  RawMesh joined;
  for (std::size_t rank = 0; ranks.rank() == 0 && rank < all.size(); ++rank) {
    RawMesh part = decode_surface(all[rank], static_cast<int>(rank));
    Message().swap(all[rank]);
    if (rank == first_part && joined.materials.empty() && joined.textures.empty()) {
      become[rank].resize(part.materials.size());
      std::iota(become[rank].begin(), become[rank].end(), 0u);
      joined = std::move(part);
    } else {
      become[rank] = append_materials(joined, std::move(part), name);
    }
  }
  out.materials = std::move(joined.materials);
  out.textures = std::move(joined.textures);
  std::vector<std::uint32_t> mine = std::move(ranks.exchange(become).front());
  if (mine.size() != count) throw Error("a message of another size than expected");
  return mine;
}

}  // namespace

SurfaceKinds kinds_of(const RawMesh& mesh) {
  return {!mesh.wedges.uv.empty(), !mesh.wedges.normal.empty(), !mesh.wedges.colour.empty(),
          !mesh.wedges.material.empty()};
}

std::uint64_t surface_bytes(const RankSurface& surface) {
  const RawWedges& w = surface.own;
  const auto bytes = [](const auto& items) { return items.size() * sizeof(items.front()); };
  std::uint64_t sum = bytes(w.corners) + bytes(w.uv) + bytes(w.normal) + bytes(w.colour) + bytes(w.material);
  for (const Texture& texture : surface.textures) sum += 2 * texture.bytes.size();
  return sum;
}

RankSurface share_surface(RawMesh& own, const SurfaceKinds& kinds, const std::string& name, Ranks& ranks) {
  RankSurface out;
  out.kinds = kinds;
  const std::vector<std::uint32_t> become = join_materials(own, out, name, ranks);
  out.wedges = own.wedges.empty() ? own.positions.size() : wedge_count(own);
  out.own = std::exchange(own.wedges, {});
  RawWedges& w = out.own;
  if (w.corners.empty()) w.corners = own.triangles;
  if (kinds.uv) w.uv.resize(out.wedges);
  if (kinds.normals) w.normal.resize(out.wedges);
  if (kinds.colours) w.colour.resize(out.wedges);
  if (kinds.materials) w.material.resize(own.triangles.size(), no_material);
  for (std::uint32_t& material : w.material)
    if (material != no_material) material = become.at(material);
  return out;
}

}  // namespace lodestone
