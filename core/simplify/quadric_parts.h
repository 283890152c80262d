// Cutting a block that is too large for 16-bit ids into parts that are simplified one by one.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/simplify/simplifier.h"

namespace lodestone::quadric {

using BlockKernelCall = std::function<void(const SimplifyInput&, SimplifyResult&)>;

// Working memory, reused between calls.
struct PartsScratch {
  std::vector<std::uint32_t> order;         // triangles, part after part
  std::vector<std::uint32_t> stamp, local;  // by vertex
  std::vector<std::uint8_t> shared;         // by vertex: locked by the caller, or used by several parts
  std::vector<std::size_t> part_end;
  std::vector<std::uint32_t> vertices;  // of the current part, in order of appearance
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> locked;
  SimplifyResult result;
};

// Splits the triangles at the median of their barycentres along the longest axis until each part has at most
// `vertex_limit` vertices, locks what several parts share, and gives each part its share of the target. Depends on the
// input alone. `result` has its final sizes; vertices without triangles keep themselves.
void simplify_in_parts(const SimplifyInput& input, std::size_t vertex_limit, const BlockKernelCall& kernel,
                       PartsScratch& scratch, SimplifyResult& result);

}  // namespace lodestone::quadric
