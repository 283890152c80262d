// Work on a thread of its own, with its progress, ended after some milliseconds. usage: cancel MILLISECONDS
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>

#include "lodestone/lodestone.h"

using namespace lodestone;

int main(int argc, char** argv) try {
  if (argc != 2) return std::fputs("usage: cancel MILLISECONDS\n", stderr), 2;
  CancelFlag cancel{false};
  std::thread worker([&] {
    std::size_t steps = 0;
    try {
      const auto inner = make_tbb_scheduler();
      // Whatever takes a scheduler can be watched by one: here cleaning and building, as well as reading and writing.
      const auto scheduler =
          make_watched_scheduler(*inner, {.cancel = &cancel, .progress = [&](const std::string&, double) { ++steps; }});
      Repairs repairs;
      IndexedMesh mesh = prepare_mesh(generate_mesh({Shape::sphere, 2'000'000, 1}), repairs, *scheduler);
      const Hierarchy model = build_hierarchy(std::move(mesh), {}, *scheduler);
      std::printf("built: %d levels\n", model.finest() + 1);
    } catch (const Cancelled& cancelled) {
      std::printf("%s after %zu steps\n", cancelled.what(), steps);
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(argv[1])));
  cancel = true;
  worker.join();
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
