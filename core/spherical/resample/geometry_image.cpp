#include "core/spherical/resample/geometry_image.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/spherical/octahedron/octahedral_image.h"

namespace lodestone::spherical {
namespace {

std::uint32_t checked(std::uint32_t n) {
  if (n >= 3 && n <= 32767 && n % 2 == 1) return n;
  throw InputError(describe("", "geometry image", "has " + std::to_string(n) + " samples along a side",
                            "give an odd number from 3 to 32767"));
}

}  // namespace

GeometrySampler::GeometrySampler(const Surface& surface, std::span<const Vec3d> directions, std::uint32_t n)
    : surface_(surface),
      raster_(surface.triangles, directions, {checked(n), SampleGrid::Placing::on_sides}),
      image_{n, std::vector<Vec3d>(std::size_t{n} * n)},
      covered_(image_.positions.size()) {}

void GeometrySampler::draw(std::size_t tile, SampleTile& room) {
  raster_.cover(tile, room);
  for (std::size_t y = 0; y < room.height; ++y)
    for (std::size_t x = 0; x < room.width; ++x) {
      const std::size_t i = y * SampleTile::side + x, sample = (room.y + y) * image_.n + (room.x + x);
      if (room.triangle[i] == no_triangle) continue;
      const auto& v = surface_.triangles[room.triangle[i]].v;
      // Weights of single precision sum up to 1 only roughly.
      const double b = room.weight[1][i], c = room.weight[2][i];
      const Vec3d p = surface_.positions[v[0]];
      image_.positions[sample] = p + (b * (surface_.positions[v[1]] - p) + c * (surface_.positions[v[2]] - p));
      covered_[sample] = 1;
    }
}

GeometryImage GeometrySampler::finish() {
  if (const auto missing = std::ranges::count(covered_, 0); missing > 0)
    throw InputError(describe("", "geometry image", std::to_string(missing) + " samples are on no triangle",
                              "give a closed mesh whose map covers the sphere"));
  copy_border(std::span(image_.positions), image_.n, 1);
  return std::move(image_);
}

GeometryImage sample_geometry(const Surface& surface, std::span<const Vec3d> directions, std::uint32_t n) {
  GeometrySampler sampler(surface, directions, n);
  sampler.raster().prepare();
  SampleTile room;
  for (std::size_t tile = 0; tile < sampler.raster().tile_count(); ++tile) sampler.draw(tile, room);
  return sampler.finish();
}

WideGeometry wide_geometry(const GeometryImage& image) {
  Vec3d low = image.positions.front(), high = low;
  for (const Vec3d p : image.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double longest = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  WideGeometry wide{{{image.n, image.n}, {}}, low, longest > 0 ? longest / 65535 : 1};
  const auto code = [&](double v, double from) {
    return static_cast<std::uint16_t>(std::min(std::floor((v - from) / wide.step + 0.5), 65535.0));
  };
  for (const Vec3d p : image.positions)
    wide.image.values.insert(wide.image.values.end(), {code(p.x, low.x), code(p.y, low.y), code(p.z, low.z)});
  return wide;
}

GeometryImage geometry_of(const WideGeometry& wide) {
  GeometryImage image{wide.image.size.width, {}};
  for (std::size_t i = 0; i < wide.image.values.size(); i += 3) {
    const Vec3d steps{static_cast<double>(wide.image.values[i]), static_cast<double>(wide.image.values[i + 1]),
                      static_cast<double>(wide.image.values[i + 2])};
    image.positions.push_back(wide.origin + wide.step * steps);
  }
  return image;
}

RawMesh remesh(const GeometryImage& image) {
  const std::uint32_t n = image.n, last = n - 1;
  RawMesh mesh;
  std::vector<std::uint32_t> vertex(image.positions.size());
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      // The copy that copy_border() takes for the first.
      std::uint32_t i = x, j = y;
      if (y == 0 || y == last) i = std::min(x, last - x);
      if (x == 0 || x == last) j = std::min(y, last - y);
      if (i == 0 && (j == 0 || j == last)) i = j = 0;
      if (i == x && j == y) {
        vertex[std::size_t{y} * n + x] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(image.positions[std::size_t{y} * n + x]);
      } else {
        vertex[std::size_t{y} * n + x] = vertex[std::size_t{j} * n + i];
      }
    }
  // Both squares at an end of the cut would have the same diagonal between its neighbours: they have those through it.
  const auto ends_cut = [last](std::uint32_t x, std::uint32_t y) {
    return (2 * x == last && (y == 0 || y == last)) || (2 * y == last && (x == 0 || x == last));
  };
  for (std::uint32_t y = 0; y < last; ++y)
    for (std::uint32_t x = 0; x < last; ++x) {
      const std::size_t at = std::size_t{y} * n + x;
      const std::uint32_t a = vertex[at], b = vertex[at + 1], c = vertex[at + n + 1], d = vertex[at + n];
      const auto distance = [&](std::uint32_t v, std::uint32_t w) {
        return length(mesh.positions[v] - mesh.positions[w]);
      };
      const bool along = ends_cut(x, y) || ends_cut(x + 1, y + 1) ||
                         (!ends_cut(x + 1, y) && !ends_cut(x, y + 1) && distance(a, c) <= distance(b, d));
      const std::array<Triangle, 2> pair = along ? std::array<Triangle, 2>{{{{a, d, c}}, {{a, c, b}}}}
                                                 : std::array<Triangle, 2>{{{{a, d, b}}, {{b, d, c}}}};
      mesh.triangles.insert(mesh.triangles.end(), pair.begin(), pair.end());
    }
  return mesh;
}

}  // namespace lodestone::spherical
