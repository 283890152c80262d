#include "core/progressive/mesh/octahedral_layout.h"

#include <bit>

#include "core/files/json.h"
#include "core/files/json_view.h"

namespace lodestone {
namespace {

constexpr std::uint64_t most_side = 1u << 15;

std::uint32_t read_side(const JsonView& json, std::uint64_t most) {
  const std::uint64_t side = json.integer();
  if (!std::has_single_bit(side) || side > most) json.fail("is not a side of squares, which are powers of two");
  return static_cast<std::uint32_t>(side);
}

}  // namespace

Json to_json(const OctahedralLayout& layout) {
  if (layout.squares.empty()) return true;
  Json squares = Json::array();
  for (const SquareRun& run : layout.squares) squares.push_back({run.side, run.count});
  return {{"side", layout.side}, {"squares", std::move(squares)}};
}

OctahedralLayout read_octahedral_layout(const JsonView& json) {
  if (json.json().is_boolean()) {
    if (!json.boolean()) json.fail("is left out where images are not octahedral");
    return {};
  }
  OctahedralLayout layout{read_side(json.at("side"), most_side), {}};
  const JsonView squares = json.at("squares");
  if (squares.size() == 0) squares.fail("an atlas has squares");
  std::uint64_t left = std::uint64_t{layout.side} * layout.side;
  std::uint32_t before = layout.side;
  for (std::size_t k = 0; k < squares.size(); ++k) {
    const JsonView run = squares.at(k);
    before = read_side(run.at(std::size_t{0}), before);
    const std::uint64_t count = run.at(std::size_t{1}).integer(), area = std::uint64_t{before} * before;
    if (count > left / area) squares.fail("the squares do not fit into the atlas");
    left -= count * area;
    layout.squares.push_back({before, static_cast<std::uint32_t>(count)});
  }
  return layout;
}

}  // namespace lodestone
