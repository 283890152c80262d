// The verifier passes what is right and names what is wrong: every check is seen failing.
#include <gtest/gtest.h>

#include <algorithm>
#include <barrier>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <string_view>
#include <thread>
#include <utility>

#include "core/hierarchy/model/find_signatures.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/hierarchy/verify/verify_peers.h"
#include "core/spatial/mesh_distance.h"
#include "tests/core/hierarchy/lattice_meshes.h"

namespace lodestone {
namespace {

using test::NaiveHierarchy;
using test::NaivePayload;

constexpr float sigma0 = 0.6f;
constexpr int finest = 2;

std::string failures_of(const VerifyReport& report) {
  std::string names;
  for (const VerifyCheck& check : report.checks)
    if (!check.passed) names += check.name + ": " + check.detail + "\n";
  return names;
}

TEST(Verify, PassesHierarchiesMadeByTheDefinitions) {
  for (const bool open : {false, true})
    for (const int levels : {0, 1, 2, 3})
      for (const float s : {0.05f, 0.2f, 0.6f}) {
        const IndexedMesh mesh = test::bumpy_sphere(4, open);
        const VerifyReport report = verify_hierarchy(test::naive_hierarchy(mesh, levels, s).hierarchy, &mesh);
        EXPECT_TRUE(report.valid()) << "L " << levels << " sigma0 " << s << "\n" << failures_of(report);
        EXPECT_EQ(report.checks.size(), 15u);
      }
}

TEST(Verify, AnswersWithoutTheInputToo) {
  const VerifyReport report = verify_hierarchy(test::naive_hierarchy(test::bumpy_sphere(3), 2, 0.2f).hierarchy);
  EXPECT_TRUE(report.valid());
  EXPECT_EQ(report.find("input"), nullptr);
  EXPECT_FALSE(VerifyReport{}.valid());
}

// Points spread over both surfaces are the slow twin of the verifier's; halved errors are exceeded twice as far.
TEST(Verify, TellsItsProgressUpToTheEnd) {
  for (const IndexedMesh& mesh : {test::bumpy_sphere(3), test::bumpy_sphere(4)}) {
    std::vector<double> told;
    (void)verify_hierarchy(test::naive_hierarchy(mesh, finest, sigma0).hierarchy, &mesh,
                           [&](double share) { told.push_back(share); });
    ASSERT_FALSE(told.empty());
    EXPECT_GT(told.front(), 0);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_EQ(told.back(), 1);
  }
}

TEST(Verify, SaysHowFarPointsExceedTheErrors) {
  Hierarchy h = test::naive_hierarchy(test::bumpy_sphere(4), finest, sigma0).hierarchy;
  const std::vector<double> ratio = verify_hierarchy(h).error_ratio;
  ASSERT_EQ(ratio.size(), 3u);
  EXPECT_EQ(ratio[finest], 0);
  for (int l = 0; l < finest; ++l) {
    const MeshDistance distance = compare_meshes(level_mesh(h, l), level_mesh(h, finest), {50'000});
    const double sampled = std::max(distance.forward.max, distance.backward.max) / h.transform.scale;
    const double error = double{h.levels[static_cast<std::size_t>(l)].error} * cell_size(l);
    EXPECT_GT(sampled, 0);
    EXPECT_NEAR(ratio[static_cast<std::size_t>(l)], sampled / error, 0.1 * sampled / error) << l;
  }
  for (Cell& cell : h.cells) cell.error /= 2;
  for (Level& level : h.levels) level.error /= 2;
  const std::vector<double> doubled = verify_hierarchy(h).error_ratio;
  for (std::size_t l = 0; l < ratio.size(); ++l) EXPECT_NEAR(doubled[l], 2 * ratio[l], 1e-5 * ratio[l]) << l;
}

TEST(Verify, HasNoRatioWithoutStructure) {
  test::NaiveHierarchy broken = test::naive_hierarchy(test::bumpy_sphere(3), finest, sigma0);
  broken.hierarchy.cells[0].child_count = 1000;
  EXPECT_TRUE(verify_hierarchy(broken.hierarchy).error_ratio.empty());
}

// Places in a NaiveHierarchy that the breakages below aim at.
CellId first_of(const NaiveHierarchy& t, int level) {
  return t.hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
}
NaivePayload& finest_cell(NaiveHierarchy& t) { return (*t.payloads)[first_of(t, finest)]; }
NaivePayload& middle_cell(NaiveHierarchy& t) { return (*t.payloads)[first_of(t, 1)]; }
std::size_t first_shared(const NaivePayload& c) { return c.positions.size() - c.shared_ids.size(); }

Cell& most_moved_cell(NaiveHierarchy& t) {
  return *std::max_element(t.hierarchy.cells.begin(), t.hierarchy.cells.end(),
                           [](const Cell& a, const Cell& b) { return a.max_displacement < b.max_displacement; });
}

// A vertex of the cell that no other cell has and that has another parent to go to.
std::size_t own_vertex(const NaivePayload& cell) {
  EXPECT_GT(first_shared(cell), 0u);
  return 0;
}

// Peers that are threads, each with the families that its number says.
class ThreadPeer final : public VerifyPeers {
 public:
  struct Post {
    explicit Post(std::size_t peers) : boxes(peers, std::vector<Bytes>(peers)), arrived(static_cast<long>(peers)) {}
    std::vector<std::vector<Bytes>> boxes;  // by sender, then by receiver
    std::barrier<> arrived;
  };
  ThreadPeer(const Hierarchy& hierarchy, Post& post, std::size_t index)
      : hierarchy_(hierarchy), post_(post), index_(index) {}
  [[nodiscard]] std::size_t count() const override { return post_.boxes.size(); }
  [[nodiscard]] std::size_t index() const override { return index_; }
  [[nodiscard]] std::size_t owner(CellId cell) const override {
    return (hierarchy_.cells[cell].parent * 7u + 1) % count();
  }
  [[nodiscard]] std::vector<Bytes> exchange(std::vector<Bytes>&& out) override {
    post_.boxes[index_] = std::move(out);
    post_.arrived.arrive_and_wait();
    std::vector<Bytes> in;
    for (const std::vector<Bytes>& sent : post_.boxes) in.push_back(sent.at(index_));
    post_.arrived.arrive_and_wait();
    return in;
  }

 private:
  const Hierarchy& hierarchy_;
  Post& post_;
  std::size_t index_;
};

// The report of each peer.
std::vector<VerifyReport> reports_of_peers(const Hierarchy& hierarchy, std::size_t count) {
  ThreadPeer::Post post(count);
  std::vector<VerifyReport> reports(count);
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < count; ++i)
    threads.emplace_back([&, i] {
      ThreadPeer peer(hierarchy, post, i);
      reports[i] = verify_by_peers(hierarchy, peer);
    });
  threads.clear();
  return reports;
}

// Peers find what one process finds; which of several failures they name is another matter.
void expect_same_by_peers(const Hierarchy& hierarchy, std::initializer_list<std::size_t> counts,
                          const std::string& what) {
  const VerifyReport alone = verify_hierarchy(hierarchy);
  const auto numbers = [](const VerifyCheck& check) {
    return check.name + (check.passed ? " " + check.detail : check.detail.substr(check.detail.rfind(" (")));
  };
  for (const std::size_t count : counts)
    for (const VerifyReport& report : reports_of_peers(hierarchy, count)) {
      ASSERT_EQ(report.checks.size(), alone.checks.size()) << what;
      for (std::size_t i = 0; i < alone.checks.size(); ++i)
        EXPECT_EQ(numbers(report.checks[i]), numbers(alone.checks[i])) << what << ", " << count << " peers";
      EXPECT_EQ(report.error_ratio, alone.error_ratio) << what << ", " << count << " peers";
    }
}

struct Breakage {
  const char* check;  // the one that must fail
  const char* what;
  std::function<void(NaiveHierarchy&)> apply;
};

// Another parent than now, within the bound of (1) or not.
void send_elsewhere(NaiveHierarchy& t, CellId c, std::size_t v) {
  NaivePayload& cell = (*t.payloads)[c];
  const auto count = static_cast<std::uint32_t>((*t.payloads)[t.hierarchy.cells[c].parent].positions.size());
  cell.parents[v] = (cell.parents[v] + 1) % count;
}

const Breakage breakages[] = {
    {"structure", "level ranges", [](auto& t) { ++t.hierarchy.levels[1].first_cell; }},
    {"structure", "cells of no level", [](auto& t) { t.hierarchy.levels[finest].cell_count -= 1; }},
    {"structure", "Morton order",
     [](auto& t) { std::swap(t.hierarchy.cells[first_of(t, 1)].code, t.hierarchy.cells[first_of(t, 1) + 1].code); }},
    {"structure", "children", [](auto& t) { t.hierarchy.cells[0].child_count -= 1; }},
    {"structure", "parent", [](auto& t) { t.hierarchy.cells.back().parent = CellId(0); }},
    {"structure", "stored triangles", [](auto& t) { t.hierarchy.levels[1].triangles += 1; }},
    {"structure", "stored vertices", [](auto& t) { t.hierarchy.levels[1].vertices += 1; }},
    {"structure", "vertex index",
     [](auto& t) { finest_cell(t).triangles[0].v[0] = static_cast<std::uint32_t>(finest_cell(t).positions.size()); }},
    {"structure", "degenerate", [](auto& t) { finest_cell(t).triangles[0].v[0] = finest_cell(t).triangles[0].v[1]; }},
    {"structure", "parent index", [](auto& t) { finest_cell(t).parents[0] = 0xffff'ffffu; }},
    {"structure", "no parents", [](auto& t) { finest_cell(t).parents.pop_back(); }},
    {"structure", "no normals", [](auto& t) { finest_cell(t).normals.pop_back(); }},
    {"structure", "too many ids", [](auto& t) { finest_cell(t).shared_ids.resize(100'000); }},
    {"structure", "NaN", [](auto& t) { finest_cell(t).positions[0].x = std::nanf(""); }},
    {"structure", "no levels", [](auto& t) { t.hierarchy.levels.clear(); }},
    {"cells", "empty finest cell",
     [](auto& t) {
       t.hierarchy.levels[finest].triangles -= finest_cell(t).triangles.size();
       finest_cell(t).triangles.clear();
     }},
    {"partition", "triangle in the wrong cell",
     [](auto& t) { t.hierarchy.cells[first_of(t, finest)].code.morton ^= 1; }},
    {"partition", "vertex of no triangle",
     [](auto& t) {
       NaivePayload& cell = finest_cell(t);
       cell.positions.insert(cell.positions.begin(), Vec3f{0.1f, 0.1f, 0.1f});
       cell.normals.insert(cell.normals.begin(), PackedNormal{});
       cell.parents.insert(cell.parents.begin(), 0);
       for (Triangle& triangle : cell.triangles)
         for (std::uint32_t& v : triangle.v) ++v;
       t.hierarchy.levels[finest].vertices += 1;
     }},
    {"partition", "outside the root", [](auto& t) { finest_cell(t).positions[0].x = -0.001f; }},
    {"identity", "copies apart",
     [](auto& t) {
       Vec3f& p = finest_cell(t).positions.back();
       p.x = std::nextafter(p.x, 2.0f);
     }},
    {"identity", "minus zero is another pattern",
     [](auto& t) {
       for (std::size_t c = first_of(t, finest); c < t.payloads->size(); ++c)
         if ((*t.payloads)[c].shared_ids.back() == finest_cell(t).shared_ids.back())
           (*t.payloads)[c].positions.back().x = 0;
       finest_cell(t).positions.back().x = -0.0f;
     }},
    {"identity", "normals apart", [](auto& t) { finest_cell(t).normals.back().u ^= 1; }},
    {"identity", "shared by one cell", [](auto& t) { finest_cell(t).shared_ids.back() = 0xffff'fff0u; }},
    {"identity", "twice in one cell",
     [](auto& t) { finest_cell(t).shared_ids.back() = finest_cell(t).shared_ids.front(); }},
    {"identity", "not shared, though at one position",
     [](auto& t) {
       // The vertex comes first in its cell, so that it may be left out of the shared ones.
       NaivePayload& cell = finest_cell(t);
       cell.shared_ids.erase(cell.shared_ids.begin());
     }},
    {"identity", "id given to another vertex on the next level",
     [](auto& t) {
       // Two vertices that survive exchange their ids on level 1, in all copies.
       const NaivePayload& cell = middle_cell(t);
       ASSERT_GE(cell.shared_ids.size(), 2u);
       std::vector<std::uint32_t> kept;
       for (std::size_t c = first_of(t, finest); c < t.payloads->size(); ++c)
         for (const std::uint32_t id : (*t.payloads)[c].shared_ids)
           if (std::count(cell.shared_ids.begin(), cell.shared_ids.end(), id) > 0 && (kept.empty() || kept[0] != id))
             kept.push_back(id);
       ASSERT_GE(kept.size(), 2u);
       for (std::size_t c = first_of(t, 1); c < first_of(t, finest); ++c)
         for (std::uint32_t& id : (*t.payloads)[c].shared_ids)
           id = id == kept[0] ? kept[1] : id == kept[1] ? kept[0] : id;
     }},
    {"parents", "one copy goes elsewhere",
     [](auto& t) { send_elsewhere(t, first_of(t, finest), finest_cell(t).positions.size() - 1); }},
    {"parents", "on level 1 too",
     [](auto& t) { send_elsewhere(t, first_of(t, 1), middle_cell(t).positions.size() - 1); }},
    {"vertices", "vertex that is not a parent",
     [](auto& t) {
       NaivePayload& cell = (*t.payloads)[0];
       cell.positions.push_back(cell.positions[0]);
       cell.normals.push_back(cell.normals[0]);
       t.hierarchy.levels[0].vertices += 1;
     }},
    {"triangles", "own vertex goes elsewhere",
     [](auto& t) { send_elsewhere(t, first_of(t, finest), own_vertex(finest_cell(t))); }},
    {"triangles", "turned over",
     [](auto& t) { std::swap(middle_cell(t).triangles[0].v[0], middle_cell(t).triangles[0].v[1]); }},
    {"triangles", "one missing",
     [](auto& t) {
       middle_cell(t).triangles.pop_back();
       t.hierarchy.levels[1].triangles -= 1;
     }},
    {"triangles", "one twice",
     [](auto& t) {
       middle_cell(t).triangles.push_back(middle_cell(t).triangles[0]);
       t.hierarchy.levels[1].triangles += 1;
     }},
    {"displacement", "bound of (1)", [](auto& t) { t.hierarchy.sigma0 *= 0.4f; }},
    {"displacement", "stored too small",
     [](auto& t) {
       float& stored = most_moved_cell(t).max_displacement;
       stored = std::nextafter(stored, 0.0f);
     }},
    {"displacement", "stored too large", [](auto& t) { most_moved_cell(t).max_displacement *= 1.01f; }},
    {"displacement", "of the root", [](auto& t) { t.hierarchy.cells[0].max_displacement = 0.1f; }},
    {"edges", "longest too small", [](auto& t) { t.hierarchy.levels[1].max_edge *= 0.999f; }},
    {"edges", "longest too large", [](auto& t) { t.hierarchy.levels[1].max_edge *= 1.001f; }},
    {"edges", "long ones of the finest level", [](auto& t) { t.hierarchy.levels[finest].long_edges += 1; }},
    {"edges", "long ones of another level", [](auto& t) { t.hierarchy.levels[1].long_edges += 1; }},
    {"boxes", "too large",
     [](auto& t) { t.hierarchy.cells[1].bounds.hi.x = std::nextafter(t.hierarchy.cells[1].bounds.hi.x, 2.0f); }},
    {"boxes", "too small",
     [](auto& t) {
       t.hierarchy.cells.back().bounds.lo.y = std::nextafter(t.hierarchy.cells.back().bounds.lo.y, 2.0f);
     }},
    {"boxes", "without the children's",
     [](auto& t) {
       t.hierarchy.cells[0].bounds = {};
       for (const Vec3f p : (*t.payloads)[0].positions) t.hierarchy.cells[0].bounds.extend(p);
     }},
    {"reach", "Euclidean too small", [](auto& t) { t.hierarchy.levels[1].reach[0] *= 0.999f; }},
    {"reach", "Euclidean too large", [](auto& t) { t.hierarchy.levels[1].reach[0] *= 1.001f; }},
    {"reach", "Chebyshev too small", [](auto& t) { t.hierarchy.levels[finest].reach[1] *= 0.999f; }},
    {"reach", "diameter too small", [](auto& t) { t.hierarchy.levels[0].diameter *= 0.999f; }},
    {"errors", "not 0 on the finest level", [](auto& t) { t.hierarchy.cells.back().error = 1e-6f; }},
    {"errors", "less than the children's",
     [](auto& t) { t.hierarchy.cells[0].error = std::nextafter(t.hierarchy.cells[1].error, 0.0f); }},
    {"errors", "less than the distance of the children's vertices",
     [](auto& t) { t.hierarchy.cells[0].error = t.hierarchy.cells[1].error; }},
    {"errors", "absurdly large", [](auto& t) { t.hierarchy.cells[1].error *= 2; }},
    {"errors", "of the level", [](auto& t) { t.hierarchy.levels[1].error *= 0.99f; }},
    {"fingerprint", "triangle turned over",
     [](auto& t) { std::swap(finest_cell(t).triangles[0].v[0], finest_cell(t).triangles[0].v[1]); }},
    {"fingerprint", "fewer triangles", [](auto& t) { t.hierarchy.provenance.input_triangles -= 1; }},
    {"fingerprint", "fewer vertices", [](auto& t) { t.hierarchy.provenance.input_vertices -= 1; }},
    {"fingerprint", "another input", [](auto& t) { t.hierarchy.provenance.fingerprint += 1; }},
    {"input", "turned over",
     [](auto& t) { std::swap(finest_cell(t).triangles[0].v[0], finest_cell(t).triangles[0].v[1]); }},
    {"input", "moved by one place",
     [](auto& t) {
       float& x = finest_cell(t).positions[0].x;
       x = std::nextafter(x, 2.0f);
     }},
    {"input", "one twice, one missing", [](auto& t) { finest_cell(t).triangles[0] = finest_cell(t).triangles[1]; }},
    {"input", "another scale", [](auto& t) { t.hierarchy.transform.scale *= 2; }},
};

TEST(Verify, SeesEveryBreakageInTheCheckMeantForIt) {
  const IndexedMesh mesh = test::bumpy_sphere(4);
  const NaiveHierarchy whole = test::naive_hierarchy(mesh, finest, sigma0);
  ASSERT_TRUE(verify_hierarchy(whole.hierarchy, &mesh).valid());
  for (const Breakage& breakage : breakages) {
    NaiveHierarchy broken = whole;
    breakage.apply(broken);
    const VerifyReport report = verify_hierarchy(broken.attach(), &mesh);
    const VerifyCheck* check = report.find(breakage.check);
    ASSERT_NE(check, nullptr) << breakage.check;
    EXPECT_FALSE(check->passed) << breakage.check << ", " << breakage.what << "\n" << failures_of(report);
    EXPECT_FALSE(check->detail.empty());
    EXPECT_FALSE(report.valid());
    if (breakage.check != std::string_view("input")) expect_same_by_peers(broken.hierarchy, {3}, breakage.what);
  }
}

TEST(Verify, IsTheSameByAnyNumberOfPeers) {
  for (const int levels : {0, 1, 3}) {
    NaiveHierarchy model = test::naive_hierarchy(test::on_lattice(test::bumpy_sphere(4, true), {14}), levels, 0.2f);
    model.attach();
    Hierarchy& h = model.hierarchy;
    expect_same_by_peers(h, {1, 2, 5}, std::to_string(levels) + " levels");
    h.signatures = std::make_shared<const Signatures>(find_signatures(h));
    expect_same_by_peers(h, {1, 2, 5}, std::to_string(levels) + " levels with signatures");
    Signatures::Table table = h.signatures->table();
    std::ranges::rotate(table.places, table.places.begin() + static_cast<std::ptrdiff_t>(table.places.size() / 2));
    for (float& error : table.errors) error /= 2;
    if (Signatures::fault(h, table)) continue;
    h.signatures = std::make_shared<const Signatures>(h, std::move(table));
    EXPECT_EQ(verify_hierarchy(h).valid(), levels == 0);
    expect_same_by_peers(h, {1, 2, 5}, std::to_string(levels) + " levels with wrong signatures");
  }
}

TEST(Verify, ChecksSignaturesWhereThereAreSome) {
  NaiveHierarchy model = test::naive_hierarchy(test::bumpy_sphere(4), finest, sigma0);
  EXPECT_EQ(verify_hierarchy(model.attach()).find("signatures"), nullptr);
  const Signatures::Table whole = find_signatures(model.hierarchy).table();
  const auto passes = [&](const auto& change) {
    Signatures::Table table = whole;
    change(table);
    EXPECT_EQ(Signatures::fault(model.hierarchy, table), nullptr);
    model.hierarchy.signatures = std::make_shared<const Signatures>(model.hierarchy, std::move(table));
    const VerifyReport report = verify_hierarchy(model.hierarchy);
    EXPECT_EQ(report.valid(), report.find("signatures")->passed);
    return report.find("signatures")->passed;
  };
  EXPECT_TRUE(passes([](auto&) {}));
  // Another place: copies differ, or none is that of all users.
  EXPECT_FALSE(passes([](auto& t) { t.places.back() = t.places.back() == 1 ? 2 : 1; }));
  EXPECT_FALSE(passes([](auto& t) { t.places.back() = 0; }));
}

TEST(Verify, ChecksTheErrorsOfSignatures) {
  NaiveHierarchy model = test::naive_hierarchy(test::bumpy_sphere(4), finest, sigma0);
  const Signatures::Table whole = find_signatures(model.attach()).table();
  const auto failed = [&](const auto& change) {
    Signatures::Table table = whole;
    for (float& error : table.errors) change(error);
    model.hierarchy.signatures = std::make_shared<const Signatures>(model.hierarchy, std::move(table));
    std::string names;
    for (const VerifyCheck& check : verify_hierarchy(model.hierarchy).checks)
      if (!check.passed) names += check.name;
    return names;
  };
  EXPECT_EQ(failed([](float&) {}), "");
  EXPECT_EQ(failed([](float& error) { error = 0; }), "errors");  // vertices have moved
  EXPECT_EQ(failed([](float& error) { error *= 1.01f; }), "errors");
}

TEST(Verify, ChecksTheLatticeAndWhatItAddsToTheErrors) {
  const IndexedMesh mesh = test::on_lattice(test::bumpy_sphere(4), {14});
  const NaiveHierarchy whole = test::naive_hierarchy(mesh, finest, sigma0);
  EXPECT_TRUE(verify_hierarchy(whole.hierarchy, &mesh).valid())
      << failures_of(verify_hierarchy(whole.hierarchy, &mesh));
  const Breakage lattice_breakages[] = {
      {"structure", "out of range", [](auto& t) { t.hierarchy.transform.lattice.bits = 25; }},
      {"lattice", "off the lattice on the finest level",
       [](auto& t) { finest_cell(t).positions[0].x += 0.25f * t.hierarchy.transform.lattice.step(); }},
      {"lattice", "off the lattice on a coarse level",
       [](auto& t) { middle_cell(t).positions[0].z += 0.25f * t.hierarchy.transform.lattice.step(); }},
      {"lattice", "another lattice", [](auto& t) { t.hierarchy.transform.lattice.bits = 13; }},
      {"errors", "without the lattice's share", [](auto& t) { t.hierarchy.cells.back().error = 0; }},
      {"errors", "a lattice that is said to be finer", [](auto& t) { t.hierarchy.transform.lattice.bits = 15; }},
      {"input", "on another lattice", [](auto& t) { t.hierarchy.transform.lattice.bits = 15; }},
  };
  for (const Breakage& breakage : lattice_breakages) {
    NaiveHierarchy broken = whole;
    breakage.apply(broken);
    const VerifyReport report = verify_hierarchy(broken.attach(), &mesh);
    EXPECT_FALSE(report.find(breakage.check)->passed) << breakage.what;
  }
}

TEST(Verify, RunsNothingOnABrokenStructure) {
  NaiveHierarchy broken = test::naive_hierarchy(test::bumpy_sphere(3), 2, 0.2f);
  broken.hierarchy.cells[0].first_child = CellId(0xffff'fff0u);
  for (const VerifyCheck& check : verify_hierarchy(broken.attach()).checks) EXPECT_FALSE(check.passed) << check.name;
}

// A stored edge count may follow float or double, but long edges never come from nothing.
TEST(Verify, AllowsLongEdgesThatTheInputHas) {
  const IndexedMesh mesh = test::bumpy_sphere(1);  // 32 large triangles
  const VerifyReport report = verify_hierarchy(test::naive_hierarchy(mesh, 3, 0.2f).hierarchy, &mesh);
  EXPECT_TRUE(report.valid()) << failures_of(report);
}

TEST(Verify, RefusesLongEdgesWhereTheFinerLevelHasNone) {
  // Level 0 is stretched, and its stored figures say so truthfully: only the comparison of the levels can object.
  NaiveHierarchy t = test::naive_hierarchy(test::bumpy_sphere(4), 1, 0.6f);
  Level& root = t.hierarchy.levels[0];
  ASSERT_EQ(t.hierarchy.levels[1].long_edges, 0u);
  for (Vec3f& p : (*t.payloads)[0].positions) p = 64.0f * p;  // exact, so that the longest edge is, too
  root.max_edge *= 64;
  for (const Triangle& triangle : (*t.payloads)[0].triangles)
    for (std::size_t e = 0; e < 3; ++e)
      root.long_edges += length((*t.payloads)[0].positions[triangle.v[e]] -
                                (*t.payloads)[0].positions[triangle.v[(e + 1) % 3]]) > t.hierarchy.sigma0;
  ASSERT_GT(root.long_edges, 0u);
  const VerifyReport report = verify_hierarchy(t.attach());
  EXPECT_NE(report.find("edges")->detail.find("none on the finer level"), std::string::npos);
  EXPECT_FALSE(report.find("displacement")->passed);
}

}  // namespace
}  // namespace lodestone
