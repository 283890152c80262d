// Hierarchies: built, saved, loaded, verified; their levels and cells as arrays.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/hierarchy/model/level_mesh.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/subjects/build.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/save.h"
#include "parallel/out_of_core/build_model.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/docs.h"
#include "python/bindings/json_values.h"
#include "render/lod/verify_radii.h"

namespace lodestone::python {
namespace {

namespace fs = std::filesystem;

// A cell with the hierarchy that holds its arrays.
struct CellOf {
  ModelPtr model;
  const Cell* cell = nullptr;
};

ModelConfig take_config(Options& options) {
  ModelConfig config;
  BuildConfig& build = config.build;
  options.take("sigma0", build.sigma0);
  options.take("cell_triangles", build.cell_triangles);
  options.take("finest_level", build.finest_level);
  options.take("half_levels", build.half_levels);
  options.take("simplifier", build.simplifier);
  options.take<std::string>("placement", build.placement, placement_named);
  options.take<std::string>("strategy", build.strategy, [](const std::string& name) { return strategy_named(name); });
  options.take("refine", build.refine);
  options.take("refine_limit", build.refine_limit);
  options.take("measure_errors", config.measure_errors);
  options.take("texture_levels", config.texture_copies);
  if (options.take("compress", build.order_cells) && build.order_cells) config.lattice = {Lattice::automatic};
  options.take("lattice_bits", config.lattice.bits);
  if (const int bits = config.lattice.bits; bits < Lattice::automatic || bits > Lattice::most_bits)
    throw UsageError("lattice_bits: " + std::to_string(bits) + " is not between 1 and " +
                     std::to_string(Lattice::most_bits));
  return config;
}

ModelPtr build(const py::object& mesh, const py::kwargs& given) {
  Options options("build", given);
  ModelConfig config = take_config(options);
  const MeshSource source = mesh_source(mesh);
  LongCall call(options);
  options.finish();
  config.build.cancel = call.cancel();
  config.progress = [&](const ModelProgress& now) { call.report(now.step, now.share); };
  return call.run([&] {
    ModelResult made = build_model(take_mesh(source, call), source.path.string(), config, call.scheduler());
    return std::make_shared<Model>(Model{std::move(made.hierarchy), std::move(made.warnings)});
  });
}

ModelPtr load_hierarchy(const fs::path& path, const py::kwargs& given) {
  Options options("load", given);
  LongCall call(options);
  options.finish();
  call.report("reading", 0);
  return call.run([&] { return std::make_shared<Model>(Model{load_lode(path, call.scheduler()), {}}); });
}

std::uint64_t save_hierarchy(const ModelPtr& model, const fs::path& path, const py::kwargs& given) {
  Options options("Hierarchy.save", given);
  bool compress = false;
  options.take("compress", compress);
  LongCall call(options);
  options.finish();
  CellSource cells(model->hierarchy);
  const auto count = static_cast<double>(model->hierarchy.cells.size());
  return call.run([&] {
    return save_lode(cells, path, call.scheduler(), compress ? LodeForm::compressed : LodeForm::plain,
                     [&](std::size_t done) { call.report("writing", static_cast<double>(done) / count); });
  });
}

py::object to_python_report(const VerifyReport& report) {
  Json checks = Json::array();
  for (const VerifyCheck& check : report.checks)
    checks.push_back({{"name", check.name}, {"passed", check.passed}, {"detail", check.detail}});
  return to_python({{"valid", report.valid()}, {"checks", checks}, {"sampled_over_error", report.error_ratio}});
}

py::object verify(const ModelPtr& model, const py::kwargs& given) {
  Options options("verify", given);
  py::object input = py::none();
  options.take("input", input);
  std::optional<MeshSource> source;
  if (!input.is_none()) source = mesh_source(input);
  LongCall call(options);
  options.finish();
  const VerifyReport report = call.run([&] {
    std::optional<IndexedMesh> mesh;
    Repairs repairs;
    if (source)
      mesh = prepare_mesh(take_mesh(*source, call), repairs, call.scheduler(), source->path.string(),
                          model->hierarchy.transform.lattice);
    call.report("verifying", 0);
    return verify_with_radii(model->hierarchy, call.scheduler(), mesh ? &*mesh : nullptr,
                             [&](double share) { call.report_or_stop("verifying", share); });
  });
  return to_python_report(report);
}

MeshPtr mesh_of_level(const ModelPtr& model, int level) {
  const py::gil_scoped_release free;
  return std::make_shared<RawMesh>(level_mesh(model->hierarchy, level));
}

CellOf cell_at(const ModelPtr& model, std::int64_t index) {
  const auto& cells = model->hierarchy.cells;
  if (index < 0 || index >= static_cast<std::int64_t>(cells.size()))
    throw py::index_error("there is no cell " + std::to_string(index) + "; there are " + std::to_string(cells.size()));
  return {model, &cells[static_cast<std::size_t>(index)]};
}

template <class Value>
auto array_of(std::span<const Value> Cell::*values) {
  return [values](const py::object& self) { return view_of(self.cast<const CellOf&>().cell->*values, self); };
}

// Copies, as short indices have another type.
template <class Value>
auto array_of(IndexView<Value> Cell::*values) {
  return [values](const CellOf& of) {
    const IndexView<Value>& view = of.cell->*values;
    return to_array(std::vector<Value>(view.begin(), view.end()));
  };
}

py::object parent_of(const CellOf& of) {
  return of.cell->parent == no_cell ? py::object(py::none()) : py::int_(std::uint32_t{of.cell->parent});
}

py::array normals_of(const CellOf& of) {
  std::vector<Vec3f> normals;
  for (const PackedNormal normal : of.cell->normals) normals.push_back(unpack_normal(normal));
  return to_array(std::move(normals));
}

py::array vec3_array(Vec3d v) { return to_array(std::vector<double>{v.x, v.y, v.z}); }

py::tuple bounds_of(const CellOf& of) {
  const Box3f& box = of.cell->bounds;
  return py::make_tuple(vec3_array(to_double(box.lo)), vec3_array(to_double(box.hi)));
}

void bind_cell(py::module_& module) {
  py::class_<CellOf>(module, "Cell", doc::cell)
      .def_property_readonly("positions", array_of(&Cell::positions))
      .def_property_readonly("triangles", array_of(&Cell::triangles))
      .def_property_readonly("parents", array_of(&Cell::parents))
      .def_property_readonly("shared_ids", array_of(&Cell::shared_ids))
      .def_property_readonly("normals", &normals_of)
      .def_property_readonly("level",
                             [](const CellOf& of) {
                               const Hierarchy& hierarchy = of.model->hierarchy;
                               return hierarchy.level_of(CellId(of.cell - hierarchy.cells.data()));
                             })
      .def_property_readonly("parent", &parent_of)
      .def_property_readonly(
          "children",
          [](const CellOf& of) {
            const std::uint32_t first = of.cell->child_count > 0 ? std::uint32_t{of.cell->first_child} : 0;
            return py::module_::import("builtins").attr("range")(first, first + of.cell->child_count);
          })
      .def_property_readonly("bounds", &bounds_of)
      .def_property_readonly("error", [](const CellOf& of) { return of.cell->error; });
}

}  // namespace

void bind_hierarchies(py::module_& module) {
  bind_cell(module);
  py::class_<Model, ModelPtr>(module, "Hierarchy", doc::hierarchy)
      .def_property_readonly("finest", [](const Model& model) { return model.hierarchy.finest(); })
      .def_property_readonly("cell_count", [](const Model& model) { return model.hierarchy.cells.size(); })
      .def_property_readonly("levels", [](const Model& model) { return to_python(level_table(model.hierarchy)); })
      .def_property_readonly("sigma0", [](const Model& model) { return model.hierarchy.sigma0; })
      .def_property_readonly("half_levels", [](const Model& model) { return model.hierarchy.grids.halves; })
      .def_property_readonly("origin", [](const Model& model) { return vec3_array(model.hierarchy.transform.origin); })
      .def_property_readonly("scale", [](const Model& model) { return model.hierarchy.transform.scale; })
      .def_property_readonly("lattice_bits", [](const Model& model) { return model.hierarchy.transform.lattice.bits; })
      .def_readonly("warnings", &Model::warnings)
      .def("mesh", &mesh_of_level, py::arg("level"), doc::hierarchy_mesh)
      .def("cell", &cell_at, py::arg("index"), doc::hierarchy_cell)
      .def("save", &save_hierarchy, py::arg("path"), doc::hierarchy_save)
      .def("__repr__", [](const Model& model) {
        return "<lodestone.Hierarchy: levels 0 to " + std::to_string(model.hierarchy.finest()) + ", " +
               std::to_string(model.hierarchy.cells.size()) + " cells>";
      });
  module.def("build", &build, py::arg("mesh"), doc::build);
  module.def("load", &load_hierarchy, py::arg("path"), doc::load);
  module.def("verify", &verify, py::arg("hierarchy"), doc::verify);
}

}  // namespace lodestone::python
