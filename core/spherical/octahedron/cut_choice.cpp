#include "core/spherical/octahedron/cut_choice.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/spatial/triangle_bvh.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/octahedron/rough_square.h"
#include "core/spherical/octahedron/sphere_raster.h"

namespace lodestone::spherical {
namespace {

constexpr std::uint32_t least_side = 8, greatest_side = 64;  // samples along the square
constexpr std::uint32_t triangles_per_sample = 4;
constexpr double hidden = 0.25;  // cost of a length that is not seen at all; 1.25 where all of the sky is
constexpr double first_step = 0.2, last_step = 0.004;  // radians

// Numbers of trials for a square of so many samples: together, they grow faster than the samples.
struct Trials {
  explicit Trials(std::uint32_t side)
      : steps(3 * side / 4),
        poles(static_cast<int>(3 * side / 2)),
        twists(static_cast<int>(side / 8)),
        starts(std::max(3 * side / 32, 1u)),
        rays(std::max(3 * side / 4, 16u)) {}
  std::size_t steps;   // along an arc; even
  int poles, twists;   // rotations
  std::size_t starts;  // of them, for the search in steps
  std::size_t rays;
};

std::uint32_t side_for(std::size_t triangles) {
  std::uint32_t side = least_side;
  while (side < greatest_side && std::size_t{side} * side * triangles_per_sample < triangles) side *= 2;
  return side;
}

// Point k of n, spread evenly over the sphere along a spiral.
Vec3d spiral(int k, int n) {
  const double z = 1 - (2 * k + 1.0) / n, r = std::sqrt(1 - z * z), angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// Orthonormal axes; the columns of Affine3d are the images of x, y and z.
Affine3d turned(Vec3d axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turn = [&](Vec3d v) { return c * v + (s * cross(axis, v) + (1 - c) * dot(axis, v) * axis); };
  return {{turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})}, {}};
}

// Takes `pole` to the south pole, then twists about it.
Affine3d to_south(Vec3d pole, double twist) {
  const Vec3d down{0, 0, -1}, axis = cross(pole, down);
  const double size = length(axis), angle = std::atan2(size, dot(pole, down));
  const Affine3d turn = size > 1e-12 ? turned((1 / size) * axis, angle) : turned({1, 0, 0}, angle);
  return turned({0, 0, 1}, twist) * turn;
}

Vec3d back(const Affine3d& rotation, Vec3d d) {
  return {dot(rotation.axes[0], d), dot(rotation.axes[1], d), dot(rotation.axes[2], d)};
}

Affine3d orthonormal(const Affine3d& a) {
  const Vec3d x = (1 / length(a.axes[0])) * a.axes[0], z = cross(x, a.axes[1]), unit_z = (1 / length(z)) * z;
  return {{x, cross(unit_z, x), unit_z}, {}};
}

}  // namespace

CutMeasure::CutMeasure(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                       std::span<const Vec3d> directions)
    : side_(side_for(triangles.size())), samples_(std::size_t{side_} * side_) {
  static_assert(greatest_side <= SampleTile::side, "one tile");
  SphereRaster raster(triangles, directions, {side_, SampleGrid::Placing::in_cells});
  raster.prepare();
  SampleTile tile;
  raster.cover(0, tile);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::size_t at = i / side_ * SampleTile::side + i % side_;
    if (tile.triangle[at] == no_triangle)
      throw InputError(describe("", "sphere map", "triangles leave a part of the sphere uncovered",
                                "give a closed mesh whose map covers the sphere"));
    for (std::size_t k = 0; k < 3; ++k)
      samples_[i].position =
          samples_[i].position + double{tile.weight[k][at]} * positions[triangles[tile.triangle[at]].v[k]];
  }
  const std::size_t steps = Trials(side_).steps;
  for (std::size_t k = 1; k <= steps; ++k) {
    const double angle = std::numbers::pi / 2 * static_cast<double>(k) / static_cast<double>(steps);
    arc_.push_back({std::sin(angle), std::cos(angle)});
  }
  find_exposure();
}

std::size_t CutMeasure::number_of(std::int64_t x, std::int64_t y) const {
  const Texel at = continued({x, y}, side_);
  return static_cast<std::size_t>(at.y * side_ + at.x);
}

// Rays from the samples against the mesh between the samples, which is all that tells coarse visibility.
void CutMeasure::find_exposure() {
  Vec3d low = samples_.front().position, high = low;
  for (const Sample& s : samples_) {
    low = {std::min(low.x, s.position.x), std::min(low.y, s.position.y), std::min(low.z, s.position.z)};
    high = {std::max(high.x, s.position.x), std::max(high.y, s.position.y), std::max(high.z, s.position.z)};
  }
  const double size = std::max({high.x - low.x, high.y - low.y, high.z - low.z}), scale = size > 0 ? 1 / size : 1;
  std::vector<Vec3d> positions;
  for (const Sample& s : samples_) positions.push_back(scale * (s.position - low));
  std::vector<Triangle> triangles;
  for (std::uint32_t y = 0; y + 1 < side_; ++y)
    for (std::uint32_t x = 0; x + 1 < side_; ++x) {
      const std::uint32_t a = y * side_ + x, b = a + 1, c = a + side_, d = c + 1;
      triangles.push_back({{a, c, d}});
      triangles.push_back({{a, d, b}});
    }
  const TriangleBvh mesh(positions, triangles);
  std::vector<Vec3d> sky(Trials(side_).rays);
  for (std::size_t k = 0; k < sky.size(); ++k) sky[k] = spiral(static_cast<int>(k), static_cast<int>(sky.size()));
  // Exposure changes slowly: one sample stands for four.
  for (std::int64_t y = 0; y < side_; y += 2)
    for (std::int64_t x = 0; x < side_; x += 2) {
      const auto beside = [&](std::int64_t i, std::int64_t j) { return positions[number_of(x + i, y + j)]; };
      const Vec3d normal = cross(beside(0, 1) - beside(0, -1), beside(1, 0) - beside(-1, 0));
      const double flat = length(normal);
      const Vec3d up = flat > 0 ? (1 / flat) * normal : Vec3d{};
      double seen = 0, all = 0;
      for (const Vec3d ray : sky) {
        const double weight = dot(ray, up);
        if (weight < 0.05) continue;
        all += weight;
        // From a little above: the mesh between the samples may be above the sample.
        const Vec3d from = beside(0, 0) + 0.01 * up;
        if (std::isinf(mesh.meet(from, ray, 0, TriangleBvh::Hit::any_will_do))) seen += weight;
      }
      for (const std::int64_t j : {0, 1})
        for (const std::int64_t i : {0, 1}) samples_[number_of(x + i, y + j)].exposure = all > 0 ? seen / all : 1;
    }
}

CutMeasure::Sample CutMeasure::at(Vec3d direction) const {
  const SquarePoint p = rough_square_point(direction, octant_of(direction));
  const double x = p.s * side_ + 0.5, y = p.t * side_ + 0.5;  // one more than in samples, which makes both positive
  const auto left = static_cast<std::int64_t>(x), top = static_cast<std::int64_t>(y);
  const double across = x - static_cast<double>(left), down = y - static_cast<double>(top);
  Sample sum;
  const auto add = [&](std::size_t number, double weight) {
    sum.position = sum.position + weight * samples_[number].position;
    sum.exposure += weight * samples_[number].exposure;
  };
  const bool within = left > 0 && top > 0 && left < side_ && top < side_;
  for (const std::int64_t j : {0, 1})
    for (const std::int64_t i : {0, 1})
      add(within ? static_cast<std::size_t>((top + j - 1) * side_ + left + i - 1)
                 : number_of(left + i - 1, top + j - 1),
          (i == 0 ? 1 - across : across) * (j == 0 ? 1 - down : down));
  return sum;
}

CutCost CutMeasure::measure(const Affine3d& rotation, std::size_t stride) const {
  CutCost sum;
  for (const Vec3d end : {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, -1, 0}}) {
    const Vec3d from = back(rotation, {0, 0, -1}), to = back(rotation, end);
    Sample last = at(from);
    for (std::size_t k = stride - 1; k < arc_.size(); k += stride) {
      const Sample next = at(arc_[k].sine * to + arc_[k].cosine * from);
      const double part = length(next.position - last.position), exposure = 0.5 * (last.exposure + next.exposure);
      sum.length += part;
      sum.exposure += part * exposure;
      last = next;
    }
  }
  sum.cost = sum.exposure + hidden * sum.length;
  if (sum.length > 0) sum.exposure /= sum.length;
  return sum;
}

// In smaller and smaller steps about the axes, while the cost falls.
void CutMeasure::improve(CutChoice& choice) const {
  for (double step = first_step; step > last_step; step /= 2) {
    for (bool moved = true; moved;) {
      moved = false;
      for (const Vec3d axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
        for (const double angle : {step, -step}) {
          const Affine3d rotation = orthonormal(turned(axis, angle) * choice.rotation);
          const CutCost cost = measure(rotation, 1);
          if (!(cost.cost < choice.cost.cost)) continue;
          choice.rotation = rotation, choice.cost = cost, moved = true;
        }
    }
  }
}

CutChoice CutMeasure::choose() const {
  const Trials trials(side_);
  CutChoice best;
  best.cost = best.before = measure(best.rotation, 1);
  std::vector<CutChoice> choices;
  for (int pole = 0; pole < trials.poles; ++pole)
    for (int twist = 0; twist < trials.twists; ++twist) {
      CutChoice& choice = choices.emplace_back();
      choice.rotation = orthonormal(to_south(spiral(pole, trials.poles), std::numbers::pi / 2 * twist / trials.twists));
      choice.cost = measure(choice.rotation, 2);
    }
  std::ranges::stable_sort(choices, {}, [](const CutChoice& choice) { return choice.cost.cost; });
  choices.resize(trials.starts);
  for (CutChoice& choice : choices) {
    choice.cost = measure(choice.rotation, 1);
    improve(choice);
    if (choice.cost.cost < best.cost.cost) best.rotation = choice.rotation, best.cost = choice.cost;
  }
  return best;
}

std::vector<Vec3d> rotated(std::span<const Vec3d> directions, const Affine3d& rotation) {
  std::vector<Vec3d> out;
  out.reserve(directions.size());
  for (const Vec3d d : directions) {
    const Vec3d turned = rotation.vector(d);
    out.push_back((1 / length(turned)) * turned);
  }
  return out;
}

}  // namespace lodestone::spherical
