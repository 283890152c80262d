#include "experiments/subjects/verify.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"

namespace lodestone {

Json to_json(const VerifyReport& report, const std::string& file, bool measured_errors) {
  Json checks = Json::array();
  for (const VerifyCheck& c : report.checks)
    checks.push_back({{"name", c.name}, {"passed", c.passed}, {"detail", c.detail}});
  return {{"file", file},
          {"valid", report.valid()},
          {"checks", checks},
          {"errors", measured_errors ? "measured" : "estimated"},
          {"sampled_over_error", report.error_ratio}};
}

void print_report(const VerifyReport& report, const std::string& file, bool measured_errors) {
  for (const VerifyCheck& c : report.checks)
    fmt::print("{} {:<28} {}\n", c.passed ? "holds" : "FAILS", c.name, c.detail);
  const auto worst = std::ranges::max_element(report.error_ratio);
  if (!measured_errors && worst != report.error_ratio.end() && *worst > 1)
    fmt::print(
        "note: errors are estimates; on level {} a point is {:.2f} times the level's error away from the other "
        "surface: "
        "build --measure-error makes them bounds\n",
        worst - report.error_ratio.begin(), *worst);
  fmt::print("{}: {}\n", file, report.valid() ? "valid" : "NOT VALID");
}

void require_valid(const VerifyReport& report, const std::string& file) {
  if (!report.valid())
    throw NegativeResult(
        describe(file, "", "the hierarchy does not hold what it promises", "build it again from its input"));
}

}  // namespace lodestone
