// The same bytes for any number of threads and any strategy. usage: threads FOLDER
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 2) return std::fputs("usage: threads FOLDER\n", stderr), 2;
  const RawMesh raw = generate_mesh({Shape::terrain, 150'000, 7});
  std::string first;
  for (const int threads : {1, 2, 5})
    for (const Strategy strategy : {Strategy::serial, Strategy::levels, Strategy::graph}) {
      const auto scheduler = make_tbb_scheduler(threads);
      Repairs repairs;
      const Hierarchy model =
          build_hierarchy(prepare_mesh(RawMesh(raw), repairs, *scheduler), {.strategy = strategy}, *scheduler);
      const std::filesystem::path file = std::filesystem::path(argv[1]) / "threads.lode";
      save_lode(model, file, *scheduler);
      std::ifstream in(file, std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(in), {}};
      if (first.empty()) first = bytes;
      std::printf("%d threads, %-6s: %zu bytes, %s\n", threads, std::string(name_of(strategy)).c_str(), bytes.size(),
                  bytes == first ? "the same" : "DIFFERENT");
      if (bytes != first) return 1;
    }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
