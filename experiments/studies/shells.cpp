// Experiment `shells`: what can be seen of a model from outside as one surface, beside the simplifiers of a library, at
// equal numbers of triangles.
//
// The shell's resolution is found by trying, which is not timed. meshoptimizer's remesher, where the library has one,
// gets as many voxels as the shell has samples along the longest side, or twice or four times as many where they give
// too few triangles, up to its limit; what it makes is simplified to the number by the same library. Accuracy is judged
// by what pictures from all around show: of the input, how far from the result; and of the result, how far from the
// input, which finds what a result adds.
#include <algorithm>
#include <cmath>

#include "core/mesh/raw_mesh.h"
#include "core/simplify/peers/whole_mesh.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/compare.h"
#include "parallel/scheduler/clock.h"
#include "render/reconstruct/reconstruct.h"

namespace lodestone {
namespace shells_study {

constexpr int most_voxels = 256;  // of meshoptimizer's remesher, along the longest side

std::vector<ParameterInfo> parameters() {
  return {
      threads_parameter(),
      rounds_parameter(3),
      {"target",
       50'000.0,
       "",
       "triangles that each family is asked for; simplifiers cannot make more than the input has",
       100,
       1e9,
       {}},
  };
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"family", "", "shell, or a function of meshoptimizer: simplify, sloppy, remesh", label},
      {"input_triangles", "", "of the input", count},
      {"triangles", "", "of the result", count},
      {"closed", "", "the result has no border", label},
      {"manifold", "", "no edge of more than two triangles, no vertex of more than one fan", label},
      {"components", "", "of the result", count},
      {"seen_coverage", "%",
       "share of the pixels of pictures of the input whose point has the result within the spacing of the shell's "
       "samples",
       accuracy},
      {"seen_rms", "% of the diagonal", "distance from the result of what pictures of the input show", accuracy},
      {"shown_rms", "% of the diagonal", "distance from the input of what pictures of the result show", accuracy},
  };
  add_spread_columns(list, "seconds", "s", "making it");
  add_spread_columns(list, "cpu_seconds", "s", "processor time of all threads");
  return list;
}

// One family, and what came out: in the space and with the transform of the input.
struct Way {
  std::string family;
  std::function<IndexedMesh()> make;
  Rounds times;
  IndexedMesh mesh;
};

class ShellComparison {
 public:
  ShellComparison(const Parameters& parameters, const RunContext& context)
      : parameters_(parameters),
        context_(context),
        scheduler_(study_scheduler(parameters)),
        mesh_(read_study_mesh(context, *scheduler_).mesh),
        target_(static_cast<std::size_t>(parameters.number("target"))) {}

  std::vector<Row> run() {
    choose_resolution();
    if (has_meshoptimizer_remesher()) choose_voxels();
    std::vector<Way> ways = list_ways();
    for (int round = 0; round < parameters_.integer("rounds"); ++round)
      for (Way& way : ways) {
        const CpuClock clock;
        way.mesh = way.make();
        way.times.add(clock.elapsed());
        check_cancelled(context_);
      }
    const std::vector<Vec3d> seen = points_in_pictures(mesh_, {}, *scheduler_);
    const RawMesh input = in_model_space(mesh_);
    std::vector<Row> rows;
    for (const Way& way : ways) rows.push_back(row_of(way, seen, input));
    return rows;
  }

 private:
  void choose_resolution() {
    config_.merge = MergeKind::shell;
    const Reconstruction tried = reconstruct_to_triangles(mesh_, config_, target_, *scheduler_);
    spacing_ = tried.report.spacing;
    config_.triangles = target_;
    config_.resolution = tried.report.drawn_resolution;
    check_cancelled(context_);
  }

  std::vector<Way> list_ways() {
    const PeerMesh whole{mesh_.positions, mesh_.triangles, {}};
    const std::size_t target = std::min(target_, mesh_.triangles.size());
    std::vector<Way> ways;
    const auto add = [&](const char* family, std::function<IndexedMesh()> make) {
      ways.push_back({family, std::move(make), {}, {}});
    };
    add("simplify", [=, this] { return mesh_of(simplify_with_meshoptimizer(whole, target)); });
    add("sloppy", [=, this] { return mesh_of(cluster_with_meshoptimizer(whole, target)); });
    if (has_meshoptimizer_remesher()) add("remesh", [=, this] { return remesh(whole); });
    add("shell", [this] { return normalised(reconstruct(mesh_, config_, *scheduler_).mesh); });
    return ways;
  }

  [[nodiscard]] IndexedMesh remesh(const PeerMesh& whole) const {
    const PeerMesh fine = remesh_with_meshoptimizer(whole, voxels_);
    return mesh_of(fine.triangles.size() > target_ ? simplify_with_meshoptimizer(fine, target_) : fine);
  }
  // As many as the shell has samples, doubled until they give the triangles that are asked for.
  void choose_voxels() {
    const PeerMesh whole{mesh_.positions, mesh_.triangles, {}};
    voxels_ = static_cast<int>(std::lround(config_.resolution));
    while (voxels_ < most_voxels && remesh_with_meshoptimizer(whole, voxels_).triangles.size() < target_)
      voxels_ = std::min(2 * voxels_, most_voxels);
  }
  [[nodiscard]] IndexedMesh mesh_of(PeerMesh peer) const {
    IndexedMesh mesh;
    mesh.transform = mesh_.transform;
    mesh.positions = std::move(peer.positions), mesh.triangles = std::move(peer.triangles);
    return mesh;
  }
  [[nodiscard]] IndexedMesh normalised(const RawMesh& raw) const {
    IndexedMesh mesh;
    mesh.transform = mesh_.transform;
    for (const Vec3d& p : raw.positions) mesh.positions.push_back(mesh_.transform.to_normalised(p));
    mesh.triangles = raw.triangles;
    return mesh;
  }

  Row row_of(const Way& way, std::span<const Vec3d> seen, const RawMesh& input) {
    const RawMesh made = in_model_space(way.mesh);
    const double percent = 100 * mesh_.transform.scale / diagonal_of(input);
    const auto coverage = [&](std::span<const Vec3d> points, const RawMesh& by) {
      return measure_coverage(points, by, mesh_.transform, spacing_, *scheduler_);
    };
    Row row;
    row["family"] = way.family, row["input_triangles"] = mesh_.triangles.size();
    row["triangles"] = way.mesh.triangles.size();
    add_spread(row, "seconds", way.times.wall);
    add_spread(row, "cpu_seconds", way.times.cpu);
    if (context_.repetition > 0 || way.mesh.triangles.empty()) return row;
    const MeshQuality quality = measure_quality(made.positions, made.triangles);
    row["closed"] = quality.closed(), row["manifold"] = quality.manifold(), row["components"] = quality.components;
    const SurfaceCoverage covered = coverage(seen, made);
    row["seen_coverage"] = 100 * covered.share, row["seen_rms"] = percent * covered.rms;
    row["shown_rms"] = percent * coverage(points_in_pictures(way.mesh, {}, *scheduler_), input).rms;
    return row;
  }

  const Parameters& parameters_;
  const RunContext& context_;
  std::unique_ptr<Scheduler> scheduler_;
  IndexedMesh mesh_;
  std::size_t target_;
  ReconstructConfig config_;
  int voxels_ = 0;      // of the remesher
  double spacing_ = 0;  // that the number of triangles stands for
};

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.at_most("seen_coverage", 100);
  for (const Row& row : rows) {
    if (text_in(row, "family") != "shell") continue;
    for (const char* property : {"closed", "manifold"})
      if (row.contains(property)) verdict.require(row[property] == true, std::string("the shell is not ") + property);
    verdict.require(number_in(row, "triangles").value_or(0) <= 1.1 * parameters.number("target"),
                    "the shell has more triangles than were asked for");
  }
  return std::move(verdict).messages();
}

}  // namespace shells_study

Experiment shells_experiment() {
  using namespace shells_study;
  return {"shells",
          "At equal numbers of triangles, how near is a closed shell to what can be seen of a model, and simplifiers "
          "beside "
          "it?",
          true,
          parameters(),
          columns(),
          [](const Parameters& parameters, const RunContext& context) {
            return ShellComparison(parameters, context).run();
          },
          verify};
}

}  // namespace lodestone
