// Accessors of a glTF file: arrays of vectors in its buffers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/files/scalar.h"
#include "core/formats/gltf/gltf_document.h"

namespace lodestone {

struct GltfAccessor {
  std::size_t count = 0;
  int components = 0;  // 1 to 4; matrices are not read
  ScalarType type{};
  bool normalised = false;  // integers stand for [0, 1] or [-1, 1]
  std::size_t stride = 0;
  std::span<const char> bytes;  // at least (count - 1) * stride + the size of an element
  std::vector<char> patched;    // the array behind `bytes` when values were replaced by sparse ones

  [[nodiscard]] std::size_t element_bytes() const { return static_cast<std::size_t>(components) * size_of(type); }
  // The largest integer of a normalised type, which stands for 1; 1 for other types.
  [[nodiscard]] double largest() const;
};

// Describes the elements of an accessor without opening its bytes. A Draco compressed primitive has none.
[[nodiscard]] GltfAccessor describe_accessor(const JsonView& accessor);
// Opens its bytes, too: every element lies in its buffer view. Throws InputError naming the place, UnsupportedError for
// accessors without bytes of their own (all zero, but for sparse values): they are for morph targets.
[[nodiscard]] GltfAccessor open_accessor(GltfDocument& document, const JsonView& reference);

// `components` values of each element in order; integers that stand for fractions are divided, missing values are 0.
[[nodiscard]] std::vector<double> read_values(const GltfAccessor& accessor, int components);
// Reads unsigned scalars. Throws InputError at `place` when one is not below `limit`.
[[nodiscard]] std::vector<std::uint32_t> read_indices(const GltfAccessor& accessor, std::uint64_t limit,
                                                      const JsonView& place);

}  // namespace lodestone
