// Experiment `spherical`: a mesh over the sphere, what it costs in time and bytes and how right its images are.
#include "experiments/subjects/spherical.h"

#include "experiments/metrics/cost/cost.h"
#include "experiments/metrics/cracks/progressive_cracks.h"
#include "experiments/metrics/geometry/texture_sliding.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/result_hash.h"

namespace lodestone {
namespace spherical_study {

constexpr std::uint32_t checked_levels = 5;

constexpr const char* map_texts = "names of colour, normal, geometry, separated by commas";

std::optional<std::string> usual_maps(const std::string& names) { return to_string(spherical_maps(names)); }

std::vector<ParameterInfo> parameters() {
  return {
      threads_parameter(),
      rounds_parameter(1),
      {"effort", "normal", "", "how long the map to the sphere is improved", 0, 0, {"fast", "normal", "best"}},
      {"texture", 1024, "pixels", "side of the largest component's images, a power of two", 16, 16384, {}},
      {"maps", to_string(SphericalMaps{}), "", "the images", 0, 0, {}, OtherTexts{map_texts, usual_maps}},
      {"images", "webp", "", "format of the images", 0, 0, {"webp", "jpeg", "png"}},
      {"quality", 90, "", "of webp and jpeg; webp of 100 is without loss", 1, 100, {}},
  };
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list = spherical_columns();
  append(list, spread_ends(list, {"seconds", "cpu_seconds"}));
  append(
      list,
      {{"hash", "", "hash of the result", label},
       {"same", "", "all rounds and a single worker make the same", label},
       {"residual_edges", "", "cracks: edges of a level's border that are not the image of the input's", count},
       {"texture_sliding", "texels", "mean way of the texture at a level, drawn where its error is a pixel", accuracy},
       {"texture_sliding_max", "texels", "the largest such way", accuracy},
       {"morph_sliding", "texels", "texture_sliding from a level of a fourth more vertices", accuracy},
       {"morph_sliding_max", "texels", "the largest such way", accuracy}});
  return list;
}

SphericalConfig config_of(const Parameters& parameters) {
  SphericalConfig config;
  config.map.effort = sphere_effort(parameters.text("effort"));
  config.texture = static_cast<std::uint32_t>(parameters.integer("texture"));
  config.maps = spherical_maps(parameters.text("maps"));
  config.media_type = "image/" + parameters.text("images");
  config.quality = parameters.integer("quality");
  return config;
}

// The size of the whole as an .lpm, which is not kept.
ProgressiveFileSize lpm_size(const ProgressiveMesh& mesh, const RunContext& context) {
  const std::filesystem::path file = std::filesystem::path(context.directory) / "scratch.lpm";
  const ProgressiveFileSize size = save_progressive(mesh, file);
  std::filesystem::remove(file);
  return size;
}

std::vector<Row> rows_of(const Parameters& parameters, const RunContext& context) {
  const Study study(parameters, context);
  ReadConfig reading = study_reading();
  reading.attributes = true;
  const IndexedMesh mesh = read_study_mesh(context, *study.scheduler, reading).mesh;
  const SphericalConfig config = config_of(parameters);
  SphericalResult result;
  result.input_triangles = mesh.triangles.size();
  std::uint64_t hash = 0;
  bool same = true;
  const CostMeter meter;
  const Rounds times = time_rounds(parameters.integer("rounds"), context, [&] {
    const CpuClock clock;
    result.mesh = make_spherical(mesh, config, *study.scheduler, result.report);
    const StageTime time = clock.elapsed();
    const std::uint64_t made = hash_of(result.mesh);
    same = same && (hash == 0 || hash == made);
    hash = made;
    return time;
  });
  result.peak_bytes = meter.elapsed().peak_memory;
  result.time = times.median();
  result.size = lpm_size(result.mesh, context);
  if (context.repetition == 0) {
    SphericalReport report;
    same = same && hash == hash_of(make_spherical(mesh, config, *make_serial_scheduler(), report));
  }
  Row row = restricted_to(columns(), to_row(result));
  add_times(row, times);
  row["hash"] = to_hex(hash), row["same"] = same;
  row["residual_edges"] = residual_edges_of_levels(result.mesh, checked_levels);
  const SlidingOfLevels sliding = texture_sliding_of_levels(result.mesh, checked_levels);
  row["texture_sliding"] = sliding.whole.mean, row["texture_sliding_max"] = sliding.whole.max;
  row["morph_sliding"] = sliding.step.mean, row["morph_sliding_max"] = sliding.step.max;
  return {row};
}

std::vector<std::string> verify(const Parameters&, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("seconds");
  verdict.spread("cpu_seconds");
  verdict.present("hash");
  verdict.is_true("same");
  verdict.at_most("flips", 0);
  verdict.at_most("residual_edges", 0);
  verdict.at_most("efficiency", 1);
  verdict.at_most("texture_sliding", 1);
  return std::move(verdict).messages();
}

}  // namespace spherical_study

Experiment spherical_experiment() {
  using namespace spherical_study;
  return {"spherical", "What does a seamless texture over the sphere cost in time and bytes, and how right is it?",
          true,        parameters(),
          columns(),   rows_of,
          verify};
}

}  // namespace lodestone
