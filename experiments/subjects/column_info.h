// Rows of results and the columns that they have: what a sweep stores and what a command prints as JSON, under the same
// names and in the same units.
#pragma once

#include <string>
#include <vector>

#include "core/files/json.h"

namespace lodestone {

// name -> number, text, truth value or null (not measured in this row). A flat object.
using Row = Json;

// A condition on the setting for a column to be measured: one of these must hold.
struct ColumnNeed {
  struct Condition {
    std::string parameter;
    Json value;
    bool is = true;  // false: any other value
  };
  std::vector<Condition> any;
};

struct ColumnInfo {
  // Less is better for accuracy, more is better for quality (PSNR, SSIM).
  enum class Kind { label, accuracy, quality, cost, count };

  std::string name;
  std::string unit;     // "s", "% of the diagonal", "pixels", ...; empty: none
  std::string meaning;  // for the report and docs/schema.md
  Kind kind = Kind::count;
  std::vector<ColumnNeed> needs{};  // all of them; empty: every setting has it
};

}  // namespace lodestone
