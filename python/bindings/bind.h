// The parts of the module, a subject each, and the objects that several of them know.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "core/mesh/indexed_mesh.h"
#include "python/bindings/long_call.h"

namespace lodestone::python {

namespace py = pybind11;

// A hierarchy as Python holds it. Nothing in it changes.
struct Model {
  Hierarchy hierarchy;
  std::vector<std::string> warnings;
};
using ModelPtr = std::shared_ptr<Model>;
using MeshPtr = std::shared_ptr<RawMesh>;

// A mesh or the name of a file that holds one. A mesh is copied, since what works on it consumes it.
struct MeshSource {
  MeshPtr mesh;                // null: the file
  std::filesystem::path path;  // "mesh" for a mesh: its name in messages
};
// Throws UsageError for something else.
[[nodiscard]] MeshSource mesh_source(const py::object& given);
[[nodiscard]] RawMesh take_mesh(const MeshSource& source, LongCall& call);

// In the order in which types have to be known.
void bind_errors(py::module_& module);
void bind_meshes(py::module_& module);
void bind_hierarchies(py::module_& module);
void bind_selections(py::module_& module);
void bind_pictures(py::module_& module);
void bind_progressive(py::module_& module);
void bind_experiments(py::module_& module);

}  // namespace lodestone::python
