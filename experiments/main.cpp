// The `lodestone` command: build, look into, prove and draw hierarchical levels of detail.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>

#include "core/base/error.h"
#include "experiments/commands/command.h"
#include "experiments/version.h"

int main(int argc, char** argv) {
  using namespace lodestone;
  CLI::App app{"Lodestone: level of detail of large triangle surfaces, without cracks or pops"};
  app.set_version_flag("--version", std::string(program_version()));
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& e) {
    return std::string("lodestone: ") + e.what() + "; see lodestone --help\n";
  });
  add_generate(app);
  add_build(app);
  add_info(app);
  add_verify(app);
  add_compare(app);
  add_render(app);
  add_export(app);
  install_interrupt_handler();
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const Cancelled&) {
    fmt::print(stderr, "lodestone: interrupted; no output file was left\n");
    return 130;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "lodestone: out of memory; close other programs or use a smaller input\n");
  } catch (const std::exception& e) {
    fmt::print(stderr, "lodestone: {}\n", e.what());
  }
  return 1;
}
