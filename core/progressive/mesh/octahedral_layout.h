// How images lie over octahedral squares (core/spherical/octahedron), as files have it.
#pragma once

#include <cstdint>
#include <vector>

namespace lodestone {

class Json;
class JsonView;

// So many squares of equal sides, powers of two in texels.
struct SquareRun {
  std::uint32_t side = 0, count = 0;
  friend bool operator==(const SquareRun&, const SquareRun&) = default;
};

// Without squares: one image. With squares: an atlas of small ones (core/spherical/octahedron/square_atlas.h), a power
// of two along its side. Its squares follow each other along a Morton curve, larger ones first. Images of the same
// layout may have other sizes: all lengths are in proportion.
struct OctahedralLayout {
  std::uint32_t side = 0;  // of an atlas, texels
  std::vector<SquareRun> squares{};
  friend bool operator==(const OctahedralLayout&, const OctahedralLayout&) = default;
};

// true, or {"side": 256, "squares": [[64, 2], [16, 30]]}.
[[nodiscard]] Json to_json(const OctahedralLayout& layout);
// Throws InputError with the place for squares that do not fit.
[[nodiscard]] OctahedralLayout read_octahedral_layout(const JsonView& json);

}  // namespace lodestone
