// The contract of simplifier.h, for every simplifier, on the shapes that break simplifiers.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>

#include "core/base/error.h"
#include "core/simplify/quadric/quadric_reference.h"
#include "core/simplify/quadric/quadric_simplifier.h"
#include "core/simplify/simplifiers.h"
#include "tests/core/simplify/simplify_checks.h"
#include "tests/core/simplify/simplify_meshes.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

using namespace simplify_test;

struct Maker {
  std::string name;
  std::function<std::unique_ptr<Simplifier>()> make;
  bool keeps_topology = true;
};

void PrintTo(const Maker& maker, std::ostream* out) { *out << maker.name; }

const std::vector<Maker> makers{
    {"quadric", [] { return make_simplifier("quadric"); }},
    {"plain", [] { return make_quadric_simplifier(InstructionSet::plain); }},
    {"reference", make_quadric_reference},
    {"endpoint", [] { return make_simplifier("quadric", Placement::endpoint); }},
    {"cluster", [] { return make_simplifier("cluster"); }, false},
    {"openmesh", [] { return make_simplifier("openmesh"); }},
    {"meshopt", [] { return make_simplifier("meshopt"); }},
};

class EverySimplifier : public ::testing::TestWithParam<Maker> {
 protected:
  const SimplifyResult& run(TestMesh& mesh, float bound, std::size_t target) {
    input_ = mesh.input(bound, target);
    const SimplifyResult& result = simplifier_->simplify(input_);
    EXPECT_EQ(broken_contract(input_, result), "");
    if (GetParam().keeps_topology) {
      EXPECT_EQ(broken_topology(input_, result), "");
    }
    return result;
  }
  [[nodiscard]] bool reaches(const SimplifyResult& result) const {
    const double share = GetParam().keeps_topology ? 1.0 : 1.1;  // clustering approaches the target
    return static_cast<double>(result.triangles) <= share * static_cast<double>(input_.target_triangles);
  }
  SimplifyInput input_;
  std::unique_ptr<Simplifier> simplifier_ = GetParam().make();
};

INSTANTIATE_TEST_SUITE_P(Simplifiers, EverySimplifier, ::testing::ValuesIn(makers),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(EverySimplifier, ReachesTheTargetOnASphere) {
  TestMesh mesh = bumpy_sphere(4);
  EXPECT_TRUE(reaches(run(mesh, 0.5f, mesh.triangles.size() / 4)));
}

TEST_P(EverySimplifier, KeepsTheBoundWhenItIsTight) {
  TestMesh mesh = bumpy_sphere(4);
  for (const float bound : {0.02f, 0.06f, 0.12f}) run(mesh, bound, 0);
  EXPECT_GT(run(mesh, 1e-4f, 0).triangles, mesh.triangles.size() / 2);
}

TEST_P(EverySimplifier, KeepsATorus) {
  TestMesh mesh = torus(40, 20);
  EXPECT_TRUE(reaches(run(mesh, 1, mesh.triangles.size() / 4)));
  run(mesh, 10, 0);
}

TEST_P(EverySimplifier, SimplifiesAPlaneAndItsBorder) {
  TestMesh mesh = plane(20);
  const SimplifyResult& result = run(mesh, 2, 100);
  EXPECT_TRUE(reaches(result));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) EXPECT_EQ(result.positions[v].z, 0);
}

TEST_P(EverySimplifier, SimplifiesAnOpenTerrainWithALockedBlockBorder) {
  TestMesh mesh = terrain(30);
  for (Vec3f& p : mesh.positions) p = 2.0f * p + Vec3f{-1, -1, 0};
  lock_outside(mesh, 0.99f);
  EXPECT_TRUE(reaches(run(mesh, 0.5f, mesh.triangles.size() / 3)));
}

TEST_P(EverySimplifier, SimplifiesSlivers) {
  TestMesh mesh = slivers(100);
  run(mesh, 0.2f, 50);
}

TEST_P(EverySimplifier, SimplifiesABoxWithSharpEdges) {
  TestMesh mesh = box(10);
  EXPECT_TRUE(reaches(run(mesh, 0.5f, mesh.triangles.size() / 4)));
}

TEST_P(EverySimplifier, KeepsNonManifoldFans) {
  TestMesh mesh = book(3, 8);
  run(mesh, 0.3f, 40);
}

TEST_P(EverySimplifier, KeepsDoubledFaces) {
  TestMesh mesh = plane(8);
  const std::vector<Triangle> front = mesh.triangles;
  for (const auto& [v] : front) mesh.triangles.push_back({{v[0], v[2], v[1]}});
  run(mesh, 0.3f, 20);
}

TEST_P(EverySimplifier, KeepsComponentsApart) {
  TestMesh mesh = both(bumpy_sphere(2), torus(16, 8), {3, 0, 0});
  run(mesh, 5, 0);
}

TEST_P(EverySimplifier, KeepsLabels) {
  if (simplifier_->knows_wedges()) return;  // gets wedges instead: test_wedges.cpp
  TestMesh mesh = bumpy_sphere(4);
  std::vector<std::uint32_t> labels;
  for (const Vec3f& p : mesh.positions) labels.push_back(p.x > 0 ? 7 : p.y > 0 ? 8 : 9);
  SimplifyInput input = mesh.input(0.5f, mesh.triangles.size() / 4);
  input.labels = labels;
  const SimplifyResult& result = simplifier_->simplify(input);
  EXPECT_EQ(broken_contract(input, result), "");
  for (std::size_t v = 0; v < labels.size(); ++v) EXPECT_EQ(labels[result.parent[v]], labels[v]);
  EXPECT_LT(result.triangles, mesh.triangles.size() / 2);
}

// Where many vertices stay, the others do not make up for them.
TEST_P(EverySimplifier, KeepsAShareOfWhatMayMove) {
  TestMesh mesh = terrain(30);
  for (Vec3f& p : mesh.positions) p = 2.0f * p + Vec3f{-1, -1, 0};
  lock_outside(mesh, 0.4f);
  SimplifyInput input = mesh.input(1, mesh.triangles.size() / 4);
  const std::size_t unlimited = simplifier_->simplify(input).triangles;
  input.least_share = 0.5;
  const auto movable = static_cast<std::size_t>(std::ranges::count(mesh.locked, 0));
  const std::size_t limited = simplifier_->simplify(input).triangles;
  EXPECT_GE(limited, unlimited);
  if (!GetParam().keeps_topology) return;  // clustering approaches what it is asked for
  EXPECT_GT(limited, unlimited);
  EXPECT_GE(limited + 1, mesh.triangles.size() - movable);
}

TEST_P(EverySimplifier, LeavesAnEmptyMeshEmpty) {
  TestMesh mesh;
  EXPECT_EQ(run(mesh, 1, 0).triangles, 0u);
}

TEST_P(EverySimplifier, LeavesVerticesWithoutTriangles) {
  TestMesh mesh{{{0, 0, 0}, {1, 0, 0}}, {}, {}};
  EXPECT_EQ(run(mesh, 9, 0).parent, (std::vector<std::uint32_t>{0, 1}));
}

TEST_P(EverySimplifier, TakesOneTriangle) {
  TestMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}, {}};
  EXPECT_EQ(run(mesh, 0.1f, 0).triangles, 1u);
}

TEST_P(EverySimplifier, DoesNothingWhenAllIsLocked) {
  TestMesh mesh = bumpy_sphere(2);
  lock_outside(mesh, -1);
  EXPECT_EQ(run(mesh, 1, 0).triangles, mesh.triangles.size());
}

TEST_P(EverySimplifier, AnswersTheSameAtEveryCall) {
  TestMesh mesh = bumpy_sphere(3), other = torus(30, 10);
  const SimplifyResult first = run(mesh, 0.5f, 200);
  run(other, 0.5f, 100);
  const SimplifyResult& again = run(mesh, 0.5f, 200);
  EXPECT_EQ(again.parent, first.parent);
  EXPECT_EQ(again.positions, first.positions);
}

TEST(Placement, EndpointLeavesSurvivorsWhereTheyAre) {
  TestMesh mesh = bumpy_sphere(4);
  for (const std::string& kind : simplifier_names()) {
    const auto simplifier = make_simplifier(kind, Placement::endpoint);
    const SimplifyResult& result = simplifier->simplify(mesh.input(0.5f, mesh.triangles.size() / 4));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      if (result.parent[v] != v) continue;
      EXPECT_EQ(result.positions[v], mesh.positions[v]) << kind;
    }
  }
}

TEST(Placement, OptimalMovesSomeAndCollapsesTheSame) {
  TestMesh mesh = bumpy_sphere(4);
  const SimplifyInput input = mesh.input(0.5f, mesh.triangles.size() / 4);
  const auto endpoint = make_simplifier("quadric", Placement::endpoint);
  const auto optimal = make_simplifier("quadric", Placement::optimal);
  const SimplifyResult &a = endpoint->simplify(input), &b = optimal->simplify(input);
  EXPECT_EQ(a.parent, b.parent);
  EXPECT_NE(a.positions, b.positions);
}

TEST(Placement, OptimalIsKnownToQuadricAlone) {
  for (const std::string& kind : simplifier_names()) {
    if (kind == "quadric") continue;
    EXPECT_THROW((void)make_simplifier(kind, Placement::optimal), InputError) << kind;
  }
}

TEST(Placement, IsReadBothWays) {
  for (const Placement p : {Placement::optimal, Placement::endpoint}) EXPECT_EQ(placement_named(name_of(p)), p);
  EXPECT_THROW((void)placement_named("middle"), InputError);
}

// As sets of corners, each triangle from its least corner on.
std::vector<std::array<std::uint32_t, 3>> sorted(const std::vector<Triangle>& triangles) {
  std::vector<std::array<std::uint32_t, 3>> all;
  for (auto [v] : triangles) {
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    all.push_back(v);
  }
  std::sort(all.begin(), all.end());
  return all;
}

// The markers that make the map readable must not change what the library does.
TEST(Meshopt, LeavesTheLibrarysOwnMeshWhereAllIsAllowed) {
  for (const std::uint32_t n : {8u, 20u}) {
    TestMesh mesh = terrain(n);
    // In the unit cube, where the simplifier would take it: the same roundings for both.
    const auto lowest = std::ranges::min(mesh.positions, {}, [](Vec3f p) { return p.z; }).z;
    for (Vec3f& p : mesh.positions) p.z -= lowest;
    const SimplifyInput input = mesh.input(10, mesh.triangles.size() / 2);
    std::vector<unsigned> own(3 * mesh.triangles.size());
    own.resize(meshopt_simplify(own.data(), mesh.triangles[0].v.data(), own.size(), &mesh.positions[0].x,
                                mesh.positions.size(), sizeof(Vec3f), 3 * input.target_triangles, 1e9f, 0, nullptr));
    std::vector<Triangle> expected;
    for (std::size_t i = 0; i < own.size(); i += 3) expected.push_back({{own[i], own[i + 1], own[i + 2]}});
    const auto simplifier = make_simplifier("meshopt");
    EXPECT_EQ(sorted(image(input, simplifier->simplify(input))), sorted(expected)) << n;
  }
}

TEST(SimplifierNames, UnknownOnesAreRefusedWithTheKnown) {
  expect_error_of<InputError>([] { return make_simplifier("octree"); },
                              {"unknown simplifier 'octree'; known are quadric, cluster, openmesh, meshopt"});
}

// Collapses nothing, but for the faults that it is asked for.
class Idle final : public Simplifier {
 public:
  enum class Fault { none, cycle, locked, far, count, sizes };
  explicit Idle(Fault fault) : fault_(fault) {}
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    result_ = {};
    for (std::uint32_t v = 0; v < input.positions.size(); ++v) result_.parent.push_back(v);
    result_.positions.assign(input.positions.begin(), input.positions.end());
    result_.triangles = input.triangles.size();
    if (fault_ == Fault::cycle) std::swap(result_.parent[0], result_.parent[1]);
    if (fault_ == Fault::locked) result_.positions[2].x += input.max_displacement / 2;
    if (fault_ == Fault::far) result_.positions[3].x += 2 * input.max_displacement;
    if (fault_ == Fault::count) ++result_.triangles;
    if (fault_ == Fault::sizes) result_.positions.pop_back();
    return result_;
  }

 private:
  Fault fault_;
  SimplifyResult result_;
};

TEST(AddedSimplifiers, AreCheckedAgainstTheContract) {
  using enum Idle::Fault;
  TestMesh mesh = bumpy_sphere(2);
  SimplifyInput input = mesh.input(0.5f, 10);
  std::vector<std::uint8_t> locks(mesh.positions.size());
  locks[2] = 1;
  input.locked = locks;
  const auto added = [&](const std::string& name, Idle::Fault fault) {
    add_simplifier(name, {[fault](Placement) { return std::make_unique<Idle>(fault); }});
    return make_simplifier(name);
  };
  EXPECT_EQ(added("idle", none)->simplify(input).triangles, mesh.triangles.size());
  const auto expect_fault = [&](const std::string& name, Idle::Fault fault, const std::string& what) {
    const auto simplifier = added(name, fault);
    expect_error_of<InputError>([&] { (void)simplifier->simplify(input); },
                                {"'" + name + "' breaks its contract", what});
  };
  expect_fault("cycle", cycle, "idempotent");
  expect_fault("locked", Idle::Fault::locked, "a locked vertex was moved");
  expect_fault("far", far, "displaced by");
  expect_fault("count", count, "triangles are left");
  expect_fault("sizes", sizes, "sizes differ");
}

TEST(AddedSimplifiers, HaveNamesOfTheirOwn) {
  const SimplifierInfo idle{[](Placement) { return std::make_unique<Idle>(Idle::Fault::none); }};
  for (const char* name : {"", "two words", "../up", "Q", "quadric"})
    expect_error_of<InputError>([&] { add_simplifier(name, idle); }, {"'" + std::string(name) + "'", "name"});
  expect_error_of<InputError>([&] { add_simplifier("nothing", {}); }, {"'nothing'", "no function"});
  expect_error_of<InputError>([&] { add_simplifier("nowhere", {idle.make, {}}); }, {"no placement"});
}

}  // namespace
}  // namespace lodestone
