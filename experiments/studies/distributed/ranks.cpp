// Experiment `ranks`: the blocks of a real hierarchy dealt out to virtual ranks, level by level, without running them.
//
// Small cells give a model that fits a laptop as many blocks as one of 10^9 triangles has: how evenly blocks can be
// dealt out depends on how many each rank gets.
#include <algorithm>

#include "core/base/error.h"
#include "experiments/studies/distributed/mpi_program.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/run_file.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/build.h"
#include "experiments/subjects/row.h"

namespace lodestone {
namespace ranks_study {

std::vector<ParameterInfo> parameters() {
  return {threads_parameter(),
          cell_triangles_parameter(),
          as_condition(
              {"virtual_ranks", 4096, "", "most ranks to plan for; and a quarter of them, and so on", 2, 1 << 20, {}}),
          {"seed",
           0,
           "",
           "of the triangles by which borders are chosen, drawn at random; 0: evenly over the cells",
           0,
           1e9,
           {}}};
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  return {{"ranks", "", "virtual ones", count},
          {"level", "", "0 is the coarsest", count},
          {"coarser", "", "levels above the finest: 0 at the finest", count},
          {"level_cells", "", "cells of the level", count},
          {"level_blocks", "", "blocks of the level", count},
          {"level_triangles", "", "triangles of the level", count},
          {"busy_ranks", "", "that have a block of the level", count},
          {"most_triangles", "", "of the level, of a rank", count},
          {"level_imbalance", "", "triangles of the level of a rank: maximum over mean of all ranks", cost},
          {"moved_bytes", "bytes", "of the level's cells that another rank makes than the one that needs them", cost},
          {"most_moved", "bytes", "of these that a rank sends or gets", cost},
          {"largest_message", "bytes", "of cells from one rank to another in a round", cost},
          {"move_rounds", "", "in which the cells of the level move", count},
          {"input_triangles", "", "triangles of the finest level", count},
          {"cells", "", "cells of all levels", count},
          {"samples", "", "triangles by which the borders between ranks are chosen", count},
          {"border_vertices", "", "of the finest level, that several ranks use: once for each", count},
          {"most_border_vertices", "", "of these, of a rank", count},
          {"first_rank_bytes", "bytes", "tables at rank 0", cost}};
}

Row row_of(const Json& file, const Json& plan, const Json& level) {
  Row row;
  const double ranks = plan.at("ranks").get<double>(), triangles = level.at("triangles").get<double>();
  row["ranks"] = plan.at("ranks"), row["level"] = level.at("level");
  row["coarser"] = plan.at("levels").size() - 1 - level.at("level").get<std::size_t>();
  for (const char* name : {"cells", "blocks", "triangles"}) row[std::string("level_") + name] = level.at(name);
  for (const char* name : {"busy_ranks", "most_triangles", "moved_bytes", "largest_message"})
    row[name] = level.at(name);
  row["level_imbalance"] = level.at("most_triangles").get<double>() * ranks / std::max(triangles, 1.0);
  row["most_moved"] =
      std::max(level.at("most_sent").get<std::uint64_t>(), level.at("most_received").get<std::uint64_t>());
  row["move_rounds"] = level.at("rounds");
  row["input_triangles"] = file.at("triangles"), row["cells"] = file.at("cells");
  for (const char* name : {"samples", "border_vertices", "most_border_vertices", "first_rank_bytes"})
    row[name] = plan.at(name);
  return row;
}

std::string counts_up_to(int most) {
  std::string list = std::to_string(most);
  for (int ranks = most / 4; ranks >= 2; ranks /= 4) list = std::to_string(ranks) + "," + list;
  return list;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  if (context.input.empty()) throw InputError("the run has no input; name data in its sweep");
  const RunFile file(context);
  BuildJob job;
  job.inputs = {context.input};
  job.output = file.path();
  job.reading = study_reading();
  job.build.cell_triangles = static_cast<std::uint32_t>(parameters.integer("cell_triangles"));
  job.build.cancel = context.cancel;
  (void)lodestone::run(job, *study_scheduler(parameters));
  const Json found =
      run_mpi_program(0,
                      {"plan", file.path().string(), "--ranks", counts_up_to(parameters.integer("virtual_ranks")),
                       "--seed", std::to_string(parameters.integer("seed"))},
                      context);
  std::vector<Row> rows;
  for (const Json& plan : found.at("plans"))
    for (const Json& level : plan.at("levels")) rows.push_back(row_of(found, plan, level));
  return rows;
}

std::vector<std::string> verify(const Parameters&, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.in_order("busy_ranks", "ranks");
  verdict.in_order("busy_ranks", "level_blocks");
  verdict.in_order("most_triangles", "level_triangles");
  verdict.in_order("level_triangles", "input_triangles");
  verdict.in_order("level_cells", "cells");
  verdict.in_order("largest_message", "most_moved");
  verdict.in_order("most_moved", "moved_bytes");
  verdict.in_order("most_border_vertices", "border_vertices");
  for (const Row& row : rows) {
    const auto value = [&](const char* column) { return number_in(row, column).value_or(0); };
    verdict.require(value("ranks") >= 2, "a row has fewer than two ranks");
    verdict.require(value("level_imbalance") >= 1 - 1e-9, "a maximum is below its mean");
    verdict.require(value("most_triangles") * value("busy_ranks") >= value("level_triangles"),
                    "the ranks at work have too few triangles");
    verdict.require(value("coarser") > 0 || value("moved_bytes") == 0, "cells of the finest level move");
    verdict.require(value("first_rank_bytes") > value("cells"), "rank 0 has no tables");
  }
  return std::move(verdict).messages();
}

}  // namespace ranks_study

Experiment ranks_experiment() {
  using namespace ranks_study;
  return {"ranks",   "How evenly can the blocks of a model be dealt out to many ranks, and what moves between them?",
          true,      parameters(),
          columns(), ranks_study::run,
          verify};
}

}  // namespace lodestone
