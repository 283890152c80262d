// Meshes: read, generated, made of arrays, compared, reconstructed.
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "core/formats/mesh_file.h"
#include "core/formats/mesh_reader.h"
#include "core/mesh/generate.h"
#include "core/mesh/raw_mesh.h"
#include "core/mesh/up_axis.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/subjects/compare.h"
#include "experiments/subjects/reconstruct.h"
#include "parallel/clean/prepare.h"
#include "parallel/mesh/compare.h"
#include "parallel/mesh/generate.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/scheduler.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/docs.h"
#include "python/bindings/json_values.h"
#include "render/reconstruct/finish/resample_attributes.h"
#include "render/reconstruct/reconstruct.h"

namespace lodestone::python {
namespace {

namespace fs = std::filesystem;

void take_up(Options& options, std::optional<UpAxis>& up) {
  options.take<std::string>("up", up, [](const std::string& name) { return up_axis(name); });
}

// An attribute of the vertices, for each of them or for none.
template <class Value>
void take_attribute(Options& options, const std::string& name, std::vector<Value>& values, std::size_t vertices) {
  py::object given = py::none();
  if (!options.take(name, given)) return;
  values = from_array<Value>(given, name);
  if (values.size() != vertices)
    throw InputError(name + ": " + std::to_string(values.size()) + " values for " + std::to_string(vertices) +
                     " vertices");
}

MeshPtr make_mesh(const py::object& positions, const py::object& triangles, const py::kwargs& given) {
  Options options("Mesh", given);
  const auto mesh = std::make_shared<RawMesh>();
  mesh->positions = from_array<Vec3d>(positions, "positions");
  mesh->triangles = from_array<Triangle>(triangles, "triangles");
  const std::size_t count = mesh->positions.size();
  for (const Triangle& triangle : mesh->triangles)
    for (const std::uint32_t corner : triangle.v)
      if (corner >= count)
        throw InputError("triangles: there is no vertex " + std::to_string(corner) + "; there are " +
                         std::to_string(count));
  require_triangles(*mesh, "Mesh");
  take_attribute(options, "uv", mesh->wedges.uv, count);
  take_attribute(options, "normals", mesh->wedges.normal, count);
  take_attribute(options, "colours", mesh->wedges.colour, count);
  std::optional<UpAxis> up;
  take_up(options, up);
  options.finish();
  if (up) mesh->up = {*up, false};
  return mesh;
}

MeshPtr read(const fs::path& path, const py::kwargs& given) {
  Options options("read", given);
  ReadConfig config;
  options.take("attributes", config.attributes);
  options.take("fill_voids", config.fill_voids);
  options.take("allow_outside", config.allow_outside);
  take_up(options, config.up);
  LongCall call(options);
  options.finish();
  call.report("reading", 0);
  config.progress = [&](double share) { call.report("reading", share); };
  return call.run([&] { return std::make_shared<RawMesh>(load_mesh(path, call.scheduler(), config)); });
}

MeshPtr generate(const std::string& shape_name, const py::kwargs& given) {
  Options options("generate", given);
  GenerateConfig config;
  config.shape = shape_named(shape_name);
  options.take("triangles", config.triangles);
  options.take("seed", config.seed);
  LongCall call(options);
  options.finish();
  call.report("generating", 0);
  const auto scheduler =
      make_watched_scheduler(call.scheduler(), {.progress = [&](const std::string& work, double share) {
                               if (!work.empty()) call.report(work, share);
                             }});
  return call.run([&] { return std::make_shared<RawMesh>(generate_mesh(config, *scheduler)); });
}

std::vector<std::string> save_mesh(const RawMesh& mesh, const fs::path& path) {
  const py::gil_scoped_release free;
  if (mesh.wedges.corners.empty()) return write_mesh(path, mesh);
  const RawMesh split = split_wedges(mesh);
  return write_mesh(path, split);
}

py::object compare(const py::object& a, const py::object& b, const py::kwargs& given) {
  using lodestone::to_json;
  Options options("compare", given);
  CompareConfig config;
  options.take("area_points", config.area_points);
  const MeshSource sources[2] = {mesh_source(a), mesh_source(b)};
  LongCall call(options);
  options.finish();
  call.report("comparing", 0);
  const MeshDistance distance = call.run([&] {
    RawMesh read[2];
    const RawMesh* meshes[2]{};
    for (const int side : {0, 1}) {
      if (!sources[side].mesh) read[side] = load_mesh(sources[side].path, call.scheduler(), {.attributes = false});
      meshes[side] = sources[side].mesh ? sources[side].mesh.get() : &read[side];
    }
    return compare_meshes(*meshes[0], *meshes[1], config, call.scheduler());
  });
  Row row = to_row(distance);
  row.update({{"diagonal", distance.diagonal},
              {"forward", to_json(distance.forward)},
              {"backward", to_json(distance.backward)}});
  return to_python(row);
}

MeshPtr reconstruct_mesh(const py::object& mesh, const py::kwargs& given) {
  Options options("reconstruct", given);
  ReconstructConfig config;
  std::uint64_t triangles = 0;
  options.take("resolution", config.resolution);
  options.take("triangles", triangles);
  options.take("attributes", config.attributes);
  options.take("backend", config.backend);
  options.take("detail", config.detail);
  options.take<std::string>("merge", config.merge, [](const std::string& name) {
    return name == "shell" ? MergeKind::shell : merge_kind(name);
  });
  options.take<std::string>("projection", config.projection, projection_kind);
  const MeshSource source = mesh_source(mesh);
  LongCall call(options);
  options.finish();
  return call.run([&] {
    RawMesh raw = take_mesh(source, call);
    if (!config.attributes) raw.wedges = {}, raw.materials.clear(), raw.textures.clear();
    Repairs repairs;
    const IndexedMesh clean = prepare_mesh(std::move(raw), repairs, call.scheduler(), source.path.string());
    call.report("reconstructing", 0);
    const Reconstruction made = triangles > 0 ? reconstruct_to_triangles(clean, config, triangles, call.scheduler())
                                              : reconstruct(clean, config, call.scheduler());
    if (made.mesh.triangles.empty())
      throw InputError(describe(source.path.string(), "", "no view sees three neighbouring samples of a surface",
                                "give a higher resolution"));
    return std::make_shared<RawMesh>(split_wedges(made.mesh));
  });
}

// A property: the array, or None where the mesh has none.
template <class Get>
auto array_or_none(Get get) {
  return [get](const py::object& self) -> py::object {
    const auto& values = get(self.cast<const RawMesh&>());
    if (values.empty()) return py::none();
    return view_of(std::span(values), self);
  };
}

}  // namespace

MeshSource mesh_source(const py::object& given) {
  if (py::isinstance<RawMesh>(given)) return {given.cast<MeshPtr>(), "mesh"};
  try {
    return {nullptr, given.cast<fs::path>()};
  } catch (const py::cast_error&) {
    throw UsageError(py::repr(given).cast<std::string>() + " is neither a Mesh nor the name of a file");
  }
}

RawMesh take_mesh(const MeshSource& source, LongCall& call) {
  if (source.mesh) return *source.mesh;
  call.report("reading", 0);
  return load_mesh(source.path, call.scheduler(), {.progress = [&](double share) { call.report("reading", share); }});
}

void bind_meshes(py::module_& module) {
  py::class_<RawMesh, MeshPtr>(module, "Mesh", doc::mesh)
      .def(py::init(&make_mesh), py::arg("positions"), py::arg("triangles"))
      .def_property_readonly("positions", array_or_none([](const RawMesh& m) -> auto& { return m.positions; }))
      .def_property_readonly("triangles", array_or_none([](const RawMesh& m) -> auto& { return m.triangles; }))
      .def_property_readonly("uv", array_or_none([](const RawMesh& m) -> auto& { return m.wedges.uv; }))
      .def_property_readonly("normals", array_or_none([](const RawMesh& m) -> auto& { return m.wedges.normal; }))
      .def_property_readonly("colours", array_or_none([](const RawMesh& m) -> auto& { return m.wedges.colour; }))
      .def_property_readonly("corners", array_or_none([](const RawMesh& m) -> auto& { return m.wedges.corners; }))
      .def_property_readonly("materials", array_or_none([](const RawMesh& m) -> auto& { return m.wedges.material; }))
      .def_property_readonly("up", [](const RawMesh& mesh) { return std::string(name_of(mesh.up.axis)); })
      .def_readonly("warnings", &RawMesh::warnings)
      .def("save", &save_mesh, py::arg("path"), doc::mesh_save)
      .def("__repr__", [](const RawMesh& mesh) {
        return "<lodestone.Mesh: " + std::to_string(mesh.triangles.size()) + " triangles, " +
               std::to_string(mesh.positions.size()) + " vertices>";
      });
  module.def("read", &read, py::arg("path"), doc::read);
  module.def("generate", &generate, py::arg("shape"), doc::generate);
  module.def("compare", &compare, py::arg("a"), py::arg("b"), doc::compare);
  module.def("reconstruct", &reconstruct_mesh, py::arg("mesh"), doc::reconstruct);
}

}  // namespace lodestone::python
