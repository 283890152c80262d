#include "parallel/spherical/make_spherical.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/spherical/assemble.h"
#include "core/spherical/octahedron/cut_choice.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/resample/image_error.h"
#include "core/spherical/resample/mesh_source.h"
#include "core/spherical/resample/resampler.h"
#include "parallel/clean/prepare.h"

namespace lodestone {
namespace {

using namespace spherical;

constexpr std::uint32_t least_texture = 16;

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
    for (const double area : areas_) whole_area_ += area;
  }

  void map() {
    config_.on_phase("mapping to the sphere");
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      SphereMapReport part;
      directions_.push_back(
          map_to_sphere(surfaces_[k].positions, surfaces_[k].triangles, config_.map, scheduler_, part));
      report_.efficiency += share(k) * part.sums.efficiency();
      add(report_.map.collapse, part.collapse), add(report_.map.map, part.map), add(report_.map.measure, part.measure);
      report_.map.sums.add(part.sums);
      report_.map.levels = std::max(report_.map.levels, part.levels);
      report_.map.waves += part.waves;
      report_.map.colours = std::max(report_.map.colours, part.colours);
      report_.map.by_connectivity += part.by_connectivity;
      report_.map.attempts += part.attempts;
    }
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
    const CutChoice choice = choose_cut(measure);
    if (!config_.choose_cut) return choice.before;
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
    for (std::size_t k = 0; k < surfaces_.size(); ++k) add_component(k);
    source_.reset();
  }

  void add_component(std::size_t k) {
    CpuClock clock;
    const SurfaceSource source(source_, surfaces_[k], directions_[k]);
    const ResampledImages images = draw(k, source);
    add(report_.resampling, clock.elapsed());
    clock = {};
    std::string name;  // what tells the images of several components apart
    if (surfaces_.size() > 1) name.append(" ").append(std::to_string(k + 1));
    Material material{.name = "octahedral" + name};
    const LinearImage colour = add_image(images.colour, PixelMeaning::colours, "colour" + name, material.texture);
    std::uint32_t number = no_texture;
    LinearImage normal;
    if (config_.normals) normal = add_image(images.normal, PixelMeaning::normals, "normals" + name, number);
    object_normals_.push_back(number);
    materials_.push_back(std::move(material));
    add(report_.encoding, clock.elapsed());
    measure(k, source, colour, normal);
  }

  ResampledImages draw(std::size_t k, const SurfaceSource& source) {
    Resampler resampler(surfaces_[k], directions_[k], source, {.size = texture_of(k), .normals = config_.normals});
    SphereRaster& raster = resampler.raster();
    in_chunks(directions_[k].size(), 4096, [&](ChunkRange range) { raster.place(range.begin, range.end); });
    in_chunks(surfaces_[k].triangles.size(), 4096, [&](ChunkRange range) { raster.bound(range.begin, range.end); });
    raster.sort();
    std::vector<SampleTile> rooms(static_cast<std::size_t>(scheduler_.workers()));
    in_chunks(raster.tile_count(), 1, [&](ChunkRange range) {
      resampler.draw(range.begin, rooms[static_cast<std::size_t>(scheduler_.worker_index())]);
    });
    return resampler.finish();
  }

  // Encodes an image, and returns it as a viewer has it after decoding.
  LinearImage add_image(const LinearImage& image, PixelMeaning meaning, const std::string& name,
                        std::uint32_t& number) {
    number = static_cast<std::uint32_t>(textures_.size());
    PixelImage pixels = to_pixels(image, meaning);
    if (meaning == PixelMeaning::colours && is_opaque(pixels)) drop_alpha(pixels);
    std::vector<char> bytes = encode_image(pixels, config_.media_type, config_.quality);
    (meaning == PixelMeaning::colours ? report_.colour_bytes : report_.normal_bytes) += bytes.size();
    report_.pixels += std::uint64_t{pixels.size.width} * pixels.size.height;
    PixelImage decoded = decode_image(bytes, config_.media_type);
    copy_border(std::span(decoded.pixels), decoded.size.width, decoded.channels);
    textures_.push_back({.name = name,
                         .media_type = config_.media_type,
                         .wrap_u = TextureWrap::clamp,
                         .wrap_v = TextureWrap::clamp,
                         .bytes = std::move(bytes)});
    return to_linear(decoded, meaning);
  }

  [[nodiscard]] static bool is_opaque(const PixelImage& image) {
    for (std::size_t i = 3; i < image.pixels.size(); i += 4)
      if (image.pixels[i] != 255) return false;
    return image.channels == 4;
  }
  static void drop_alpha(PixelImage& image) {
    for (std::size_t p = 0; 4 * p < image.pixels.size(); ++p)
      std::copy_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(4 * p), 3,
                  image.pixels.begin() + static_cast<std::ptrdiff_t>(3 * p));
    image.pixels.resize(image.pixels.size() / 4 * 3);
    image.channels = 3;
  }

  void measure(std::size_t k, const SurfaceSource& source, const LinearImage& colour, const LinearImage& normal) {
    const auto points = static_cast<std::uint64_t>(share(k) * static_cast<double>(config_.error_points));
    const ImageErrorMeter meter(surfaces_[k], directions_[k], source, std::max<std::uint64_t>(points, 100));
    std::vector<ImageErrorSums> parts(chunk_count(meter.size(), error_grain));
    in_chunks(meter.size(), error_grain,
              [&](ChunkRange range) { parts[range.index] = meter.measure(colour, normal, range.begin, range.end); });
    ImageErrorSums sums;
    for (const ImageErrorSums& part : parts) sums.add(part);
    const ImageError error = image_error(sums);
    report_.colour_psnr += share(k) * error.colour_psnr;
    report_.normal_psnr += share(k) * error.normal_psnr;
  }

  ProgressiveMesh collapse() {
    config_.on_phase("collapsing");
    const CpuClock clock;
    RawMesh raw = assemble(mesh_, surfaces_, unfoldings_);
    raw.materials = std::move(materials_);
    raw.textures = std::move(textures_);
    Repairs repairs;
    IndexedMesh whole = prepare_mesh(std::move(raw), repairs, scheduler_);
    ProgressiveMesh out = make_progressive(std::move(whole), config_.progressive, scheduler_, report_.progressive);
    if (config_.normals) out.object_normals = std::move(object_normals_);
    report_.collapsing = clock.elapsed();
    return out;
  }

  [[nodiscard]] double share(std::size_t k) const {
    return whole_area_ > 0 ? areas_[k] / whole_area_ : 1.0 / static_cast<double>(areas_.size());
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
  std::vector<Material> materials_;
  std::vector<Texture> textures_;
  std::vector<std::uint32_t> object_normals_;
};

}  // namespace

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
