// Random meshes, sound and broken, through every simplifier: the contract holds whatever comes in.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/simplify/quadric/quadric_reference.h"
#include "core/simplify/quadric/quadric_simplifier.h"
#include "core/simplify/simplifiers.h"
#include "tests/core/simplify/simplify_checks.h"
#include "tests/core/simplify/simplify_meshes.h"

namespace lodestone {
namespace {

using namespace simplify_test;

std::uint32_t below(std::size_t n) { return *rc::gen::inRange<std::uint32_t>(0, static_cast<std::uint32_t>(n)); }

// A sound mesh, then some of: moved vertices (also onto each other and into planes), holes, doubled and turned
// triangles, vertices glued together, locks.
TestMesh random_mesh() {
  TestMesh m;
  const auto size = 3 + below(6);
  switch (below(4)) {
    case 0:
      m = bumpy_sphere(static_cast<int>(1 + below(2)));
      break;
    case 1:
      m = terrain(size);
      break;
    case 2:
      m = torus(3 + below(6), size);
      break;
    default:
      m = box(1 + below(4));
  }
  const std::size_t vertices = m.positions.size();
  for (auto k = below(6); k > 0; --k) m.positions[below(vertices)] = m.positions[below(vertices)];
  for (auto k = below(10); k > 0; --k) {
    const auto coordinate = [] { return static_cast<float>(below(9)) / 4 - 1; };
    m.positions[below(vertices)] = {coordinate(), coordinate(), coordinate()};
  }
  for (auto k = below(8); k > 0 && m.triangles.size() > 1; --k)
    m.triangles.erase(m.triangles.begin() + below(m.triangles.size()));
  for (auto k = below(4); k > 0; --k) m.triangles.push_back(m.triangles[below(m.triangles.size())]);
  for (auto k = below(4); k > 0; --k) {
    Triangle& t = m.triangles[below(m.triangles.size())];
    std::swap(t.v[0], t.v[1]);
  }
  for (auto k = below(4); k > 0; --k) {
    const std::uint32_t a = below(vertices), b = below(vertices);
    for (Triangle& t : m.triangles)
      for (std::uint32_t& v : t.v) v = v == a ? b : v;
  }
  std::erase_if(m.triangles, is_degenerate);
  m.locked.assign(vertices, 0);
  for (auto k = below(3) * below(vertices); k > 0; --k) m.locked[below(vertices)] = 1;
  return m;
}

RC_GTEST_PROP(EverySimplifierOn, RandomMeshes, ()) {
  TestMesh mesh = random_mesh();
  const float bound = static_cast<float>(1 + below(40)) / 20;
  SimplifyInput input = mesh.input(bound, below(mesh.triangles.size() + 1));
  if (below(2) == 0) {
    input.lattice = {static_cast<int>(2 + below(Lattice::most_bits - 1))};
    for (Vec3f& p : mesh.positions) p = input.lattice.nearest(0.5 * (to_double(p) + Vec3d{1, 1, 1}));
  }
  const auto fast = make_quadric_simplifier(), plain = make_quadric_simplifier(InstructionSet::plain);
  const auto endpoint = make_simplifier("quadric", Placement::endpoint);
  const auto openmesh = make_simplifier("openmesh"), meshopt = make_simplifier("meshopt");
  const auto reference = make_quadric_reference(), cluster = make_simplifier("cluster");
  for (Simplifier* simplifier :
       {fast.get(), plain.get(), endpoint.get(), reference.get(), openmesh.get(), meshopt.get()}) {
    const SimplifyResult& result = simplifier->simplify(input);
    RC_ASSERT(broken_contract(input, result) == "");
    RC_ASSERT(broken_topology(input, result) == "");
  }
  RC_ASSERT(broken_contract(input, cluster->simplify(input)) == "");
  const SimplifyResult& expected = plain->simplify(input);
  for (const InstructionSet set : {InstructionSet::best, InstructionSet::avx2}) {
    if (!is_available(set)) continue;
    const auto lanes = make_quadric_simplifier(set);
    const SimplifyResult& result = lanes->simplify(input);
    RC_ASSERT(result.parent == expected.parent);
    RC_ASSERT(result.positions == expected.positions);
  }
}

}  // namespace
}  // namespace lodestone
