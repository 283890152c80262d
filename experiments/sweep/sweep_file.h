// A sweep file (docs/experiments.md): data, sweeps of one experiment each, figures. Read strictly: what is
// unknown or contradicts itself is an InputError that names the file and the line.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/json.h"
#include "core/mesh/generate.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/parameter_files.h"

namespace lodestone {

// Source of an input: a file or folder, or a generator.
struct DataSource {
  std::string name;
  std::string place;              // "line 7", for messages
  std::string path;               // relative ones are relative to the sweep file; empty: generated
  std::string sha256;             // that the file must have; empty: any
  std::vector<std::string> with;  // files that are read with it, as a mesh's textures; those of scenes are known
  std::string shape;              // as the file has it
  std::optional<GenerateConfig> generate;
};

struct SweepSection {
  std::string name;
  const Experiment* experiment = nullptr;
  std::vector<std::string> data;  // names; empty for an experiment that takes none
  int repetitions = 1;
  std::vector<Json> settings;        // what each run sets, as an object; no two alike
  std::vector<std::string> metrics;  // columns that the tables of the report show; empty: all
};

// The sizes that a sweep file is run with: its own, or those with the overrides of that name.
enum class SweepForm : std::uint8_t { small, standard, full };
[[nodiscard]] std::string_view name_of(SweepForm form);

// As the decision has it; `sweep` and `y` are never empty, other texts may be.
struct FigureSpec {
  std::string title, x, kind = "line", log, mark;
  std::vector<std::string> sweep, y, series;
  bool pareto = false;
  std::map<std::string, Json> where;  // a value, or a comparison as "<= 0.5", by name
};

struct SweepFile {
  std::string file;
  std::string name, title, question;
  SweepForm form = SweepForm::standard;
  std::vector<DataSource> data;  // all, whether a sweep uses them or not
  std::vector<SweepSection> sweeps;
  ParameterFiles files;  // that settings name
  std::vector<FigureSpec> figures;
  std::vector<std::string> notes;  // not errors, but to be known before hours have gone
};

using ExperimentLookup = std::function<const Experiment&(const std::string&)>;

// The overrides of the form apply; those of the other one are checked as well. Throws FileError when the file cannot be
// read, InputError for whatever is wrong in it.
[[nodiscard]] SweepFile load_sweep_file(const std::string& file, SweepForm form,
                                        const ExperimentLookup& lookup = find_experiment);

// Leaves out the other sweeps, with the figures that need them. Throws InputError for a name that no sweep has.
void keep_sweeps(SweepFile& file, const std::vector<std::string>& names);

}  // namespace lodestone
