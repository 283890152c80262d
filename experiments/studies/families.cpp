// Experiment `families`: the ways to make levels, at equal numbers of triangles on the same model.
//
// The levels of the hierarchy set the numbers; the progressive mesh is cut to the same, the reconstruction's resolution
// is found by trying, which is not timed. Hierarchy and progressive mesh give all levels at once: their seconds are
// those of the whole; a reconstruction makes one, and so does a simplifier of another library, which gets the whole
// mesh and knows neither blocks nor a displacement bound. Rounds take turns between the families.
#include <algorithm>
#include <array>
#include <string_view>

#include "core/hierarchy/model/level_mesh.h"
#include "core/mesh/raw_mesh.h"
#include "core/progressive/mesh/level.h"
#include "core/simplify/peers/whole_mesh.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/compare.h"
#include "experiments/subjects/reconstruct.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace families_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(3),
      as_condition({"level_count", 3, "", "levels below the input", 1, 15, {}}),
      {"merge", "stitch", "", "of reconstructed levels", 0, 0, {"stitch", "concatenate"}},
      {"peers", false, "", "whole meshes simplified by meshoptimizer and by OpenMesh are families, too", 0, 0, {}},
  };
  append(list, build_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"family", "", "hlod, progressive, reconstructed, meshoptimizer or openmesh", label},
      {"level", "", "levels above the finest", count},
      {"input_triangles", "", "of the input", count},
      {"target", "", "triangles asked for: those of the hierarchy's level", count},
      {"triangles", "", "of the level", count},
      {"all_levels", "", "the seconds are those of all levels together", label},
      {"manifold", "", "no edge of more than two triangles, no vertex of more than one fan", label},
  };
  add_spread_columns(list, "seconds", "s", "making it");
  add_spread_columns(list, "cpu_seconds", "s", "processor time of all threads");
  append(list, geometry_columns());
  return list;
}

// In the order of the rows of a level.
constexpr std::array<std::string_view, 3> own_families{"hlod", "progressive", "reconstructed"};
constexpr std::array<std::string_view, 2> peer_families{"meshoptimizer", "openmesh"};

// One level of one family: how it is made, and what came out.
struct Way {
  std::string family;
  int level = 0;
  std::size_t target = 0;
  bool all_levels = true;
  Rounds times;
  RawMesh mesh;
};

class Comparison {
 public:
  Comparison(const Parameters& parameters, const RunContext& context)
      : parameters_(parameters),
        context_(context),
        scheduler_(study_scheduler(parameters)),
        mesh_(read_study_mesh(context, *scheduler_).mesh) {
    config_.merge = merge_kind(parameters.text("merge"));
  }

  std::vector<Row> run() {
    build();  // rounds that warm up
    collapse();
    choose_levels();
    choose_peers();
    const int rounds = parameters_.integer("rounds");
    for (int round = 0; round < rounds; ++round) {
      hlod_.add(build());
      check_cancelled(context_);
      progressive_.add(collapse());
      check_cancelled(context_);
      for (Way& way : reconstructed_) reconstruct_level(way);
      for (Way& way : peers_) simplify_whole(way);
      context_.progress(static_cast<double>(round + 1) / (rounds + 1));
    }
    return rows();
  }

 private:
  StageTime build() {
    IndexedMesh mesh = mesh_;
    const CpuClock clock;
    hierarchy_ = build_hierarchy(std::move(mesh), build_config(parameters_, context_), *scheduler_);
    return clock.elapsed();
  }

  StageTime collapse() {
    ProgressiveReport report;
    const CpuClock clock;
    collapsed_ = make_progressive(mesh_, {}, *scheduler_, report);
    return clock.elapsed();
  }

  void choose_levels() {
    const int count = std::min(parameters_.integer("level_count"), hierarchy_.finest());
    for (int up = 1; up <= count; ++up) {
      Way way{"reconstructed", up, 0, false, {}, {}};
      way.target = hierarchy_.levels[static_cast<std::size_t>(hierarchy_.finest() - up)].triangles;
      const Reconstruction tried = reconstruct_to_triangles(mesh_, config_, way.target, *scheduler_);
      resolutions_.push_back(1 / tried.report.spacing);
      reconstructed_.push_back(std::move(way));
      check_cancelled(context_);
    }
  }

  void choose_peers() {
    if (!parameters_.flag("peers")) return;
    for (const Way& level : reconstructed_)
      for (const std::string_view peer : peer_families)
        peers_.push_back({std::string(peer), level.level, level.target, false, {}, {}});
  }

  void simplify_whole(Way& way) {
    const PeerMesh whole{mesh_.positions, mesh_.triangles, {}};
    const CpuClock clock;
    PeerMesh left = way.family == "openmesh" ? simplify_with_openmesh(whole, way.target)
                                             : simplify_with_meshoptimizer(whole, way.target);
    way.times.add(clock.elapsed());
    way.mesh.positions.clear();
    for (const Vec3f& p : left.positions) way.mesh.positions.push_back(mesh_.transform.to_model(p));
    way.mesh.triangles = std::move(left.triangles);
    check_cancelled(context_);
  }

  void reconstruct_level(Way& way) {
    ReconstructConfig config = config_;
    config.resolution = resolutions_[static_cast<std::size_t>(way.level - 1)];
    const CpuClock clock;
    way.mesh = reconstruct(mesh_, config, *scheduler_).mesh;
    way.times.add(clock.elapsed());
  }

  std::vector<Row> rows() {
    const RawMesh reference = in_model_space(mesh_);
    const LevelFinder levels(collapsed_);
    std::vector<Row> rows;
    for (const Way& way : reconstructed_) {
      const Way hlod{"hlod", way.level, way.target,
                     true,   hlod_,     level_mesh(hierarchy_, hierarchy_.finest() - way.level)};
      const Way progressive{"progressive", way.level,    way.target,
                            true,          progressive_, levels.level_mesh(levels.vertices_for_triangles(way.target))};
      for (const Way* one : {&hlod, &progressive, &way}) rows.push_back(row_of(*one, reference));
      for (const Way& peer : peers_)
        if (peer.level == way.level) rows.push_back(row_of(peer, reference));
    }
    return rows;
  }

  Row row_of(const Way& way, const RawMesh& reference) {
    Row row;
    row["family"] = way.family, row["level"] = way.level, row["all_levels"] = way.all_levels;
    row["input_triangles"] = reference.triangles.size(), row["target"] = way.target;
    row["triangles"] = way.mesh.triangles.size();
    add_spread(row, "seconds", way.times.wall);
    add_spread(row, "cpu_seconds", way.times.cpu);
    if (context_.repetition > 0) return row;
    row["manifold"] = measure_quality(way.mesh.positions, way.mesh.triangles).manifold();
    add_geometry(row, reference, way.mesh, *scheduler_);
    return row;
  }

  const Parameters& parameters_;
  const RunContext& context_;
  std::unique_ptr<Scheduler> scheduler_;
  IndexedMesh mesh_;
  ReconstructConfig config_;
  Hierarchy hierarchy_;
  ProgressiveMesh collapsed_;
  Rounds hlod_, progressive_;
  std::vector<Way> reconstructed_, peers_;
  std::vector<double> resolutions_;  // of the reconstructed ones
};

// A row of each family for every level, and none of them far from the number of triangles that the others have.
void check_levels(RowVerdict& verdict, bool with_peers) {
  std::vector<std::string_view> families(own_families.begin(), own_families.end());
  if (with_peers) families.insert(families.end(), peer_families.begin(), peer_families.end());
  verdict.require(verdict.rows().size() % families.size() == 0, "a family is missing");
  for (std::size_t i = 0; i < verdict.rows().size(); ++i) {
    const Row& row = verdict.rows()[i];
    verdict.require(text_in(row, "family") == families[i % families.size()], "the families are not in their order");
    const double target = number_in(row, "target").value_or(0), triangles = number_in(row, "triangles").value_or(0);
    verdict.require(triangles > 0.5 * target && triangles < 1.5 * target,
                    text_in(row, "family") + " is far from the number of triangles asked for");
  }
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  check_build(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters& parameters, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  check_geometry(verdict);
  check_levels(verdict, parameters.flag("peers"));
  return std::move(verdict).messages();
}

}  // namespace families_study

Experiment families_experiment() {
  using namespace families_study;
  return {
      "families",
      "At equal numbers of triangles, which is nearest to the input, and what does each cost: hierarchy, progressive "
      "mesh, or reconstruction?",
      true,
      parameters(),
      columns(),
      [](const Parameters& parameters, const RunContext& context) { return Comparison(parameters, context).run(); },
      verify,
      check};
}

}  // namespace lodestone
