// Octahedral images of a painted sphere and of real models, against what was painted and against plain loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/resample/image_error.h"
#include "core/spherical/resample/octahedral_codec.h"
#include "core/spherical/resample/resampler.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/load.h"
#include "parallel/spherical/map_to_sphere.h"
#include "tests/core/spherical/painted_sphere.h"
#include "tests/test_data.h"

namespace lodestone::spherical {
namespace {

SurfaceSource loaded(const test::PaintedSphere& sphere) {
  const auto source = std::make_shared<MeshSource>(sphere.mesh);
  for (std::size_t t = 0; t < source->texture_count(); ++t) source->load(t);
  return {source, sphere.surface, sphere.directions};
}

Vec3d value_at(const LinearImage& image, std::uint32_t x, std::uint32_t y) {
  const float* const v = &image.values[(std::size_t{y} * image.size.width + x) * image.channels];
  return {v[0], v[1], v[2]};
}

double largest(Vec3d v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Chart borders lie on the equator and on two meridians: not a trace of the black between the charts.
TEST(Resample, ColoursAreThePaintEverywhere) {
  const test::PaintedSphere sphere = test::painted_sphere(4);
  const SurfaceSource source = loaded(sphere);
  for (const std::uint32_t n : {16u, 64u, 150u})
    for (const std::uint32_t sides : {2u, 4u}) {
      const ResampledImages images =
          resample(sphere.surface, sphere.directions, source, {.size = n, .sides = sides, .normals = true});
      EXPECT_EQ(images.filled, 0u);
      const SampleGrid grid{n, SampleGrid::Placing::in_cells};
      double worst = 0, worst_normal = 0;
      for (std::uint32_t y = 1; y + 1 < n; ++y)
        for (std::uint32_t x = 1; x + 1 < n; ++x) {
          const Vec3d d = direction_of(grid.place(x, y));
          worst = std::max(worst, largest(value_at(images.colour, x, y) - test::waves(d)));
          worst_normal = std::max(worst_normal, largest(value_at(images.normal, x, y) - d));
        }
      EXPECT_LT(worst, 0.02 + 3.0 / (n * n)) << n;
      EXPECT_LT(worst_normal, 0.005 + 20.0 / (n * n)) << n;
    }
}

TEST(Resample, NormalsThatAreMissingAreThoseOfTheTriangles) {
  test::PaintedSphere sphere = test::painted_sphere(5);
  sphere.mesh.wedges.normal.clear();
  const ResampledImages images =
      resample(sphere.surface, sphere.directions, loaded(sphere), {.size = 64, .sides = 2, .normals = true});
  const SampleGrid grid{64, SampleGrid::Placing::in_cells};
  for (std::uint32_t y = 1; y < 63; ++y)
    for (std::uint32_t x = 1; x < 63; ++x)
      EXPECT_LT(largest(value_at(images.normal, x, y) - direction_of(grid.place(x, y))), 0.02);
}

TEST(Resample, ImagesAreSymmetricAlongTheirSides) {
  const test::PaintedSphere sphere = test::painted_sphere(3);
  const ResampledImages images =
      resample(sphere.surface, sphere.directions, loaded(sphere), {.size = 40, .sides = 2, .normals = true});
  for (const LinearImage* image : {&images.colour, &images.normal})
    for (std::uint32_t i = 0; i < 40; ++i)
      for (const std::uint32_t side : {0u, 39u}) {
        EXPECT_EQ(value_at(*image, i, side), value_at(*image, 39 - i, side));
        EXPECT_EQ(value_at(*image, side, i), value_at(*image, side, 39 - i));
      }
}

// Vertex colours: each sample by hand, from all triangles. Alpha counts where the material is not opaque.
void expect_means_of_samples(AlphaMode mode) {
  test::PaintedSphere sphere = test::painted_sphere(2);
  test::Numbers number(9);
  sphere.mesh.wedges.materials[0].texture = no_texture;
  sphere.mesh.wedges.materials[0].base_colour = {0.5f, 1, 0.25f, 1};
  sphere.mesh.wedges.materials[0].alpha_mode = mode;
  for (std::size_t w = 0; w < sphere.mesh.positions.size(); ++w) {
    const auto byte = [&] { return static_cast<std::uint8_t>(256 * number()); };
    sphere.mesh.wedges.colour.push_back({byte(), byte(), byte(), byte()});
  }
  const SurfaceSource source = loaded(sphere);
  constexpr std::uint32_t n = 24, sides = 4;
  const ResampledImages images =
      resample(sphere.surface, sphere.directions, source, {.size = n, .sides = sides, .normals = false});
  EXPECT_TRUE(images.normal.values.empty());
  const SampleGrid grid{n * sides, SampleGrid::Placing::in_cells};
  LinearImage expected{{n, n}, 4, std::vector<float>(n * n * 4)};
  for (std::uint32_t y = 0; y < n * sides; ++y)
    for (std::uint32_t x = 0; x < n * sides; ++x) {
      const Vec3d d = direction_of(grid.place(x, y));
      for (std::size_t t = 0; t < sphere.surface.triangles.size(); ++t) {
        std::array<double, 3> w{};
        for (std::size_t k = 0; k < 3; ++k)
          w[k] = dot(d, cross(sphere.directions[sphere.surface.triangles[t].v[(k + 1) % 3]],
                              sphere.directions[sphere.surface.triangles[t].v[(k + 2) % 3]]));
        if (std::ranges::min(w) < 0) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          const Rgba8 c = sphere.mesh.wedges.colour[sphere.mesh.triangles[t].v[k]];
          const double alpha = mode == AlphaMode::opaque ? 1 : c.a / 255.0;
          const double weight = w[k] / (w[0] + w[1] + w[2]) / (sides * sides) * alpha;
          float* const to = &expected.values[(std::size_t{y / sides} * n + x / sides) * 4];
          to[0] += static_cast<float>(weight * 0.5 * srgb_to_linear(c.r / 255.0));
          to[1] += static_cast<float>(weight * srgb_to_linear(c.g / 255.0));
          to[2] += static_cast<float>(weight * 0.25 * srgb_to_linear(c.b / 255.0));
          to[3] += static_cast<float>(weight);
        }
        break;
      }
    }
  average_border(expected);
  for (std::size_t i = 0; i < expected.values.size(); ++i)
    EXPECT_NEAR(images.colour.values[i], expected.values[i], 2e-5) << i;
}

TEST(Resample, PixelsAreTheMeanOfTheirSamples) { expect_means_of_samples(AlphaMode::blend); }

TEST(Resample, AlphaOfOpaqueMaterialsIsLeftOut) { expect_means_of_samples(AlphaMode::opaque); }

TEST(Resample, TilesMayBeDrawnInAnyOrder) {
  const test::PaintedSphere sphere = test::painted_sphere(3);
  const SurfaceSource source = loaded(sphere);
  const ResampleConfig config{.size = 150, .sides = 2, .normals = true};
  const ResampledImages forward = resample(sphere.surface, sphere.directions, source, config);
  Resampler resampler(sphere.surface, sphere.directions, source, config);
  const std::size_t half = sphere.directions.size() / 2;
  resampler.raster().place(half, sphere.directions.size());
  resampler.raster().place(0, half);
  resampler.raster().bound(0, sphere.surface.triangles.size());
  resampler.raster().sort();
  SampleTile room;
  for (std::size_t tile = resampler.raster().tile_count(); tile-- > 0;) resampler.draw(tile, room);
  const ResampledImages backward = resampler.finish();
  EXPECT_EQ(forward.colour.values, backward.colour.values);
  EXPECT_EQ(forward.normal.values, backward.normal.values);
}

TEST(Resample, HolesAreFilledFromAround) {
  test::PaintedSphere sphere = test::painted_sphere(4, [](Vec3d) { return Vec3d{0.5, 0.25, 0.75}; });
  for (std::size_t t = 100; t < 180; ++t) sphere.surface.source_triangle[t] = no_source;
  const ResampledImages images =
      resample(sphere.surface, sphere.directions, loaded(sphere), {.size = 64, .sides = 2, .normals = true});
  EXPECT_GT(images.filled, 80u);  // of some 160 pixels in the triangles, those at their border are not empty
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x)
      EXPECT_LT(largest(value_at(images.colour, x, y) - Vec3d{0.5, 0.25, 0.75}), 0.01);
}

TEST(Resample, NormalMapsOfBothSpacesBendTheNormal) {
  const Vec3d tilt = (1 / std::sqrt(1.25)) * Vec3d{0.5, 0, 1};
  for (const bool object_space : {true, false}) {
    test::PaintedSphere sphere = test::painted_sphere(4);
    const auto encoded = [](double v) { return static_cast<std::uint8_t>(std::lround(127.5 * (v + 1))); };
    sphere.mesh.wedges.textures.push_back(
        test::texture_of(test::atlas([&](Vec3d d) { return object_space ? -1.0 * d : tilt; }, encoded)));
    sphere.mesh.wedges.materials[0].normal_map = 1;
    const ResampledImages images =
        resample(sphere.surface, sphere.directions, loaded(sphere), {.size = 64, .sides = 2, .normals = true});
    const SampleGrid grid{64, SampleGrid::Placing::in_cells};
    for (std::uint32_t y = 1; y < 63; ++y)
      for (std::uint32_t x = 1; x < 63; ++x) {
        const Vec3d d = direction_of(grid.place(x, y)), n = value_at(images.normal, x, y);
        if (object_space) {
          EXPECT_LT(largest(n + d), 0.03);
          continue;
        }
        // Directions of u differ from chart to chart: pixels in the middle of one.
        if (std::min({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < 0.2) continue;
        EXPECT_NEAR(dot(n, d), tilt.z, 0.02);
        // u grows from the x axis to the y axis.
        const Vec3d along{d.x > 0 ? -1.0 : 1.0, d.y > 0 ? 1.0 : -1.0, 0};
        EXPECT_GT(dot(n, along) - dot(n, d) * dot(d, along), 0.2);
      }
  }
}

// Four points in one triangle, or each in its own, with a map of either space or without one.
TEST(Resample, NormalsOfFourPointsAreThoseOfEach) {
  test::Numbers number(12);
  for (const int map : {0, 1, 2}) {
    test::PaintedSphere sphere = test::painted_sphere(3);
    const auto encoded = [](double v) { return static_cast<std::uint8_t>(std::lround(127.5 * (v + 1))); };
    sphere.mesh.wedges.textures.push_back(test::texture_of(test::atlas(
        [&](Vec3d d) {
          return map == 1 ? -1.0 * d : Vec3d{0.6 * d.x, 0.6 * d.y, 0.8};
        },
        encoded)));
    if (map > 0) sphere.mesh.wedges.materials[0].normal_map = 1;
    const SurfaceSource source = loaded(sphere);
    for (int k = 0; k < 500; ++k) {
      std::array<SurfacePoint, 4> points;
      std::array<std::uint32_t, 4> triangles;
      Footprint4 footprints{};
      for (std::size_t i = 0; i < 4; ++i) {
        const auto count = static_cast<double>(sphere.surface.triangles.size());
        triangles[i] = k % 2 == 0 && i > 0 ? triangles[0] : static_cast<std::uint32_t>(count * number());
        const auto b = static_cast<float>(0.5 * number()), c = static_cast<float>(0.5 * number());
        points[i] = {triangles[i], {1 - b - c, b, c}};
        footprints.centre_u[i] = source.uv(points[i]).x, footprints.centre_v[i] = source.uv(points[i]).y;
      }
      TapList taps;
      std::array<SurfaceTaps, 4> ranges;
      source.add_taps(triangles, footprints, {.colour = false}, taps, ranges);
      std::array<Float4, 4> mapped, normals;
      for (std::size_t i = 0; i < 4; ++i)
        mapped[i] = source.mapped_normal(triangles[i], taps.between(ranges[i].normal_begin, ranges[i].normal_end));
      source.set_normals(points, mapped, normals);
      for (std::size_t i = 0; i < 4; ++i) {
        const Vec3f n = to_vec3f(normals[i]), expected = source.normal(points[i], footprints.lane(i));
        EXPECT_LT(length((1 / length(n)) * n - expected), 1e-6f) << map << ' ' << k;
      }
    }
  }
}

TEST(Resample, ErrorsAreMeasuredOnTheSurface) {
  const test::PaintedSphere sphere = test::painted_sphere(3, [](Vec3d) { return Vec3d{0.5, 0.5, 0.5}; });
  const SurfaceSource source = loaded(sphere);
  const ResampledImages images =
      resample(sphere.surface, sphere.directions, source, {.size = 64, .sides = 2, .normals = true});
  const ImageErrorMeter meter(sphere.surface, sphere.directions, source, 20'000);
  EXPECT_EQ(meter.size(), 20'000u);
  const ImageError same = measure_images(meter, images.colour, images.normal);
  EXPECT_EQ(same.samples, 20'000u);
  EXPECT_GT(same.colour_psnr, 80);
  EXPECT_GT(same.normal_psnr, 40);
  // A tenth of the range too bright, and normals turned by a right angle.
  LinearImage bright = images.colour, turned = images.normal;
  const double shade = linear_to_srgb(images.colour.values[0]);
  for (std::size_t i = 0; i < bright.values.size(); ++i)
    if (i % 4 != 3) bright.values[i] = static_cast<float>(srgb_to_linear(shade + 0.1));
  for (std::size_t i = 0; i < turned.values.size(); i += 3) {
    const Vec3f n{turned.values[i], turned.values[i + 1], turned.values[i + 2]};
    const Vec3f side = cross(n, std::abs(n.x) < 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0});
    const Vec3f unit = (1 / length(side)) * side;
    turned.values[i] = unit.x, turned.values[i + 1] = unit.y, turned.values[i + 2] = unit.z;
  }
  const ImageError off = measure_images(meter, bright, turned);
  EXPECT_NEAR(off.colour_psnr, 20, 0.1);
  EXPECT_NEAR(off.mean_angle, 90, 3);
  EXPECT_NEAR(off.normal_psnr, -10 * std::log10(0.5 / 3), 0.3);
}

TEST(Resample, WrongInputIsRefused) {
  test::PaintedSphere sphere = test::painted_sphere(1);
  const SurfaceSource source = loaded(sphere);
  for (const ResampleConfig& config :
       {ResampleConfig{.size = 0}, {.size = 16, .sides = 3}, {.size = 20'000, .sides = 2}, {.size = 16, .sides = 16}})
    EXPECT_THROW(Resampler(sphere.surface, sphere.directions, source, config), InputError);
  std::swap(sphere.surface.source_triangle[0], sphere.surface.source_triangle[5]);
  EXPECT_THROW(loaded(sphere), InputError);
  sphere = test::painted_sphere(1);
  sphere.mesh.wedges.textures[0].bytes.resize(100);
  EXPECT_THROW(loaded(sphere), InputError);
}

TEST(WideNormals, ComeBack) {
  test::Numbers number(6);
  LinearImage normals{{32, 32}, 3, {}};
  for (int i = 0; i < 32 * 32; ++i) {
    const Vec3d d = i < 6 ? Vec3d{i == 0   ? 1.0
                                  : i == 1 ? -1.0
                                           : 0,
                                  i == 2   ? 1.0
                                  : i == 3 ? -1.0
                                           : 0,
                                  i == 4   ? 1.0
                                  : i == 5 ? -1.0
                                           : 0}
                          : number.direction();
    for (const double v : {d.x, d.y, d.z}) normals.values.push_back(static_cast<float>(v));
  }
  const LinearImage back = normals_of(wide_normals(normals));
  for (std::size_t i = 0; i < normals.values.size(); ++i) EXPECT_NEAR(back.values[i], normals.values[i], 2e-5);
}

TEST(Resample, RealModelsKeepTheirTextures) {
  LODESTONE_MODEL_OR_SKIP(path, "textured/Gutenberg/Gutenberg.obj");
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  test::PaintedSphere model;
  model.mesh = prepare_mesh(load_mesh(path, *scheduler), repairs, *scheduler);
  model.surface = test::surface_of(model.mesh);
  SphereMapReport report;
  model.directions = map_to_sphere(model.surface.positions, model.surface.triangles, {}, *scheduler, report);
  const SurfaceSource source = loaded(model);
  const ResampledImages images =
      resample(model.surface, model.directions, source, {.size = 1024, .sides = 2, .normals = true});
  const PixelImage colour = symmetric_levels(images.colour, PixelMeaning::colours).front();
  const ImageError error =
      measure_images(ImageErrorMeter(model.surface, model.directions, source, 50'000),
                     to_linear(colour, PixelMeaning::colours), normals_of(wide_normals(images.normal)));
  RecordProperty("colour", std::to_string(error.colour_psnr));
  RecordProperty("normal", std::to_string(error.normal_psnr));
  EXPECT_GT(error.colour_psnr, 47);
  EXPECT_GT(error.normal_psnr, 45);
}

}  // namespace
}  // namespace lodestone::spherical
