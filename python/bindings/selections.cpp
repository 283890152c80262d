// Cameras, the cells that are drawn from one, vertices where they are drawn, and the proof of it: cracks and pops.
#include <pybind11/stl.h>

#include <array>

#include "core/mesh/raw_mesh.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/metrics/drawn/drawn_mesh.h"
#include "experiments/subjects/render.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/docs.h"
#include "python/bindings/json_values.h"
#include "python/bindings/views.h"

namespace lodestone::python {
namespace {

using Triple = std::array<double, 3>;

Vec3d to_vec3(const Triple& v) { return {v[0], v[1], v[2]}; }
py::tuple to_tuple(Vec3d v) { return py::make_tuple(v.x, v.y, v.z); }

Camera make_camera(const Triple& position, const Triple& target, const Triple& up, double vertical_fov) {
  return {to_vec3(position), to_vec3(target), to_vec3(up), vertical_fov};
}

std::vector<Camera> path_of(const ModelPtr& model, const std::string& path, const py::kwargs& given) {
  Options options("camera_path", given);
  Scene scene = scene_of("model");
  scene.camera.path = path;
  options.take("frames", scene.camera.frames);
  const ImageSize size = take_size(options);
  options.finish();
  if (scene.camera.frames < 1) throw UsageError("frames: there is at least one");
  const SceneView view(scene, {OpenModel{.hierarchy = &model->hierarchy}});
  return camera_path(view, size);
}

// The cells of a view, those outside the picture included: a partition of the finest level.
struct Selected {
  ModelPtr model;
  Radii radii;
  Vec3f viewpoint;
  Blend blend = Blend::smoothstep;
  ViewProjection view_projection;
  ImageSize size;
  Selection selection;

  [[nodiscard]] MorphContext context() const { return {&model->hierarchy, &radii, blend, viewpoint, {}}; }
  [[nodiscard]] ProofFrame frame(bool follows) const {
    return {
        .morph = context(), .view_projection = view_projection, .size = size, .follows = follows, .thorough = false};
  }
};

Selected select(const ModelPtr& model, const Camera& camera, const py::kwargs& given) {
  Options options("select", given);
  const ViewConfig config = take_view(options);
  options.finish();
  const py::gil_scoped_release free;
  SceneView view = view_of_model(*model);
  view.update(camera, config);
  const ModelFrame& frame = view.frame().only();
  Selected selected{model, view.radii(0), frame.morph.viewpoint, config.blend, frame.view_projection, config.size, {}};
  const Frustum frustum = frustum_of(selected.view_projection);
  select_cells(model->hierarchy, selected.radii, selected.viewpoint, {.frustum = &frustum}, selected.selection);
  return selected;
}

py::array drawn_positions(const Selected& selected, std::size_t index) {
  if (index >= selected.selection.cells.size())
    throw py::index_error("there are " + std::to_string(selected.selection.cells.size()) + " selected cells");
  const CellId cell = selected.selection.cells[index].cell;
  std::vector<Vec3f> drawn(selected.model->hierarchy.cells[cell].positions.size());
  morph_cell(selected.context(), cell, drawn);
  return to_array(std::move(drawn));
}

MeshPtr mesh_of(const Selected& selected) {
  const py::gil_scoped_release free;
  DrawnMesh drawn = drawn_mesh(selected.context(), selected.selection);
  const auto mesh = std::make_shared<RawMesh>();
  const Transform& transform = selected.model->hierarchy.transform;
  mesh->positions = std::move(drawn.positions);
  for (Vec3d& p : mesh->positions) p = transform.origin + transform.scale * p;
  mesh->triangles = std::move(drawn.triangles);
  mesh->up = transform.up;
  return mesh;
}

// The figures of a frame, under the names that `lodestone render` gives them, without those of drawing.
py::object figures(const SurfaceSample& sample) {
  FrameResult frame;
  frame.surface = sample;
  Row row = without_nulls(to_row(frame));
  for (const char* name : {"cells", "triangles"}) row.erase(name);
  return to_python(row);
}

py::object cracks(const Selected& selected, const py::kwargs& given) {
  Options options("cracks", given);
  LongCall call(options);
  options.finish();
  return figures(call.run([&] {
    return FrameProof(selected.model->hierarchy, call.scheduler()).measure(selected.frame(/*follows=*/false));
  }));
}

py::object pops(const Selected& before, const Selected& after, const py::kwargs& given) {
  Options options("pops", given);
  LongCall call(options);
  options.finish();
  if (before.model != after.model) throw UsageError("pops: the selections are of different hierarchies");
  return figures(call.run([&] {
    FrameProof proof(before.model->hierarchy, call.scheduler());
    static_cast<void>(proof.measure(before.frame(/*follows=*/false)));
    return proof.measure(after.frame(/*follows=*/true));
  }));
}

// An array of one value of each selected cell.
template <class Value, class Get>
auto column(Get get) {
  return [get](const Selected& selected) {
    std::vector<Value> values;
    for (const SelectedCell& cell : selected.selection.cells) values.push_back(get(cell));
    return to_array(std::move(values));
  };
}

template <class Get>
auto flags(Get get) {
  return [get](const Selected& selected) {
    return column<std::uint8_t>(get)(selected).attr("view")(py::dtype::of<bool>());
  };
}

void bind_camera(py::module_& module) {
  const Camera usual;
  py::class_<Camera>(module, "Camera", doc::camera)
      .def(py::init(&make_camera), py::arg("position"), py::arg("target"), py::arg("up") = Triple{0, 0, 1},
           py::arg("vertical_fov") = usual.vertical_fov)
      .def_property_readonly("position", [](const Camera& camera) { return to_tuple(camera.position); })
      .def_property_readonly("target", [](const Camera& camera) { return to_tuple(camera.target); })
      .def_property_readonly("up", [](const Camera& camera) { return to_tuple(camera.up); })
      .def_readonly("vertical_fov", &Camera::vertical_fov);
  module.def("camera_path", &path_of, py::arg("hierarchy"), py::arg("path"), doc::camera_path);
}

}  // namespace

void bind_selections(py::module_& module) {
  bind_camera(module);
  py::class_<Selected>(module, "Selection", doc::selection)
      .def_property_readonly("cells", column<std::uint32_t>([](const SelectedCell& c) { return c.cell; }))
      .def_property_readonly("levels", column<std::uint8_t>([](const SelectedCell& c) { return c.level; }))
      .def_property_readonly("visible", flags([](const SelectedCell& c) { return c.visible; }))
      .def_property_readonly("morphing", flags([](const SelectedCell& c) { return c.morphing; }))
      .def_property_readonly("admissible", [](const Selected& selected) { return selected.radii.admissible; })
      .def_property_readonly("viewpoint",
                             [](const Selected& selected) { return to_tuple(to_double(selected.viewpoint)); })
      .def("positions", &drawn_positions, py::arg("index"), doc::selection_positions)
      .def("mesh", &mesh_of, doc::selection_mesh)
      .def("__len__", [](const Selected& selected) { return selected.selection.cells.size(); });
  module.def("select", &select, py::arg("hierarchy"), py::arg("camera"), doc::select);
  module.def("cracks", &cracks, py::arg("selection"), doc::cracks);
  module.def("pops", &pops, py::arg("before"), py::arg("after"), doc::pops);
}

}  // namespace lodestone::python
