// Variables that stages of a program pass on to each other, as the text of the effects declares them, and a geometry
// stage between them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lodestone {

// "flat out vec3 tint;"
struct GlVarying {
  std::string qualifiers;  // "flat "
  std::string type, name;
  friend bool operator==(const GlVarying&, const GlVarying&) = default;
};

// The varyings that lines of the source declare; `direction` is "in" or "out". Lines that begin with a layout are
// ignored.
[[nodiscard]] std::vector<GlVarying> varyings_of(std::string_view source, std::string_view direction);

// The source with locations for its varyings: the place in `order`, by name. Varyings of other names are not changed.
[[nodiscard]] std::string with_locations(std::string_view source, std::string_view direction,
                                         const std::vector<GlVarying>& order);

// A geometry stage that passes on what the vertex stage declares, and has code of its own: `declarations` with its own
// varyings, `calls` for every corner.
[[nodiscard]] std::string geometry_source(const std::vector<GlVarying>& from_vertices,
                                          const std::vector<GlVarying>& order, std::string_view declarations,
                                          std::string_view calls);

}  // namespace lodestone
