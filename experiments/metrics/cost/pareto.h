// Cost against accuracy: the settings that no other setting beats in both.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace lodestone {

struct CostError {
  double cost = 0, error = 0;  // less is better; points with a number that is not finite count for nothing
};

// Indices of the points for which no other one is at most as dear and at most as wrong, and less in one of the two; by
// rising cost. Of equal points the first. O(n log n).
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const CostError> points);

// The cheapest point with an error of at most `limit`, of equally cheap ones the most accurate; empty if there is none.
[[nodiscard]] std::optional<std::size_t> cheapest_within(std::span<const CostError> points, double limit);

// Round limits (1, 2, 5 times powers of ten) to ask for the cheapest point of: from the first one that some point keeps
// to the first that all of the front keep. Zero comes first where a point has no error at all; over many powers of ten
// these are isolated.
[[nodiscard]] std::vector<double> error_limits(std::span<const CostError> points);

}  // namespace lodestone
