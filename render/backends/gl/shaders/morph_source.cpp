#include "render/backends/gl/shaders/morph_source.h"

#include "render/lod/blend_curve.h"

namespace lodestone {
namespace {

// distance_metric.h
constexpr const char* euclidean_source = R"(
float norm(vec3 a) {
  precise float sum = (a.x * a.x + a.y * a.y) + a.z * a.z;
  precise float root = sqrt(sum);
  return root;
}
)";
constexpr const char* chebyshev_source = R"(
float norm(vec3 a) { return max(max(a.x, a.y), a.z); }
)";

// blend.cpp
std::string share_source(Blend blend) {
  if (const BlendCurve* curve = curve_of(blend)) return CurveShare(*curve).glsl();
  switch (blend) {
    case Blend::linear:
      return "float share(float t) { return t; }\n";
    case Blend::smoothstep:
      return "float share(float t) { return cubic(t); }\n";
    case Blend::smootherstep:
      return R"(
float share(float t) {
  precise float s = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
  return s;
}
)";
    case Blend::cosine:
      return R"(
float share(float t) {
  precise float s = (1.0 - cos(3.14159265358979 * t)) / 2.0;
  return s;
}
)";
    case Blend::early:
      return "float share(float t) { precise float u = min(2.0 * t, 1.0); return cubic(u); }\n";
    case Blend::late:
      return "float share(float t) { precise float u = max(2.0 * t - 1.0, 0.0); return cubic(u); }\n";
    case Blend::step:
      return "float share(float t) { return t < 0.5 ? 0.0 : 1.0; }\n";
  }
  return "";
}

// limits.cpp
constexpr const char* unlimited_source = "float limited(float d, vec3 w) { return d; }\n";
constexpr const char* limited_source = R"(
struct Limit { vec4 lo_radius; vec4 hi; };
layout(std430, binding = 2) readonly restrict buffer Limits { Limit limits[]; };
uvec2 limit_range;  // of the draw

float limited(float d, vec3 w) {
  for (uint i = limit_range.x; i < limit_range.y; ++i) {
    vec4 lo_radius = limits[i].lo_radius;
    precise vec3 outside = max(max(lo_radius.xyz - w, w - limits[i].hi.xyz), vec3(0.0));
    precise float at_least = lo_radius.w - norm(outside);
    d = max(d, at_least);
  }
  return d;
}
)";

// morph.cpp; the CPU has found the lambdas of adaptive radii, one for each signature
constexpr const char* given_lambda = R"(
layout(std430, binding = 2) readonly restrict buffer Lambdas { float lambdas[]; };
layout(location = 7) in uint signature_place;
float lambda_of_vertex() { return lambdas[draw.z + signature_place]; }
)";
constexpr const char* found_lambda = "float lambda_of_vertex() { return morph_lambda(level, own_position); }\n";

constexpr const char* morph_functions = R"(
float blend_share(float t) {
  if (!(t > 0.0)) return 0.0;
  if (t >= 1.0) return 1.0;
  return clamp(share(t), 0.0, 1.0);
}

float morph_lambda(uint level, vec3 w) {
  float begin = instances[instance].levels[level].band.x, end = instances[instance].levels[level].band.y;
  precise vec3 apart = abs(w - instances[instance].viewpoint.xyz);
  precise float d = limited(norm(apart), w);
  if (d < begin || (d <= begin && begin < end)) return 1.0;
  if (d >= end) return 0.0;
  precise float t = (d - begin) / (end - begin);
  precise float lambda = 1.0 - blend_share(t);
  return lambda;
}

vec3 morph_position(float lambda, vec3 w, vec3 parent) {
  if (lambda >= 1.0) return w;
  if (lambda <= 0.0) return parent;
  precise vec3 n = lambda * w + (1.0 - lambda) * parent;
  return n;
}
)";

}  // namespace

std::string morph_source(GlVariant variant) {
  return std::string(variant.metric == DistanceMetric::chebyshev ? chebyshev_source : euclidean_source) +
         "float cubic(float t) { precise float s = t * t * (3.0 - 2.0 * t); return s; }\n" +
         share_source(variant.blend) + (variant.limited ? limited_source : unlimited_source) + morph_functions;
}

std::string lambda_source(GlVariant variant) { return variant.given ? given_lambda : found_lambda; }

}  // namespace lodestone
