// Arrays of numpy over memory of ours, and back.
//
// An array that is a view shares the memory of the object that it belongs to, keeps that alive, and cannot be written.
#pragma once

#include <pybind11/numpy.h>

#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/math/vec3.h"
#include "core/mesh/attributes.h"

namespace lodestone::python {

namespace py = pybind11;

// The scalar that a record is made of, and how many of them: a Vec3f is 3 floats. A record of one is a column by
// itself.
template <class Of, py::ssize_t Width>
struct Columns {
  using Scalar = Of;
  static constexpr py::ssize_t width = Width;
};
template <class Record>
struct Layout : Columns<Record, 1> {};
template <>
struct Layout<Vec3f> : Columns<float, 3> {};
template <>
struct Layout<Vec3d> : Columns<double, 3> {};
template <>
struct Layout<Vec2f> : Columns<float, 2> {};
template <>
struct Layout<Triangle> : Columns<std::uint32_t, 3> {};

template <>
struct Layout<Rgba8> : Columns<std::uint8_t, 4> {};

template <class Record>
std::vector<py::ssize_t> shape_of(std::size_t count) {
  if (Layout<Record>::width == 1) return {static_cast<py::ssize_t>(count)};
  return {static_cast<py::ssize_t>(count), Layout<Record>::width};
}

// A view of shape (n,) or (n, width) that keeps `owner` alive.
template <class Record>
py::array view_of(std::span<const Record> records, py::handle owner) {
  using Scalar = typename Layout<Record>::Scalar;
  static_assert(sizeof(Record) == sizeof(Scalar) * static_cast<std::size_t>(Layout<Record>::width));
  py::array array(py::dtype::of<Scalar>(), shape_of<Record>(records.size()), records.data(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

// An array that takes the vector over.
template <class Record>
py::array to_array(std::vector<Record>&& records) {
  auto* const kept = new std::vector<Record>(std::move(records));
  const py::capsule owner(kept, [](void* memory) { delete static_cast<std::vector<Record>*>(memory); });
  using Scalar = typename Layout<Record>::Scalar;
  return py::array(py::dtype::of<Scalar>(), shape_of<Record>(kept->size()), kept->data(), owner);
}

// A copy of an array of shape (n,) or (n, width); numbers are converted as numpy does. Throws InputError, naming it,
// for another shape.
template <class Record>
std::vector<Record> from_array(const py::object& values, const std::string& name) {
  using Scalar = typename Layout<Record>::Scalar;
  constexpr py::ssize_t width = Layout<Record>::width;
  const auto array = py::array_t<Scalar, py::array::c_style | py::array::forcecast>::ensure(values);
  if (!array) throw py::error_already_set();
  const bool fits = width == 1 ? array.ndim() == 1 : array.ndim() == 2 && array.shape(1) == width;
  if (!fits)
    throw InputError(name + ": not an array of shape (n" + (width == 1 ? ",)" : ", " + std::to_string(width) + ")"));
  const auto* const first = reinterpret_cast<const Record*>(array.data());
  return std::vector<Record>(first, first + array.shape(0));
}

}  // namespace lodestone::python
