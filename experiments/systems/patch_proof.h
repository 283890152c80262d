// Cracks of a surface that is made of patches: by its triangles alone, as no relation of vertices to those of the full
// surface is known.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "experiments/metrics/drawn/drawn_mesh.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/subjects/frame_proof.h"
#include "experiments/systems/lod_system.h"

namespace lodestone {

// A model as patches show it.
struct DrawnPatches {
  const DrawnMesh& surface;
  const DrawnMesh& skirts;  // cover cracks: looked at for leaks alone
  const DrawnPoints& points;
};

class PatchProof {
 public:
  // `full`: the finest surface of the model.
  PatchProof(const DrawnMesh& full, double junction_distance, Scheduler& scheduler);

  // Open edges are edges of the border with an end where the full surface has no border, nor a point of its border has
  // been placed; there are no gaps of vertices and no jumps. Torn pixels, of the surface alone, and leaks of closed
  // models, where a depth is given, as in ProofFrame.
  [[nodiscard]] SurfaceSample measure(const DrawnPatches& drawn, const Screen& screen,
                                      std::optional<std::span<const float>> full_depth) const;

 private:
  std::vector<Vec3d> border_;  // places of the full surface's border, ascending
  double junction_distance_;
  Scheduler& scheduler_;
};

}  // namespace lodestone
