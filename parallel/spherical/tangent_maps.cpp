#include "parallel/spherical/tangent_maps.h"

#include <algorithm>
#include <vector>

#include "core/spatial/mesh_distance.h"
#include "core/spatial/point_triangle.h"
#include "core/spatial/surface_samples.h"
#include "core/spherical/resample/octahedral_codec.h"
#include "core/spherical/resample/tangent_normals.h"

namespace lodestone {
namespace {

using namespace spherical;

constexpr std::size_t measured_grain = 16384;  // points of one partial sum
constexpr double worth = 0.75;                 // share of the angle without maps that is left with them, at most

class TangentMapper {
 public:
  TangentMapper(ProgressiveMesh& mesh, const TangentMapConfig& config, Scheduler& scheduler, TangentMapReport& report)
      : mesh_(mesh), config_(config), scheduler_(scheduler), report_(report), parts_(mesh.object_normals.size()) {}

  void run() {
    mesh_.tangents = tangents_of(mesh_.triangles, mesh_.positions, mesh_.wedges.uv, mesh_.wedges.normal);
    for (const Triangle& t : mesh_.triangles)
      if (const std::uint32_t m = material_of(t); m < parts_.size()) parts_[m].triangles.push_back(t);
    for_parts([&](std::size_t m) { make(m); });
    measure();
    if (!(report_.angle < worth * report_.plain_angle)) {
      mesh_.tangents.clear();
      report_.angle = report_.plain_angle;
      return;
    }
    for (std::size_t m = 0; m < parts_.size(); ++m)
      if (mesh_.object_normals[m] != no_texture) add(m);
  }

 private:
  // The images of one material, and the triangles that they are on.
  struct Part {
    std::vector<Triangle> triangles;
    LinearImage object, map;  // as decoded
    std::vector<char> bytes;  // of the map
  };
  struct AngleSums {
    double shown = 0, plain = 0;
    std::uint64_t points = 0;
  };

  template <class Body>
  void for_parts(const Body& body) {
    scheduler_.for_chunks(parts_.size(), 1, [&](ChunkRange range) {
      if (mesh_.object_normals[range.begin] != no_texture) body(range.begin);
    });
  }
  [[nodiscard]] std::uint32_t material_of(const Triangle& t) const {
    return mesh_.wedges.material.empty() ? 0 : mesh_.wedges.material[t.v[0]];
  }
  [[nodiscard]] FramedMesh framed(std::span<const Triangle> triangles) const {
    return {triangles, mesh_.wedges.uv, mesh_.wedges.normal, mesh_.tangents};
  }

  void make(std::size_t m) {
    Part& part = parts_[m];
    const Texture& normals = mesh_.wedges.textures[mesh_.object_normals[m]];
    const OctahedralLayout layout =
        m < mesh_.octahedral.size() ? mesh_.octahedral[m].value_or(OctahedralLayout{}) : OctahedralLayout{};
    part.object = decode_octahedral(normals.bytes, PixelMeaning::normals, normals.media_type, layout);
    const LinearImage map =
        tangent_normals(framed(part.triangles), part.object, std::max(part.object.size.width / 2, 1u));
    part.bytes = encode_image(to_pixels(map, PixelMeaning::normals), config_.media_type, config_.quality);
    part.map = to_linear(decode_image(part.bytes, config_.media_type), PixelMeaning::normals);
  }

  void measure() {
    const std::vector<Vec3d> positions = [&] {
      std::vector<Vec3d> wide;
      for (const Vec3f p : mesh_.positions) wide.push_back(to_double(p));
      return wide;
    }();
    const SurfaceSamples samples(positions, mesh_.triangles, config_.points);
    const std::uint64_t count = samples.size() - samples.vertices();
    std::vector<AngleSums> sums(chunk_count(count, measured_grain));
    scheduler_.for_chunks(count, measured_grain, [&](ChunkRange range) {
      std::vector<Vec3d> points;
      std::vector<std::uint32_t> triangles;
      samples.take(samples.vertices() + range.begin, samples.vertices() + range.end, points, &triangles);
      for (std::size_t i = 0; i < points.size(); ++i)
        measure(points[i], mesh_.triangles[triangles[i]], sums[range.index]);
    });
    AngleSums all;
    for (const AngleSums& part : sums) all.shown += part.shown, all.plain += part.plain, all.points += part.points;
    if (all.points == 0) return;
    report_.angle = all.shown / static_cast<double>(all.points);
    report_.plain_angle = all.plain / static_cast<double>(all.points);
  }

  void measure(Vec3d point, const Triangle& t, AngleSums& sums) const {
    const std::uint32_t m = material_of(t);
    if (m >= parts_.size() || mesh_.object_normals[m] == no_texture) return;
    const auto at = [&](std::size_t k) { return to_double(mesh_.positions[t.v[k]]); };
    const std::array<double, 3> weight = barycentric(point, at(0), at(1), at(2));
    const FramedMesh mesh = framed(mesh_.triangles);
    sums.shown += shown_angle(mesh, t, weight, parts_[m].map, parts_[m].object);
    sums.plain += shown_angle(mesh, t, weight, {}, parts_[m].object);
    ++sums.points;
  }

  void add(std::size_t m) {
    report_.bytes += parts_[m].bytes.size();
    report_.pixels += std::uint64_t{parts_[m].map.size.width} * parts_[m].map.size.height;
    mesh_.wedges.materials[m].normal_map = static_cast<std::uint32_t>(mesh_.wedges.textures.size());
    mesh_.wedges.textures.push_back({.name = "tangent " + mesh_.wedges.textures[mesh_.object_normals[m]].name,
                                     .media_type = config_.media_type,
                                     .wrap_u = TextureWrap::clamp,
                                     .wrap_v = TextureWrap::clamp,
                                     .bytes = std::move(parts_[m].bytes)});
  }

  ProgressiveMesh& mesh_;
  const TangentMapConfig& config_;
  Scheduler& scheduler_;
  TangentMapReport& report_;
  std::vector<Part> parts_;
};

}  // namespace

void add_tangent_maps(ProgressiveMesh& mesh, const TangentMapConfig& config, Scheduler& scheduler,
                      TangentMapReport& report) {
  const CpuClock clock;
  report = {};
  TangentMapper(mesh, config, scheduler, report).run();
  report.time = clock.elapsed();
}

}  // namespace lodestone
