// lodestone verify: proves the invariants of a .lode file, independently of the builder.
#include "experiments/subjects/verify.h"

#include <optional>

#include "core/base/error.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/joined_stream.h"
#include "parallel/mesh/load.h"
#include "render/lod/verify_radii.h"

namespace lodestone {
namespace {

struct VerifyOptions {
  std::string file;
  std::vector<std::string> inputs;
  InputOptions reading;
};

// On the lattice of the file. Both arguments may be .lode files by mistake, or even the same one: the message says
// which of them was meant.
IndexedMesh read_input(const std::vector<std::string>& inputs, const ReadConfig& reading, Scheduler& scheduler,
                       Lattice lattice) {
  try {
    Repairs repairs;
    const std::vector<std::filesystem::path> files(inputs.begin(), inputs.end());
    return prepare_mesh(load_meshes(files, scheduler, reading), repairs, scheduler, name_of_files(files), lattice);
  } catch (const UnsupportedError& error) {
    throw UnsupportedError(std::string("--input ") + error.what());
  }
}

void run(const VerifyOptions& options, const CommonOptions& common) {
  const auto& [file, meshes, input_options] = options;
  std::vector<FileArgument> inputs{{"FILE", file}};
  for (const std::string& input : meshes) inputs.push_back({"--input", input});
  check_files(common, inputs);
  ReadConfig reading = read_config(input_options, meshes);
  Progress progress("reading", common.quiet);
  progress.phase("reading");
  const auto scheduler = make_scheduler(common);
  const Hierarchy hierarchy = load_lode(file, *scheduler);
  reading.up = hierarchy.transform.up.axis;  // whatever the files say: it is not compared
  std::optional<IndexedMesh> mesh;
  if (!meshes.empty()) mesh = read_input(meshes, reading, *scheduler, hierarchy.transform.lattice);
  progress.phase("verifying");
  const VerifyReport report =
      verify_with_radii(hierarchy, *scheduler, mesh ? &*mesh : nullptr, [&](double share) { progress.update(share); });
  progress.clear();
  const bool measured = hierarchy.provenance.measured_errors;
  write_result(common, to_json(report, file, measured));
  if (common.prints()) print_report(report, file, measured);
  require_valid(report, file);
}

OptionTable declare(VerifyOptions& o) {
  return with_input_options({OptionSpec{"FILE", &o.file, "Hierarchy (.lode)"}.must(),
                             {"--input", &o.inputs,
                              "Mesh it was built from: compare the finest level with it triangle by triangle; once for "
                              "each of several files"}},
                            o.reading);
}

}  // namespace

void add_verify(CommandTable& commands) {
  define_command<VerifyOptions>(commands,
                                {"verify", "Check every invariant of a hierarchy, independently of the builder",
                                 "  lodestone verify scan.lode\n"
                                 "  lodestone verify scan.lode --input scan.ply --json verify.json\n"},
                                declare, run);
}

}  // namespace lodestone
