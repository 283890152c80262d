// Checks every invariant of a file against the mesh that it was built from. usage: verify MODEL.lode [INPUT.ply]
#include <cstdio>
#include <exception>
#include <optional>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) return std::fputs("usage: verify MODEL.lode [INPUT.ply]\n", stderr), 2;
  const auto scheduler = make_tbb_scheduler();
  const Hierarchy model = load_lode(argv[1], *scheduler);
  std::optional<IndexedMesh> input;
  if (argc == 3) {
    Repairs repairs;
    input = prepare_mesh(load_mesh(argv[2], *scheduler), repairs, *scheduler, argv[2], model.transform.lattice);
  }
  const VerifyReport report = verify_hierarchy(model, input ? &*input : nullptr);
  for (const VerifyCheck& check : report.checks)
    std::printf("%-6s %-13s %s\n", check.passed ? "holds" : "FAILS", check.name.c_str(), check.detail.c_str());
  return report.valid() ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
