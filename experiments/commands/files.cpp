#include "experiments/commands/files.h"

#include <filesystem>
#include <system_error>

#include "core/base/error.h"
#include "core/files/atomic_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// Also for names that do not exist yet.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  return fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

// Pipes and devices: not replaced but written to, and not to be opened twice.
bool is_stream(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

void check_output(const FileArgument& output) {
  if (is_stream(output.path)) return;
  AtomicFile probe(output.path);  // never committed: the temporary goes, and what stood under the name stays
  if (!output.extension.empty() && fs::path(output.path).extension() != output.extension)
    throw InputError(describe(output.path, "", output.option + " must name a " + output.extension + " file"));
}

void refuse_same(const FileArgument& a, const FileArgument& b) {
  if (is_stream(a.path) || !same_file(a.path, b.path)) return;
  throw InputError(describe(a.path, "", "is given as " + a.option + " and as " + b.option,
                            "the one would destroy the other; choose two names"));
}

}  // namespace

void check_files(const std::vector<FileArgument>& inputs, const std::vector<FileArgument>& outputs) {
  for (const auto* list : {&inputs, &outputs})
    for (const FileArgument& file : *list)
      if (file.path.empty()) throw InputError(file.option + ": the file name is empty");
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    for (const FileArgument& input : inputs) refuse_same(input, *output);
    for (auto other = outputs.begin(); other != output; ++other) refuse_same(*other, *output);
  }
  for (const FileArgument& output : outputs) check_output(output);
}

}  // namespace lodestone
