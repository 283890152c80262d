// The .lode model file: one hierarchy, little-endian, versioned, checksummed, plain or compressed. A plain one is used
// in place from a memory map. The bytes are described in core/hierarchy/lode/lode_format.h; the parallel twins are in
// parallel/hierarchy/save.h.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// Told by its first bytes, else by the extension .lode, so that a damaged one is not taken for something else.
[[nodiscard]] bool is_lode_file(const std::filesystem::path& path);

// Compressed files are about a sixth as large, cost the build more, and need a hierarchy on a lattice.
enum class LodeForm : std::uint8_t { plain, compressed };

// Writes the hierarchy to a temporary name beside `path`, then renames: the file is complete or absent. Equal
// hierarchies give equal bytes. Throws FileError when the target cannot be written, InputError when a hierarchy without
// a lattice is to be compressed. A compressed file is assembled in memory. Returns the size of the file.
std::uint64_t write_lode(const Hierarchy& hierarchy, const std::filesystem::path& path,
                         LodeForm form = LodeForm::plain);

// Maps the file and checks all of it: sizes, checksums, order of the tables, every index of every payload. Plain
// payloads remain in the map, which `storage` keeps alive; the file must not be shortened while it is in use.
// Compressed ones are decompressed into memory. Throws FileError (missing, unreadable), InputError (not a .lode file,
// truncated, altered), UnsupportedError (newer version, unknown feature), ResourceError (no memory).
[[nodiscard]] Hierarchy open_lode(const std::filesystem::path& path);

}  // namespace lodestone
