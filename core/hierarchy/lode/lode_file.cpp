#include "core/hierarchy/lode/lode_file.h"

#include <array>
#include <fstream>
#include <vector>

#include "core/files/atomic_file.h"
#include "core/files/input_file.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/model/find_signatures.h"

namespace lodestone {

namespace {

// The tables come first and have the checksums of the payloads, so these are encoded twice: for the checksums, and to
// be written. That is cheaper than holding the file in memory; the parallel twin writes at offsets instead.
std::uint64_t write_plain(const Hierarchy& hierarchy, AtomicFile& file) {
  const LodeLayout layout = plan_lode(hierarchy);
  const std::vector<LodeChunk> chunks = lode_chunks(layout);
  std::vector<std::uint64_t> checksums(hierarchy.cells.size());
  std::vector<std::byte> buffer;
  for (const LodeChunk chunk : chunks) encode_lode_chunk(hierarchy, layout, chunk, buffer, checksums);
  const std::vector<std::byte> assets = encode_assets(hierarchy, &signatures_of(hierarchy)->table());
  file.write(encode_lode_tables(hierarchy, layout, checksums, assets));
  for (const LodeChunk chunk : chunks) {
    encode_lode_chunk(hierarchy, layout, chunk, buffer, checksums);
    file.write(buffer);
  }
  file.write(assets);
  return file.position();
}

std::uint64_t write_compressed(const Hierarchy& hierarchy, AtomicFile& file) {
  std::vector<std::uint64_t> sizes(hierarchy.cells.size()), checksums(hierarchy.cells.size());
  std::vector<std::byte> payloads;
  compress_lode_chunk(hierarchy, {CellId(0), CellId(sizes.size())}, payloads, sizes, checksums);
  const LodeLayout layout = plan_compressed_lode(hierarchy, sizes);
  const std::vector<std::byte> assets = encode_assets(hierarchy, &signatures_of(hierarchy)->table());
  file.write(encode_lode_tables(hierarchy, layout, checksums, assets));
  file.write(payloads);
  file.write(assets);
  return file.position();
}

}  // namespace

bool is_lode_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, lode_magic.size()> begin{};
  return (file.read(begin.data(), begin.size()) && begin == lode_magic) || path.extension() == ".lode";
}

std::uint64_t write_lode(const Hierarchy& hierarchy, const std::filesystem::path& path, LodeForm form) {
  AtomicFile file(path);
  const std::uint64_t bytes =
      form == LodeForm::compressed ? write_compressed(hierarchy, file) : write_plain(hierarchy, file);
  file.commit();
  return bytes;
}

Hierarchy open_lode(const std::filesystem::path& path) {
  const auto map = std::make_shared<const MappedFile>(path);
  LodeReader reader(map->bytes(), map, path.string());
  reader.check(CellId(0), CellId(reader.cell_count()));
  return std::move(reader).take();
}

}  // namespace lodestone
