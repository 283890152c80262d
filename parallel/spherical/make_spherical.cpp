#include "parallel/spherical/make_spherical.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/spherical/assemble.h"
#include "core/spherical/octahedron/cut_choice.h"
#include "core/spherical/topology/make_spheres.h"
#include "parallel/clean/prepare.h"
#include "parallel/scheduler/runner.h"
#include "parallel/spherical/component_images.h"
#include "parallel/spherical/plain_parts.h"

namespace lodestone {
namespace {

using namespace spherical;

constexpr std::size_t small_component = 8192;  // triangles; the map to the sphere uses one worker for so few

constexpr double most_bend = 2;  // pixels

double area_of(const Surface& surface) {
  double area = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (surface.source_triangle[t] == no_source) continue;
    const auto at = [&](std::size_t k) { return surface.positions[surface.triangles[t].v[k]]; };
    area += 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
  }
  return area;
}

class Maker {
 public:
  Maker(const IndexedMesh& mesh, const SphericalConfig& config, Scheduler& scheduler, SphericalReport& report)
      : mesh_(mesh), config_(config), scheduler_(scheduler), report_(report) {}

  ProgressiveMesh make() {
    close();
    map();
    place_cuts();
    config_.on_phase("resampling");
    std::vector<double> shares;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) shares.push_back(share(k));
    images_ = make_component_images({mesh_, surfaces_, directions_, shares, plain_}, config_, scheduler_, report_);
    unfold_all();
    return collapse();
  }

 private:
  template <class Body>
  void in_chunks(std::size_t count, std::size_t grain, const Body& body) {
    scheduler_.for_chunks(count, grain, [&](ChunkRange range) { body(range); });
  }

  void close() {
    config_.on_phase("closing holes and handles");
    const CpuClock clock;
    Spheres spheres = make_spheres(mesh_, config_.handles, runner_over(scheduler_));
    surfaces_ = std::move(spheres.surfaces);
    report_.topology = spheres.report;
    report_.closing = clock.elapsed();
    keep_largest();
    const std::size_t count = surfaces_.size();
    plain_ = take_plain_parts(mesh_, config_.maps, surfaces_);
    report_.plain = count - surfaces_.size();
    for (const Surface& surface : surfaces_) areas_.push_back(area_of(surface));
    for (const double area : areas_) whole_area_ += area;
  }

  // In their order; of equal ones the first.
  void keep_largest() {
    const std::size_t count = surfaces_.size();
    if (config_.components == 0 || count <= config_.components) return;
    std::vector<double> areas;
    for (const Surface& surface : surfaces_) areas.push_back(area_of(surface));
    std::vector<std::size_t> kept(count);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    std::stable_sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) { return areas[a] > areas[b]; });
    kept.resize(config_.components);
    std::sort(kept.begin(), kept.end());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (kept[k] != k) surfaces_[k] = std::move(surfaces_[kept[k]]);  // no move to itself
    }
    surfaces_.resize(kept.size());
    report_.left_out = count - kept.size();
  }

  void map() {
    config_.on_phase("mapping to the sphere");
    directions_.resize(surfaces_.size());
    std::vector<SphereMapReport> parts(surfaces_.size());
    const auto map_one = [&](std::size_t k, Scheduler& scheduler) {
      directions_[k] = map_to_sphere(surfaces_[k].positions, surfaces_[k].triangles, config_.map, scheduler, parts[k]);
    };
    std::vector<std::size_t> small;
    for (std::size_t k = 0; k < surfaces_.size(); ++k)
      surfaces_[k].triangles.size() < small_component ? small.push_back(k) : map_one(k, scheduler_);
    const CpuClock clock;
    in_chunks(small.size(), 1, [&](ChunkRange range) { map_one(small[range.begin], *make_serial_scheduler()); });
    report_.map.map += clock.elapsed();
    // Their own clocks have counted each other.
    for (const std::size_t k : small) parts[k].collapse = parts[k].map = parts[k].measure = {};
    for (std::size_t k = 0; k < surfaces_.size(); ++k) add_map_report(k, parts[k]);
  }

  void add_map_report(std::size_t k, const SphereMapReport& part) {
    report_.efficiency += share(k) * part.sums.efficiency();
    report_.map.collapse += part.collapse, report_.map.map += part.map, report_.map.measure += part.measure;
    report_.map.sums.add(part.sums);
    report_.map.levels = std::max(report_.map.levels, part.levels);
    report_.map.waves += part.waves;
    report_.map.colours = std::max(report_.map.colours, part.colours);
    report_.map.by_connectivity += part.by_connectivity;
    report_.map.attempts += part.attempts;
  }

  void place_cuts() {
    config_.on_phase("unfolding");
    const CpuClock clock;
    std::vector<CutCost> cuts(surfaces_.size());
    in_chunks(surfaces_.size(), 1, [&](ChunkRange range) { cuts[range.begin] = place_cut(range.begin); });
    double exposed = 0;
    for (const CutCost& cut : cuts) {
      report_.cut_length += cut.length * mesh_.transform.scale;
      exposed += cut.length * mesh_.transform.scale * cut.exposure;
    }
    report_.cut_exposure = report_.cut_length > 0 ? exposed / report_.cut_length : 0;
    report_.unfolding = clock.elapsed();
  }

  void unfold_all() {
    const CpuClock clock;
    unfoldings_.resize(surfaces_.size());
    in_chunks(surfaces_.size(), 1, [&](ChunkRange range) {
      const std::size_t k = range.begin;
      unfoldings_[k] = unfold(surfaces_[k].triangles, directions_[k], most_bend / images_.places[k].side);
    });
    for (const Unfolding& unfolding : unfoldings_) report_.added_vertices += unfolding.added.size();
    report_.unfolding += clock.elapsed();
  }

  // Turns the sphere to where the cut shows least, unless rounding would turn a triangle over.
  CutCost place_cut(std::size_t k) {
    const Surface& surface = surfaces_[k];
    const CutMeasure measure(surface.positions, surface.triangles, directions_[k]);
    if (!config_.choose_cut) return measure.measure({});
    const CutChoice choice = measure.choose();
    std::vector<Vec3d> turned = rotated(directions_[k], choice.rotation);
    if (measure_sphere_map(surface.positions, surface.triangles, turned).flips > 0) return choice.before;
    directions_[k] = std::move(turned);
    return choice.cost;
  }

  ProgressiveMesh collapse() {
    config_.on_phase("collapsing");
    const CpuClock clock;
    if (!plain_.triangles.empty()) {
      unfoldings_.push_back(plain_unfolding(plain_));
      surfaces_.push_back(std::move(plain_));
    }
    RawMesh raw = assemble(mesh_, surfaces_, unfoldings_, images_.places);
    raw.materials = std::move(images_.materials);
    raw.textures = std::move(images_.textures);
    Repairs repairs;
    IndexedMesh whole = prepare_mesh(std::move(raw), repairs, scheduler_);
    const Transform& model = mesh_.transform;  // the box of `whole` may be smaller: components may be left out
    whole.transform.origin = model.origin + model.scale * whole.transform.origin;
    whole.transform.scale *= model.scale;
    ProgressiveMesh out = make_progressive(std::move(whole), config_.progressive, scheduler_, report_.progressive);
    if (config_.maps.normal) out.object_normals = std::move(images_.object_normals);
    out.geometry_images = std::move(images_.geometry_images);
    out.octahedral = std::move(images_.octahedral);
    report_.collapsing = clock.elapsed();
    return out;
  }

  [[nodiscard]] double share(std::size_t k) const {
    return whole_area_ > 0 ? areas_[k] / whole_area_ : 1.0 / static_cast<double>(areas_.size());
  }
  const IndexedMesh& mesh_;
  const SphericalConfig& config_;
  Scheduler& scheduler_;
  SphericalReport& report_;
  std::vector<Surface> surfaces_;
  Surface plain_;              // components without images
  std::vector<double> areas_;  // of what has a source, by surface
  double whole_area_ = 0;
  std::vector<std::vector<Vec3d>> directions_;
  std::vector<Unfolding> unfoldings_;
  ComponentImages images_;
};

struct MapName {
  std::string_view name;
  bool SphericalMaps::*map;
};
constexpr std::array map_names{MapName{"colour", &SphericalMaps::colour}, MapName{"normal", &SphericalMaps::normal},
                               MapName{"geometry", &SphericalMaps::geometry}};

}  // namespace

std::string to_string(const SphericalMaps& maps) {
  std::string names;
  for (const MapName& map : map_names)
    if (maps.*map.map) names.append(names.empty() ? "" : ",").append(map.name);
  return names;
}

SphericalMaps spherical_maps(std::string_view names) {
  SphericalMaps maps, all;
  for (const MapName& map : map_names) maps.*map.map = false, all.*map.map = true;
  for (std::size_t at = 0, end = 0; end != std::string_view::npos; at = end + 1) {
    end = names.find(',', at);
    const std::string_view name = names.substr(at, end - at);
    const auto map = std::ranges::find(map_names, name, &MapName::name);
    if (map == map_names.end())
      throw InputError(describe({}, {}, "unknown map '" + std::string(name) + "'", "name some of " + to_string(all)));
    maps.*map->map = true;
  }
  return maps;
}

ProgressiveMesh make_spherical(const IndexedMesh& mesh, const SphericalConfig& config, Scheduler& scheduler,
                               SphericalReport& report) {
  report = {};
  if (config.texture < least_octahedral_side || (config.texture & (config.texture - 1)) != 0)
    throw InputError(describe("", "",
                              std::to_string(config.texture) + " pixels cannot be the side of an octahedral image",
                              "give a power of two from 16 on"));
  return Maker(mesh, config, scheduler, report).make();
}

}  // namespace lodestone
