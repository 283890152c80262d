// The commit that an executable was built from: "HASH", "HASH dirty" or "unknown".
#pragma once

namespace lodestone {
extern const char commit_text[64];
}  // namespace lodestone
