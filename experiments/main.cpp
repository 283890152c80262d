// The `lodestone` command: build, look into, prove and draw hierarchical levels of detail.
#include "experiments/commit.h"
#include "experiments/program.h"

int main(int argc, char** argv) { return lodestone::run_program(argc, argv, lodestone::commit_text); }
