#include "experiments/subjects/result_hash.h"

#include <fmt/core.h>

#include <span>

#include "core/files/checksum.h"

namespace lodestone {
namespace {

template <class Values>
void add(std::uint64_t& sum, const Values& values) {
  sum = sum * 0x9e37'79b9'7f4a'7c15ull + checksum(std::as_bytes(std::span(values)));
}

// The same for short indices as for others.
template <class T>
void add(std::uint64_t& sum, const IndexView<T>& indices) {
  std::vector<T> room;
  add(sum, indices.widened(room));
}

}  // namespace

std::string to_hex(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::uint64_t hash_of(const Hierarchy& hierarchy) {
  std::uint64_t sum = hierarchy.levels.size();
  for (const Cell& cell : hierarchy.cells) {
    add(sum, std::span(&cell.code.morton, 1));
    add(sum, std::span(&cell.bounds, 1));
    add(sum, std::span(&cell.error, 1));
    add(sum, cell.positions);
    add(sum, cell.normals);
    add(sum, cell.parents);
    add(sum, cell.shared_ids);
    add(sum, cell.triangles);
  }
  return sum;
}

std::uint64_t hash_of(const ProgressiveMesh& mesh) {
  std::uint64_t sum = mesh.base_vertices;
  add(sum, mesh.positions);
  add(sum, mesh.triangles);
  add(sum, mesh.parents);
  return sum;
}

std::uint64_t hash_of(const RawMesh& mesh) {
  std::uint64_t sum = 0;
  add(sum, mesh.positions);
  add(sum, mesh.triangles);
  return sum;
}

std::uint64_t hash_of(const Image& image) {
  std::uint64_t sum = static_cast<std::uint64_t>(image.size.width);
  add(sum, image.rgba);
  return sum;
}

}  // namespace lodestone
