#include "core/formats/gltf/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

ScalarType component_type(const JsonView& value) {
  // In the order of ScalarType; 5124, signed integers of 32 bits, is not used in glTF.
  constexpr std::uint64_t first = 5120, unused = 5124, last = 5126;
  const std::uint64_t number = value.integer();
  if (number < first || number > last || number == unused)
    value.fail("unknown component type " + std::to_string(number), damaged_file);
  return static_cast<ScalarType>(number - first);
}

int component_count(const JsonView& value) {
  constexpr std::array<std::string_view, 4> names{"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto found = std::find(names.begin(), names.end(), value.string());
  if (found == names.end()) value.fail("unknown type " + quote(value.string()), damaged_file);
  return static_cast<int>(found - names.begin()) + 1;
}

// Returns the view from `offset` on; requires that `count` elements of `size` bytes, `stride` apart, lie in it.
std::span<const char> elements(const JsonView& place, std::span<const char> view, std::uint64_t offset,
                               std::uint64_t count, std::uint64_t stride, std::uint64_t size) {
  const std::uint64_t room = offset < view.size() ? view.size() - offset : 0;
  // Checked by division, since count and stride come from the file.
  if (count > 0 && (room < size || count - 1 > (room - size) / stride))
    place.fail("reaches beyond its buffer view: " + std::to_string(count) + " elements of " + std::to_string(size) +
                   " bytes from byte " + std::to_string(offset) + " of " + std::to_string(view.size()),
               damaged_file);
  return view.subspan(static_cast<std::size_t>(std::min<std::uint64_t>(offset, view.size())));
}

// Replaces single elements ("sparse").
void patch(GltfDocument& document, const JsonView& sparse, GltfAccessor& accessor) {
  const std::size_t size = accessor.element_bytes();
  accessor.patched.resize(accessor.count * size);
  for (std::size_t i = 0; i < accessor.count; ++i)
    std::memcpy(accessor.patched.data() + i * size, accessor.bytes.data() + i * accessor.stride, size);

  const JsonView where = sparse.at("indices"), what = sparse.at("values");
  GltfAccessor indices;
  indices.components = 1;
  indices.type = component_type(where.at("componentType"));
  indices.count = static_cast<std::size_t>(sparse.at("count").integer());
  indices.stride = size_of(indices.type);
  indices.bytes = elements(where, document.view(where.at("bufferView")).bytes, where.integer_or("byteOffset", 0),
                           indices.count, indices.stride, indices.stride);
  const std::span<const char> values = elements(what, document.view(what.at("bufferView")).bytes,
                                                what.integer_or("byteOffset", 0), indices.count, size, size);
  const std::vector<std::uint32_t> targets = read_indices(indices, accessor.count, where);
  for (std::size_t i = 0; i < targets.size(); ++i)
    std::memcpy(accessor.patched.data() + targets[i] * size, values.data() + i * size, size);
  accessor.bytes = accessor.patched;
  accessor.stride = size;
}

}  // namespace

double GltfAccessor::largest() const {
  if (!normalised || !is_integer(type)) return 1;
  return with_scalar_type(type,
                          [](auto zero) { return static_cast<double>(std::numeric_limits<decltype(zero)>::max()); });
}

GltfAccessor describe_accessor(const JsonView& accessor) {
  GltfAccessor result;
  result.count = static_cast<std::size_t>(accessor.at("count").integer());
  result.type = component_type(accessor.at("componentType"));
  result.components = component_count(accessor.at("type"));
  result.normalised = accessor.boolean_or("normalized", false);
  return result;
}

GltfAccessor open_accessor(GltfDocument& document, const JsonView& reference) {
  const JsonView description = document.item("accessors", reference);
  GltfAccessor accessor = describe_accessor(description);
  const std::optional<JsonView> view_index = description.find("bufferView");
  if (!view_index)
    throw UnsupportedError(describe(document.file(), description.place(), "an accessor has no bufferView",
                                    "store its values in a buffer"));
  const GltfView view = document.view(*view_index);
  const std::size_t size = accessor.element_bytes();
  accessor.stride = view.stride == 0 ? size : view.stride;
  accessor.bytes =
      elements(description, view.bytes, description.integer_or("byteOffset", 0), accessor.count, accessor.stride, size);
  if (const std::optional<JsonView> sparse = description.find("sparse")) patch(document, *sparse, accessor);
  return accessor;
}

std::vector<double> read_values(const GltfAccessor& accessor, int components) {
  const auto wanted = static_cast<std::size_t>(components);
  const auto present = static_cast<std::size_t>(std::min(components, accessor.components));
  const double largest = accessor.largest();
  std::vector<double> values(accessor.count * wanted);
  with_scalar_type(accessor.type, [&](auto zero) {
    using T = decltype(zero);
    for (std::size_t i = 0; i < accessor.count; ++i)
      for (std::size_t k = 0; k < present; ++k) {
        const auto value = static_cast<double>(load<T>(accessor.bytes.data() + i * accessor.stride + k * sizeof(T)));
        values[i * wanted + k] = largest == 1 ? value : std::max(value / largest, -1.0);
      }
  });
  return values;
}

std::vector<std::uint32_t> read_indices(const GltfAccessor& accessor, std::uint64_t limit, const JsonView& place) {
  if (accessor.components != 1 || accessor.type == ScalarType::float32 || accessor.type == ScalarType::int8 ||
      accessor.type == ScalarType::int16)
    place.fail("indices are not unsigned numbers", damaged_file);
  std::vector<std::uint32_t> indices(accessor.count);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i] = static_cast<std::uint32_t>(
        load_as<std::int64_t>(accessor.type, std::endian::little, accessor.bytes.data() + i * accessor.stride));
    if (indices[i] >= limit)
      place.fail("index " + std::to_string(indices[i]) + " at " + std::to_string(i) + " is out of range, there are " +
                     std::to_string(limit),
                 damaged_file);
  }
  return indices;
}

}  // namespace lodestone
