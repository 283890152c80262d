#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "core/base/id.h"

namespace lodestone {
namespace {

template <class From, class To>
constexpr bool becomes = std::is_constructible_v<To, From> || std::is_convertible_v<From, To>;

template <class A, class B>
concept comparable = requires(A a, B b) {
  a < b;
}
|| requires(A a, B b) { a == b; };

// No id takes the place of another one, and a plain number becomes one only by name.
static_assert(!becomes<CellId, VertexId> && !becomes<VertexId, TriangleId> && !becomes<TriangleId, CellId>);
static_assert(!becomes<CellId, CellRank> && !becomes<CellRank, CellId>);
static_assert(!std::is_assignable_v<CellRank&, CellId> && !std::is_assignable_v<CellId&, std::uint32_t>);
static_assert(!std::is_convertible_v<std::uint32_t, CellId> && std::is_constructible_v<CellId, std::size_t>);
static_assert(!comparable<CellId, CellRank> && comparable<CellId, CellId> && comparable<CellId, std::uint32_t>);

// It costs what a plain number does.
static_assert(sizeof(CellId) == sizeof(std::uint32_t) && std::is_trivially_copyable_v<CellId>);

TEST(Id, ReadsAsItsNumber) {
  static_assert(CellId(7) == 7u && CellId(7) + 1 == 8u && CellId(7) < CellId(8) && CellId() == 0u);
  const std::vector<int> squares{0, 1, 4, 9};
  int sum = 0;
  for (VertexId v{0}; v < squares.size(); ++v) sum += squares[v];
  EXPECT_EQ(sum, 14);
  EXPECT_EQ(std::to_string(TriangleId(12)), "12");
}

TEST(Id, IsAKey) {
  std::unordered_map<CellId, int> values{{CellId(3), 1}, {CellId(5), 2}};
  ++values.at(CellId(5));
  EXPECT_EQ(values.at(CellId(5)), 3);
  EXPECT_FALSE(values.contains(CellId(4)));
}

}  // namespace
}  // namespace lodestone
