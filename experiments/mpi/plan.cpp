#include "experiments/mpi/plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <sstream>

#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/commands/command.h"
#include "parallel/distributed/plan_ranks.h"
#include "parallel/hierarchy/save.h"

namespace lodestone {
namespace {

constexpr int most_ranks = 1 << 20;

struct PlanOptions {
  std::string file, ranks = "2,16,256,4096";
  std::uint64_t seed = 0;
};

// "2,16,256"
std::vector<int> parse_ranks(const std::string& text) {
  std::vector<int> list;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    int ranks = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), ranks);
    if (error != std::errc() || end != word.data() + word.size() || ranks < 1 || ranks > most_ranks)
      throw UsageError(describe("--ranks " + text, "", "'" + word + "' is not a number of ranks from 1 to 2^20",
                                "give some, as 2,16,256"));
    list.push_back(ranks);
  }
  if (list.empty()) throw UsageError("--ranks is empty; give some, as 2,16,256");
  return list;
}

Json to_json(const LevelPlan& level, std::size_t index) {
  return {{"level", index},
          {"cells", level.cells},
          {"blocks", level.blocks},
          {"triangles", level.triangles},
          {"busy_ranks", level.busy_ranks},
          {"most_triangles", level.most_triangles},
          {"moved_cells", level.moved_cells},
          {"moved_bytes", level.moved_bytes},
          {"most_sent", level.most_sent},
          {"most_received", level.most_received},
          {"largest_message", level.largest_message},
          {"rounds", level.rounds}};
}

Json to_json(const RankPlan& plan) {
  Json levels = Json::array();
  for (std::size_t l = 0; l < plan.levels.size(); ++l) levels.push_back(to_json(plan.levels[l], l));
  return {{"ranks", plan.ranks},
          {"imbalance", plan.imbalance},
          {"samples", plan.samples},
          {"moved_bytes", plan.moved_bytes()},
          {"border_vertices", plan.border_vertices},
          {"most_border_vertices", plan.most_border_vertices},
          {"first_rank_bytes", plan.first_rank_bytes},
          {"levels", levels}};
}

void print(const RankPlan& plan) {
  const auto triangles = static_cast<double>(plan.levels.back().triangles);
  fmt::print(
      "{} ranks: imbalance {:.3f}, {:.2f} bytes of cells per triangle, {} vertices between ranks, {:.1f} MB of "
      "tables at rank 0\n",
      plan.ranks, plan.imbalance, static_cast<double>(plan.moved_bytes()) / triangles, plan.border_vertices,
      static_cast<double>(plan.first_rank_bytes) * 1e-6);
  fmt::print("{:>7} {:>10} {:>12} {:>10} {:>14} {:>12} {:>14} {:>14}\n", "level", "cells", "triangles", "ranks",
             "most triangles", "moved cells", "moved bytes", "largest message");
  for (std::size_t l = 0; l < plan.levels.size(); ++l) {
    const LevelPlan& level = plan.levels[l];
    fmt::print("{:>7} {:>10} {:>12} {:>10} {:>14} {:>12} {:>14} {:>14}\n", l, level.cells, level.triangles,
               level.busy_ranks, level.most_triangles, level.moved_cells, level.moved_bytes, level.largest_message);
  }
}

void run(const PlanOptions& options, const CommonOptions& common) {
  check_files(common, {{"FILE", options.file}});
  const std::vector<int> ranks = parse_ranks(options.ranks);
  const Hierarchy hierarchy = load_lode(options.file, *make_scheduler(common));
  Json plans = Json::array();
  for (const int count : ranks) {
    const RankPlan plan = plan_ranks(hierarchy, {.ranks = count, .seed = options.seed});
    plans.push_back(to_json(plan));
    if (common.prints()) print(plan);
  }
  write_result(common, {{"file", options.file},
                        {"triangles", hierarchy.levels.back().triangles},
                        {"cells", hierarchy.cells.size()},
                        {"plans", plans}});
}

OptionTable declare(PlanOptions& o) {
  return {OptionSpec{"FILE", &o.file, "Hierarchy (.lode) without attributes"}.must(),
          OptionSpec{"--ranks", &o.ranks, "Numbers of ranks to plan for"}.of_type("R,R,..."),
          {"--seed", &o.seed,
           "Draw the triangles that choose the ranks' borders at random, as from an input without order; 0: evenly"}};
}

}  // namespace

void add_plan(CommandTable& commands, bool works) {
  struct Both {
    PlanOptions own;
    CommonOptions common;
  };
  const auto both = std::make_shared<Both>();
  CommandInfo info{"plan", "Say how the build of a file would spread over many ranks, without running them",
                   "  lodestone-mpi plan statue.lode --ranks 2,16,256,4096 --json plan.json\n"
                   "  lodestone-mpi plan statue.lode --ranks 64 --seed 1\n"};
  add_command(commands, info, both->common, declare(both->own), [both, works] {
    if (works) run(both->own, both->common);
  });
}

}  // namespace lodestone
