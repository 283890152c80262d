// Nearest points on a triangle mesh by Embree (wald2014): the reference and the peer of TriangleBvh and LevelSurface.
//
// Embree walks its tree in single precision; what a triangle is nearest in is computed here, in double, for every
// triangle that the walk meets. The radius is rounded up, so that no nearer triangle is passed over.
#pragma once

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>

#include "core/mesh/indexed_mesh.h"
#include "core/spatial/point_triangle.h"

namespace lodestone {

class EmbreePoints {
 public:
  // Positions are those of floats, as of a level; the arguments must outlive this.
  EmbreePoints(std::span<const Vec3d> positions, std::span<const Triangle> triangles)
      : positions_(positions),
        triangles_(triangles),
        device_(rtcNewDevice("threads=1")),
        scene_(rtcNewScene(device_.get())) {
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(Vec3f), positions.size()));
    for (const Vec3d p : positions) *vertices++ = to_float(p);
    auto* indices = static_cast<Triangle*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   sizeof(Triangle), triangles.size()));
    for (const Triangle& t : triangles) *indices++ = t;
    rtcSetGeometryPointQueryFunction(geometry, &EmbreePoints::meet);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_.get());
  }

  // Squared. hint: a triangle that may be near.
  [[nodiscard]] double nearest(Vec3d p, std::uint32_t& hint) const {
    Query query{this, p, squared_distance(p, hint), hint};
    RTCPointQuery sphere{};
    const Vec3f at = to_float(p);
    sphere.x = at.x, sphere.y = at.y, sphere.z = at.z;
    sphere.radius = radius_of(query);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &sphere, &context, nullptr, &query);
    hint = query.triangle;
    return query.squared;
  }

 private:
  struct Query {
    const EmbreePoints* points = nullptr;
    Vec3d p;
    double squared = 0;
    std::uint32_t triangle = 0;
  };
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };

  // The point is rounded, too.
  [[nodiscard]] static float radius_of(const Query& query) {
    constexpr double rounding = 1e-7;
    return std::nextafter(static_cast<float>(std::sqrt(query.squared) + rounding),
                          std::numeric_limits<float>::infinity());
  }
  [[nodiscard]] double squared_distance(Vec3d p, std::uint32_t triangle) const {
    const auto& v = triangles_[triangle].v;
    return nearest_on_triangle(p, positions_[v[0]], positions_[v[1]], positions_[v[2]]).squared_distance;
  }
  static bool meet(RTCPointQueryFunctionArguments* met) {
    Query& query = *static_cast<Query*>(met->userPtr);
    const double squared = query.points->squared_distance(query.p, met->primID);
    if (!(squared < query.squared)) return false;
    query.squared = squared;
    query.triangle = met->primID;
    met->query->radius = radius_of(query);
    return true;
  }

  std::span<const Vec3d> positions_;
  std::span<const Triangle> triangles_;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
};

}  // namespace lodestone
