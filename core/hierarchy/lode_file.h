// The .lode model file: one hierarchy, little-endian, versioned, checksummed, used in place from a memory map. The
// bytes are described in core/hierarchy/lode_format.h; the parallel twins are in parallel/save.h.
#pragma once

#include <filesystem>

#include "core/hierarchy/hierarchy.h"

namespace lodestone {

// Writes the hierarchy to a temporary name beside `path`, then renames: there is a whole file or none. Equal
// hierarchies give equal bytes. Throws FileError when the target cannot be written.
void write_lode(const Hierarchy& hierarchy, const std::filesystem::path& path);

// Maps the file and checks all of it: sizes, checksums, order of the tables, every index of every payload. The payloads
// stay in the map, which `storage` keeps alive; the file must not be shortened while it is in use.
// Throws FileError (missing, unreadable), InputError (foreign, truncated, altered), UnsupportedError (newer version).
[[nodiscard]] Hierarchy open_lode(const std::filesystem::path& path);

}  // namespace lodestone
