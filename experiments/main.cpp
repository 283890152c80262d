// The `lodestone` command: build, look into, prove and draw hierarchical levels of detail.
#include "experiments/commands/program.h"
#include "experiments/commit.h"

int main(int argc, char** argv) { return lodestone::run_program(argc, argv, lodestone::commit_text); }
