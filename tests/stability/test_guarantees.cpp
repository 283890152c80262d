// The guarantees by force: random small models, parameters and viewpoints. RC_PARAMS="max_success=10000" in the
// environment tries ten thousand instead of a hundred (scripts/stability); a counterexample is shrunk, printed as a
// RandomModel, and belongs into the named cases below.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <optional>

#include "core/base/error.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/edge_census.h"
#include "experiments/metrics/cracks/adversary.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/pops/pops.h"
#include "parallel/clean/prepare.h"
#include "tests/stability/random_models.h"

namespace lodestone::test {
namespace {

struct Topology {
  bool closed = false;  // each edge has two triangles, in opposite directions
  std::int64_t euler = 0;
};

// Vertices that no triangle uses do not count.
Topology topology_of(std::span<const Triangle> triangles, std::size_t vertices) {
  std::vector<char> used(vertices, 0);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) used[v] = 1;
  const EdgeCensus edges = count_edges(triangles, vertices);
  return {edges.border == 0 && edges.non_manifold == 0 && edges.inconsistent == 0,
          std::count(used.begin(), used.end(), 1) - static_cast<std::int64_t>(edges.edges) +
              static_cast<std::int64_t>(triangles.size())};
}

class Trial {
 public:
  // Nothing if no triangle is left.
  static std::optional<Trial> of(const RandomModel& model) {
    RawMesh mesh = mesh_of(model);
    std::optional<Trial> trial;
    try {
      Repairs repairs;
      const auto scheduler = make_serial_scheduler();
      trial.emplace(Trial(model, prepare_mesh(std::move(mesh), repairs, *scheduler, {}, lattice_of(model))));
    } catch (const InputError&) {
      return std::nullopt;
    }
    return trial;
  }

  // An empty text if all guarantees hold.
  [[nodiscard]] std::string fault() {
    if (const VerifyReport report = verify_hierarchy(hierarchy_, &input_); !report.valid()) {
      for (const VerifyCheck& check : report.checks)
        if (!check.passed) return "verify: " + check.name + ": " + check.detail;
    }
    if (const std::string text = topology_fault(); !text.empty()) return text;
    if (const std::string text = view_fault(radii_of(model_, hierarchy_)); !text.empty()) return text;
    return view_fault(adaptive_radii_of(model_, hierarchy_));
  }

  // The adversary at 0.99 times the largest reach of a vertex with a cell that is refined and one that is not: the
  // first has its descendants where it is, the second its parent. Nothing if there is no such vertex.
  [[nodiscard]] std::optional<double> widest_crack() {
    std::vector<float> reaches;
    for (const AdversarialView& view : adversarial_views(hierarchy_, uniform_radii(1))) reaches.push_back(view.reach);
    std::ranges::sort(reaches, std::greater{});
    for (const float reach : reaches) {
      const float kappa0 = 0.99f * reach;
      const Radii radii = uniform_radii(kappa0);
      const std::vector<AdversarialView> views = adversarial_views(hierarchy_, radii);
      const auto cracks = [&](const AdversarialView& view) { return view.refined && view.reach > kappa0; };
      if (std::ranges::none_of(views, cracks)) continue;
      double widest = 0;
      for (const AdversarialView& view : views) {
        const Drawn drawn(hierarchy_, radii, blend(), view.viewpoint);
        widest = std::max(widest, vertex_gaps(drawn.context, drawn.selection, *basis_, *scheduler_, scratch_).gap_max);
      }
      return widest;
    }
    return std::nullopt;
  }

 private:
  struct Drawn {
    Drawn(const Hierarchy& hierarchy, const Radii& radii, Blend blend, Vec3f viewpoint)
        : context{&hierarchy, &radii, blend, viewpoint} {
      select_cells(hierarchy, radii, viewpoint, {}, selection);
    }
    MorphContext context;
    Selection selection;
  };

  Trial(const RandomModel& model, IndexedMesh input)
      : model_(model),
        input_(std::move(input)),
        scheduler_(make_serial_scheduler()),
        hierarchy_(build_hierarchy(IndexedMesh(input_), build_config(model), *scheduler_)),
        basis_(make_crack_basis(hierarchy_, *scheduler_)) {}

  [[nodiscard]] Radii uniform_radii(float kappa0) const {
    RadiiConfig config;
    config.rule = RadiiRule::uniform;
    config.metric = metric_of(model_);
    config.kappa0 = kappa0;
    return make_radii(hierarchy_, config);
  }

  [[nodiscard]] Blend blend() const { return all_blends()[static_cast<std::size_t>(model_.blend)]; }

  // A closed surface remains one at every level. Clustering may pinch, and turn two triangles onto each other.
  [[nodiscard]] std::string topology_fault() const {
    const Topology before = topology_of(input_.triangles, input_.positions.size());
    if (!before.closed || build_config(model_).simplifier == "cluster") return {};
    for (int l = 0; l <= hierarchy_.finest(); ++l) {
      const RawMesh level = level_mesh(hierarchy_, l);
      const Topology here = topology_of(level.triangles, level.positions.size());
      if (!here.closed) return "level " + std::to_string(l) + " is not closed";
      if (here.euler != before.euler)
        return "level " + std::to_string(l) + " has the Euler number " + std::to_string(here.euler) + ", not " +
               std::to_string(before.euler);
    }
    return {};
  }

  [[nodiscard]] std::string view_fault(const Radii& radii) {
    if (!radii.admissible) return "the radii are not admissible";
    const std::vector<Vec3f> views = viewpoints_of(model_, hierarchy_, 6);
    std::optional<Drawn> before;
    for (std::size_t k = 0; k < views.size(); ++k) {
      const std::string where = " at view " + std::to_string(k);
      Drawn now(hierarchy_, radii, blend(), views[k]);
      const CrackReport cracks = residual_edges(now.context, now.selection, *basis_, *scheduler_, scratch_);
      if (cracks.uncovered_leaves > 0) return "the selection is not a partition" + where;
      if (cracks.open_edges > 0) return std::to_string(cracks.open_edges) + " residual edges" + where;
      if (const double gap = vertex_gaps(now.context, now.selection, *basis_, *scheduler_, scratch_).gap_max; gap > 0)
        return "a gap of " + std::to_string(gap) + where;
      if (before && blend() != Blend::step) {
        const PopReport pops =
            largest_jump(before->context, before->selection, now.context, now.selection, *scheduler_);
        if (!pops.bounded && hierarchy_.finest() > 0) return "no bound of the jumps" + where;
        if (!(pops.jump_over_bound <= 1))
          return "a jump of " + std::to_string(pops.jump_over_bound) + " times its bound" + where;
      }
      before.emplace(std::move(now));
    }
    return {};
  }

  RandomModel model_;
  IndexedMesh input_;
  std::unique_ptr<Scheduler> scheduler_;
  Hierarchy hierarchy_;
  std::shared_ptr<const CrackBasis> basis_;
  CrackScratch scratch_;
};

struct NamedCase {
  const char* name;
  RandomModel model;
};

// Found by the search, and others that are likely to matter.
const NamedCase named_cases[] = {
    {"found: a level without a triangle, whose longest edge is none",
     {.shape = 6, .soup = {1, 0, 0, 0, 0, 0, 0, 0, 3}, .sigma0 = 14, .levels = 1, .simplifier = 1, .beta = 1}},
    {"one triangle", {.shape = 6, .soup = {0, 0, 0, 4, 0, 0, 0, 4, 0}, .sigma0 = 1, .levels = 4}},
    {"triangles on top of each other",
     {.shape = 6,
      .soup = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 0, 0, 4, 0, 4, 0, 0, 0, 0, 0, 4, 4, 0, 0, 4, 1},
      .sigma0 = 20,
      .simplifier = 1,
      .delta = 5}},
    {"a flat sheet of many collapses",
     {.shape = 3, .squares = 10, .sigma0 = 20, .levels = 4, .uniform = true, .beta = 1, .views = 3}},
    {"a crumpled torus",
     {.shape = 2, .squares = 5, .amplitude = 8, .seed = 11, .sigma0 = 20, .levels = 4, .endpoint = true, .blend = 5}},
    {"half levels of a crumpled sheet, the finest alone in its grid",
     {.shape = 3, .squares = 10, .amplitude = 8, .seed = 3, .sigma0 = 8, .levels = 3, .half_levels = true, .views = 5}},
    {"fins on a lattice, clustered",
     {.shape = 5,
      .squares = 8,
      .amplitude = 8,
      .levels = 4,
      .simplifier = 1,
      .lattice = true,
      .kappa = 40,
      .views = 9}},
};

TEST(Guarantees, HoldForNamedCases) {
  for (const NamedCase& named : named_cases) {
    std::optional<Trial> trial = Trial::of(named.model);
    ASSERT_TRUE(trial) << named.name;
    EXPECT_EQ(trial->fault(), "") << named.name;
  }
}

RC_GTEST_PROP(Guarantees, HoldForRandomModels, ()) {
  const RandomModel model = *random_model();
  std::optional<Trial> trial = Trial::of(model);
  RC_CLASSIFY(!trial, "no triangle");
  if (!trial) return;
  const std::string fault = trial->fault();
  RC_LOG() << fault;
  RC_ASSERT(fault.empty());
}

// A search that finds nothing below the reach would say nothing above it either.
RC_GTEST_PROP(Guarantees, AreLostBelowTheReach, ()) {
  RandomModel model = *random_model();
  model.half_levels = false;  // their uniform radii are those of steps
  std::optional<Trial> trial = Trial::of(model);
  const std::optional<double> crack = trial ? trial->widest_crack() : std::nullopt;
  RC_CLASSIFY(!crack, "nothing can crack");
  RC_ASSERT(!crack || *crack > 0);
}

}  // namespace
}  // namespace lodestone::test
