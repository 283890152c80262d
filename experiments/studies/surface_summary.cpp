#include "experiments/studies/surface_summary.h"

#include <algorithm>

namespace lodestone {

using enum ColumnInfo::Kind;

std::vector<ColumnInfo> SurfaceSummary::columns() {
  const std::string percent = "% of the extent";
  return {
      {"surface_triangles", "", "of the whole surface as drawn, before culling, mean over the frames", cost},
      {"open_edges", "", "residual edges of a frame, by the exact definition, most", accuracy},
      {"cracked_frames", "%", "frames with residual edges", accuracy},
      {"gap_max", percent, "largest distance of two places at which one vertex is drawn", accuracy},
      {"gap_mean", percent, "mean of these distances where there are any, of the worst frame", accuracy},
      {"gap_pixels", "pixels", "largest distance of two places at which one vertex is drawn", accuracy},
      {"gap_mean_pixels", "pixels", "mean of these distances where there are any in view, of the worst frame",
       accuracy},
      {"t_junctions", "",
       "border vertices nearer to the inside of another border edge than 1 % of a finest cell's side, most", accuracy},
      {"torn_pixels", "pixels", "rays through a crack of a closed model, hidden or not, most", accuracy},
      {"leak_pixels", "pixels", "where a closed model shows its inside or what is behind it, most", accuracy},
      {"jump_max", percent, "largest way of a vertex from one frame to the next", accuracy},
      {"jump_p99", percent, "way that 99 % of the vertices do not exceed, most", accuracy},
      {"jump_per_step", "", "largest way of a vertex over that of the viewpoint", accuracy},
      {"jump_pixels", "pixels", "largest way of a vertex in the picture, without the camera's own", accuracy},
      {"jump_p99_pixels", "pixels", "way that 99 % of the vertices in view do not exceed, most", accuracy},
      {"jump_over_bound", "",
       "largest jump over the analytic bound of the morph (of blend = step: of a linear one); above 1: a pop; null: "
       "there is no bound",
       accuracy},
  };
}

void SurfaceSummary::add_to(Row& row) const {
  const auto count = static_cast<double>(std::max<std::size_t>(samples_.size(), 1));
  double triangles = 0, cracked = 0;
  for (const SurfaceSample& s : samples_) triangles += s.triangles, cracked += s.open_edges > 0 ? 1 : 0;
  row["surface_triangles"] = triangles / count, row["cracked_frames"] = 100 * cracked / count;

  // Each the largest of all frames; null where no frame has it.
  for (const ColumnInfo& column : columns())
    if (!row.contains(column.name)) row[column.name] = nullptr;
  const auto most = [&](const char* column, std::optional<double> value) {
    if (value) row[column] = std::max(number_in(row, column).value_or(*value), *value);
  };
  bool bounded = true;
  for (const SurfaceSample& s : samples_) {
    most("open_edges", s.open_edges), most("t_junctions", s.t_junctions);
    most("gap_max", s.gap), most("gap_mean", s.gap_mean), most("gap_pixels", s.gap_pixels);
    most("gap_mean_pixels", s.gap_mean_pixels);
    most("torn_pixels", s.torn_pixels), most("leak_pixels", s.leak_pixels);
    if (!s.jump) continue;
    most("jump_max", s.jump->largest), most("jump_p99", s.jump->p99), most("jump_per_step", s.jump->per_step);
    most("jump_pixels", s.jump->pixels), most("jump_p99_pixels", s.jump->p99_pixels);
    most("jump_over_bound", s.jump->over_bound);
    bounded = bounded && s.jump->over_bound;
  }
  if (!bounded) row["jump_over_bound"] = nullptr;
}

void SurfaceSummary::check(RowVerdict& verdict, bool continuous_blend) {
  verdict.in_order("gap_mean", "gap_max");
  verdict.in_order("gap_mean_pixels", "gap_pixels");
  verdict.in_order("jump_p99", "jump_max");
  verdict.in_order("jump_p99_pixels", "jump_pixels");
  verdict.at_most("cracked_frames", 100);
  for (const Row& row : verdict.rows()) {
    if (!row.is_object()) continue;
    const auto zero = [&](const char* column) { return number_in(row, column).value_or(0) == 0; };
    verdict.require(!zero("gap_max") || zero("open_edges"), "residual edges without a gap");
    if (row.value("admissible", Row()) != true) continue;
    for (const char* column : {"open_edges", "gap_max", "gap_pixels", "torn_pixels"})
      verdict.require(zero(column), std::string(column) + " is not 0, although the radii are admissible");
    if (continuous_blend)
      verdict.require(number_in(row, "jump_over_bound").value_or(0) <= 1,
                      "a vertex jumps beyond its bound, although the radii are admissible and the blend is continuous");
  }
}

}  // namespace lodestone
