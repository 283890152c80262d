// Figures drawn as SVG, by Python and matplotlib (plot.py, which is part of the program).
#pragma once

#include <string>
#include <vector>

#include "experiments/report/figure.h"

namespace lodestone {

// To be put into a page whose style sheet has the variables that the script names.
struct Plot {
  std::string wide, narrow;  // for windows of 640 pixels and more, and less
};

struct Plots {
  std::vector<Plot> plots;  // one per figure, or none at all
  std::string note;         // why there is none, and what to do about it
};

// Asks $LODESTONE_PYTHON, or else python3 of the path and of the system, whichever has matplotlib. Where none has, or
// drawing fails, a note says so: a report without plots is worth having. Throws FileError when there is no room for
// temporary files; these have no name and end with the process.
[[nodiscard]] Plots draw_plots(const std::vector<Figure>& figures);

}  // namespace lodestone
