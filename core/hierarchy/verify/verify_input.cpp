// The triangles of the finest level against those of the input.
#include <algorithm>
#include <numeric>

#include "core/base/sort_unique.h"
#include "core/hierarchy/verify/verify_checks.h"
#include "core/mesh/refine.h"

namespace lodestone::verify {
namespace {

// Corners in file order, rotated so that the smallest comes first: equal iff the triangles and their orientations are.
struct Corners {
  std::array<std::array<float, 3>, 3> p;
  friend bool operator==(const Corners&, const Corners&) = default;
  friend auto operator<=>(const Corners&, const Corners&) = default;
};

Corners corners(Vec3f a, Vec3f b, Vec3f c) {
  const auto plain = [](Vec3f v) { return std::array{v.x + 0.0f, v.y + 0.0f, v.z + 0.0f}; };  // -0 becomes +0
  Corners result{{plain(a), plain(b), plain(c)}};
  std::rotate(result.p.begin(), std::min_element(result.p.begin(), result.p.end()), result.p.end());
  return result;
}

// Corners of the triangles of a mesh, by number.
class InputTriangles {
 public:
  explicit InputTriangles(const IndexedMesh& mesh) : mesh_(mesh) {}
  template <typename Body>
  void for_each(Body&& body) const {
    for (std::uint64_t i = 0; i < mesh_.triangles.size(); ++i) body(i, (*this)[i]);
  }
  [[nodiscard]] Corners operator[](std::uint64_t i) const {
    const auto& v = mesh_.triangles[i].v;
    return corners(mesh_.positions[v[0]], mesh_.positions[v[1]], mesh_.positions[v[2]]);
  }

 private:
  const IndexedMesh& mesh_;
};

class FinestTriangles {
 public:
  explicit FinestTriangles(const Hierarchy& hierarchy) : cells_(hierarchy.cells_of(hierarchy.finest())) {}
  template <typename Body>
  void for_each(Body&& body) const {
    for (std::uint64_t c = 0; c < cells_.size(); ++c)
      for (std::uint64_t t = 0; t < cells_[c].triangles.size(); ++t) body(c << 32 | t, (*this)[c << 32 | t]);
  }
  [[nodiscard]] Corners operator[](std::uint64_t i) const {
    const Cell& cell = cells_[i >> 32];
    const auto& v = cell.triangles[i & 0xffff'ffffu].v;
    return corners(cell.positions[v[0]], cell.positions[v[1]], cell.positions[v[2]]);
  }

 private:
  std::span<const Cell> cells_;
};

// The parts of the input triangles after splitting edges beyond a limit: the definition of core/mesh/refine.h once
// more, without ids, since the splits follow from positions alone.
class RefinedTriangles {
 public:
  RefinedTriangles(const IndexedMesh& mesh, double longest) : lattice_(mesh.transform.lattice) {
    const double limit = refine_limit(longest, lattice_);
    limit2_ = limit * limit;
    for (const Triangle& t : mesh.triangles)
      add(to_double(mesh.positions[t.v[0]]), to_double(mesh.positions[t.v[1]]), to_double(mesh.positions[t.v[2]]));
    sort_unique(parts_);
  }
  template <typename Body>
  void for_each(Body&& body) const {
    for (std::uint64_t i = 0; i < parts_.size(); ++i) body(i, parts_[i]);
  }
  [[nodiscard]] const Corners& operator[](std::uint64_t i) const { return parts_[i]; }

 private:
  [[nodiscard]] bool is_long(Vec3d p, Vec3d q) const { return dot(p - q, p - q) > limit2_; }
  [[nodiscard]] Vec3f rounded(Vec3d p) const { return lattice_ ? lattice_.nearest(p) : to_float(p); }

  // Rotates the corners until the edges that are too long are bc and ca, or ab alone, or all, or none.
  void add(Vec3d a, Vec3d b, Vec3d c) {
    const bool ab = is_long(a, b), bc = is_long(b, c), ca = is_long(c, a);
    const Vec3d m = 0.5 * (a + b), n = 0.5 * (b + c), o = 0.5 * (c + a);
    if (ab && bc && ca) {
      add(a, m, o), add(m, b, n), add(o, n, c), add(m, n, o);
    } else if (bc && ca) {
      add(c, o, n);
      const double from_a = dot(a - n, a - n), from_b = dot(b - o, b - o);
      if (from_a <= from_b) {
        add(o, a, n), add(a, b, n);
      } else {
        add(o, a, b), add(o, b, n);
      }
    } else if (ab && !bc && !ca) {
      add(a, m, c), add(m, b, c);
    } else if (ab || bc || ca) {
      add(b, c, a);
    } else if (const Corners part = corners(rounded(a), rounded(b), rounded(c));
               part.p[0] != part.p[1] && part.p[1] != part.p[2] && part.p[2] != part.p[0]) {
      parts_.push_back(part);
    }
  }

  Lattice lattice_;
  double limit2_ = 0;
  std::vector<Corners> parts_;
};

// Triangles in buckets by the position of their smallest corner: both sides are sorted and compared bucket by bucket,
// which keeps the working set small and needs 8 bytes per triangle instead of 36.
constexpr int bucket_level = 6;
constexpr std::size_t bucket_count = std::size_t{1} << (3 * bucket_level);

std::size_t bucket_of(const Corners& t) {
  return CellCode::from(cell_of({t.p[0][0], t.p[0][1], t.p[0][2]}, bucket_level)).morton;
}

bool is_here(const Part& part, std::size_t bucket) { return bucket % part.peers() == part.index(); }

struct Buckets {
  std::vector<std::uint64_t> first;      // one per bucket and one more; the buckets of other peers are empty
  std::vector<std::uint64_t> triangles;  // by bucket
};

template <typename Triangles>
Buckets bucketed(const Part& part, const Triangles& triangles) {
  Buckets result;
  result.first.assign(bucket_count + 1, 0);
  triangles.for_each([&](std::uint64_t, const Corners& t) {
    const std::size_t bucket = bucket_of(t);
    if (is_here(part, bucket)) ++result.first[bucket + 1];
  });
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.triangles.resize(result.first.back());
  std::vector<std::uint64_t> next(result.first.begin(), result.first.end() - 1);
  triangles.for_each([&](std::uint64_t i, const Corners& t) {
    const std::size_t bucket = bucket_of(t);
    if (is_here(part, bucket)) result.triangles[next[bucket]++] = i;
  });
  return result;
}

template <typename Triangles>
void take_sorted(const Triangles& triangles, const Buckets& buckets, std::size_t bucket, std::vector<Corners>& out) {
  out.clear();
  for (std::uint64_t i = buckets.first[bucket]; i < buckets.first[bucket + 1]; ++i)
    out.push_back(triangles[buckets.triangles[i]]);
  std::sort(out.begin(), out.end());
}

std::string name_of(const Corners& t) {
  std::string text = "triangle";
  for (const auto& p : t.p)
    text += " (" + std::to_string(p[0]) + ", " + std::to_string(p[1]) + ", " + std::to_string(p[2]) + ")";
  return text;
}

// Compares both as multisets, bucket by bucket.
template <typename Given>
void compare(const Part& part, const Given& given, const FinestTriangles& kept, Finding& same) {
  const Buckets given_by_bucket = bucketed(part, given), kept_by_bucket = bucketed(part, kept);
  std::vector<Corners> a, b;
  for (std::size_t bucket = 0; bucket < bucket_count; ++bucket) {
    take_sorted(given, given_by_bucket, bucket, a);
    take_sorted(kept, kept_by_bucket, bucket, b);
    if (a.empty() && b.empty()) continue;
    same.require(a == b, [&] {
      const std::size_t shorter = std::min(a.size(), b.size());
      std::size_t at = 0;
      while (at < shorter && a[at] == b[at]) ++at;
      const bool lost = at == b.size() || (at < a.size() && a[at] < b[at]);
      return name_of(lost ? a[at] : b[at]) +
             (lost ? ": in the input, but not in the finest level" : ": in the finest level, but not in the input");
    });
  }
}

}  // namespace

void check_input(const Part& part, const IndexedMesh& input, Finding& same) {
  const Hierarchy& hierarchy = part.hierarchy;
  Transform transform = input.transform;
  transform.up = hierarchy.transform.up;  // may have been given
  if (part.has_tables())
    same.require(hierarchy.transform == transform, [] { return "origin or scale differ from the input's"; });
  const FinestTriangles kept(hierarchy);
  if (!hierarchy.provenance.refined)
    compare(part, InputTriangles(input), kept, same);
  else
    compare(part, RefinedTriangles(input, double{hierarchy.sigma0} * hierarchy.cell_size(hierarchy.finest())), kept,
            same);
}

}  // namespace lodestone::verify
