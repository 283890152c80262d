// Which points of a grid are in the free space (free_space.h) and which are not, by cubic blocks of points.
//
// A sheet without thickness is seen past on both sides, and no point of the grid lies in it. Where a sample has no
// solid point below it, the point nearest to it is made solid and keeps the sample: the surface is closed around it.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/reconstruct/outside/free_space.h"

namespace lodestone {

struct GridPoint {
  int x = 0, y = 0, z = 0;
};

// A solid point that stands for a thin sheet, and the sample of it.
struct SheetPoint {
  std::uint64_t point = 0;  // number of the grid point
  ViewNumber view = no_view;
  std::uint32_t pixel = 0;
};

class ShellGrid {
 public:
  static constexpr int block_side = 8;  // points; a power of two, so that the points of a layer fill one word
  static constexpr std::size_t block_points = block_side * block_side * block_side;

  // Around the box, which holds all that the maps show.
  ShellGrid(const FreeSpace& space, const Box3f& box, double spacing, Scheduler& scheduler);

  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] std::size_t blocks() const { return solid_.size(); }
  [[nodiscard]] GridPoint first_point(std::size_t block) const;  // of the block
  [[nodiscard]] GridPoint point_at(std::size_t block, std::size_t place) const {
    const GridPoint first = first_point(block);
    const auto digit = [&](int axis) { return static_cast<int>(place >> (axis * side_bits) & side_mask); };
    return {first.x + digit(0), first.y + digit(1), first.z + digit(2)};
  }
  [[nodiscard]] Vec3d position(GridPoint p) const;
  [[nodiscard]] bool contains(GridPoint p) const;
  [[nodiscard]] std::size_t block_of(GridPoint p) const;
  // Place of a point in its block, in [0, block_points): x, y, z from the lowest digit.
  [[nodiscard]] static std::size_t place_in_block(GridPoint p) {
    const auto digit = [](int i, int axis) { return (static_cast<std::size_t>(i) & side_mask) << (axis * side_bits); };
    return digit(p.x, 0) | digit(p.y, 1) | digit(p.z, 2);
  }
  [[nodiscard]] bool is_solid(GridPoint p) const {
    const std::size_t place = place_in_block(p);
    return (solid_[block_of(p)][place / word_bits] >> place % word_bits & 1) != 0;
  }
  // True if no edge of the grid that starts in the block changes sides.
  [[nodiscard]] bool is_uniform(std::size_t block) const;
  [[nodiscard]] const SheetPoint* sheet_at(GridPoint p) const;  // null: none
  [[nodiscard]] std::size_t sheet_points() const { return sheets_.size(); }
  // The views that tell where the surface is in a block.
  void views_of(std::size_t block, std::vector<ViewNumber>& views) const;

 private:
  static constexpr std::size_t side_mask = block_side - 1;
  static constexpr int side_bits = std::popcount(side_mask);
  static constexpr std::size_t word_bits = 64;
  // One bit per point of a block.
  using Bits = std::array<std::uint64_t, block_points / word_bits>;

  [[nodiscard]] GridPoint nearest_point(Vec3d p) const;
  [[nodiscard]] std::uint64_t number(GridPoint p) const { return block_of(p) * block_points + place_in_block(p); }
  void make_solid(std::size_t block, std::size_t place) {
    solid_[block][place / word_bits] |= std::uint64_t{1} << place % word_bits;
  }
  [[nodiscard]] bool is_margin(GridPoint p) const;
  [[nodiscard]] Box3f box_of(std::size_t block) const;
  void carve(std::size_t block);
  void find_sheets(Scheduler& scheduler);
  [[nodiscard]] std::optional<GridPoint> sheet_point(const PositionMap& map, std::size_t pixel) const;

  const FreeSpace& space_;
  double spacing_;
  Vec3d origin_;
  int side_[3];                     // blocks along x, y, z
  std::vector<Bits> solid_;         // of each block
  std::vector<SheetPoint> sheets_;  // by ascending number
};

}  // namespace lodestone
