// From a tolerance to numbers: the selection radius r_l and the morph band [a_l, c_l] of every level, or a selection
// radius R_C of every cell (docs/decisions/0055).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/camera/projection.h"
#include "render/lod/blend.h"

namespace lodestone {

class Signatures;  // core/hierarchy/model/signatures.h

enum class RadiiRule : std::uint8_t {
  per_level,  // r_l = max(kappa0 h_l, what keeps a band of width beta h_{l+1} at level l+1): admissible for any kappa0
  uniform,    // r_l = kappa0 h_l, the published rule: admissible iff kappa0 > rho + 3 delta
  adaptive,   // R_C from the errors of the cell and of those around it: always admissible; pixel_error only
};

struct RadiiConfig {
  RadiiRule rule = RadiiRule::per_level;
  DistanceMetric metric = DistanceMetric::euclidean;
  std::optional<float> kappa0 = {};  // least r_l / h_l; unset: from pixel_error at each level
  float pixel_error = 1;             // tau, in pixels; used when kappa0 is unset (per_level only)
  int image_height = 720;            // pixels
  float vertical_fov = 0.785f;       // radians
  float aspect = 16.0f / 9.0f;       // width over height: the angle to the image corner
  float beta = 0.5f;                 // least band width at level l over h_l; > 0
  float delta = 0;                   // guard for a selection stale by delta h_l; >= 0
  // Share of the constraint between the radii of neighbouring cells that adaptive radii keep, in [0, 1]: below 1 the
  // drawn surface may crack, which is what ablations look for.
  float constraint = 1;
  friend bool operator==(const RadiiConfig&, const RadiiConfig&) = default;
};

// "per-level" and so on.
[[nodiscard]] std::string_view name_of(RadiiRule rule);

// The same rule for a picture of this size and a camera of this field of view, in radians.
[[nodiscard]] RadiiConfig for_picture(RadiiConfig config, ImageSize size, double vertical_fov);

// The radius, over the error, that keeps the error below pixel_error anywhere in the picture.
[[nodiscard]] double radius_over_error(const RadiiConfig& config);

struct Radii {
  DistanceMetric metric = DistanceMetric::euclidean;
  std::vector<float> select;      // r_l for l < L: a cell of level l is drawn iff d(v_p, B) >= r_l and no ancestor is
  std::vector<float> band_begin;  // a_l: lambda = 1 up to here
  std::vector<float> band_end;    // c_l: lambda = 0 from here; at level 0 infinite (lambda = 1)
  // r_{l-1} > a_l for all levels, guards included: the drawn surface is continuous in space and time.
  bool admissible = false;
  // Adaptive radii, else empty: R_C by cell. A cell is drawn iff d(v_p, B) >= R_C and no ancestor is. On the finest
  // level, where all are drawn, it is where the morph begins, at 0 or farther away. Then select[l] is the largest of
  // level l, and [band_begin, band_end] are the narrowest that a vertex of the level may morph in, as wide as beta asks
  // for.
  std::vector<float> by_cell;
  std::shared_ptr<const Signatures> signatures;  // null: cells are exchanged without a morph
  float delta = 0;                               // of the configuration, for by_cell

  // The radius at which a cell of this level is refined.
  [[nodiscard]] float of(CellId cell, std::size_t level) const {
    return by_cell.empty() ? select[level] : by_cell[cell];
  }
};

// A relative guard for the rounding of distances: widens a_l and narrows c_l.
inline constexpr float rounding_guard = 4e-6f;

// Detail is limited near a box, as if the viewpoint kept away from it: the distance is no less there than what is left
// of the radius (render/lod/limits.h). Selection and morph of a frame take the same limits.
struct DetailLimit {
  Box3f box;
  float radius = 0;
  friend bool operator==(const DetailLimit&, const DetailLimit&) = default;
};
using DetailLimits = std::span<const DetailLimit>;

// Throws InputError for parameters out of range. An inadmissible uniform kappa0 gives admissible = false and bands that
// are steps at r_{l-1}; the caller decides if that is an error. Adaptive radii need signatures: without those given and
// those of the hierarchy they are found here, which takes all of its payloads.
[[nodiscard]] Radii make_radii(const Hierarchy& hierarchy, const RadiiConfig& config,
                               std::shared_ptr<const Signatures> signatures = nullptr);

// H(D, P) axis by axis: how far points of the inner box may lie from the outer one, in either direction of an axis. The
// norm of it is the largest distance.
[[nodiscard]] Vec3d overhang(const Box3f& inner, const Box3f& outer);

// rho: a uniform kappa0 is admissible just above it.
[[nodiscard]] float greatest_reach(const Hierarchy& hierarchy, DistanceMetric metric);

}  // namespace lodestone
