// The journal of a build: one that was interrupted is continued by the same build alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/hierarchy/build.h"
#include "parallel/out_of_core/journal.h"

namespace lodestone {

struct InputIdentity {
  std::uint64_t content = 0;  // as MeshStream::identity
  std::uint64_t vertices = 0, triangles = 0;
  Up up{};
};

// Equal for builds that come to the same cells. Form and order of cells are a matter of the very last step. `program`:
// its version.
[[nodiscard]] std::vector<std::byte> build_identity(const InputIdentity& input, const BuildConfig& build,
                                                    Lattice lattice, const std::string& program);

// Opens or creates the journal and calls take for what it has of the build. Throws InputError where it is that of
// another one, and what Journal throws.
[[nodiscard]] std::unique_ptr<Journal> open_build_journal(
    const std::filesystem::path& path, std::span<const std::byte> identity,
    const std::function<void(Journal::Kind, std::span<const std::byte>)>& take);

// Creates the folder for files with names, unless it is there.
void create_scratch_folder(const std::filesystem::path& folder);

}  // namespace lodestone
