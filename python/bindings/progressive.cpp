// Progressive meshes: made, saved, loaded, and their levels.
#include <pybind11/stl/filesystem.h>

#include "core/base/error.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "experiments/command_line/exit_status.h"
#include "parallel/clean/prepare.h"
#include "parallel/progressive/level_errors.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/runner.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/docs.h"

namespace lodestone::python {
namespace {

namespace fs = std::filesystem;

// A mesh, and where its levels are.
struct Levels {
  explicit Levels(ProgressiveMesh&& made) : mesh(std::move(made)), finder(mesh) {}
  const ProgressiveMesh mesh;
  const LevelFinder finder;
};
using LevelsPtr = std::shared_ptr<Levels>;

LevelsPtr make_levels(const py::object& mesh, const py::kwargs& given) {
  Options options("progressive", given);
  ProgressiveConfig config;
  std::optional<progressive::MetricKind> metric;
  bool normals = true;
  options.take<std::string>("metric", metric, progressive::metric_kind);
  options.take("base_triangles", config.base_triangles);
  options.take("finest_triangles", config.finest_triangles);
  options.take("normals", normals);
  const MeshSource source = mesh_source(mesh);
  LongCall call(options);
  options.finish();
  return call.run([&] {
    RawMesh raw = take_mesh(source, call);
    if (!normals) raw.wedges.normal.clear();
    Repairs repairs;
    IndexedMesh clean = prepare_mesh(std::move(raw), repairs, call.scheduler(), source.path.string());
    config.metric = metric.value_or(fitting_metric(clean.wedges));
    call.report("collapsing", 0);
    ProgressiveReport report;
    return std::make_shared<Levels>(make_progressive(std::move(clean), config, call.scheduler(), report));
  });
}

LevelsPtr load_levels(const fs::path& path) {
  const py::gil_scoped_release free;
  return std::make_shared<Levels>(load_progressive(path));
}

std::size_t save_levels(const LevelsPtr& levels, const fs::path& path, const py::kwargs& given) {
  Options options("Progressive.save", given);
  ProgressiveFileConfig config;
  options.take("position_bits", config.lpm.position_bits);
  options.take("uv_bits", config.lpm.uv_bits);
  options.take("compress", config.compress_glb);
  LongCall call(options);
  options.finish();
  call.report("writing", 0);
  return call.run([&] { return save_progressive(levels->mesh, path, config, runner_over(call.scheduler())).bytes; });
}

// One of them, as `lodestone lod` takes it.
struct LevelChoice {
  std::optional<std::uint32_t> vertices;
  std::optional<std::uint64_t> triangles;
  std::optional<double> error;
};

std::uint32_t vertices_of(const LevelChoice& choice, const Levels& levels, Scheduler& scheduler) {
  const auto& [mesh, finder] = levels;
  if (choice.vertices) return finder.vertices_for(*choice.vertices);
  if (choice.triangles) return finder.vertices_for_triangles(*choice.triangles);
  if (*choice.error < mesh.finest_error * mesh.transform.scale)
    throw InputError("error: no level is so near to the input; the finest is within " +
                     std::to_string(mesh.finest_error * mesh.transform.scale));
  return LevelErrors(mesh, finder, scheduler).vertices_for(*choice.error / mesh.transform.scale);
}

MeshPtr level(const LevelsPtr& levels, const py::kwargs& given) {
  Options options("Progressive.level", given);
  LevelChoice choice;
  options.take("vertices", choice.vertices);
  options.take("triangles", choice.triangles);
  options.take("error", choice.error);
  LongCall call(options);
  options.finish();
  if (choice.vertices.has_value() + choice.triangles.has_value() + choice.error.has_value() != 1)
    throw UsageError("Progressive.level: give one of vertices, triangles and error");
  return call.run([&] {
    RawMesh mesh = levels->finder.level_mesh(vertices_of(choice, *levels, call.scheduler()));
    if (mesh.triangles.empty()) throw InputError("the level has no triangles; ask for a finer one");
    return std::make_shared<RawMesh>(std::move(mesh));
  });
}

template <class Value>
auto array_of(std::vector<Value> ProgressiveMesh::*values) {
  return [values](const py::object& self) { return view_of(std::span(self.cast<const Levels&>().mesh.*values), self); };
}

}  // namespace

void bind_progressive(py::module_& module) {
  py::class_<Levels, LevelsPtr>(module, "Progressive", doc::levels)
      .def_property_readonly("positions", array_of(&ProgressiveMesh::positions))
      .def_property_readonly("parents", array_of(&ProgressiveMesh::parents))
      .def_property_readonly("errors", array_of(&ProgressiveMesh::errors))
      .def_property_readonly("triangles", array_of(&ProgressiveMesh::triangles))
      .def_property_readonly("base_vertices", [](const Levels& levels) { return levels.mesh.base_vertices; })
      .def_property_readonly(
          "finest_error", [](const Levels& levels) { return levels.mesh.finest_error * levels.mesh.transform.scale; })
      .def("level", &level, doc::levels_level)
      .def("save", &save_levels, py::arg("path"), doc::levels_save)
      .def("__repr__", [](const Levels& levels) {
        return "<lodestone.Progressive: " + std::to_string(levels.mesh.triangles.size()) + " triangles, base of " +
               std::to_string(levels.mesh.base_vertices) + " vertices>";
      });
  module.def("progressive", &make_levels, py::arg("mesh"), doc::progressive);
  module.def("load_progressive", &load_levels, py::arg("path"), doc::load_progressive);
}

}  // namespace lodestone::python
