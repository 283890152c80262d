// lodestone-mpi build: one .lode file by all processes of an MPI job (docs/cluster.md).
#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "core/base/error.h"
#include "experiments/command_line/version.h"
#include "experiments/commands/input.h"
#include "experiments/large_memory.h"
#include "experiments/metrics/cost/cost.h"
#include "experiments/mpi/job.h"
#include "experiments/mpi/rank_trace.h"
#include "experiments/subjects/build.h"
#include "parallel/distributed/building/build_distributed.h"
#include "parallel/distributed/generated_stream.h"

namespace lodestone {
namespace {

struct JobOptions {
  std::vector<std::string> inputs;
  std::string generator, output, scratch, trace;
  InputOptions reading;
  Bytes memory_limit;
  float sigma0 = BuildConfig{}.sigma0;
  std::uint32_t cell_triangles = BuildConfig{}.cell_triangles;
  std::optional<int> levels, lattice_bits;
  std::string simplifier = BuildConfig{}.simplifier;
  std::optional<std::string> placement;
  bool half_levels = false, texture_levels = false, no_attributes = false, resume = false;
  double timeout = 600;
};

// The processes of the job, as rank 0 reports them.
struct JobReport {
  DistributedResult result;
  std::vector<std::uint64_t> peak_bytes;  // by rank
  std::vector<std::string> hosts;
  StageTime time;  // of rank 0: all wait for each other
  int threads = 0;
};

DistributedConfig config_of(const JobOptions& options) {
  DistributedConfig config;
  config.build.sigma0 = options.sigma0;
  config.build.cell_triangles = options.cell_triangles;
  config.build.finest_level = options.levels.value_or(-1);
  config.build.half_levels = options.half_levels;
  config.build.simplifier = options.simplifier;
  if (options.placement) config.build.placement = placement_named(*options.placement);
  config.output = options.output;
  config.texture_copies = options.texture_levels;
  config.lattice = {options.lattice_bits.value_or(0)};
  config.limit = {.bytes = options.memory_limit.count, .scratch = options.scratch, .resume = options.resume};
  config.program = std::string(program_version());
  return config;
}

RankInput open_input(const JobOptions& options, Ranks& ranks, Scheduler& scheduler) {
  if (!options.generator.empty())
    return shared_out(generated_stream(parse_generator(options.generator)), ranks.count());
  ReadConfig reading = read_config(options.reading, options.inputs);
  reading.attributes = !options.no_attributes;
  const std::vector<std::filesystem::path> files(options.inputs.begin(), options.inputs.end());
  return open_rank_input(files, reading, ranks, scheduler);
}

void check_outputs(const JobOptions& options, const CommonOptions& common) {
  std::vector<FileArgument> outputs{{"--output", options.output, ".lode"}};
  if (!options.trace.empty()) outputs.push_back({"--trace", options.trace});
  check_files(common, file_arguments("IN", options.inputs), outputs);
}

JobReport run_job(const JobOptions& options, const CommonOptions& common, Transport& transport) {
  if (options.resume && transport.rank() == 0)
    set_interrupt_line("lodestone-mpi: interrupted; --resume continues from the temporary files that were kept\n");
  if (transport.rank() == 0) check_outputs(options, common);
  Ranks ranks(transport);
  std::unique_ptr<Scheduler> scheduler = make_scheduler(common);
  RankTrace trace(options.trace, ranks, scheduler);
  DistributedConfig config = config_of(options);
  Progress progress = job_progress("reading", common, transport.rank());
  config.on_stage = [&](const std::string& stage) {
    trace.begin_stage(stage);
    if (config.limit.bytes > 0) return_free_memory();
  };
  ranks.show([&](const std::string& work, double share) {
    if (share == 0)
      progress.phase(work);
    else
      progress.update(share);
  });
  JobReport report;
  config.last_words = [&] {
    trace.gather();
    report.peak_bytes = ranks.gather(peak_resident_bytes());
    report.hosts = hosts_of(ranks);
  };
  const CpuClock clock;
  report.result = build_distributed([&](Ranks& all, Scheduler& workers) { return open_input(options, all, workers); },
                                    config, ranks, *scheduler);
  report.time = clock.elapsed();
  report.peak_bytes[static_cast<std::size_t>(transport.rank())] = peak_resident_bytes();
  report.threads = scheduler->workers();
  if (transport.rank() == 0) trace.write();
  return report;
}

// Maximum over mean.
double imbalance(const std::vector<double>& values) {
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return sum > 0 ? std::ranges::max(values) * static_cast<double>(values.size()) / sum : 1;
}
template <class Of>
double imbalance_of(const std::vector<RankReport>& ranks, const Of& of) {
  std::vector<double> values;
  for (const RankReport& rank : ranks) values.push_back(static_cast<double>(of(rank)));
  return imbalance(values);
}

Json to_json(const RankStage& stage) {
  Json json = to_json(stage.time);
  json.update({{"bytes_sent", stage.traffic.bytes_sent},
               {"bytes_received", stage.traffic.bytes_received},
               {"messages_sent", stage.traffic.messages_sent},
               {"rounds", stage.traffic.rounds},
               {"waited_seconds", stage.traffic.waited_seconds}});
  return json;
}

Json rank_json(const JobReport& report, std::size_t rank) {
  const RankReport& of = report.result.ranks[rank];
  Json stages;
  for (std::size_t s = 0; s < of.stages.size(); ++s) stages[distributed_stages[s]] = to_json(of.stages[s]);
  Json json = to_json(of.total());
  json.update({{"rank", rank},
               {"host", report.hosts[rank]},
               {"triangles", of.triangles},
               {"cells", of.cells},
               {"blocks_resumed", of.blocks_resumed},
               {"peak_bytes", report.peak_bytes[rank]},
               {"stages", stages}});
  return json;
}

std::uint64_t bytes_sent(const JobReport& report) {
  std::uint64_t sum = 0;
  for (const RankReport& rank : report.result.ranks) sum += rank.total().traffic.bytes_sent;
  return sum;
}

// The part of the ranks' time in which they waited for messages.
double waited_share(const JobReport& report) {
  double waited = 0, all = 0;
  for (const RankReport& rank : report.result.ranks) {
    waited += rank.total().traffic.waited_seconds;
    all += rank.total().time.seconds;
  }
  return all > 0 ? waited / all : 0;
}

Json to_json(const JobReport& report, const JobOptions& options) {
  const Hierarchy& hierarchy = report.result.tables;
  const std::vector<RankReport>& ranks = report.result.ranks;
  std::uint64_t stored = 0;
  for (const Level& level : hierarchy.levels) stored += level.triangles;
  Json per_rank = Json::array();
  for (std::size_t r = 0; r < ranks.size(); ++r) per_rank.push_back(rank_json(report, r));
  const std::vector<double> memory(report.peak_bytes.begin(), report.peak_bytes.end());
  const std::vector<std::string> inputs{options.generator};
  return {{"inputs", options.inputs.empty() ? inputs : options.inputs},
          {"output", options.output},
          {"input_triangles", hierarchy.provenance.input_triangles},
          {"input_vertices", hierarchy.provenance.input_vertices},
          {"levels", hierarchy.levels.size()},
          {"cells", hierarchy.cells.size()},
          {"stored_triangles", stored},
          {"file_bytes", report.result.file_bytes},
          {"seconds", report.time.seconds},
          {"threads", report.threads},
          {"memory_limit", options.memory_limit.count},
          {"spilled", report.result.spilled},
          {"bytes_sent", bytes_sent(report)},
          {"rounds", ranks.front().total().traffic.rounds},
          {"waited_share", waited_share(report)},
          {"imbalance",
           {{"triangles", imbalance_of(ranks, [](const RankReport& r) { return r.triangles; })},
            {"cpu_seconds", imbalance_of(ranks, [](const RankReport& r) { return r.total().time.cpu_seconds; })},
            {"memory", imbalance(memory)}}},
          {"ranks", per_rank},
          {"level_table", level_table(hierarchy)},
          {"warnings", report.result.warnings},
          {"repairs", to_json(hierarchy.provenance.repairs)}};
}

void print(const JobReport& report, const JobOptions& options) {
  const Hierarchy& hierarchy = report.result.tables;
  fmt::print("{}: {} triangles -> {} levels, {} cells, by {} ranks of {} threads\n", options.output,
             hierarchy.provenance.input_triangles, hierarchy.levels.size(), hierarchy.cells.size(), report.hosts.size(),
             report.threads);
  const auto triangles = static_cast<double>(hierarchy.provenance.input_triangles);
  fmt::print("{:.1f} MB, {:.2f} s, at most {:.0f} MB in a rank, {:.1f} bytes sent per triangle\n",
             static_cast<double>(report.result.file_bytes) * 1e-6, report.time.seconds,
             static_cast<double>(std::ranges::max(report.peak_bytes)) * 1e-6,
             static_cast<double>(bytes_sent(report)) / triangles);
  print_repairs(hierarchy.provenance.repairs);
  print_warnings(report.result.warnings);
}

OptionTable declare(JobOptions& o) {
  return with_input_options(
      {OptionSpec{"IN", &o.inputs, std::string("Mesh, in one file or several: ") + mesh_formats},
       OptionSpec{"--generate", &o.generator, "A generated surface instead of a file, such as sphere:16e6:1"}.of_type(
           "SHAPE:TRIANGLES[:SEED]"),
       OptionSpec{"-o,--output", &o.output, "Hierarchy to write (.lode), in a folder that all machines share"}.must(),
       up_option(o.reading.up),
       {"--no-attributes", &o.no_attributes, "Leave out what the mesh has besides its shape"},
       {"--sigma0", &o.sigma0, "As for lodestone build, like the options below"},
       OptionSpec{"--cell-triangles", &o.cell_triangles, "Mean triangles per occupied finest cell"}.between(1, 1e9),
       OptionSpec{"--levels", &o.levels, "Finest level L instead (the root is level 0)"}.between(0, max_level),
       {"--half-levels", &o.half_levels, "Levels of a half of the triangles instead of a quarter"},
       OptionSpec{"--lattice", &o.lattice_bits, "Put the vertices on multiples of 2^-BITS of the longest extent"}
           .between(1, Lattice::most_bits)
           .of_type("BITS"),
       {"--texture-levels", &o.texture_levels, "Store copies of the textures for coarser levels"},
       {"--simplifier", &o.simplifier, "quadric, cluster, openmesh or meshopt"},
       {"--placement", &o.placement, "optimal or endpoint"},
       {"--memory-limit", &o.memory_limit,
        "Memory that each process may have resident, such as 2GiB or 1500MB: if they need more, they put triangles and "
        "cells into temporary files, for the same bytes"},
       OptionSpec{"--scratch", &o.scratch, "Folder for temporary files, on each machine; default: that of the output"}
           .only_with({"--memory-limit"})
           .of_type("DIR"),
       OptionSpec{"--resume", &o.resume,
                  "Keep what is done in temporary files when the job is interrupted, and continue from it, with any "
                  "number of processes"}
           .only_with({"--memory-limit"}),
       {"--trace", &o.trace,
        "File for what each rank did when, its workers, stages and waits for messages: JSON for chrome://tracing or "
        "ui.perfetto.dev (.json)"},
       timeout_option(o.timeout)},
      o.reading);
}

void check(const JobOptions& options) {
  if (options.inputs.empty() == options.generator.empty())
    throw UsageError("one mesh is built: give either files or --generate");
}

void run(const JobOptions& options, const CommonOptions& common, Transport& transport) {
  const JobReport report = run_job(options, common, transport);
  if (transport.rank() != 0) return;
  write_result(common, to_json(report, options));
  if (common.prints()) print(report, options);
}

}  // namespace

void add_build_job(CommandTable& commands, MpiTransport& transport) {
  add_job<JobOptions>(commands, transport,
                      {"build", "Build the hierarchical level of detail of a mesh by all processes of an MPI job",
                       "  mpirun -n 4 lodestone-mpi build statue.ply -o statue.lode --threads 2 --json build.json\n"
                       "  mpirun -n 4 lodestone-mpi build city/tileset.json -o city.lode --texture-levels\n"
                       "  mpirun -n 8 lodestone-mpi build --generate sphere:64e6:1 -o sphere.lode --threads 1\n"},
                      {declare, check, run});
}

}  // namespace lodestone
