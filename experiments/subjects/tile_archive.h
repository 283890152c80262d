// A folder as a 3D Tiles archive (.3tz, Maxar-Public/3tz-specification 1.3): a ZIP of stored files whose last entry is
// an index, the MD5 of each path with the offset of its file. A server that gives parts of files streams it.
//
// Written here and not by a library: the index holds the offsets of files, which libzip and minizip do not tell while
// they write.
#pragma once

#include <cstdint>
#include <filesystem>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Packs all files below the folder, sorted by path; the same bytes for the same files. Returns the bytes written.
// Throws FileError for a file that cannot be read or written, ResourceError for a file of 4 GiB, which the format
// cannot hold, UnsupportedError where OpenSSL refuses MD5, Cancelled.
std::uint64_t write_tile_archive(const std::filesystem::path& folder, const std::filesystem::path& target,
                                 const CancelFlag& cancel);

}  // namespace lodestone
