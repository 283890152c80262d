// Ids of cells, vertices and triangles as types of their own: a call that exchanges two of them does not compile.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace lodestone {

// A 32-bit index that knows what it counts. An integer becomes an id only where the code says so; an id reads as an
// integer anywhere, so that it indexes, compares, adds up and prints as one. Arrays on disk and in packed layouts hold
// plain integers.
template <class Subject>
class Id {
 public:
  constexpr Id() = default;
  constexpr explicit Id(std::integral auto value) : value_(static_cast<std::uint32_t>(value)) {}
  constexpr operator std::uint32_t() const { return value_; }
  constexpr Id& operator++() {
    ++value_;
    return *this;
  }

 private:
  std::uint32_t value_ = 0;
};

// Ids of different subjects cannot be compared.
template <class A, class B>
requires(!std::same_as<A, B>) bool operator==(Id<A>, Id<B>) = delete;
template <class A, class B>
requires(!std::same_as<A, B>) bool operator<=>(Id<A>, Id<B>) = delete;

using CellId = Id<struct Cell>;            // index in Hierarchy::cells
using CellRank = Id<struct LevelCells>;    // index of a cell among those of its level, in Morton order
using VertexId = Id<struct VertexOfMesh>;  // index of a vertex in its mesh; in a hierarchy, in its cell
using TriangleId = Id<struct Triangle>;    // index of a triangle in its mesh; in a hierarchy, in its cell

}  // namespace lodestone

template <class Subject>
struct std::hash<lodestone::Id<Subject>> {
  std::size_t operator()(lodestone::Id<Subject> id) const { return std::hash<std::uint32_t>{}(id); }
};
