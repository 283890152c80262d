#include "parallel/spherical/make_spherical.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/math/box3.h"
#include "core/spherical/assemble.h"
#include "core/spherical/octahedron/cut_choice.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/octahedron/square_atlas.h"
#include "core/spherical/resample/geometry_image.h"
#include "core/spherical/resample/image_error.h"
#include "core/spherical/resample/mesh_source.h"
#include "core/spherical/resample/octahedral_codec.h"
#include "core/spherical/resample/resampler.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/compare.h"

namespace lodestone {
namespace {

using namespace spherical;

constexpr std::uint32_t least_texture = 16;
constexpr double least_share = 1.0 / 256;      // of the area, for images of its own
constexpr std::size_t small_component = 8192;  // triangles; the map to the sphere uses one worker for so few

struct MapName {
  std::string_view name;
  bool SphericalMaps::*map;
};
constexpr std::array map_names{MapName{"colour", &SphericalMaps::colour}, MapName{"normal", &SphericalMaps::normal},
                               MapName{"geometry", &SphericalMaps::geometry}};

Runner runner_over(Scheduler& scheduler) {
  Runner runner;
  runner.workers = static_cast<std::size_t>(scheduler.workers());
  runner.run = [&scheduler](std::size_t count, const Runner::Body& body) {
    scheduler.for_chunks(
        count, 1, [&](ChunkRange range) { body(range.begin, static_cast<std::size_t>(scheduler.worker_index())); });
  };
  return runner;
}

void add(StageTime& sum, const StageTime& time) {
  sum.seconds += time.seconds;
  sum.cpu_seconds += time.cpu_seconds;
}

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
    unfold_all();
    resample_all();
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
    for (const Surface& surface : surfaces_) areas_.push_back(area_of(surface));
    keep_largest();
    for (const double area : areas_) whole_area_ += area;
  }

  // In their order; of equal ones the first.
  void keep_largest() {
    const std::size_t count = surfaces_.size();
    if (config_.components == 0 || count <= config_.components) return;
    std::vector<std::size_t> kept(count);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    std::stable_sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) { return areas_[a] > areas_[b]; });
    kept.resize(config_.components);
    std::sort(kept.begin(), kept.end());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (kept[k] == k) continue;  // no move to itself
      surfaces_[k] = std::move(surfaces_[kept[k]]);
      areas_[k] = areas_[kept[k]];
    }
    surfaces_.resize(kept.size()), areas_.resize(kept.size());
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
    add(report_.map.map, clock.elapsed());
    // Their own clocks have counted each other.
    for (const std::size_t k : small) parts[k].collapse = parts[k].map = parts[k].measure = {};
    for (std::size_t k = 0; k < surfaces_.size(); ++k) add_map_report(k, parts[k]);
  }

  void add_map_report(std::size_t k, const SphereMapReport& part) {
    report_.efficiency += share(k) * part.sums.efficiency();
    add(report_.map.collapse, part.collapse), add(report_.map.map, part.map), add(report_.map.measure, part.measure);
    report_.map.sums.add(part.sums);
    report_.map.levels = std::max(report_.map.levels, part.levels);
    report_.map.waves += part.waves;
    report_.map.colours = std::max(report_.map.colours, part.colours);
    report_.map.by_connectivity += part.by_connectivity;
    report_.map.attempts += part.attempts;
  }

  void unfold_all() {
    config_.on_phase("unfolding");
    const CpuClock clock;
    unfoldings_.resize(surfaces_.size());
    std::vector<CutCost> cuts(surfaces_.size());
    in_chunks(surfaces_.size(), 1, [&](ChunkRange range) {
      cuts[range.begin] = place_cut(range.begin);
      unfoldings_[range.begin] = unfold(surfaces_[range.begin].triangles, directions_[range.begin]);
    });
    for (const Unfolding& unfolding : unfoldings_) report_.added_vertices += unfolding.added.size();
    double exposed = 0;
    for (const CutCost& cut : cuts) {
      report_.cut_length += cut.length * mesh_.transform.scale;
      exposed += cut.length * mesh_.transform.scale * cut.exposure;
    }
    report_.cut_exposure = report_.cut_length > 0 ? exposed / report_.cut_length : 0;
    report_.unfolding = clock.elapsed();
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

  void resample_all() {
    config_.on_phase("resampling");
    const CpuClock clock;
    source_ = std::make_shared<MeshSource>(mesh_);
    in_chunks(source_->texture_count(), 1, [&](ChunkRange range) { source_->load(range.begin); });
    add(report_.resampling, clock.elapsed());
    const std::vector<std::size_t> small = small_components();
    for (std::size_t k = 0, next = 0; k < surfaces_.size(); ++k) {
      if (next < small.size() && small[next] == k && ++next > 0) continue;
      // Images of several components are told apart by their numbers.
      std::string name;
      if (surfaces_.size() > 1) name.append(" ").append(std::to_string(k + 1));
      places_[k].material = static_cast<std::uint32_t>(materials_.size());
      materials_.push_back({.name = "octahedral" + name});
      if (config_.maps.colour || config_.maps.normal) add_component(k, name);
      if (config_.maps.geometry) add_geometry(k, name);
    }
    if (!small.empty()) add_atlas(small);
    source_.reset();
    report_.geometry_rms = std::sqrt(report_.geometry_rms);
  }

  // Those that share their images. A geometry image is that of one component.
  std::vector<std::size_t> small_components() {
    places_.resize(surfaces_.size());
    std::vector<std::size_t> small;
    for (std::size_t k = 0; k < surfaces_.size() && !config_.maps.geometry; ++k)
      if (share(k) < least_share) small.push_back(k);
    if (small.size() < 2) small.clear();
    return small;
  }

  void add_atlas(const std::vector<std::size_t>& small) {
    CpuClock clock;
    std::vector<std::uint32_t> sides;
    for (const std::size_t k : small) sides.push_back(texture_of(k));
    const SquareAtlas atlas = pack_squares(std::move(sides), config_.texture);
    LinearImage colour = blank_image(atlas, 4), normal = blank_image(atlas, config_.maps.normal ? 3 : 0);
    in_chunks(small.size(), 1, [&](ChunkRange range) {
      const std::size_t k = small[range.begin];
      const AtlasSquare& square = atlas.squares[range.begin];
      const SurfaceSource source(source_, surfaces_[k], directions_[k]);
      const ResampledImages images =
          resample(surfaces_[k], directions_[k], source, {.size = square.image(), .normals = config_.maps.normal});
      paste(images.colour, square, colour);
      if (config_.maps.normal) paste(images.normal, square, normal);
      places_[k] = place_in(atlas, range.begin, static_cast<std::uint32_t>(materials_.size()));
    });
    fill_rest(atlas, colour), fill_rest(atlas, normal);
    add(report_.resampling, clock.elapsed());
    clock = {};
    materials_.push_back({.name = "octahedral atlas"});
    std::uint32_t number = no_texture;
    if (config_.maps.colour)
      colour = add_image(colour, PixelMeaning::colours, "colour atlas", materials_.back().texture);
    if (config_.maps.normal) normal = add_image(normal, PixelMeaning::normals, "normals atlas", number);
    object_normals_.push_back(number);
    add(report_.encoding, clock.elapsed());
    measure_atlas(small, atlas, colour, normal);
  }

  void measure_atlas(const std::vector<std::size_t>& small, const SquareAtlas& atlas, const LinearImage& colour,
                     const LinearImage& normal) {
    std::vector<ImageError> errors(small.size());
    in_chunks(small.size(), 1, [&](ChunkRange range) {
      const std::size_t k = small[range.begin];
      const SurfaceSource source(source_, surfaces_[k], directions_[k]);
      const ImageErrorMeter meter(surfaces_[k], directions_[k], source, error_points(k));
      const auto own = [&](const LinearImage& image) {
        return image.values.empty() ? LinearImage{} : cut_out(image, atlas.squares[range.begin]);
      };
      errors[range.begin] = measure_images(meter, own(colour), own(normal));
    });
    for (std::size_t i = 0; i < small.size(); ++i) add_error(small[i], errors[i]);
  }

  // The result of a Resampler or a GeometrySampler.
  template <class Sampler>
  auto draw(std::size_t k, Sampler sampler) {
    SphereRaster& raster = sampler.raster();
    in_chunks(directions_[k].size(), 4096, [&](ChunkRange range) { raster.place(range.begin, range.end); });
    in_chunks(surfaces_[k].triangles.size(), 4096, [&](ChunkRange range) { raster.bound(range.begin, range.end); });
    raster.sort();
    std::vector<SampleTile> rooms(static_cast<std::size_t>(scheduler_.workers()));
    in_chunks(raster.tile_count(), 1, [&](ChunkRange range) {
      sampler.draw(range.begin, rooms[static_cast<std::size_t>(scheduler_.worker_index())]);
    });
    return sampler.finish();
  }

  void add_component(std::size_t k, const std::string& name) {
    CpuClock clock;
    const SurfaceSource source(source_, surfaces_[k], directions_[k]);
    const ResampleConfig config{.size = texture_of(k), .normals = config_.maps.normal};
    const ResampledImages images = draw(k, Resampler(surfaces_[k], directions_[k], source, config));
    add(report_.resampling, clock.elapsed());
    clock = {};
    std::uint32_t number = no_texture;
    LinearImage colour, normal;
    if (config_.maps.colour)
      colour = add_image(images.colour, PixelMeaning::colours, "colour" + name, materials_.back().texture);
    if (config_.maps.normal) normal = add_image(images.normal, PixelMeaning::normals, "normals" + name, number);
    object_normals_.push_back(number);
    add(report_.encoding, clock.elapsed());
    measure(k, source, colour, normal);
  }

  void add_geometry(std::size_t k, const std::string& name) {
    CpuClock clock;
    const WideGeometry geometry =
        wide_geometry(draw(k, GeometrySampler(surfaces_[k], directions_[k], texture_of(k) / 4 + 1)));
    add(report_.resampling, clock.elapsed());
    clock = {};
    std::vector<char> bytes = encode_wide_png(geometry.image);
    report_.geometry_bytes += bytes.size();
    report_.geometry_samples += geometry.image.values.size() / 3;
    const Transform& model = mesh_.transform;
    geometry_images_.push_back({add_texture("geometry" + name, "image/png", std::move(bytes)),
                                model.origin + model.scale * geometry.origin, model.scale * geometry.step});
    add(report_.encoding, clock.elapsed());
    RawMesh surface;
    surface.positions = surfaces_[k].positions, surface.triangles = surfaces_[k].triangles;
    const MeshDistance d = compare_meshes(surface, remesh(geometry_of(geometry)), {error_points(k)}, scheduler_);
    const double rms = std::max(d.forward.rms, d.backward.rms) / diagonal();
    report_.geometry_rms += share(k) * rms * rms;
    report_.geometry_max = std::max({report_.geometry_max, d.forward.max / diagonal(), d.backward.max / diagonal()});
  }

  // Encodes an image, and returns it as a viewer has it after decoding.
  LinearImage add_image(const LinearImage& image, PixelMeaning meaning, const std::string& name,
                        std::uint32_t& number) {
    std::vector<char> bytes = encode_octahedral(image, meaning, config_.media_type, config_.quality);
    (meaning == PixelMeaning::colours ? report_.colour_bytes : report_.normal_bytes) += bytes.size();
    report_.pixels += std::uint64_t{image.size.width} * image.size.height;
    LinearImage decoded = decode_octahedral(bytes, meaning, config_.media_type);
    number = add_texture(name, config_.media_type, std::move(bytes));
    return decoded;
  }

  std::uint32_t add_texture(const std::string& name, const std::string& media_type, std::vector<char> bytes) {
    textures_.push_back({.name = name,
                         .media_type = media_type,
                         .wrap_u = TextureWrap::clamp,
                         .wrap_v = TextureWrap::clamp,
                         .bytes = std::move(bytes)});
    return static_cast<std::uint32_t>(textures_.size() - 1);
  }

  void measure(std::size_t k, const SurfaceSource& source, const LinearImage& colour, const LinearImage& normal) {
    const ImageErrorMeter meter(surfaces_[k], directions_[k], source, error_points(k));
    std::vector<ImageErrorSums> parts(chunk_count(meter.size(), error_grain));
    in_chunks(meter.size(), error_grain,
              [&](ChunkRange range) { parts[range.index] = meter.measure(colour, normal, range.begin, range.end); });
    ImageErrorSums sums;
    for (const ImageErrorSums& part : parts) sums.add(part);
    add_error(k, image_error(sums));
  }

  void add_error(std::size_t k, const ImageError& error) {
    if (config_.maps.colour) report_.colour_psnr += share(k) * error.colour_psnr;
    report_.normal_psnr += share(k) * error.normal_psnr;
  }

  ProgressiveMesh collapse() {
    config_.on_phase("collapsing");
    const CpuClock clock;
    RawMesh raw = assemble(mesh_, surfaces_, unfoldings_, places_);
    raw.materials = std::move(materials_);
    raw.textures = std::move(textures_);
    Repairs repairs;
    IndexedMesh whole = prepare_mesh(std::move(raw), repairs, scheduler_);
    ProgressiveMesh out = make_progressive(std::move(whole), config_.progressive, scheduler_, report_.progressive);
    if (config_.maps.normal) out.object_normals = std::move(object_normals_);
    out.geometry_images = std::move(geometry_images_);
    out.octahedral = true;
    report_.collapsing = clock.elapsed();
    return out;
  }

  [[nodiscard]] double share(std::size_t k) const {
    return whole_area_ > 0 ? areas_[k] / whole_area_ : 1.0 / static_cast<double>(areas_.size());
  }
  [[nodiscard]] double diagonal() const {  // of the input, normalised
    Box3f box;
    for (const Vec3f p : mesh_.positions) box.extend(p);
    return length(to_double(box.hi) - to_double(box.lo));
  }
  [[nodiscard]] std::uint64_t error_points(std::size_t k) const {
    return std::max<std::uint64_t>(static_cast<std::uint64_t>(share(k) * static_cast<double>(config_.error_points)),
                                   100);
  }
  // As many pixels per area as the largest component has, within a factor of two.
  [[nodiscard]] std::uint32_t texture_of(std::size_t k) const {
    const double largest = *std::max_element(areas_.begin(), areas_.end());
    std::uint32_t side = config_.texture;
    for (double area = areas_[k]; side > least_texture && !(area * 2 > largest); area *= 4) side /= 2;
    return side;
  }

  const IndexedMesh& mesh_;
  const SphericalConfig& config_;
  Scheduler& scheduler_;
  SphericalReport& report_;
  std::vector<Surface> surfaces_;
  std::vector<double> areas_;  // of what has a source, by surface
  double whole_area_ = 0;
  std::vector<std::vector<Vec3d>> directions_;
  std::vector<Unfolding> unfoldings_;
  std::shared_ptr<MeshSource> source_;  // while images are made
  std::vector<ImagePlace> places_;      // by surface
  std::vector<Material> materials_;
  std::vector<Texture> textures_;
  std::vector<std::uint32_t> object_normals_;
  std::vector<GeometryTexture> geometry_images_;
};

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
  if (config.texture < least_texture || (config.texture & (config.texture - 1)) != 0)
    throw InputError(describe("", "",
                              std::to_string(config.texture) + " pixels cannot be the side of an octahedral image",
                              "give a power of two from 16 on"));
  return Maker(mesh, config, scheduler, report).make();
}

}  // namespace lodestone
