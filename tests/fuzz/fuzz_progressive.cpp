// .lpm and progressive glTF: any bytes give a mesh whose every level can be computed, or an Error. Checksums would keep
// the fuzzer out of the splits, so that the harness sets them right.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/base/error.h"
#include "core/files/byte_reader.h"
#include "core/files/checksum.h"
#include "core/progressive/lpm/lpm_format.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "tests/fuzz/json_mutator.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return lodestone::mutate_json(data, size, max_size, seed);
}

namespace {

void set_word(std::vector<char>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, 4);
}

void mend_checksums(std::vector<char>& bytes) {
  std::size_t at = 16, length_at = 8, crc_at = 12;
  while (at <= bytes.size()) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + length_at, 4);
    if (length > bytes.size() - at) return;
    set_word(bytes, crc_at, lodestone::crc32(std::as_bytes(std::span(bytes).subspan(at, length))));
    at += length;
    if (bytes.size() - at < 12) return;
    length_at = at, crc_at = at + 4, at += 12;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  std::vector<char> bytes(data, data + size);
  if (size >= 16 && std::memcmp(data, progressive::lpm_magic, 8) == 0) mend_checksums(bytes);
  try {
    ByteReader input({bytes.data(), bytes.size()}, "fuzz");
    const ProgressiveMesh mesh = read_progressive(input, true);
    const LevelFinder levels(mesh);
    for (const std::uint32_t share : {0u, 1u, 2u, 4u}) {
      const std::uint32_t level = levels.vertices_for(mesh.vertex_count() / 4 * share);
      for (const Triangle& t : levels.compute_level(level))
        for (const std::uint32_t id : t.v)
          if (id >= level) std::abort();
    }
  } catch (const Error&) {
  }
  return 0;
}
