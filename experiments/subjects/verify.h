// A report of verify, for a user.
#pragma once

#include <string>

#include "core/files/json.h"
#include "core/hierarchy/verify/verify.h"

namespace lodestone {

[[nodiscard]] Json to_json(const VerifyReport& report, const std::string& file, bool measured_errors);
// The checks, a line each, by how much estimated errors are too small, and the verdict.
void print_report(const VerifyReport& report, const std::string& file, bool measured_errors);
// Throws NegativeResult if a check has failed.
void require_valid(const VerifyReport& report, const std::string& file);

}  // namespace lodestone
