// Which points of a grid are in the free space (free_space.h) and which are not, by blocks of 8 x 8 x 8 points.
//
// A sheet without thickness is seen past on both sides, and no point of the grid lies in it. Where a sample has no
// solid point below it, the point nearest to it is made solid and keeps the sample: the surface is closed around it.
#pragma once

#include <array>
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
  static constexpr int block_side = 8;

  // Around the box, which holds all that the maps show.
  ShellGrid(const FreeSpace& space, const Box3f& box, double spacing, Scheduler& scheduler);

  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] std::size_t blocks() const { return solid_.size(); }
  [[nodiscard]] GridPoint first_point(std::size_t block) const;  // of the block
  [[nodiscard]] Vec3d position(GridPoint p) const;
  [[nodiscard]] bool contains(GridPoint p) const;
  [[nodiscard]] std::size_t block_of(GridPoint p) const;
  // Number of a point in its block: x, y, z from the lowest digit.
  [[nodiscard]] static std::size_t place_in_block(GridPoint p) {
    return static_cast<std::size_t>((p.z & 7) << 6 | (p.y & 7) << 3 | (p.x & 7));
  }
  [[nodiscard]] bool is_solid(GridPoint p) const {
    const std::size_t place = place_in_block(p);
    return (solid_[block_of(p)][place >> 6] >> (place & 63) & 1) != 0;
  }
  // True if no edge of the grid that starts in the block changes sides.
  [[nodiscard]] bool is_uniform(std::size_t block) const;
  [[nodiscard]] const SheetPoint* sheet_at(GridPoint p) const;  // null: none
  [[nodiscard]] std::size_t sheet_points() const { return sheets_.size(); }
  // The views that tell where the surface is in a block.
  void views_of(std::size_t block, std::vector<ViewNumber>& views) const;

 private:
  [[nodiscard]] GridPoint nearest_point(Vec3d p) const;
  [[nodiscard]] std::uint64_t number(GridPoint p) const { return block_of(p) * 512 + place_in_block(p); }
  [[nodiscard]] bool is_margin(GridPoint p) const;
  [[nodiscard]] Box3f box_of(std::size_t block) const;
  void carve(std::size_t block);
  void find_sheets(Scheduler& scheduler);
  [[nodiscard]] std::optional<GridPoint> sheet_point(const PositionMap& map, std::size_t pixel) const;

  const FreeSpace& space_;
  double spacing_;
  Vec3d origin_;
  int side_[3];                                      // blocks along x, y, z
  std::vector<std::array<std::uint64_t, 8>> solid_;  // of each block, one bit per point
  std::vector<SheetPoint> sheets_;                   // by ascending number
};

}  // namespace lodestone
