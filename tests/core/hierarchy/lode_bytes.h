// For tests of .lode files: small models, their bytes, a header that is changed but fits, and a comparison.
#pragma once

#define XXH_INLINE_ALL
#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "core/hierarchy/lode/lode_format.h"
#include "tests/core/hierarchy/lattice_meshes.h"
#include "tests/test_folder.h"

namespace lodestone::test {

namespace fs = std::filesystem;
using Bytes = std::vector<char>;

class LodeFile : public FolderTest {
 protected:
  [[nodiscard]] fs::path path(const char* name = "model.lode") const { return folder_ / name; }
};

inline Bytes read_bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_bytes(const fs::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline Hierarchy lattice_model() { return lattice_sphere(3, {13}).hierarchy; }

inline Hierarchy small_model() { return naive_hierarchy(bumpy_sphere(3), 2, 0.3f).hierarchy; }

// Changes the header and makes its checksum fit.
template <class Change>
[[nodiscard]] Bytes with_header(Bytes bytes, const Change& change) {
  LodeHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  change(header);
  header.table_checksum = 0;
  std::memcpy(bytes.data(), &header, sizeof(header));
  header.table_checksum = XXH3_64bits(bytes.data(), header.payload_offset);
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

template <typename T>
bool same(std::span<const T> a, std::span<const T> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

inline void expect_equal(const Hierarchy& a, const Hierarchy& b) {
  EXPECT_EQ(a.transform, b.transform);
  EXPECT_EQ(a.sigma0, b.sigma0);
  EXPECT_EQ(a.grids, b.grids);
  const auto provenance = [](const Provenance& p) {
    return std::tie(p.repairs, p.fingerprint, p.input_vertices, p.input_triangles, p.simplifier, p.cell_triangles,
                    p.measured_errors, p.refined);
  };
  EXPECT_TRUE(provenance(a.provenance) == provenance(b.provenance));
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t l = 0; l < a.levels.size(); ++l) {
    EXPECT_EQ(a.levels[l].first_cell, b.levels[l].first_cell);
    EXPECT_EQ(a.levels[l].cell_count, b.levels[l].cell_count);
    EXPECT_EQ(a.levels[l].triangles, b.levels[l].triangles);
    EXPECT_EQ(a.levels[l].vertices, b.levels[l].vertices);
    EXPECT_EQ(a.levels[l].reach, b.levels[l].reach);
    EXPECT_EQ(a.levels[l].diameter, b.levels[l].diameter);
    EXPECT_EQ(a.levels[l].error, b.levels[l].error);
    EXPECT_EQ(a.levels[l].max_edge, b.levels[l].max_edge);
    EXPECT_EQ(a.levels[l].long_edges, b.levels[l].long_edges);
  }
  ASSERT_EQ(a.cells.size(), b.cells.size());
  for (std::size_t c = 0; c < a.cells.size(); ++c) {
    const Cell &p = a.cells[c], &q = b.cells[c];
    EXPECT_EQ(p.code, q.code);
    EXPECT_EQ(p.parent, q.parent);
    EXPECT_EQ(p.first_child, q.first_child);
    EXPECT_EQ(p.child_count, q.child_count);
    EXPECT_EQ(p.bounds, q.bounds);
    EXPECT_EQ(p.max_displacement, q.max_displacement);
    EXPECT_EQ(p.error, q.error);
    EXPECT_TRUE(same(p.positions, q.positions) && same(p.normals, q.normals) &&
                std::ranges::equal(p.parents, q.parents) && same(p.shared_ids, q.shared_ids));
    // The codec of triangles may begin them with another corner.
    EXPECT_TRUE(std::equal(p.triangles.begin(), p.triangles.end(), q.triangles.begin(), q.triangles.end(),
                           [&](const Triangle& s, const Triangle& t) {
                             return a.transform.lattice ? canonical(s) == canonical(t) : s == t;
                           }));
  }
}

}  // namespace lodestone::test
