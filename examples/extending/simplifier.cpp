// A simplifier of one's own: `simplifier build IN.ply -o OUT.lode --simplifier shortest-edge`.
//
// It halves the mesh of a block by collapsing its shortest edges, each vertex once. It knows neither quadrics nor
// wedges: the framework checks that it keeps the bound, the locks and the labels, and measures the errors.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <set>
#include <vector>

#include "lodestone/lodestone.h"

using namespace lodestone;

namespace {

class ShortestEdge final : public Simplifier {
 public:
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    const auto count = static_cast<std::uint32_t>(input.positions.size());
    result_ = {};
    for (std::uint32_t v = 0; v < count; ++v) result_.parent.push_back(v);
    result_.positions.assign(input.positions.begin(), input.positions.end());
    collapse(input);
    result_.triangles = static_cast<std::size_t>(std::ranges::count_if(input.triangles, [&](const Triangle& t) {
      return !is_degenerate({{result_.parent[t.v[0]], result_.parent[t.v[1]], result_.parent[t.v[2]]}});
    }));
    return result_;
  }

 private:
  struct Edge {
    float length2;
    std::uint32_t from, to;
    auto operator<=>(const Edge&) const = default;  // a total order: the same result at every call
  };

  void collapse(const SimplifyInput& input) {
    std::set<Edge> edges;  // half-edges, shortest first
    for (const Triangle& t : input.triangles)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t from = t.v[k], to = t.v[(k + 1) % 3];
        const Vec3f way = input.positions[to] - input.positions[from];
        edges.insert({dot(way, way), from, to});
      }
    // A vertex that has moved, or that another has moved onto or past, stays: no triangle is turned twice.
    std::vector<bool> settled(input.positions.size());
    std::size_t left = input.triangles.size();
    for (const Edge& edge : edges) {
      if (left <= input.target_triangles) return;
      const bool far = length(to_double(input.positions[edge.to]) - to_double(input.positions[edge.from])) >
                       static_cast<double>(input.max_displacement);
      const bool other_label = !input.labels.empty() && input.labels[edge.from] != input.labels[edge.to];
      if (far || other_label || input.locked[edge.from] || settled[edge.from] || settled[edge.to]) continue;
      result_.parent[edge.from] = edge.to;
      settled[edge.from] = settled[edge.to] = true;
      left -= std::min<std::size_t>(left, 2);
    }
  }

  SimplifyResult result_;
};

}  // namespace

int main(int argc, char** argv) try {
  add_simplifier("shortest-edge", {[](Placement) { return std::make_unique<ShortestEdge>(); }});
  return run_program(argc, argv);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
