// Residency: a camera at rest comes to rest, with the families that it has always had, whatever came before and in
// whatever order families arrive.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "core/hierarchy/model/distance_metric.h"
#include "render/lod/limits.h"
#include "render/lod/residency.h"
#include "tests/render/lod/random_tables.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr std::uint64_t root_bytes = 100;

// The rule of choose_families on a sorted list.
std::set<CellId> choose_slowly(const Case& c) {
  const Tables& t = c.tables;
  std::vector<CellId> needed = c.needed;
  std::uint64_t room = c.room;
  if (c.need <= room) return {needed.begin(), needed.end()};
  std::stable_sort(needed.begin(), needed.end(), [&](CellId a, CellId b) {
    const float of_a = excess(t.hierarchy, t.radii, c.viewpoint, a),
                of_b = excess(t.hierarchy, t.radii, c.viewpoint, b);
    const auto away = [&](CellId cell) {
      return distance(DistanceMetric::euclidean, c.viewpoint, t.hierarchy.cells[cell].bounds);
    };
    return of_a != of_b ? of_a > of_b : away(a) < away(b);
  });
  std::set<CellId> chosen;
  std::vector<DetailLimit> limits;
  for (const CellId family : needed) {
    const Cell& cell = t.hierarchy.cells[family];
    const float radius = t.radius_of(family);
    if (family != 0 && !chosen.contains(cell.parent)) continue;
    if (limited_distance(t.radii.metric, c.viewpoint, cell.bounds, limits) >= radius) continue;
    if (t.bytes[family] <= room) {
      room -= t.bytes[family];
      chosen.insert(family);
    } else {
      limits.push_back({cell.bounds, radius});
      if (limits.size() == passed_over_at_most) break;
    }
  }
  return chosen;
}

TEST(FamilyChoice, IsThatOfASortedList) {
  std::mt19937 random(1);
  std::size_t short_of = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Case c(random);
    const std::vector<CellId> chosen = c.choose();
    EXPECT_EQ(std::set(chosen.begin(), chosen.end()), choose_slowly(c));
    EXPECT_LE(c.tables.bytes_of(chosen), c.room);
    short_of += c.room < c.need ? 1 : 0;
  }
  EXPECT_GT(short_of, 100u);
}

// Above a square of cells, most of them are equally far by Chebyshev's distance.
TEST(FamilyChoice, TakesTheNearestByEuclidOfThoseEquallyFar) {
  constexpr int side = 9;
  Tables t;
  t.hierarchy.levels.resize(3);
  t.hierarchy.cells.resize(1);
  t.hierarchy.cells[0].bounds = {{0, 0, 0}, {side, side, 0}};
  t.hierarchy.levels[0].cell_count = 1;
  t.add_level(1, [&](CellId) {
    std::vector<Box3f> boxes;
    for (int i = 0; i < side * side; ++i) {
      const auto x = static_cast<float>(i % side), y = static_cast<float>(i / side);
      boxes.push_back({{x, y, 0}, {x + 1, y + 1, 0}});
    }
    return boxes;
  });
  t.add_level(2, [&](CellId parent) { return std::vector<Box3f>{t.hierarchy.cells[parent].bounds}; });
  t.radii.metric = DistanceMetric::chebyshev;
  t.radii.select = {30, 20, 0};
  t.radii.band_begin = {0, 0, 0};
  t.radii.admissible = true;
  t.bytes.assign(t.hierarchy.cells.size(), 1);
  std::set<CellId> expected{CellId(0)};
  for (int y = 3; y < 6; ++y)
    for (int x = 3; x < 6; ++x) expected.insert(CellId(static_cast<std::uint32_t>(1 + side * y + x)));
  const auto chosen = choose_families(t.hierarchy, t.radii, {side / 2.0f, side / 2.0f, 10}, {t.bytes, expected.size()});
  EXPECT_EQ(std::set(chosen.begin(), chosen.end()), expected);
}

TEST(FamilyChoice, WastesNothing) {
  std::mt19937 random(2);
  std::size_t full = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const Case c(random);
    const Tables& t = c.tables;
    const std::vector<CellId> chosen = c.choose();
    const std::set<CellId> is_chosen(chosen.begin(), chosen.end());
    std::vector<DetailLimit> limits;
    std::uint64_t largest = 0;
    for (const CellId family : c.needed) {
      if (!is_chosen.contains(family)) limits.push_back({t.hierarchy.cells[family].bounds, t.radius_of(family)});
      largest = std::max(largest, t.bytes[family]);
    }
    // All that is chosen is drawn, or at the very border of it.
    for (const CellId family : chosen)
      EXPECT_LE(limited_distance(t.radii.metric, c.viewpoint, t.hierarchy.cells[family].bounds, limits),
                t.radius_of(family) * (1 + 1e-6f));
    if (largest > c.room / 10 || c.need <= c.room) continue;
    EXPECT_GT(t.bytes_of(chosen), c.room * 9 / 10);
    ++full;
  }
  EXPECT_GT(full, 10u);
}

// Loads what is wanted, each family after a while and in any order, as CellStream does; checks the budget.
class Loader {
 public:
  Loader(const Tables& tables, std::uint64_t budget, std::uint32_t seed)
      : tables_(tables),
        budget_(budget),
        random_(seed),
        residency_(tables.hierarchy, tables.bytes, root_bytes, budget, uniform(random_, 0.1f, 0.5f)) {}

  // A frame; true if it differs from the one before.
  bool draw(Vec3f viewpoint) {
    const std::vector<DetailLimit> before(residency_.limits().begin(), residency_.limits().end());
    const std::uint64_t wanted = tables_.bytes_of(residency_.wanted()), room = residency_.room();
    const std::vector<CellId> gone = residency_.make_room();
    for (const CellId c : gone) EXPECT_EQ(families.erase(c), 1u);
    if (!gone.empty()) {
      EXPECT_LT(room + tables_.bytes_of(gone) - tables_.bytes[gone.back()], wanted) << "gone for nothing";
    }
    bool changed = !gone.empty();
    std::shuffle(loading_.begin(), loading_.end(), random_);
    std::erase_if(loading_, [&](CellId c) {
      if (random_() % 3 > 0) return false;
      if (residency_.take_in(c)) changed = true, families.insert(c);
      return true;
    });
    const bool updated = residency_.update(tables_.radii, viewpoint);
    request();
    changed = changed || !std::ranges::equal(before, residency_.limits());
    EXPECT_TRUE(updated || !changed) << "a change is not told";
    return updated || !loading_.empty();
  }

  // Frames until none differs for a long time; at most so many.
  int rest(Vec3f viewpoint, int at_most) {
    int last = 0;
    for (int frame = 1; frame < last + 40 && frame < at_most; ++frame)
      if (draw(viewpoint)) last = frame;
    return last;
  }
  DetailLimits limits() const { return residency_.limits(); }

  std::set<CellId> families;

 private:
  void request() {
    std::uint64_t bytes = tables_.bytes_of(loading_);
    EXPECT_EQ(residency_.bytes(), root_bytes + tables_.bytes_of(families));
    EXPECT_LE(bytes + residency_.bytes(), budget_);
    for (const CellId c : residency_.wanted()) {
      if (std::ranges::find(loading_, c) != loading_.end()) continue;
      bytes += tables_.bytes[c];
      if (bytes > residency_.room()) return;
      loading_.push_back(c);
    }
  }

  const Tables& tables_;
  std::uint64_t budget_;
  std::mt19937 random_;
  Residency residency_;
  std::vector<CellId> loading_;
};

TEST(Residency, RestsWithACameraAtRestWhateverTheOrderOfArrivals) {
  std::mt19937 random(3);
  std::size_t short_of = 0;
  for (int trial = 0; trial < 150; ++trial) {
    SCOPED_TRACE(trial);
    const Case c(random);
    const Tables& t = c.tables;
    const std::set<CellId> chosen = choose_slowly(c);
    short_of += c.room < c.need ? 1 : 0;
    std::vector<float> radii;
    for (std::uint32_t history = 0; history < 4; ++history) {
      Loader loader(t, root_bytes + c.room, static_cast<std::uint32_t>(trial) * 10 + history);
      for (std::uint32_t k = 0; k < 40 * history; ++k) (void)loader.draw(random_point(random));
      const int limit = 300 + 20 * static_cast<int>(t.hierarchy.cells.size());
      EXPECT_LT(loader.rest(c.viewpoint, limit), limit - 40);
      std::set<CellId> held;
      for (const CellId family : c.needed)
        if (loader.families.contains(family)) held.insert(family);
      // Families that are needed but not chosen may remain where nobody wants their room; no limit differs for them.
      EXPECT_TRUE(std::ranges::includes(held, chosen));
      EXPECT_TRUE(history > 0 || held == chosen);
      std::vector<float> found;
      for (const DetailLimit& l : loader.limits()) found.push_back(l.radius);
      if (history == 0) radii = found;
      EXPECT_EQ(found, radii);
    }
  }
  EXPECT_GT(short_of, 80u);
}

}  // namespace
}  // namespace lodestone
