// The contract of simplifier.h, for every simplifier, on the shapes that break simplifiers.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/base/error.h"
#include "core/simplify/quadric_reference.h"
#include "core/simplify/quadric_simplifier.h"
#include "core/simplify/simplifier.h"
#include "tests/core/simplify_checks.h"
#include "tests/core/simplify_meshes.h"

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
    {"quadric", [] { return make_simplifier(SimplifierKind::quadric); }},
    {"plain", [] { return make_quadric_simplifier(InstructionSet::plain); }},
    {"reference", make_quadric_reference},
    {"cluster", [] { return make_simplifier(SimplifierKind::cluster); }, false},
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

TEST(SimplifierNames, AreReadBothWays) {
  for (const SimplifierKind kind : {SimplifierKind::quadric, SimplifierKind::cluster})
    EXPECT_EQ(simplifier_kind(name_of(kind)), kind);
}

TEST(SimplifierNames, UnknownOnesAreRefusedWithTheKnown) {
  try {
    (void)simplifier_kind("octree");
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "unknown simplifier 'octree'; known are quadric, cluster");
  }
}

}  // namespace
}  // namespace lodestone
