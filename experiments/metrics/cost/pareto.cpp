#include "experiments/metrics/cost/pareto.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace lodestone {
namespace {

bool counts(const CostError& point) { return std::isfinite(point.cost) && std::isfinite(point.error); }

// The smallest round number that is not below `value` > 0.
double round_up(double value) {
  for (int power = static_cast<int>(std::floor(std::log10(value))) - 1;; ++power)
    for (const double digit : {1.0, 2.0, 5.0}) {
      // A quotient of decimals, so that 0.02 is the number that is printed as 0.02.
      const double limit = power < 0 ? digit / std::pow(10, -power) : digit * std::pow(10, power);
      if (limit >= value) return limit;
    }
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const CostError> points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (counts(points[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order)
    if (points[i].error < best) {
      best = points[i].error;
      front.push_back(i);
    }
  return front;
}

std::optional<std::size_t> cheapest_within(std::span<const CostError> points, double limit) {
  for (const std::size_t i : pareto_front(points))
    if (points[i].error <= limit) return i;
  return std::nullopt;
}

std::vector<double> error_limits(std::span<const CostError> points) {
  const std::vector<std::size_t> front = pareto_front(points);
  if (front.empty()) return {};
  std::vector<double> limits;
  const double worst = points[front.front()].error;
  double best = points[front.back()].error;
  if (best <= 0) {
    limits.push_back(0);
    if (worst <= 0) return limits;
    // The next-best point is where positive limits begin to matter.
    for (const std::size_t i : front)
      if (points[i].error > 0) best = points[i].error;
  }
  const std::size_t zeros = limits.size();
  for (double limit = round_up(best);; limit = round_up(limit * 1.5)) {
    limits.push_back(limit);
    if (limit >= worst) break;
  }
  // Over many powers of ten, those alone, and the last.
  if (limits.size() > 9)
    limits.erase(
        std::remove_if(limits.begin() + static_cast<std::ptrdiff_t>(zeros), limits.end() - 1,
                       [](double limit) { return std::abs(std::log10(limit) - std::round(std::log10(limit))) > 1e-6; }),
        limits.end() - 1);
  return limits;
}

}  // namespace lodestone
