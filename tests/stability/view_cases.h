// Views that break renderers: from a vertex, from inside, from a face of a cell, from nearly infinitely far away, with
// the near plane through triangles, with very narrow and very wide fields of view.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/render/conformance.h"

namespace lodestone::test {

// A closed surface with several levels, whose extent is not 1 and whose origin is not 0.
inline std::shared_ptr<const Hierarchy> model() {
  static const std::shared_ptr<const Hierarchy> made = [] {
    const auto scheduler = make_serial_scheduler();
    RawMesh mesh = generate_mesh({Shape::sphere, 12'000, 1});
    for (Vec3d& p : mesh.positions) p = 3.0 * p + Vec3d{10, -7, 2};
    Repairs repairs;
    BuildConfig config;
    config.cell_triangles = 200;
    config.strategy = Strategy::serial;
    return std::make_shared<Hierarchy>(
        build_hierarchy(prepare_mesh(std::move(mesh), repairs, *scheduler), config, *scheduler));
  }();
  return made;
}

struct ViewCase : ConformanceScene {
  bool inside = false;  // every pixel sees the model
};

// Cameras are given in normalised space; radii ask for one pixel.
inline ViewCase view_case(const char* name, Vec3d from, Vec3d to, double fov = 0.785) {
  ViewCase view{{.name = name, .hierarchy = model(), .camera = detail::camera(*model(), from, to, fov), .radii = {}}};
  view.size = {160, 120};
  view.radii = for_picture({}, view.size, fov);
  return view;
}

inline constexpr Vec3d middle{0.5, 0.5, 0.5};

// The field of view in which the model fills most of the picture, as far from it.
inline double fov_at(double distance) { return 2 * std::atan(0.65 / distance); }

inline std::vector<ViewCase> view_cases() {
  constexpr double degree = 0.017453292519943295;
  const Cell& leaf = model()->cells_of(model()->finest()).front();
  const Vec3d vertex = to_double(leaf.positions.front());
  std::vector<ViewCase> views;
  views.push_back(view_case("on_a_vertex_outwards", vertex, vertex + (vertex - middle)));
  views.push_back(view_case("on_a_vertex_inwards", vertex, middle));
  views.push_back(view_case("inside", middle, {1, 0.7, 0.6}));
  views.back().inside = true;
  views.push_back(view_case("on_a_face_of_cells_inside", {0.5, 0.5, 0.25 + 0.125}, {0.9, 0.8, 0.4}));
  views.back().inside = true;
  views.push_back(view_case("on_a_corner_of_the_root", {1, 1, 1}, middle));
  views.push_back(view_case("on_a_face_of_the_root", {0, 0.5, 0.5}, {0.5, 0.5, 0.625}));
  views.push_back(view_case("one_degree", {0.5, -20, 0.5}, middle, degree));
  views.push_back(view_case("one_degree_nearby", {0.5, -0.2, 0.5}, middle, degree));
  views.push_back(view_case("170_degrees", {0.5, -0.05, 0.5}, middle, 170 * degree));
  views.push_back(view_case("170_degrees_inside", middle, {0.5, 1, 0.5}, 170 * degree));
  views.back().inside = true;
  for (const double closer : {1e-2, 1e-4, 1e-6})
    views.push_back(view_case(("near_plane_" + std::to_string(views.size())).c_str(),
                              vertex + closer * (vertex - middle), vertex + Vec3d{0.1, 0.07, -0.05}, 1.2));
  for (const double far : {1e2, 1e4, 1e6, 1e8, 1e12})
    views.push_back(view_case(("far_" + std::to_string(views.size())).c_str(), middle + far * Vec3d{0.36, -0.8, 0.48},
                              middle, fov_at(far)));
  return views;
}

}  // namespace lodestone::test
