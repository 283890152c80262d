#include "experiments/systems/tiles_system.h"

#include <algorithm>
#include <string>

#include "experiments/systems/surface/patch_hierarchy.h"
#include "experiments/systems/surface/welded_surface.h"
#include "experiments/systems/tiles/tile_tree.h"

namespace lodestone {
namespace {

class TilePatches final : public Patches {
 public:
  TilePatches(const Hierarchy& model, bool skirts, Scheduler& scheduler) : cells_(model) {
    const WeldedSurface surface = welded_surface(model, "tiles-replace");
    tiles_ = build_tile_tree(surface, {}, scheduler);
    const std::vector<std::uint8_t> on_border = border_vertices(surface);
    for (const TileNode& tile : tiles_) {
      std::vector<PackedNormal> normals;
      for (const std::uint32_t v : tile.mesh.vertices) normals.push_back(surface.normals[v]);
      std::vector<CellId>& cells = cells_of_.emplace_back();
      cells.push_back(cells_.add({tile.mesh.positions, normals, tile.mesh.triangles}));
      if (!skirts) continue;
      const Skirt skirt = skirt_of(tile, surface, on_border);
      if (!skirt.triangles.empty()) cells.push_back(cells_.add({skirt.positions, skirt.normals, skirt.triangles}));
    }
    is_skirt_.resize(cells_.hierarchy().cells.size(), false);
    for (const std::vector<CellId>& cells : cells_of_)
      if (cells.size() > 1) is_skirt_[cells[1]] = true;
  }

  [[nodiscard]] const Hierarchy& hierarchy() const override { return cells_.hierarchy(); }
  [[nodiscard]] bool is_skirt(CellId cell) const override { return is_skirt_[cell]; }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) override {
    std::vector<CellId> drawn;
    for (const std::uint32_t t : tiles_for(tiles_, viewpoint, reach))
      drawn.insert(drawn.end(), cells_of_[t].begin(), cells_of_[t].end());
    return drawn;
  }

 private:
  std::vector<TileNode> tiles_;
  std::vector<std::vector<CellId>> cells_of_;  // by tile: its own, and that of its skirt if it has one
  std::vector<bool> is_skirt_;                 // by cell
  PatchHierarchy cells_;
};

}  // namespace

LodSystem tiles_system(bool skirts) {
  const std::string tiles = "tiles that are simplified alone and replace each other";
  LodSystem system = patch_system<TilePatches>(tiles + (skirts ? ", with skirts" : ""), skirts);
  system.moves_vertices = false;
  return system;
}

}  // namespace lodestone
