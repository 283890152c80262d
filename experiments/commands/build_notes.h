// Notes of `build` on a model: repairs, losses, and the cause if it is larger than others.
#pragma once

#include <string>

#include "core/hierarchy/model/kept_vertices.h"
#include "experiments/subjects/build.h"

namespace lodestone {

// Why more triangles are stored than usual, and what to do; empty if nothing that can be named keeps them.
[[nodiscard]] std::string describe(const KeptVertices& kept, double stored_ratio, const Hierarchy& hierarchy);

// "estimated" or "measured", with the meaning of that for the errors of the hierarchy.
[[nodiscard]] const char* nature_of_errors(const Hierarchy& hierarchy);

// "note: ..." lines on standard output. `stored_ratio`: stored triangles over those of the input, if it may say
// something about the model; else 0.
void print_build_notes(const BuildResult& result, double stored_ratio);

}  // namespace lodestone
