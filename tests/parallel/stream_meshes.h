// Meshes for tests of streams: in files, and with every fault that is repaired.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "core/formats/mesh_file.h"
#include "core/formats/ply/ply.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// Binary PLY with every vertex and triangle as it is, doubles or floats.
inline void write_ply(const std::filesystem::path& path, const RawMesh& mesh, bool doubles = false) {
  std::ofstream out(path, std::ios::binary);
  out << ply_header(mesh.positions.size(), mesh.triangles.size(), doubles ? ScalarType::float64 : ScalarType::float32);
  const auto put = [&](const auto& value) { out.write(reinterpret_cast<const char*>(&value), sizeof(value)); };
  for (const Vec3d& p : mesh.positions) doubles ? put(p) : put(to_float(p));
  for (const Triangle& t : mesh.triangles) {
    out.put(3);
    put(t.v);
  }
}

// Adds corners of their own, degenerate, repeated and non-finite triangles, and vertices that nothing uses, anywhere.
inline RawMesh with_faults(RawMesh raw, unsigned seed) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const auto add = [&](Vec3d p) {
    raw.positions.push_back(p);
    return static_cast<std::uint32_t>(raw.positions.size() - 1);
  };
  const std::size_t sound = raw.triangles.size();
  for (std::size_t i = 0; i < sound / 20; ++i) {
    auto& v = raw.triangles[below(sound)].v;
    v[i % 3] = add(raw.positions[v[i % 3]]);
  }
  for (std::size_t i = 0; i < sound / 20; ++i) {
    const auto v = raw.triangles[below(sound)].v;
    raw.triangles.push_back({{v[0], v[1], v[0]}});
    raw.triangles.push_back({{v[0], v[1], add(raw.positions[v[0]])}});
    raw.triangles.push_back({{v[1], v[2], v[0]}});
    raw.triangles.push_back({{v[0], add({nan, 0, 0}), v[2]}});
    add({2, 2, 2});
  }
  std::shuffle(raw.triangles.begin(), raw.triangles.end(), random);
  return raw;
}

}  // namespace lodestone::test
