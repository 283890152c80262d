#include "core/mesh/generate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/mesh/noise.h"

namespace lodestone {
namespace {

constexpr std::uint64_t fewest_triangles = 12, most_triangles = 200'000'000;

std::uint32_t nearest(double value, std::uint32_t least) {
  return std::max(least, static_cast<std::uint32_t>(std::lround(value)));
}

// Octaves down to a wavelength of four grid steps: finer ones the grid could not show.
int octaves_for(double steps_per_unit, double frequency) {
  return std::max(1, static_cast<int>(std::floor(std::log2(steps_per_unit / (4 * frequency)))) + 1);
}

// Triangle number t of a grid whose quads are split along the diagonal from the first to the third corner.
template <class Quad>
void split_quads(std::uint32_t first, std::span<Triangle> out, const Quad& quad) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint32_t t = first + static_cast<std::uint32_t>(i);
    const std::array<std::uint32_t, 4> q = quad(t / 2);
    out[i] = t % 2 == 0 ? Triangle{{q[0], q[1], q[2]}} : Triangle{{q[0], q[2], q[3]}};
  }
}

// The lattice points on the surface of the cube {0..n}^3 and the quads between them, layer by layer in z: the bottom
// face row by row, then rings around the four sides, then the top face. 6 n^2 + 2 vertices, 6 n^2 quads.
class CubeSurface : public GeneratedSurface {
 public:
  explicit CubeSurface(std::uint64_t triangles) : n_(nearest(std::sqrt(static_cast<double>(triangles) / 12), 1)) {
    vertex_count_ = 6 * n_ * n_ + 2;
    triangle_count_ = 12 * n_ * n_;
  }

  void positions(std::uint32_t first, std::span<Vec3f> out) const final {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = place(point(first + static_cast<std::uint32_t>(i)));
  }

  void triangles(std::uint32_t first, std::span<Triangle> out) const final {
    split_quads(first, out, [this](std::uint32_t quad) { return corners(quad); });
  }

 protected:
  struct Point {
    std::uint32_t x, y, z;
  };
  // Where the lattice point of the surface goes.
  [[nodiscard]] virtual Vec3f place(Point point) const = 0;

  std::uint32_t n_;  // quads along an edge

 private:
  // Position in the ring around the sides, counter-clockwise seen from above, from x = y = 0.
  [[nodiscard]] Point ring_point(std::uint32_t position, std::uint32_t z) const {
    const std::uint32_t side = position / n_, along = position % n_;
    switch (side) {
      case 0:
        return {along, 0, z};
      case 1:
        return {n_, along, z};
      case 2:
        return {n_ - along, n_, z};
      default:
        return {0, n_ - along, z};
    }
  }

  [[nodiscard]] std::uint32_t face_vertices() const { return (n_ + 1) * (n_ + 1); }
  [[nodiscard]] std::uint32_t first_of_top() const { return vertex_count_ - face_vertices(); }

  [[nodiscard]] Point point(std::uint32_t id) const {
    if (id < face_vertices()) return {id % (n_ + 1), id / (n_ + 1), 0};
    if (id >= first_of_top()) return {(id - first_of_top()) % (n_ + 1), (id - first_of_top()) / (n_ + 1), n_};
    const std::uint32_t in_rings = id - face_vertices();
    return ring_point(in_rings % (4 * n_), 1 + in_rings / (4 * n_));
  }

  [[nodiscard]] std::uint32_t ring_id(std::uint32_t position, std::uint32_t z) const {
    if (z != 0 && z != n_) return face_vertices() + (z - 1) * 4 * n_ + position;
    const Point p = ring_point(position, z);
    return (z == 0 ? 0 : first_of_top()) + p.y * (n_ + 1) + p.x;
  }

  // Counter-clockwise seen from outside.
  [[nodiscard]] std::array<std::uint32_t, 4> corners(std::uint32_t quad) const {
    const std::uint32_t face = n_ * n_;
    if (quad < face) {
      const std::uint32_t a = quad / n_ * (n_ + 1) + quad % n_;
      return {a, a + n_ + 1, a + n_ + 2, a + 1};
    }
    if (quad >= 5 * face) {
      const std::uint32_t in_top = quad - 5 * face;
      const std::uint32_t a = first_of_top() + in_top / n_ * (n_ + 1) + in_top % n_;
      return {a, a + 1, a + n_ + 2, a + n_ + 1};
    }
    const std::uint32_t ring = 4 * n_, position = (quad - face) % ring, z = (quad - face) / ring;
    const std::uint32_t next = position + 1 == ring ? 0 : position + 1;
    return {ring_id(position, z), ring_id(next, z), ring_id(next, z + 1), ring_id(position, z + 1)};
  }
};

class Box final : public CubeSurface {
 public:
  using CubeSurface::CubeSurface;

 private:
  [[nodiscard]] Vec3f place(Point p) const override {
    const double n = n_;
    return to_float(Vec3d{p.x / n, p.y / n, p.z / n});
  }
};

class FractalSphere final : public CubeSurface {
 public:
  FractalSphere(std::uint64_t triangles, std::uint32_t seed)
      : CubeSurface(triangles),
        noise_{.seed = seed, .octaves = octaves_for(n_, frequency), .frequency = frequency, .gain = 0.45} {}

 private:
  static constexpr double frequency = 1.7, amplitude = 0.12;

  // From the cube [-1,1]^3 to the unit sphere, with sides of triangles within a factor of two of each other:
  // x' = x sqrt(1 - y^2/2 - z^2/2 + y^2 z^2/3), and so on. No trigonometry: the same bits on every machine.
  [[nodiscard]] Vec3f place(Point p) const override {
    const double n = n_;
    const double x = 2 * p.x / n - 1, y = 2 * p.y / n - 1, z = 2 * p.z / n - 1;
    const double xx = x * x, yy = y * y, zz = z * z;
    const Vec3d on_sphere{x * std::sqrt(1 - yy / 2 - zz / 2 + yy * zz / 3),
                          y * std::sqrt(1 - zz / 2 - xx / 2 + zz * xx / 3),
                          z * std::sqrt(1 - xx / 2 - yy / 2 + xx * yy / 3)};
    return to_float((1 + amplitude * fractal_noise(noise_, on_sphere)) * on_sphere);
  }

  FractalNoise noise_;
};

// Rows of points, `columns` quads wide; open, or closed in both directions.
class Terrain final : public GeneratedSurface {
 public:
  Terrain(std::uint64_t triangles, std::uint32_t seed)
      : columns_(nearest(std::sqrt(static_cast<double>(triangles) / 2), 1)),
        rows_(nearest(static_cast<double>(triangles) / (2.0 * columns_), 1)),
        noise_{.seed = seed, .octaves = octaves_for(columns_, frequency), .frequency = frequency, .gain = 0.45} {
    vertex_count_ = (columns_ + 1) * (rows_ + 1);
    triangle_count_ = 2 * columns_ * rows_;
  }

  void positions(std::uint32_t first, std::span<Vec3f> out) const override {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::uint32_t id = first + static_cast<std::uint32_t>(i);
      const double x = id % (columns_ + 1) / static_cast<double>(columns_);
      const double y = id / (columns_ + 1) / static_cast<double>(rows_);
      out[i] = to_float(Vec3d{x, y, amplitude * fractal_noise(noise_, x, y)});
    }
  }

  void triangles(std::uint32_t first, std::span<Triangle> out) const override {
    split_quads(first, out, [this](std::uint32_t quad) {
      const std::uint32_t a = quad / columns_ * (columns_ + 1) + quad % columns_;
      return std::array{a, a + 1, a + columns_ + 2, a + columns_ + 1};
    });
  }

 private:
  static constexpr double frequency = 3, amplitude = 0.1;
  std::uint32_t columns_, rows_;
  FractalNoise noise_;
};

class Torus final : public GeneratedSurface {
 public:
  explicit Torus(std::uint64_t triangles)
      : around_tube_(nearest(std::sqrt(static_cast<double>(triangles) / 5), 3)),
        around_axis_(nearest(static_cast<double>(triangles) / (2.0 * around_tube_), 3)) {
    vertex_count_ = around_tube_ * around_axis_;
    triangle_count_ = 2 * vertex_count_;
  }

  void positions(std::uint32_t first, std::span<Vec3f> out) const override {
    constexpr double turn = 2 * std::numbers::pi;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::uint32_t id = first + static_cast<std::uint32_t>(i);
      const double tube = turn * (id % around_tube_) / around_tube_, axis = turn * (id / around_tube_) / around_axis_;
      const double radius = 1 + tube_radius * std::cos(tube);
      out[i] = to_float(Vec3d{radius * std::cos(axis), radius * std::sin(axis), tube_radius * std::sin(tube)});
    }
  }

  void triangles(std::uint32_t first, std::span<Triangle> out) const override {
    split_quads(first, out, [this](std::uint32_t quad) {
      const std::uint32_t tube = quad % around_tube_, row = quad - tube;
      const std::uint32_t next_tube = tube + 1 == around_tube_ ? 0 : tube + 1;
      const std::uint32_t next_row = row + around_tube_ == vertex_count_ ? 0 : row + around_tube_;
      return std::array{row + tube, next_row + tube, next_row + next_tube, row + next_tube};
    });
  }

 private:
  static constexpr double tube_radius = 0.4;
  std::uint32_t around_tube_, around_axis_;  // quads
};

}  // namespace

Shape shape(std::string_view name) {
  if (name == "sphere") return Shape::sphere;
  if (name == "terrain") return Shape::terrain;
  if (name == "torus") return Shape::torus;
  if (name == "box") return Shape::box;
  throw InputError(
      describe("", "", "unknown shape '" + std::string(name) + "'", "choose sphere, terrain, torus or box"));
}

std::unique_ptr<const GeneratedSurface> generate_surface(const GenerateConfig& config) {
  if (config.triangles < fewest_triangles || config.triangles > most_triangles)
    throw InputError(
        describe("", "", std::to_string(config.triangles) + " triangles cannot be generated",
                 "choose from " + std::to_string(fewest_triangles) + " to " + std::to_string(most_triangles)));
  switch (config.shape) {
    case Shape::sphere:
      return std::make_unique<FractalSphere>(config.triangles, config.seed);
    case Shape::terrain:
      return std::make_unique<Terrain>(config.triangles, config.seed);
    case Shape::torus:
      return std::make_unique<Torus>(config.triangles);
    case Shape::box:
      break;
  }
  return std::make_unique<Box>(config.triangles);
}

RawMesh generate_mesh(const GenerateConfig& config) {
  const std::unique_ptr<const GeneratedSurface> surface = generate_surface(config);
  std::vector<Vec3f> positions(surface->vertex_count());
  surface->positions(0, positions);
  RawMesh mesh;
  mesh.positions.reserve(positions.size());
  for (const Vec3f p : positions) mesh.positions.push_back(to_double(p));
  mesh.triangles.resize(surface->triangle_count());
  surface->triangles(0, mesh.triangles);
  return mesh;
}

}  // namespace lodestone
