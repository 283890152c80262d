// An experiment on a small sphere, or a scene of it: what tests of experiments/studies share.
#pragma once

#include <string>
#include <vector>

#include "experiments/studies/experiment.h"
#include "parallel/mesh/generate.h"
#include "tests/test_folder.h"

namespace lodestone {

inline const Row shallow = {{"cell_triangles", 100}};

inline Row with(Row base, const Row& more) {
  base.update(more);
  return base;
}

inline double number(const Row& row, const char* column) { return row.at(column).get<double>(); }

class Studies : public FolderTest {
 protected:
  Studies() {
    sphere_ = (folder_ / "sphere.ply").string();
    generate_ply({Shape::sphere, 3000, 1}, sphere_, *make_serial_scheduler());
    scene_ = test_folder_
                 .write("scene.toml",
                        "[[model]]\nfile = \"sphere.ply\"\nextent = 1\n"
                        "[lighting]\nhead = 0.5\ndirectional = { strength = 1, shadows = true }\n"
                        "[camera]\npath = \"orbit\"\nframes = 4\n")
                 .string();
  }

  [[nodiscard]] std::vector<Row> rows_of(const std::string& name, const Row& given, int repetition = 0) const {
    const Experiment& experiment = find_experiment(name);
    RunContext context;
    context.input = name == "effects" ? scene_ : sphere_;
    context.directory = folder_.string();
    context.repetition = repetition;
    return experiment.run(Parameters(experiment.parameters, given), context);
  }
  [[nodiscard]] static std::vector<std::string> faults(const std::string& name, const Row& given,
                                                       const std::vector<Row>& rows) {
    const Experiment& experiment = find_experiment(name);
    return experiment.verify(Parameters(experiment.parameters, given), rows);
  }

  std::string sphere_, scene_;
};

// All but the one that tries sweeps out.
inline std::vector<Experiment> studies() {
  std::vector<Experiment> list;
  for (const std::string& name : experiment_names())
    if (name != "probe") list.push_back(find_experiment(name));
  return list;
}

inline std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

}  // namespace lodestone
