// Meshes on a small grid, with one float that may be anything: every simplifier keeps its contract.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/simplify/quadric/quadric_simplifier.h"
#include "core/simplify/simplifiers.h"

namespace {

using namespace lodestone;

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const SimplifyInput& input, const SimplifyResult& result) {
  std::size_t left = 0;
  for (std::size_t v = 0; v < input.positions.size(); ++v) {
    const std::uint32_t p = result.parent[v];
    require(p < input.positions.size() && result.parent[p] == p);
    require(!input.locked[v] || p == v);
    if (!is_finite(input.positions[v]) || !is_finite(input.positions[p])) continue;
    require(is_finite(result.positions[p]));
    require(length(to_double(result.positions[p]) - to_double(input.positions[v])) <= input.max_displacement);
  }
  for (const auto& [v] : input.triangles)
    left += !is_degenerate({{result.parent[v[0]], result.parent[v[1]], result.parent[v[2]]}});
  require(left == result.triangles);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 8) return 0;
  const std::size_t vertices = 3 + data[0] % 61;
  std::vector<Vec3f> positions(vertices);
  std::vector<std::uint8_t> locked(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::uint8_t byte = data[(v * 7 + 1) % size];
    positions[v] = {static_cast<float>(v % 8), static_cast<float>(v / 8), static_cast<float>(byte % 16) / 16};
    locked[v] = byte > 230;
  }
  if (data[1] & 1) std::memcpy(&positions[data[2] % vertices].x, data + 2, sizeof(float));  // any float at all
  std::vector<Triangle> triangles;
  for (std::size_t i = 4; i + 2 < size; i += 3) {
    const Triangle t{{static_cast<std::uint32_t>(data[i] % vertices),
                      static_cast<std::uint32_t>(data[i + 1] % vertices),
                      static_cast<std::uint32_t>(data[i + 2] % vertices)}};
    if (!is_degenerate(t)) triangles.push_back(t);
  }
  const SimplifyInput input{positions, triangles, locked, static_cast<float>(1 + data[3] % 64) / 8, data[2] % 32u};
  for (const std::string& kind : simplifier_names()) check(input, make_simplifier(kind)->simplify(input));
  return 0;
}
