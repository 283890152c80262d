// Experiment `distributed`: what building by several processes brings, and what they send to each other.
//
// Each round has the job, and one rank of as many threads as all of its ranks have together: the same processors
// without messages. The two take turns, and their files have to be the same.
#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/error.h"
#include "experiments/metrics/cost/order_statistics.h"
#include "experiments/studies/distributed/mpi_program.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/run_file.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/result_hash.h"
#include "experiments/subjects/row.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "parallel/scheduler/processors.h"

namespace lodestone {
namespace distributed_study {

const std::vector<std::pair<std::string, std::string>> stages{
    {"clean", "reading and cleaning"},
    {"route", "sending triangles to the ranks of their cells"},
    {"finest", "making the finest cells"},
    {"levels", "making the coarser levels"},
    {"write", "making the tables and writing the file"}};

std::vector<ParameterInfo> parameters() {
  return {as_condition({"ranks", 2, "", "processes that build together", 1, 4096, {}}),
          as_condition({"rank_threads", 1, "", "threads of each; processors are not bound to ranks", 1, 4096, {}}),
          rounds_parameter(3), cell_triangles_parameter()};
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  const std::vector<ColumnNeed> several{ColumnNeed{{{"ranks", 1, false}}}};
  std::vector<ColumnInfo> list{
      {"processors", "", "that the job may run on: fewer than threads where these take turns", count},
      {"input_triangles", "", "triangles of the input", count},
      {"cells", "", "cells of the hierarchy", count},
      {"levels", "", "levels of the hierarchy", count},
      {"file_bytes", "bytes", "size of the file", cost},
      {"mtri_per_second", "million/s", "input triangles over seconds", cost},
      {"one_seconds", "s",
       "wall of one rank with as many threads as all ranks have, or as there are processors, median", cost, several},
      {"over_one", "", "rate over that of the one rank", cost, several},
      {"imbalance_triangles", "", "finest triangles of a rank: maximum over mean", cost},
      {"imbalance_cpu", "", "processor time of a rank: maximum over mean", cost},
      {"imbalance_memory", "", "largest resident set of a rank: maximum over mean", cost},
      {"bytes_per_triangle", "bytes", "sent by all ranks, over the triangles of the input", cost},
      {"rounds_of_messages", "", "calls that all ranks make together", count},
      {"first_peak_bytes", "bytes", "largest resident set of rank 0, which makes the tables", cost},
      {"peak_bytes", "bytes", "largest resident set of any other rank", cost, several},
      {"first_write_bytes", "bytes", "that rank 0 receives in the stage `write`", cost},
      {"first_write_cpu_seconds", "s", "processor time of rank 0 in the stage `write`", cost},
      {"hash", "", "of the file's cells and payloads", label},
      {"same", "", "the file is that of one rank, in all rounds", label}};
  for (const auto& [stage, what] : stages)
    append(list, {{stage + "_seconds", "s", what + ": wall of the slowest rank", cost},
                  {stage + "_cpu_seconds", "s", what + ": processor time of all ranks", cost},
                  {stage + "_bytes", "bytes", what + ": sent by all ranks", cost},
                  {stage + "_messages", "", what + ": messages sent by all ranks", count},
                  {stage + "_rounds", "", what + ": calls that all ranks make together", count}});
  add_spread_columns(list, "seconds", "s", "wall, from the input file to the end of the output");
  add_spread_columns(list, "cpu_seconds", "s", "processor time of all ranks");
  return list;
}

// Reports of several jobs of one kind, and hashes of their files.
class Reports {
 public:
  void add(Json report, std::uint64_t hash) { reports_.push_back(std::move(report)), hashes_.push_back(hash); }
  [[nodiscard]] const Json& first() const { return reports_.front(); }
  [[nodiscard]] const std::vector<std::uint64_t>& hashes() const { return hashes_; }

  using Of = std::function<double(const Json&)>;
  [[nodiscard]] std::vector<double> values(const Of& of) const {
    std::vector<double> list;
    for (const Json& report : reports_) list.push_back(of(report));
    return list;
  }
  [[nodiscard]] double median(const Of& of) const { return median_of(values(of)); }

 private:
  std::vector<Json> reports_;
  std::vector<std::uint64_t> hashes_;
};

double number(const Json& json, const char* name) { return json.at(name).get<double>(); }

double sum_of_ranks(const Json& report, const Reports::Of& of) {
  double sum = 0;
  for (const Json& rank : report.at("ranks")) sum += of(rank);
  return sum;
}

double most_of_ranks(const Json& report, std::size_t first, const Reports::Of& of) {
  double most = 0;
  for (std::size_t r = first; r < report.at("ranks").size(); ++r) most = std::max(most, of(report.at("ranks")[r]));
  return most;
}

// Jobs of some ranks on an input.
class Jobs {
 public:
  Jobs(const Parameters& parameters, const RunContext& context)
      : parameters_(parameters), context_(context), scheduler_(make_tbb_scheduler(0)) {}

  void run(int ranks, int threads, Reports& reports) const {
    const RunFile file(context_);
    Json report = run_mpi_program(
        ranks,
        {"build", context_.input, "-o", file.path().string(), "--no-attributes", "--threads", std::to_string(threads),
         "--cell-triangles", std::to_string(parameters_.integer("cell_triangles"))},
        context_);
    reports.add(std::move(report), hash_of(load_lode(file.path(), *scheduler_)));
  }

 private:
  const Parameters& parameters_;
  const RunContext& context_;
  std::unique_ptr<Scheduler> scheduler_;
};

void add_stages(Row& row, const Reports& job) {
  for (const auto& [stage, what] : stages) {
    const auto of_stage = [&stage = stage](const char* name) {
      return [&stage, name](const Json& rank) { return number(rank.at("stages").at(stage), name); };
    };
    row[stage + "_seconds"] = job.median([&](const Json& r) { return most_of_ranks(r, 0, of_stage("seconds")); });
    row[stage + "_cpu_seconds"] = job.median([&](const Json& r) { return sum_of_ranks(r, of_stage("cpu_seconds")); });
    row[stage + "_bytes"] = sum_of_ranks(job.first(), of_stage("bytes_sent"));
    row[stage + "_messages"] = sum_of_ranks(job.first(), of_stage("messages_sent"));
    row[stage + "_rounds"] = most_of_ranks(job.first(), 0, of_stage("rounds"));
  }
  row["first_write_bytes"] = number(job.first().at("ranks")[0].at("stages").at("write"), "bytes_received");
  row["first_write_cpu_seconds"] =
      job.median([](const Json& r) { return number(r.at("ranks")[0].at("stages").at("write"), "cpu_seconds"); });
}

void add_memory(Row& row, const Reports& job, bool several) {
  const auto peak = [](const Json& rank) { return number(rank, "peak_bytes"); };
  row["first_peak_bytes"] = job.median([&](const Json& r) { return peak(r.at("ranks")[0]); });
  row["peak_bytes"] = several ? Row(job.median([&](const Json& r) { return most_of_ranks(r, 1, peak); })) : Row();
}

void add_imbalance(Row& row, const Reports& job) {
  for (const auto& [column, name] : {std::pair("imbalance_triangles", "triangles"),
                                     {"imbalance_cpu", "cpu_seconds"},
                                     {"imbalance_memory", "memory"}})
    row[column] = job.median([name = name](const Json& r) { return number(r.at("imbalance"), name); });
}

Row row_of(const Reports& job, const Reports& one, bool several) {
  Row row;
  const Json& first = job.first();
  for (const char* name : {"input_triangles", "cells", "levels", "file_bytes"}) row[name] = first.at(name);
  const auto wall = [](const Json& r) { return number(r, "seconds"); };
  const auto processor = [](const Json& r) {
    return sum_of_ranks(r, [](const Json& rank) { return number(rank, "cpu_seconds"); });
  };
  add_spread(row, "seconds", job.values(wall));
  add_spread(row, "cpu_seconds", job.values(processor));
  const double triangles = number(first, "input_triangles");
  row["processors"] = allowed_processors().size();
  row["mtri_per_second"] = 1e-6 * triangles / job.median(wall);
  row["one_seconds"] = several ? Row(one.median(wall)) : Row();
  row["over_one"] = several ? Row(one.median(wall) / job.median(wall)) : Row();
  row["bytes_per_triangle"] = number(first, "bytes_sent") / triangles;
  row["rounds_of_messages"] = first.at("rounds");
  add_imbalance(row, job);
  add_memory(row, job, several);
  add_stages(row, job);
  row["hash"] = to_hex(job.hashes().front());
  const std::uint64_t expected = one.hashes().front();
  row["same"] = std::ranges::all_of(job.hashes(), [&](std::uint64_t hash) { return hash == expected; });
  return row;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  if (context.input.empty()) throw InputError("the run has no input; name data in its sweep");
  const int ranks = parameters.integer("ranks"), threads = parameters.integer("rank_threads");
  const int rounds = parameters.integer("rounds");
  const auto processors = static_cast<int>(allowed_processors().size());
  const Jobs jobs(parameters, context);
  Reports job, one, first;
  jobs.run(1, std::min(ranks * threads, processors), first);  // warms up
  for (int round = 0; round < rounds; ++round) {
    jobs.run(ranks, threads, job);
    if (ranks > 1) jobs.run(1, std::min(ranks * threads, processors), one);
    context.progress(static_cast<double>(round + 1) / (rounds + 1));
  }
  return {row_of(job, ranks > 1 ? one : first, ranks > 1)};
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.present("hash");
  verdict.is_true("same");
  const double ranks = parameters.integer("ranks");
  for (const Row& row : rows) {
    const auto value = [&](const std::string& column) { return number_in(row, column).value_or(0); };
    double bytes = 0;
    for (const auto& [stage, what] : stages) bytes += value(stage + "_bytes");
    verdict.require(std::abs(value("bytes_per_triangle") * value("input_triangles") - bytes) <= 1e-6 * bytes,
                    "the bytes of the stages are not those of all");
    verdict.require((bytes > 0) == (ranks > 1), "one rank alone sends, or several do not");
    for (const char* column : {"imbalance_triangles", "imbalance_cpu", "imbalance_memory"})
      verdict.require(value(column) >= 1 - 1e-9 && value(column) <= ranks + 1e-9,
                      std::string(column) + " is not between 1 and the number of ranks");
    verdict.require(value("first_peak_bytes") > 0, "rank 0 takes no memory");
    verdict.require(ranks == 1 || std::abs(value("one_seconds") - value("over_one") * value("seconds")) <=
                                      1e-6 * value("one_seconds"),
                    "over_one does not follow from the seconds");
  }
  return std::move(verdict).messages();
}

}  // namespace distributed_study

Experiment distributed_experiment() {
  using namespace distributed_study;
  return {"distributed", "What do several processes bring to building, and what do they send to each other?",
          true,          parameters(),
          columns(),     distributed_study::run,
          verify};
}

}  // namespace lodestone
