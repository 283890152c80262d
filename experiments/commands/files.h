// The file names of a command line, looked at before any work: a typing error costs a line, not a night or a model.
#pragma once

#include <string>
#include <vector>

namespace lodestone {

struct FileArgument {
  std::string option;          // as the user knows it: "IN", "--output"
  std::string path;            // empty: given as an empty word
  std::string extension = {};  // that an output must have, with its dot; empty: any
};

// Throws InputError when a name is empty or has another extension than asked for, when an output would replace an input
// or another output; FileError when an output cannot be created. Leaves no trace in any folder. Inputs are not opened.
// Pipes and devices may be outputs under any name.
void check_files(const std::vector<FileArgument>& inputs, const std::vector<FileArgument>& outputs);

}  // namespace lodestone
