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
  std::span<const char> bytes;  // (count - 1) * stride + the size of an element, at least
  std::vector<char> patched;    // what `bytes` refers to when values were replaced by sparse ones

  [[nodiscard]] std::size_t element_bytes() const { return static_cast<std::size_t>(components) * size_of(type); }
  // The largest integer of a normalised type, what 1 is; 1 for others.
  [[nodiscard]] double largest() const;
};

// What an accessor says of its elements; no bytes yet. Those of a Draco compressed primitive have none.
[[nodiscard]] GltfAccessor describe_accessor(const JsonView& accessor);
// With its bytes: every element lies in its buffer view. Throws InputError naming the place, UnsupportedError for
// accessors without bytes of their own (all zero, but for sparse values): they are for morph targets.
[[nodiscard]] GltfAccessor open_accessor(GltfDocument& document, const JsonView& reference);

// `components` values of each element, one after the other, integers that stand for fractions divided; missing ones 0.
[[nodiscard]] std::vector<double> read_values(const GltfAccessor& accessor, int components);
// Of unsigned scalars. Throws InputError at `place` when one is not below `limit`.
[[nodiscard]] std::vector<std::uint32_t> read_indices(const GltfAccessor& accessor, std::uint64_t limit,
                                                      const JsonView& place);

}  // namespace lodestone
