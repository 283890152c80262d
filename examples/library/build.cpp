// From any mesh file to a .lode file, in at most 256 MiB of memory. usage: build IN.ply OUT.lode
#include <cstdio>
#include <exception>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: build IN.ply OUT.lode\n", stderr), 2;
  const auto scheduler = make_tbb_scheduler();
  ModelConfig config;
  config.output = argv[2];
  config.form = LodeForm::compressed;
  config.lattice = {Lattice::automatic};  // which a compressed file needs
  config.memory_limit = std::uint64_t{256} << 20;
  config.progress = [](const ModelProgress& now) {
    std::fprintf(stderr, "\r%-20s %3.0f %%", now.step.c_str(), 100 * now.share);
  };
  const ModelSource source = open_model_source({argv[1]}, {}, config.memory_limit, scheduler->workers());
  const bool on_disk = source.stream != nullptr;
  const ModelResult result = build_model(source, config, *scheduler);
  std::printf("\n%llu triangles, %d levels, built %s\n",
              static_cast<unsigned long long>(result.hierarchy.provenance.input_triangles),
              result.hierarchy.finest() + 1, on_disk ? "on disk" : "in memory");
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
