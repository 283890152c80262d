#include "experiments/metrics/geometry/texture_sliding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/progressive/mesh/level.h"
#include "core/spatial/mesh_distance.h"
#include "core/spatial/point_triangle.h"
#include "core/spatial/surface_samples.h"
#include "core/texture/image_codec.h"
#include "experiments/metrics/geometry/level_on_texture.h"

namespace lodestone {
namespace {

double doubled_area(const std::array<Vec3d, 3>& p) { return length(cross(p[1] - p[0], p[2] - p[0])); }

// Texels of the image of each material.
std::vector<double> texels_of(const ProgressiveMesh& mesh, const SlidingConfig& config) {
  const double plain = static_cast<double>(config.texture_size) * config.texture_size;
  std::vector<double> out(std::max<std::size_t>(mesh.wedges.materials.size(), 1), plain);
  for (std::size_t m = 0; m < mesh.wedges.materials.size(); ++m) {
    const std::uint32_t texture = mesh.wedges.materials[m].texture;
    if (texture >= mesh.wedges.textures.size()) continue;
    try {
      const PixelSize size = image_size(mesh.wedges.textures[texture].bytes, mesh.wedges.textures[texture].media_type);
      out[m] = static_cast<double>(size.width) * size.height;
    } catch (const InputError&) {  // an image that is damaged or foreign counts as none
    } catch (const UnsupportedError&) {
    }
  }
  return out;
}

class Sums {
 public:
  // A distance; the widths of a texel of the image, and of a pixel.
  void add(double distance, double texel, double pixel) {
    ++points_;
    if (!(distance < std::numeric_limits<double>::infinity()) || !(texel > 0)) {
      ++left_out_;
      return;
    }
    const double drawn = distance / std::max(texel, pixel), of_image = distance / texel;
    sum_ += drawn, image_sum_ += of_image;
    out_.max = std::max(out_.max, drawn), out_.image_max = std::max(out_.image_max, of_image);
  }

  [[nodiscard]] TextureSliding result() const {
    TextureSliding out = out_;
    const auto counted = static_cast<double>(points_ - left_out_);
    if (points_ > left_out_) out.mean = sum_ / counted, out.image_mean = image_sum_ / counted;
    out.points = points_;
    out.left_out = points_ > 0 ? static_cast<double>(left_out_) / static_cast<double>(points_) : 0;
    return out;
  }

 private:
  TextureSliding out_;
  double sum_ = 0, image_sum_ = 0;
  std::uint64_t points_ = 0, left_out_ = 0;
};

TextureSliding larger(const TextureSliding& a, const TextureSliding& b) {
  return {std::max(a.mean, b.mean),           std::max(a.max, b.max), std::max(a.image_mean, b.image_mean),
          std::max(a.image_max, b.image_max), a.points + b.points,    std::max(a.left_out, b.left_out)};
}

}  // namespace

TextureSliding texture_sliding(const ProgressiveMesh& mesh, std::uint32_t coarse, std::uint32_t fine,
                               const SlidingConfig& config) {
  if (mesh.wedges.uv.empty()) throw InputError(describe("", "", "the model has no texture coordinates"));
  const LevelFinder levels(mesh);
  const std::vector<Triangle> from = levels.compute_level(fine), to = levels.compute_level(coarse);
  if (from.empty() || to.empty()) return {};
  std::vector<Vec3d> positions;
  for (std::uint32_t v = 0; v < fine; ++v) positions.push_back(to_double(mesh.positions[v]));
  const SurfaceSamples samples(positions, from, config.points);
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> at;
  samples.take(samples.vertices(), samples.size(), points, &at);
  const LevelOnTexture level(mesh, to);
  const std::vector<double> texels = texels_of(mesh, config);
  const double pixel = levels.error_of(coarse);
  Sums sums;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Triangle& t = from[at[k]];
    const std::array<Vec3d, 3> corner{positions[t.v[0]], positions[t.v[1]], positions[t.v[2]]};
    const std::array<Vec3d, 3> uv = corners_on_texture(mesh, t);
    const std::size_t material = std::min(static_cast<std::size_t>(uv[0].z), texels.size() - 1);
    const double covered = doubled_area(uv) * texels[material];
    const double texel = covered > 0 ? std::sqrt(doubled_area(corner) / covered) : 0;
    const std::array<double, 3> w = barycentric(points[k], corner[0], corner[1], corner[2]);
    sums.add(level.distance(points[k], w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2]), texel, pixel);
  }
  return sums.result();
}

SlidingOfLevels texture_sliding_of_levels(const ProgressiveMesh& mesh, std::uint32_t levels) {
  const LevelFinder finder(mesh);
  SlidingOfLevels out;
  std::uint32_t want = mesh.vertex_count();
  for (std::uint32_t k = 0; k < levels && want > mesh.base_vertices; ++k) {
    want /= 4;
    const std::uint32_t coarse = finder.vertices_for(want), next = finder.vertices_for(coarse + coarse / 4);
    out.whole = larger(out.whole, texture_sliding(mesh, coarse, mesh.vertex_count()));
    out.step = larger(out.step, texture_sliding(mesh, coarse, next));
  }
  return out;
}

}  // namespace lodestone
