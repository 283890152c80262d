#include "core/simplify/contract/checked_simplifier.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"

namespace lodestone {
namespace {

std::string broken_at(const SimplifyInput& input, const SimplifyResult& result, std::size_t v) {
  const std::uint32_t p = result.parent[v];
  if (p >= input.positions.size()) return "the parent is out of range";
  if (result.parent[p] != p) return "P is not idempotent";
  if (!is_finite(result.positions[p])) return "the position is not a number";
  if (!input.lattice.holds(result.positions[p])) return "the position is not on the lattice";
  if (input.locked[v] && p != v) return "a locked vertex was collapsed";
  if (input.locked[v] && result.positions[v] != input.positions[v]) return "a locked vertex was moved";
  if (!input.labels.empty() && input.labels[p] != input.labels[v]) return "P changes the label";
  const double displaced = length(to_double(result.positions[p]) - to_double(input.positions[v]));
  if (!(displaced <= static_cast<double>(input.max_displacement)))
    return "displaced by " + std::to_string(displaced) + ", beyond " + std::to_string(input.max_displacement);
  return {};
}

std::string broken_wedges(const SimplifyInput& input, const SimplifyResult& result) {
  if (result.wedge_parent.size() != input.wedge_vertex.size()) return "P of wedges has another size";
  for (std::size_t w = 0; w < input.wedge_vertex.size(); ++w) {
    const std::uint32_t to = result.wedge_parent[w];
    if (to >= input.wedge_vertex.size() || input.wedge_vertex[to] != result.parent[input.wedge_vertex[w]])
      return "wedge " + std::to_string(w) + " goes to a wedge of another vertex than its own goes to";
  }
  return {};
}

class CheckedSimplifier final : public Simplifier {
 public:
  CheckedSimplifier(std::string name, std::unique_ptr<Simplifier> inner)
      : name_(std::move(name)), inner_(std::move(inner)) {
    if (!inner_) throw InputError("simplifier '" + name_ + "': the function that makes it returned nothing");
  }

  const SimplifyResult& simplify(const SimplifyInput& input) override {
    const SimplifyResult& result = inner_->simplify(input);
    const std::string fault = broken_contract(input, result);
    if (!fault.empty()) throw InputError("simplifier '" + name_ + "' breaks its contract: " + fault);
    return result;
  }
  [[nodiscard]] bool knows_wedges() const override { return inner_->knows_wedges(); }

 private:
  std::string name_;
  std::unique_ptr<Simplifier> inner_;
};

}  // namespace

std::string broken_contract(const SimplifyInput& input, const SimplifyResult& result) {
  const std::size_t count = input.positions.size();
  if (result.parent.size() != count || result.positions.size() != count) return "sizes differ from the input's";
  if (!result.distance.empty() && result.distance.size() != count) return "distances are not one a vertex";
  for (std::size_t v = 0; v < count; ++v)
    if (const std::string fault = broken_at(input, result, v); !fault.empty())
      return fault + " at vertex " + std::to_string(v);
  const auto left = static_cast<std::size_t>(std::ranges::count_if(input.triangles, [&](const Triangle& t) {
    return !is_degenerate({{result.parent[t.v[0]], result.parent[t.v[1]], result.parent[t.v[2]]}});
  }));
  if (left != result.triangles)
    return std::to_string(left) + " triangles are left, not " + std::to_string(result.triangles);
  return broken_wedges(input, result);
}

std::unique_ptr<Simplifier> make_checked_simplifier(std::string name, std::unique_ptr<Simplifier> inner) {
  return std::make_unique<CheckedSimplifier>(std::move(name), std::move(inner));
}

}  // namespace lodestone
