#include "experiments/command_line/version.h"

#include "core/base/version.h"

namespace lodestone {
namespace {

ProgramCommit& commit() {
  static ProgramCommit known;
  return known;
}

}  // namespace

std::string_view program_version() { return LODESTONE_VERSION; }

const ProgramCommit& program_commit() { return commit(); }

void set_program_commit(std::string_view text) {
  const std::size_t digits = text.find_first_not_of("0123456789abcdef");
  const std::string_view hash = text.substr(0, digits);
  commit() = {};
  if (hash.size() != 40) return;
  commit().hash = hash;
  commit().dirty = text.substr(hash.size()) == " dirty";
}

}  // namespace lodestone
