// lodestone-mpi verify: the invariants of a .lode file by all processes of an MPI job (docs/cluster.md).
#include "core/base/error.h"
#include "experiments/commands/input.h"
#include "experiments/mpi/job.h"
#include "experiments/subjects/verify.h"
#include "parallel/distributed/rank_verify.h"
#include "render/lod/verify_radii.h"

namespace lodestone {
namespace {

struct VerifyJobOptions {
  std::string file;
  double timeout = 600;
};

// Rank 0 checks the radii, which follow from the tables.
VerifyReport verify_all(const RankCells& cells, Ranks& ranks, const std::string& file, const VerifyProgress& progress) {
  if (!cells.hierarchy.signatures)
    throw UnsupportedError(
        describe(file, "", "has no signatures, as radii need them", "verify it with lodestone, in one process"));
  VerifyReport report = verify_ranks(cells, ranks, progress);
  if (ranks.rank() == 0 && report.find("structure")->passed) report.checks.push_back(verify_radii(cells.hierarchy));
  return report;
}

void run(const VerifyJobOptions& options, const CommonOptions& common, Transport& transport) {
  const bool is_first = transport.rank() == 0;
  if (is_first) check_files(common, {{"FILE", options.file}});
  Ranks ranks(transport);
  const CpuClock clock;
  const auto scheduler = make_scheduler(common);
  Progress progress = job_progress("reading", common, transport.rank());
  progress.phase("reading");
  const RankCells cells = load_rank_cells(options.file, ranks.rank(), ranks.count(), *scheduler);
  progress.phase("verifying");
  const VerifyReport report = verify_all(cells, ranks, options.file, [&](double share) { progress.update(share); });
  progress.clear();
  const Json rows = rank_rows(ranks, clock, {{"cells", cells.own.size()}});
  if (!is_first) return;

  const bool measured = cells.hierarchy.provenance.measured_errors;
  Json json = to_json(report, options.file, measured);
  json.update({{"seconds", clock.elapsed().seconds}, {"threads", scheduler->workers()}, {"ranks", rows}});
  write_result(common, json);
  if (common.prints()) print_report(report, options.file, measured);
  require_valid(report, options.file);
}

OptionTable declare(VerifyJobOptions& o) {
  return {OptionSpec{"FILE", &o.file, "Hierarchy (.lode), on a disk that all machines share"}.must(),
          timeout_option(o.timeout)};
}

}  // namespace

void add_verify_job(CommandTable& commands, MpiTransport& transport) {
  add_job<VerifyJobOptions>(
      commands, transport,
      {"verify", "Check every invariant of a hierarchy by all processes of an MPI job, as lodestone verify",
       "  mpirun -n 8 lodestone-mpi verify statue.lode --json verify.json\n"},
      {declare, nullptr, run});
}

}  // namespace lodestone
