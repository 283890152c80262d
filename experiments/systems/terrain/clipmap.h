// Geometry clipmaps (losasso2004): nested square grids around the viewer, each with twice the spacing of the one
// inside. Towards the outer end of a grid its posts move to where the next one has them, and triangles of no area close
// the junctions of the two: no crack.
//
// As published, except that the size of grids follows from the tolerance, coarser levels take their heights from the
// posts that they keep, as the triangulation here has them, and all are in memory.
#pragma once

#include <vector>

#include "experiments/systems/terrain/height_field.h"

namespace lodestone {

struct ClipmapConfig {
  int posts = 255;  // along the side of a grid: odd, at least 15
};

// The smallest grids in which no leg of a triangle is seen as longer than three tolerances; an error of 1 is within the
// tolerance from `reach` on.
[[nodiscard]] ClipmapConfig clipmap_for(const HeightField& field, double reach);

class Clipmap {
 public:
  // The grids around a viewer, in fractions of the field's grid. The field outlives it.
  Clipmap(const HeightField& field, HeightField::Over viewer, const ClipmapConfig& config);

  struct Mesh {
    std::vector<Vec3f> positions;
    std::vector<PackedNormal> normals;
    std::vector<Triangle> triangles;
  };
  [[nodiscard]] Mesh mesh() const;
  // The height at which any post of the field is drawn.
  [[nodiscard]] float height_over(Post post) const;
  [[nodiscard]] std::size_t levels() const { return grids_.size(); }

 private:
  // Posts at multiples of the spacing, from `first` over the same number of squares in both directions.
  struct Grid {
    int spacing = 1;
    Post first;
    int squares = 0;

    [[nodiscard]] int end_i() const { return first.i + squares * spacing; }
    [[nodiscard]] int end_j() const { return first.j + squares * spacing; }
    [[nodiscard]] bool contains(Post p) const {
      return p.i >= first.i && p.i <= end_i() && p.j >= first.j && p.j <= end_j();
    }
  };
  [[nodiscard]] Grid grid_at(int level) const;
  [[nodiscard]] bool covers(const Grid& grid) const;
  [[nodiscard]] float share(const Grid& grid, Post post) const;
  [[nodiscard]] float coarse_height(const Grid& grid, Post post) const;
  [[nodiscard]] float height(const Grid& grid, Post post) const;
  [[nodiscard]] bool is_main(const Grid& grid, Post post) const;
  void add_grid(std::size_t number, Mesh& mesh) const;
  void close_junctions(const Grid& inner, Mesh& mesh) const;

  const HeightField& field_;
  HeightField::Over viewer_;
  int posts_;
  std::vector<Grid> grids_;  // from the finest that is drawn to the first that covers the field
};

}  // namespace lodestone
