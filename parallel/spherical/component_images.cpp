#include "parallel/spherical/component_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/math/vec3.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/resample/geometry_image.h"
#include "core/spherical/resample/image_error.h"
#include "core/spherical/resample/mesh_source.h"
#include "core/spherical/resample/octahedral_codec.h"
#include "core/spherical/resample/resampler.h"
#include "parallel/mesh/compare.h"
#include "parallel/spherical/carried_surface.h"

namespace lodestone {
namespace {

using namespace spherical;

constexpr double least_share = 1.0 / 256;            // of the area, for images of its own
constexpr std::uint64_t pixels_for_triangle = 4096;  // at most, where there are no textures

class ImageMaker {
 public:
  ImageMaker(const MappedComponents& components, const SphericalConfig& config, Scheduler& scheduler,
             SphericalReport& report)
      : mesh_(components.mesh),
        surfaces_(components.surfaces),
        directions_(components.directions),
        shares_(components.shares),
        plain_(components.plain),
        config_(config),
        scheduler_(scheduler),
        report_(report) {}

  ComponentImages make() {
    const std::vector<std::size_t> small = small_components();
    for (std::size_t k = 0, next = 0; k < surfaces_.size(); ++k) {
      if (next < small.size() && small[next] == k && ++next > 0) continue;
      // Images of several components are told apart by their numbers.
      std::string name;
      if (surfaces_.size() > 1) name.append(" ").append(std::to_string(k + 1));
      out_.places[k].material = static_cast<std::uint32_t>(out_.materials.size());
      out_.places[k].side = texture_of(k);
      const Wanted wanted = add_material("octahedral" + name, {&k, 1}, {});
      add_component(k, name, wanted);
      if (config_.maps.geometry) add_geometry(k, name);
    }
    if (!small.empty()) add_atlas(small);
    if (!plain_.triangles.empty()) add_plain();
    sources_ = {};
    report_.geometry_rms = std::sqrt(report_.geometry_rms);
    if (colour_share_ > 0) report_.colour_psnr /= colour_share_;
    return std::move(out_);
  }

 private:
  template <class Body>
  void in_chunks(std::size_t count, std::size_t grain, const Body& body) {
    scheduler_.for_chunks(count, grain, [&](ChunkRange range) { body(range); });
  }

  // The mesh with its textures, which are decoded when the first component needs them.
  const std::shared_ptr<MeshSource>& source(SourceLook look) {
    std::shared_ptr<MeshSource>& source = sources_[static_cast<std::size_t>(look)];
    if (source) return source;
    const CpuClock clock;
    source = std::make_shared<MeshSource>(mesh_, look);
    in_chunks(source->texture_count(), 1, [&](ChunkRange range) { source->load(range.begin); });
    report_.resampling += clock.elapsed();
    return source;
  }

  // Images of a material.
  struct Wanted {
    bool colours = false, normals = false;
    MaterialMaps others;
    [[nodiscard]] bool looks() const { return colours || normals; }
  };

  void add_used(const Surface& surface, std::set<std::uint32_t>& used) const {
    for (const std::uint32_t t : surface.source_triangle)
      if (t != no_source) used.insert(material_of(mesh_, TriangleId(t)));
  }

  // For components that share their images.
  Wanted add_material(std::string name, std::span<const std::size_t> components, OctahedralLayout layout) {
    std::set<std::uint32_t> used;
    for (const std::size_t k : components) add_used(surfaces_[k], used);
    Wanted wanted;
    if (config_.maps.colour) wanted.others = material_maps(mesh_, used);
    out_.materials.push_back(carried_surface(mesh_, used, wanted.others, report_.left_out_features));
    out_.materials.back().name = std::move(name);
    out_.octahedral.emplace_back(std::move(layout));
    const std::optional<std::array<float, 4>> plain = plain_colour(used);
    if (plain) out_.materials.back().base_colour = *plain;
    wanted.colours = config_.maps.colour && !plain, wanted.normals = config_.maps.normal;
    return wanted;
  }

  // The colour of all that these materials are on, if it is the same everywhere.
  [[nodiscard]] std::optional<std::array<float, 4>> plain_colour(const std::set<std::uint32_t>& materials) const {
    const WedgeAttributes& wedges = mesh_.wedges;
    if (!wedges.colour.empty()) return std::nullopt;
    std::set<std::array<float, 4>> colours;
    for (const std::uint32_t number : materials) {
      const Material none, &m = number == no_material ? none : wedges.materials[number];
      if (m.texture != no_texture && !wedges.uv.empty()) return std::nullopt;
      colours.insert(m.base_colour);
    }
    return colours.size() == 1 ? std::optional(*colours.begin()) : std::nullopt;
  }

  // Those that share their images. A geometry image is that of one component.
  std::vector<std::size_t> small_components() {
    out_.places.resize(surfaces_.size());
    std::vector<std::size_t> small;
    for (std::size_t k = 0; k < surfaces_.size() && !config_.maps.geometry; ++k)
      if (share(k) < least_share || side_for_detail(k) < config_.texture / 2) small.push_back(k);
    if (small.size() < 2) small.clear();
    return small;
  }

  void add_atlas(const std::vector<std::size_t>& small) {
    CpuClock clock;
    std::vector<std::uint32_t> sides;
    for (const std::size_t k : small) sides.push_back(texture_of(k));
    const SquareAtlas atlas = pack_squares(std::move(sides), config_.texture);
    const Wanted wanted = add_material("octahedral atlas", small, layout_of(atlas));
    const bool colours = wanted.colours, normals = wanted.normals;
    const auto material = static_cast<std::uint32_t>(out_.materials.size() - 1);
    LinearImage colour = blank_image(atlas, colours ? 4 : 0), normal = blank_image(atlas, normals ? 3 : 0);
    if (wanted.looks()) (void)source(SourceLook::colours_and_normals);
    in_chunks(small.size(), 1, [&](ChunkRange range) {
      const std::size_t k = small[range.begin];
      const AtlasSquare& square = atlas.squares[range.begin];
      out_.places[k] = place_in(atlas, range.begin, material);
      if (!wanted.looks()) return;
      const ResampledImages images = resampled(k, SourceLook::colours_and_normals,
                                               {.size = square.image(), .colours = colours, .normals = normals});
      if (colours) paste(images.colour, square, colour);
      if (normals) paste(images.normal, square, normal);
    });
    fill_rest(atlas, colour), fill_rest(atlas, normal);
    report_.resampling += clock.elapsed();
    clock = {};
    std::uint32_t number = no_texture;
    if (colours) colour = add_image(colour, PixelMeaning::colours, "colour atlas", out_.materials.back().texture);
    if (normals) normal = add_image(normal, PixelMeaning::normals, "normals atlas", number);
    out_.object_normals.push_back(number);
    report_.encoding += clock.elapsed();
    if (wanted.looks()) measure_atlas(small, atlas, colour, normal);
    add_others(wanted.others, " atlas", [&](SourceLook look) {
      LinearImage image = blank_image(atlas, 4);
      in_chunks(small.size(), 1, [&](ChunkRange range) {
        const AtlasSquare& square = atlas.squares[range.begin];
        const ResampleConfig config{.size = square.image(), .normals = false};
        paste(resampled(small[range.begin], look, config).colour, square, image);
      });
      fill_rest(atlas, image);
      return image;
    });
  }

  // They have one material at most.
  void add_plain() {
    std::set<std::uint32_t> used;
    add_used(plain_, used);
    ImagePlace& place = out_.places.emplace_back();
    place.material = static_cast<std::uint32_t>(out_.materials.size());
    out_.materials.push_back(carried_surface(mesh_, used, {}, report_.left_out_features));
    out_.materials.back().name = "plain";
    if (const auto colour = plain_colour(used)) out_.materials.back().base_colour = *colour;
    out_.octahedral.emplace_back();
    if (config_.maps.normal) out_.object_normals.push_back(no_texture);
  }

  // By one worker; the source is loaded.
  [[nodiscard]] ResampledImages resampled(std::size_t k, SourceLook look, const ResampleConfig& config) const {
    const SurfaceSource source(sources_[static_cast<std::size_t>(look)], surfaces_[k], directions_[k]);
    return resample(surfaces_[k], directions_[k], source, config);
  }

  // Images beside colours and normals, as glTF has them: occlusion in red, roughness in green, metal in blue of one.
  template <class Draw>
  void add_others(const MaterialMaps& wanted, const std::string& name, const Draw& draw) {
    Material& material = out_.materials.back();
    const auto add = [&](SourceLook look, const auto& encode) {
      (void)source(look);
      CpuClock clock;
      const LinearImage image = draw(look);
      report_.resampling += clock.elapsed();
      clock = {};
      encode(image);
      report_.encoding += clock.elapsed();
    };
    std::optional<LinearImage> surface;
    const auto take = [&](std::size_t first, std::size_t end) {
      return [&surface, first, end](const LinearImage& image) {
        if (!surface) surface = {image.size, 3, std::vector<float>(image.values.size() / 4 * 3, 1)};
        for (std::size_t p = 0; 4 * p < image.values.size(); ++p)
          for (std::size_t c = first; c < end; ++c) surface->values[3 * p + c] = image.values[4 * p + c];
      };
    };
    if (wanted.occlusion) add(SourceLook::occlusion, take(0, 1));
    if (wanted.metal_and_roughness) add(SourceLook::metal_and_roughness, take(1, 3));
    if (surface) {
      const std::uint32_t number = add_other(*surface, PixelMeaning::values, "surface" + name);
      if (wanted.occlusion) material.occlusion.texture = number;
      if (wanted.metal_and_roughness) material.metallic_roughness.texture = number;
    }
    if (wanted.emission)
      add(SourceLook::emission, [&](const LinearImage& image) {
        material.emissive_map.texture = add_other(image, PixelMeaning::colours, "light" + name);
      });
  }

  // WebP with loss halves the resolution of colours, which in values would blur one by another.
  std::uint32_t add_other(const LinearImage& image, PixelMeaning meaning, const std::string& name) {
    const bool is_lossy_webp = config_.media_type == "image/webp" && config_.quality < 100;
    const std::string type =
        is_lossy_webp && meaning == PixelMeaning::values ? std::string("image/jpeg") : config_.media_type;
    std::vector<char> bytes = encode_octahedral(image, meaning, type, config_.quality);
    report_.material_bytes += bytes.size();
    return add_texture(name, type, std::move(bytes));
  }

  void measure_atlas(const std::vector<std::size_t>& small, const SquareAtlas& atlas, const LinearImage& colour,
                     const LinearImage& normal) {
    std::vector<ImageError> errors(small.size());
    in_chunks(small.size(), 1, [&](ChunkRange range) {
      const std::size_t k = small[range.begin];
      const SurfaceSource source(sources_.front(), surfaces_[k], directions_[k]);
      const ImageErrorMeter meter(surfaces_[k], directions_[k], source, error_points(k));
      const auto own = [&](const LinearImage& image) {
        return image.values.empty() ? LinearImage{} : cut_out(image, atlas.squares[range.begin]);
      };
      errors[range.begin] = measure_images(meter, own(colour), own(normal));
    });
    for (std::size_t i = 0; i < small.size(); ++i) add_error(small[i], errors[i], !colour.values.empty());
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

  void add_component(std::size_t k, const std::string& name, const Wanted& wanted) {
    if (wanted.looks())
      add_looks(k, name, {.size = texture_of(k), .colours = wanted.colours, .normals = wanted.normals});
    add_others(wanted.others, name, [&](SourceLook look) {
      const SurfaceSource from(source(look), surfaces_[k], directions_[k]);
      return draw(k, Resampler(surfaces_[k], directions_[k], from, {.size = texture_of(k), .normals = false})).colour;
    });
  }

  void add_looks(std::size_t k, const std::string& name, const ResampleConfig& config) {
    const std::shared_ptr<MeshSource>& looks = source(SourceLook::colours_and_normals);
    CpuClock clock;
    const SurfaceSource source(looks, surfaces_[k], directions_[k]);
    const ResampledImages images = draw(k, Resampler(surfaces_[k], directions_[k], source, config));
    report_.resampling += clock.elapsed();
    clock = {};
    std::uint32_t number = no_texture;
    LinearImage colour, normal;
    if (config.colours)
      colour = add_image(images.colour, PixelMeaning::colours, "colour" + name, out_.materials.back().texture);
    if (config.normals) normal = add_image(images.normal, PixelMeaning::normals, "normals" + name, number);
    out_.object_normals.push_back(number);
    report_.encoding += clock.elapsed();
    measure(k, source, colour, normal);
  }

  void add_geometry(std::size_t k, const std::string& name) {
    CpuClock clock;
    const WideGeometry geometry =
        wide_geometry(draw(k, GeometrySampler(surfaces_[k], directions_[k], texture_of(k) / 4 + 1)));
    report_.resampling += clock.elapsed();
    clock = {};
    std::vector<char> bytes = encode_wide_png(geometry.image);
    report_.geometry_bytes += bytes.size();
    report_.geometry_samples += geometry.image.values.size() / 3;
    const Transform& model = mesh_.transform;
    out_.geometry_images.push_back({add_texture("geometry" + name, "image/png", std::move(bytes)),
                                    model.origin + model.scale * geometry.origin, model.scale * geometry.step});
    report_.encoding += clock.elapsed();
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
    LinearImage decoded = decode_octahedral(bytes, meaning, config_.media_type, *out_.octahedral.back());
    number = add_texture(name, config_.media_type, std::move(bytes));
    return decoded;
  }

  std::uint32_t add_texture(const std::string& name, const std::string& media_type, std::vector<char> bytes) {
    out_.textures.push_back({.name = name,
                             .media_type = media_type,
                             .wrap_u = TextureWrap::clamp,
                             .wrap_v = TextureWrap::clamp,
                             .bytes = std::move(bytes)});
    return static_cast<std::uint32_t>(out_.textures.size() - 1);
  }

  void measure(std::size_t k, const SurfaceSource& source, const LinearImage& colour, const LinearImage& normal) {
    const ImageErrorMeter meter(surfaces_[k], directions_[k], source, error_points(k));
    std::vector<ImageErrorSums> parts(chunk_count(meter.size(), error_grain));
    in_chunks(meter.size(), error_grain,
              [&](ChunkRange range) { parts[range.index] = meter.measure(colour, normal, range.begin, range.end); });
    ImageErrorSums sums;
    for (const ImageErrorSums& part : parts) sums.add(part);
    add_error(k, image_error(sums), !colour.values.empty());
  }

  void add_error(std::size_t k, const ImageError& error, bool has_colours) {
    if (has_colours) report_.colour_psnr += share(k) * error.colour_psnr, colour_share_ += share(k);
    report_.normal_psnr += share(k) * error.normal_psnr;
  }

  [[nodiscard]] double share(std::size_t k) const { return shares_[k]; }
  [[nodiscard]] double diagonal() const {  // of the input, normalised
    Box3f box;
    for (const Vec3f p : mesh_.positions) box.extend(p);
    return length(to_double(box.hi) - to_double(box.lo));
  }
  [[nodiscard]] std::uint64_t error_points(std::size_t k) const {
    return std::max<std::uint64_t>(static_cast<std::uint64_t>(share(k) * static_cast<double>(config_.error_points)),
                                   100);
  }
  // Without textures there is nothing to show but normals, and colours at corners: few triangles are worth few pixels.
  [[nodiscard]] std::uint32_t side_for_detail(std::size_t k) const {
    std::uint32_t side = config_.texture;
    if (!mesh_.wedges.textures.empty()) return side;
    const std::uint64_t most_pixels = pixels_for_triangle * surfaces_[k].triangles.size();
    while (side > least_octahedral_side && std::uint64_t{side} * side > most_pixels) side /= 2;
    return side;
  }
  // As many pixels per area as the largest component has, within a factor of two, or as its detail is worth.
  [[nodiscard]] std::uint32_t texture_of(std::size_t k) const {
    const double largest = *std::ranges::max_element(shares_);
    std::uint32_t side = config_.texture;
    for (double area = share(k); side > least_octahedral_side && !(area * 2 > largest); area *= 4) side /= 2;
    return std::min(side, side_for_detail(k));
  }

  const IndexedMesh& mesh_;
  std::span<const Surface> surfaces_;
  std::span<const std::vector<Vec3d>> directions_;
  std::span<const double> shares_;
  const Surface& plain_;
  const SphericalConfig& config_;
  Scheduler& scheduler_;
  SphericalReport& report_;
  std::array<std::shared_ptr<MeshSource>, 4> sources_;  // by SourceLook; those that have been needed
  ComponentImages out_;
  double colour_share_ = 0;  // of the area: components with an image of colours
};

}  // namespace

ComponentImages make_component_images(const MappedComponents& components, const SphericalConfig& config,
                                      Scheduler& scheduler, SphericalReport& report) {
  return ImageMaker(components, config, scheduler, report).make();
}

}  // namespace lodestone
