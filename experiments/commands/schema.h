// The names that results have: the keys of every command's JSON and the columns of every experiment, for
// docs/schema.md.
#pragma once

#include <string>

namespace lodestone {

// As Markdown. A key `a.b` is b in the object a, `a[]` every element of the list a, and `*` stands for names that
// depend on the run.
[[nodiscard]] std::string schema_text();

}  // namespace lodestone
