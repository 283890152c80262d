#include "core/formats/ply/ply_layout.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/formats/common/lower_left.h"
#include "core/mesh/raw_mesh.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

template <class T, std::endian order>
void decode_vertices_as(const VertexLayout& layout, const char* record, std::span<Vec3d> out) {
  const auto [x, y, z] = layout.coordinates;
  for (Vec3d& position : out) {
    position = {static_cast<double>(load<T, order>(record + x.offset)),
                static_cast<double>(load<T, order>(record + y.offset)),
                static_cast<double>(load<T, order>(record + z.offset))};
    record += layout.stride;
  }
}

template <std::endian order>
std::size_t decode_triangles_as(const TriangleLayout& layout, const char* record, std::uint32_t vertex_count,
                                std::span<Triangle> out) {
  record += layout.count_offset;
  for (std::size_t i = 0; i < out.size(); ++i, record += layout.stride) {
    const Triangle triangle{{load<std::uint32_t, order>(record + 1), load<std::uint32_t, order>(record + 5),
                             load<std::uint32_t, order>(record + 9)}};
    // Negative indices are large ones here.
    const std::uint32_t highest = std::max({triangle.v[0], triangle.v[1], triangle.v[2]});
    if (record[0] != 3 || highest >= vertex_count) return i;
    out[i] = triangle;
  }
  return out.size();
}

}  // namespace

void decode_vertices(const VertexLayout& layout, std::span<const char> bytes, std::span<Vec3d> out) {
  assert(bytes.size() >= out.size() * layout.stride);
  const auto [x, y, z] = layout.coordinates;
  const bool big = layout.byte_order == std::endian::big;
  if (x.type == y.type && y.type == z.type) {
    with_scalar_type(x.type, [&](auto zero) {
      using T = decltype(zero);
      big ? decode_vertices_as<T, std::endian::big>(layout, bytes.data(), out)
          : decode_vertices_as<T, std::endian::little>(layout, bytes.data(), out);
    });
    return;
  }
  const char* record = bytes.data();
  for (Vec3d& position : out) {
    position = {load_as<double>(x.type, layout.byte_order, record + x.offset),
                load_as<double>(y.type, layout.byte_order, record + y.offset),
                load_as<double>(z.type, layout.byte_order, record + z.offset)};
    record += layout.stride;
  }
}

void resize_attributes(const VertexAttributeLayout& layout, std::size_t vertices, RawWedges& wedges) {
  if (!layout.normal.empty()) wedges.normal.resize(vertices);
  if (!layout.colour.empty()) wedges.colour.resize(vertices);
  if (!layout.uv.empty()) wedges.uv.resize(vertices);
}

std::uint8_t colour_component(ScalarType type, double value) {
  if (type == ScalarType::uint16) return unit_to_byte(value / 65535);
  return unit_to_byte(is_integer(type) ? value / 255 : value);
}

void decode_attributes(const VertexAttributeLayout& layout, std::span<const char> bytes, std::size_t first,
                       std::size_t count, RawWedges& wedges) {
  assert(bytes.size() >= count * layout.stride);
  const auto value = [&](const VertexAttributeLayout::Value& v, const char* record) {
    return load_as<double>(v.type, layout.byte_order, record + v.offset);
  };
  const auto component = [&](const VertexAttributeLayout::Value& v, const char* record) {
    if (v.type == ScalarType::uint8) return load<std::uint8_t>(record + v.offset);  // nearly always
    return colour_component(v.type, value(v, record));
  };
  const char* record = bytes.data();
  for (std::size_t i = first; i < first + count; ++i, record += layout.stride) {
    if (const auto& n = layout.normal; !n.empty())
      wedges.normal[i] = unit_normal({value(n[0], record), value(n[1], record), value(n[2], record)});
    if (const auto& c = layout.colour; !c.empty())
      wedges.colour[i] = {component(c[0], record), component(c[1], record), component(c[2], record),
                          c.size() > 3 ? component(c[3], record) : std::uint8_t{255}};
    if (const auto& uv = layout.uv; !uv.empty())
      wedges.uv[i] = from_lower_left(value(uv[0], record), value(uv[1], record));
  }
}

std::size_t decode_triangles(const TriangleLayout& layout, std::span<const char> bytes, std::uint32_t vertex_count,
                             std::span<Triangle> out) {
  assert(bytes.size() >= out.size() * layout.stride);
  return layout.byte_order == std::endian::big
             ? decode_triangles_as<std::endian::big>(layout, bytes.data(), vertex_count, out)
             : decode_triangles_as<std::endian::little>(layout, bytes.data(), vertex_count, out);
}

}  // namespace lodestone
