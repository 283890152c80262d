// A build on a thread of its own, with its progress, ended after some milliseconds. usage: cancel MILLISECONDS
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
  std::atomic<double> share{0};
  std::thread worker([&] {
    try {
      const auto scheduler = make_tbb_scheduler();
      Repairs repairs;
      IndexedMesh mesh = prepare_mesh(generate_mesh({Shape::sphere, 2'000'000, 1}), repairs, *scheduler);
      BuildConfig config;
      config.cancel = &cancel;
      config.progress = [&](double now) { share = now; };  // from any thread, one at a time
      const Hierarchy model = build_hierarchy(std::move(mesh), config, *scheduler);
      std::printf("built: %d levels\n", model.finest() + 1);
    } catch (const Cancelled& cancelled) {
      std::printf("%s at %.0f %%\n", cancelled.what(), 100 * share);
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(argv[1])));
  cancel = true;
  worker.join();
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
