#include "render/reconstruct/finish/sharpen.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace lodestone {
namespace {

using EdgeKey = std::uint64_t;
EdgeKey key_of(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
}

// The point nearest to `start` that lies on all planes as well as can be; directions in which they hardly differ are
// left alone.
Vec3d meet_planes(std::span<const Vec3f> points, std::span<const Vec3f> normals, Vec3d start) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d n(normals[k].x, normals[k].y, normals[k].z);
    a += n * n.transpose();
    b += n * dot(to_double(normals[k]), to_double(points[k]) - start);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(a);
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double value = solver.eigenvalues()[k];
    if (value < 0.05) continue;
    const Eigen::Vector3d axis = solver.eigenvectors().col(k);
    step += axis * (axis.dot(b) / value);
  }
  return start + Vec3d{step.x(), step.y(), step.z()};
}

class Sharpener {
 public:
  Sharpener(MergedMesh& mesh, const SharpenConfig& config, Scheduler& scheduler)
      : m_(mesh),
        config_(config),
        scheduler_(scheduler),
        least_(static_cast<float>(std::cos(config.degrees * std::numbers::pi / 180))) {}

  SharpenReport run() {
    const std::vector<std::uint32_t> chamfers = find_chamfers();
    for (const std::uint32_t t : chamfers) add_edge_vertices(m_.triangles[t]);
    report_.edges = middle_.size();
    for (const std::uint32_t t : chamfers) split(t);
    return report_;
  }

 private:
  [[nodiscard]] bool is_chamfer(std::uint32_t a, std::uint32_t b) const {
    return !m_.feature[a] && !m_.feature[b] && dot(m_.normal[a], m_.normal[b]) < least_;
  }

  // Triangles with a chamfer edge, ascending.
  [[nodiscard]] std::vector<std::uint32_t> find_chamfers() const {
    constexpr std::size_t grain = 1 << 15;
    std::vector<std::vector<std::uint32_t>> found(chunk_count(m_.triangles.size(), grain));
    scheduler_.for_chunks(m_.triangles.size(), grain, [&](ChunkRange range) {
      for (std::size_t t = range.begin; t < range.end; ++t) {
        const auto& v = m_.triangles[t].v;
        if (is_chamfer(v[0], v[1]) || is_chamfer(v[1], v[2]) || is_chamfer(v[2], v[0]))
          found[range.index].push_back(static_cast<std::uint32_t>(t));
      }
    });
    std::vector<std::uint32_t> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  std::uint32_t add_vertex(Vec3d p, Vec3f normal) {
    const float norm = length(normal);
    m_.position.push_back(to_float(p));
    m_.normal.push_back(norm > 0 ? (1 / norm) * normal : Vec3f{});
    m_.view.push_back(no_view);
    m_.pixel.push_back(0);
    m_.feature.push_back(1);
    return static_cast<std::uint32_t>(m_.position.size() - 1);
  }

  void add_edge_vertices(const Triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = std::min(t.v[k], t.v[(k + 1) % 3]), b = std::max(t.v[k], t.v[(k + 1) % 3]);
      if (!is_chamfer(a, b) || middle_.contains(key_of(a, b))) continue;
      const Vec3f points[2]{m_.position[a], m_.position[b]}, normals[2]{m_.normal[a], m_.normal[b]};
      const Vec3d middle = 0.5 * (to_double(points[0]) + to_double(points[1]));
      const Vec3d p = meet_planes(points, normals, middle);
      if (!is_near(p, middle) || is_at_end(p, points[0], points[1])) continue;
      middle_[key_of(a, b)] = add_vertex(p, normals[0] + normals[1]);
    }
  }

  [[nodiscard]] bool is_near(Vec3d p, Vec3d middle) const {
    return is_finite(p) && length(p - middle) <= config_.farthest * config_.spacing;
  }
  // A vertex that is already on the feature is not doubled.
  [[nodiscard]] bool is_at_end(Vec3d p, Vec3f a, Vec3f b) const {
    const double least = 0.1 * config_.spacing;
    return length(p - to_double(a)) < least || length(p - to_double(b)) < least;
  }

  [[nodiscard]] std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) const {
    const auto at = middle_.find(key_of(a, b));
    return at == middle_.end() ? none : at->second;
  }

  void put(std::uint32_t t, std::initializer_list<Triangle> parts) {
    bool first = true;
    for (const Triangle& part : parts) {
      if (first)
        m_.triangles[t] = part;
      else
        m_.triangles.push_back(part);
      first = false;
    }
  }

  void split(std::uint32_t t) {
    const auto v = m_.triangles[t].v;
    const std::uint32_t m[3]{middle_of(v[0], v[1]), middle_of(v[1], v[2]), middle_of(v[2], v[0])};
    const int count = (m[0] != none) + (m[1] != none) + (m[2] != none);
    if (count == 3) return split_three(t, v, m);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3],
                          ca = m[(k + 2) % 3];
      if (count == 1 && ab != none) return put(t, {{{a, ab, c}}, {{ab, b, c}}});
      // The corner between the two, and the rest by its shorter diagonal.
      if (count == 2 && bc == none) {
        const bool from_b = distance2(b, ca) < distance2(ab, c);
        return from_b ? put(t, {{{a, ab, ca}}, {{ab, b, ca}}, {{b, c, ca}}})
                      : put(t, {{{a, ab, ca}}, {{ab, b, c}}, {{ab, c, ca}}});
      }
    }
  }

  void split_three(std::uint32_t t, const std::array<std::uint32_t, 3>& v, const std::uint32_t (&m)[3]) {
    const Vec3f points[3]{m_.position[v[0]], m_.position[v[1]], m_.position[v[2]]},
        normals[3]{m_.normal[v[0]], m_.normal[v[1]], m_.normal[v[2]]};
    const Vec3d middle = (1.0 / 3) * (to_double(points[0]) + to_double(points[1]) + to_double(points[2]));
    const Vec3d p = meet_planes(points, normals, middle);
    if (!is_near(p, middle))
      return put(t, {{{v[0], m[0], m[2]}}, {{v[1], m[1], m[0]}}, {{v[2], m[2], m[1]}}, {{m[0], m[1], m[2]}}});
    const std::uint32_t c = add_vertex(p, normals[0] + normals[1] + normals[2]);
    ++report_.corners;
    put(t, {{{v[0], m[0], c}},
            {{m[0], v[1], c}},
            {{v[1], m[1], c}},
            {{m[1], v[2], c}},
            {{v[2], m[2], c}},
            {{m[2], v[0], c}}});
  }

  [[nodiscard]] float distance2(std::uint32_t a, std::uint32_t b) const {
    const Vec3f d = m_.position[b] - m_.position[a];
    return dot(d, d);
  }

  static constexpr std::uint32_t none = 0xFFFF'FFFFu;
  MergedMesh& m_;
  const SharpenConfig& config_;
  Scheduler& scheduler_;
  float least_;
  std::unordered_map<EdgeKey, std::uint32_t> middle_;
  SharpenReport report_;
};

}  // namespace

SharpenReport sharpen(MergedMesh& mesh, const SharpenConfig& config, Scheduler& scheduler) {
  return Sharpener(mesh, config, scheduler).run();
}

}  // namespace lodestone
