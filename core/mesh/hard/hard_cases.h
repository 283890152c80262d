// Hard surfaces by name: what real files hold that breaks programs, each alone and as small as it can be.
//
// Every case has one of two outcomes. Most are repaired or simply valid: every command gives a valid result. The others
// have nothing left to draw, and every command that reads them refuses them with the same words.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/mesh/hard/polygon_mesh.h"

namespace lodestone {

struct HardCase {
  std::string_view name;
  std::string_view what;     // a few words
  std::string_view refusal;  // part of the message that refuses it; empty: it is valid once it is repaired
  std::uint64_t size;        // triangles, about, unless another number is asked for
  bool scales;               // false: the number is what it is
  PolygonMesh (*make)(std::uint64_t size);
};

// In the order of docs/stability.md.
[[nodiscard]] std::span<const HardCase> hard_cases();
// Throws InputError that lists the known names.
[[nodiscard]] const HardCase& hard_case(std::string_view name);

// Binary PLY: doubles, polygons as lists. The same bytes on every machine that rounds sines alike.
[[nodiscard]] std::string hard_ply(const PolygonMesh& mesh);

}  // namespace lodestone
