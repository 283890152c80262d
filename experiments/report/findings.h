// What is to be known about a study before its figures are read: what ran, on what, and what is odd about it.
#pragma once

#include <string>
#include <vector>

#include "experiments/report/aggregate.h"

namespace lodestone {

struct RunCounts {
  std::size_t runs = 0, complete = 0, incomplete = 0, unverified = 0, failed = 0, missing = 0;

  RunCounts& operator+=(const RunCounts& other);
  [[nodiscard]] std::size_t reported() const { return complete + incomplete; }
};
[[nodiscard]] RunCounts count_runs(const SweepRecord& sweep);

// A line of the manifests of all repetitions: one value, a few with how often, or a range.
struct ManifestLine {
  std::string key, text;
  std::size_t values = 0;  // different ones
};
[[nodiscard]] std::vector<ManifestLine> summarize_manifests(const Study& study);

// In words: several machines or programs, sources that were changed, runs that lack repetitions, runs of other settings
// in the folder.
[[nodiscard]] std::vector<std::string> list_oddities(const Study& study);

}  // namespace lodestone
