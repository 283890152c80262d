#include "parallel/out_of_core/out_of_core_state.h"

#include <span>
#include <system_error>
#include <utility>

#include "parallel/mesh/vertex_sharing.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

constexpr std::size_t grain = std::size_t{1} << 18;  // vertices; a multiple of 64

BitSet shared_bits(const FinestVertices& vertices) {
  BitSet bits(vertices.sharing.size());
  for (std::size_t v = 0; v < vertices.sharing.size(); ++v)
    if (vertices.sharing[v] & FinestVertices::shared_flag) bits.set(v);
  return bits;
}

// Visits the first parts of the record of a spilled mesh, in their order.
template <class AnyMesh, class Value, class List>
void visit_head(AnyMesh& mesh, const Value& value, const List& list) {
  value(mesh.level);
  value(mesh.triangles);
  value(mesh.transform.origin);
  value(mesh.transform.scale);
  value(mesh.transform.lattice.bits);
  value(mesh.transform.up);
  value(mesh.repairs);
  value(mesh.cells.fingerprint);
  list(mesh.cells.codes);
  list(mesh.cells.first_run);
  list(mesh.cells.runs);
  list(mesh.cells.first_triangle);
}

}  // namespace

OutOfCoreFiles::OutOfCoreFiles(const MeshStream& stream, const ModelConfig& config) {
  if (!config.resume) {
    const std::filesystem::path folder = scratch_folder(config.output, config.scratch).parent_path();
    const std::filesystem::path at = folder.empty() ? "." : folder;
    triangles_ = ScratchFile::nameless(at);
    cells_ = ScratchFile::nameless(at);
    return;
  }
  folder_ = scratch_folder(config.output, config.scratch);
  create_scratch_folder(folder_);
  const InputIdentity input{stream.identity(), stream.vertex_count(), stream.triangle_count(), stream.up()};
  journal_ =
      open_build_journal(folder_ / "journal", build_identity(input, config.build, config.lattice, config.program),
                         [&](Journal::Kind kind, std::span<const std::byte> bytes) {
                           if (kind == Journal::Kind::spilled && spilled_.empty())
                             spilled_.assign(bytes.begin(), bytes.end());
                           else if (kind == Journal::Kind::block && !spilled_.empty())
                             blocks_.emplace_back(bytes.begin(), bytes.end());
                         });
  triangles_ = ScratchFile::named(folder_ / "triangles");
  cells_ = ScratchFile::named(folder_ / "cells");
  positions_ = ScratchFile::named(folder_ / "positions");
  if (has_spilled()) return;
  triangles_->truncate(0);
  cells_->truncate(0);
  positions_->truncate(0);
}

std::uint64_t OutOfCoreFiles::bytes() const {
  return triangles_->size() + cells_->size() + (positions_ ? positions_->size() : 0);
}

void OutOfCoreFiles::record_spilled(const SpilledMesh& mesh) {
  if (!journal_) return;
  const std::uint64_t at = positions_->claim(mesh.vertices.positions.size() * sizeof(Vec3f));
  positions_->write_at(at, std::as_bytes(std::span(mesh.vertices.positions)));
  ByteWriter out;
  visit_head(
      mesh, [&](const auto& value) { out.put(value); }, [&](const auto& list) { out.put_vector(list); });
  out.put(static_cast<std::uint64_t>(mesh.vertices.positions.size()));
  out.put_vector(shared_bits(mesh.vertices).words());
  journal_->append(Journal::Kind::spilled, out.bytes());
}

SpilledMesh OutOfCoreFiles::take_spilled(Scheduler& scheduler) {
  SpilledMesh mesh;
  ByteSource in(spilled_);
  visit_head(
      mesh, [&](auto& value) { in.get(value); }, [&](auto& list) { in.get_vector(list); });
  std::uint64_t vertices = 0;
  in.get(vertices);
  BitSet shared;
  in.get_vector(shared.words());
  std::vector<std::byte>().swap(spilled_);
  resize_in_parallel(mesh.vertices.positions, vertices, scheduler);
  resize_in_parallel(mesh.vertices.sharing, vertices, scheduler);
  scheduler.for_chunks(vertices, grain, [&](ChunkRange range) {
    const auto positions = std::span(mesh.vertices.positions).subspan(range.begin, range.end - range.begin);
    positions_->read_at(range.begin * sizeof(Vec3f), std::as_writable_bytes(positions));
    for (std::size_t v = range.begin; v < range.end; ++v)
      mesh.vertices.sharing[v] = shared[v] ? FinestVertices::shared_flag : unowned;
  });
  mesh.vertices.shared = number_shared(mesh.vertices.sharing, scheduler);
  return mesh;
}

void OutOfCoreFiles::record_block(std::span<const std::byte> record) {
  if (journal_) journal_->append(Journal::Kind::block, record);
}

void OutOfCoreFiles::remove() {
  if (folder_.empty()) return;
  std::error_code ignored;
  for (const char* name : {"triangles", "cells", "positions", "journal"})
    std::filesystem::remove(folder_ / name, ignored);
  std::filesystem::remove(folder_, ignored);  // unless it holds other files
}

}  // namespace lodestone
