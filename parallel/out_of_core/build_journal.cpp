#include "parallel/out_of_core/build_journal.h"

#include <algorithm>
#include <system_error>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "parallel/hierarchy/build_blocks.h"

namespace lodestone {
namespace {

constexpr std::uint32_t journal_version = 4;

}  // namespace

std::vector<std::byte> build_identity(const InputIdentity& input, const BuildConfig& build, Lattice lattice,
                                      const std::string& program) {
  ByteWriter out;
  out.put(journal_version);
  out.put(input.content);
  out.put(input.vertices);
  out.put(input.triangles);
  out.put(input.up);
  out.put(build.sigma0);
  out.put(build.finest_level);
  out.put(build.half_levels);
  out.put(build.finest_level < 0 ? build.cell_triangles : 0u);
  out.put(checksum(std::as_bytes(std::span(build.simplifier))));
  out.put(placement_of(build));
  out.put(lattice.bits);
  out.put(checksum(std::as_bytes(std::span(program))));
  return {out.bytes().begin(), out.bytes().end()};
}

std::unique_ptr<Journal> open_build_journal(
    const std::filesystem::path& path, std::span<const std::byte> identity,
    const std::function<void(Journal::Kind, std::span<const std::byte>)>& take) {
  bool begun = false;
  auto journal = std::make_unique<Journal>(path, [&](Journal::Kind kind, std::span<const std::byte> bytes) {
    if (begun) {
      take(kind, bytes);
      return true;
    }
    begun = kind == Journal::Kind::begin && std::ranges::equal(bytes, identity);
    if (!begun)
      throw InputError(describe(path.parent_path().string(), "",
                                "holds an interrupted build of another input, with other parameters or by another "
                                "version of the program",
                                "remove it, or give another --scratch"));
    return true;
  });
  if (!begun) journal->append(Journal::Kind::begin, identity);
  return journal;
}

void create_scratch_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (error)
    throw FileError(describe(folder.string(), "", "cannot create the folder for temporary files: " + error.message(),
                             "create the folder that it is in, or choose one that you may write to (--scratch)"));
}

}  // namespace lodestone
