// Vertices and triangles that a rank has in memory, as part of a mesh whose other ones are elsewhere.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/files/input_file.h"
#include "parallel/mesh/mesh_stream.h"

namespace lodestone {

struct HeldFigures {
  std::uint64_t vertices = 0, triangles = 0;  // of the whole mesh
  Up up{};
  std::filesystem::path source{};  // file or folder that it was read from
};

// Reads nothing but [first, first + size) of both kinds.
class HeldStream final : public MeshStream {
 public:
  template <class Item>
  struct Part {
    std::uint64_t first = 0;
    std::vector<Item> items;
  };

  HeldStream(std::string name, const HeldFigures& figures, Part<Vec3d>&& vertices, Part<Triangle>&& triangles)
      : name_(std::move(name)), held_vertices_(std::move(vertices)), held_triangles_(std::move(triangles)) {
    vertices_ = figures.vertices, triangles_ = figures.triangles;
    up_ = figures.up;
    source_ = figures.source;
  }
  [[nodiscard]] const std::string& name() const override { return name_; }
  void read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* /*wedges*/) const override {
    read(held_vertices_, first, out);
  }
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override {
    read(held_triangles_, first, out);
  }
  [[nodiscard]] std::uint64_t identity() const override { return source_.empty() ? 0 : file_identity(source_); }

 private:
  template <class Item>
  static void read(const Part<Item>& part, std::uint64_t first, std::span<Item> out) {
    if (!out.empty()) std::ranges::copy(std::span(part.items).subspan(first - part.first, out.size()), out.begin());
  }

  std::string name_;
  std::filesystem::path source_;
  Part<Vec3d> held_vertices_;
  Part<Triangle> held_triangles_;
};

}  // namespace lodestone
