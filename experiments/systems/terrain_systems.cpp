#include "experiments/systems/terrain_systems.h"

#include <algorithm>
#include <optional>

#include "experiments/systems/surface/patch_hierarchy.h"
#include "experiments/systems/surface/welded_surface.h"
#include "experiments/systems/terrain/chunk_tree.h"
#include "experiments/systems/terrain/clipmap.h"
#include "experiments/systems/terrain/height_field.h"

namespace lodestone {
namespace {

class TerrainChunks final : public Patches {
 public:
  TerrainChunks(const Hierarchy& model, Scheduler& /*scheduler*/)
      : cells_(model),
        field_(welded_surface(model, "chunked-skirts"), "chunked-skirts"),
        tree_(field_),
        points_(field_.places()) {}

  [[nodiscard]] const Hierarchy& hierarchy() const override { return cells_.hierarchy(); }
  [[nodiscard]] bool remakes() const override { return true; }
  // Cells come in pairs after the first, each with the skirt of a chunk.
  [[nodiscard]] bool is_skirt(CellId cell) const override { return cell % 2 == 0; }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) override {
    drawn_ = tree_.chunks_for(viewpoint, reach);
    cells_.clear();
    std::vector<CellId> cells;
    for (const DrawnChunk& drawn : drawn_) {
      place_posts(drawn);
      cells.push_back(cells_.add({positions_, normals_, tree_.chunks()[drawn.chunk].triangles}));
      hang_skirt(drawn);
      const CellId skirt = cells_.add({positions_, normals_, skirt_});
      if (!skirt_.empty()) cells.push_back(skirt);
    }
    return cells;
  }

  [[nodiscard]] DrawnPoints drawn_points() const override {
    DrawnPoints all{points_, points_};
    for (const DrawnChunk& drawn : drawn_) {
      const Square& s = tree_.chunks()[drawn.chunk].square;
      for (int j = s.j; j <= std::min(s.j + s.side, field_.rows() - 1); ++j)
        for (int i = s.i; i <= std::min(s.i + s.side, field_.columns() - 1); ++i)
          all.places[field_.index({i, j})] = field_.place({i, j}, tree_.height_over(drawn, {i, j}));
    }
    return all;
  }

 private:
  void place_posts(const DrawnChunk& drawn) {
    const Chunk& chunk = tree_.chunks()[drawn.chunk];
    positions_.clear(), normals_.clear();
    for (std::size_t p = 0; p < chunk.posts.size(); ++p) {
      positions_.push_back(field_.place(chunk.posts[p], tree_.drawn_height(drawn, p)));
      normals_.push_back(field_.normal(chunk.posts[p]));
    }
  }

  // From the rim down, its outside to the outside of the chunk.
  void hang_skirt(const DrawnChunk& drawn) {
    const Chunk& chunk = tree_.chunks()[drawn.chunk];
    positions_.clear(), normals_.clear(), skirt_.clear();
    for (const auto& edge : chunk.rim) {
      const auto first = static_cast<std::uint32_t>(positions_.size());
      for (const std::uint32_t p : edge) {
        const Post post = chunk.posts[p];
        const float top = tree_.drawn_height(drawn, p);
        positions_.push_back(field_.place(post, top));
        positions_.push_back(field_.place(post, top - tree_.skirt_depth(chunk.level)));
        normals_.insert(normals_.end(), 2, field_.normal(post));
      }
      skirt_.push_back({{first + 2, first, first + 1}});
      skirt_.push_back({{first + 2, first + 1, first + 3}});
    }
  }

  PatchHierarchy cells_;
  HeightField field_;
  ChunkTree tree_;
  std::vector<Vec3f> points_;
  std::vector<DrawnChunk> drawn_;
  std::vector<Vec3f> positions_;  // of the chunk at hand, as are the next two
  std::vector<PackedNormal> normals_;
  std::vector<Triangle> skirt_;
};

class NestedGrids final : public Patches {
 public:
  NestedGrids(const Hierarchy& model, Scheduler& /*scheduler*/)
      : cells_(model), field_(welded_surface(model, "clipmap"), "clipmap"), points_(field_.places()) {}

  [[nodiscard]] const Hierarchy& hierarchy() const override { return cells_.hierarchy(); }
  [[nodiscard]] bool remakes() const override { return true; }

  [[nodiscard]] std::vector<CellId> select(Vec3f viewpoint, double reach) override {
    grids_.emplace(field_, field_.over(viewpoint), clipmap_for(field_, reach));
    const Clipmap::Mesh mesh = grids_->mesh();
    return cells_.remake({mesh.positions, mesh.normals, mesh.triangles});
  }

  [[nodiscard]] DrawnPoints drawn_points() const override {
    DrawnPoints drawn{points_, {}};
    if (!grids_) return drawn;
    for (int j = 0; j < field_.rows(); ++j)
      for (int i = 0; i < field_.columns(); ++i)
        drawn.places.push_back(field_.place({i, j}, grids_->height_over({i, j})));
    return drawn;
  }

 private:
  PatchHierarchy cells_;
  HeightField field_;
  std::vector<Vec3f> points_;
  std::optional<Clipmap> grids_;
};

}  // namespace

LodSystem chunked_system() {
  return patch_system<TerrainChunks>("height fields: chunks of a quadtree with skirts, posts morphed to the parent's");
}

LodSystem clipmap_system() {
  return patch_system<NestedGrids>("height fields: nested grids around the viewer, with transition regions");
}

}  // namespace lodestone
