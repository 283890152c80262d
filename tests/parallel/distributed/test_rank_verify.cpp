// A file verified by several ranks, which are threads here: the report of one process.
#include <gtest/gtest.h>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/distributed/messages/local_transport.h"
#include "parallel/distributed/rank_verify.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/hierarchy/save.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

class RankVerify : public FolderTest {
 protected:
  Hierarchy built(Shape shape, Lattice lattice = {}) const {
    Repairs repairs;
    BuildConfig config;
    config.finest_level = 3;
    return build_hierarchy(prepare_mesh(generate_mesh({shape, 8'000, 3}), repairs, *scheduler_, "m", lattice), config,
                           *scheduler_);
  }
  // Texture coordinates jump between octants, which have a material each.
  Hierarchy charted(bool half_levels) const {
    RawMesh raw = generate_mesh({Shape::sphere, 8'000, 3});
    for (const auto& [v] : raw.triangles) {
      const Vec3d p = raw.positions[v[0]] + raw.positions[v[1]] + raw.positions[v[2]];
      const std::uint32_t chart = (p.x > 0.1 ? 1 : 0) + (p.y > 0.2 ? 2 : 0) + (p.z > 0.3 ? 4 : 0);
      const auto wedge = static_cast<std::uint32_t>(raw.wedges.uv.size());
      raw.wedges.corners.push_back({{wedge, wedge + 1, wedge + 2}});
      raw.wedges.material.push_back(chart);
      for (const std::uint32_t corner : v)
        raw.wedges.uv.push_back({static_cast<float>(raw.positions[corner].x + 10 * chart), 0.5f});
    }
    raw.materials.resize(8);
    Repairs repairs;
    BuildConfig config;
    config.finest_level = half_levels ? 6 : 3;
    config.half_levels = half_levels;  // some of whose blocks have no triangle
    config.sigma0 = 0.8f;
    return build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler_, "m"), config, *scheduler_);
  }
  VerifyReport verified(int ranks, int threads) const {
    VerifyReport first;
    run_local_ranks(ranks, [&](Transport& transport) {
      const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
      Ranks all(transport);
      const RankCells cells = load_rank_cells(name_, all.rank(), all.count(), *scheduler);
      const VerifyReport report = verify_ranks(cells, all);
      if (all.rank() == 0) first = report;
    });
    return first;
  }
  void expect_same() const {
    const VerifyReport expected = verify_hierarchy(load_lode(name_, *scheduler_));
    EXPECT_TRUE(expected.valid());
    for (const int ranks : {1, 2, 3, 5, 8}) {
      const VerifyReport report = verified(ranks, ranks % 2 * 2);
      ASSERT_EQ(report.checks.size(), expected.checks.size());
      for (std::size_t i = 0; i < expected.checks.size(); ++i) {
        EXPECT_EQ(report.checks[i].name, expected.checks[i].name);
        EXPECT_EQ(report.checks[i].detail, expected.checks[i].detail) << expected.checks[i].name;
      }
      EXPECT_EQ(report.error_ratio, expected.error_ratio) << ranks;
    }
  }

  const std::unique_ptr<Scheduler> scheduler_ = make_tbb_scheduler(2);
  const std::filesystem::path name_ = folder_ / "m.lode";
};

TEST_F(RankVerify, SaysWhatOneProcessSays) {
  for (const Shape shape : {Shape::sphere, Shape::terrain})
    for (const LodeForm form : {LodeForm::plain, LodeForm::compressed})
      for (const bool measured : {false, true}) {
        Hierarchy h = built(shape, form == LodeForm::plain ? Lattice{} : Lattice{Lattice::automatic});
        if (measured) (void)measure_errors(h, {}, *scheduler_);
        (void)save_lode(h, name_, *scheduler_, form);
        expect_same();
      }
}

// The bytes of a file may be damaged so that its checksums hold: by a builder that is wrong.
TEST_F(RankVerify, NamesWhatDoesNotHold) {
  Hierarchy h = built(Shape::terrain);
  h.provenance.fingerprint += 1;
  h.levels[0].max_edge *= 2;
  (void)save_lode(h, name_, *scheduler_);
  for (const int ranks : {1, 4}) {
    const VerifyReport report = verified(ranks, 0);
    EXPECT_FALSE(report.valid());
    for (const VerifyCheck& check : report.checks)
      EXPECT_EQ(check.passed, check.name != "fingerprint" && check.name != "edges") << check.name;
    EXPECT_EQ(report.find("fingerprint")->detail, "the triangles of the finest level are not the input's (1 failures)");
  }
}

// Seams run through cells and along their borders, and along those of the ranks.
TEST_F(RankVerify, SaysWhatOneProcessSaysOfWedges) {
  for (const bool half_levels : {false, true}) {
    (void)save_lode(charted(half_levels), name_, *scheduler_);
    expect_same();
  }
}

// A wedge whose parent is elsewhere than that of another wedge of its vertex.
TEST_F(RankVerify, FindsWedgesThatPart) {
  Hierarchy h = charted(false);
  std::vector<std::uint32_t> parents;
  for (Cell& cell : h.cells) {
    if (h.level_of(CellId(&cell - h.cells.data())) < h.finest() || !parents.empty()) continue;
    const Cell& above = h.cells[cell.parent];
    for (std::size_t a = 0; a < cell.positions.size() && parents.empty(); ++a)
      for (std::size_t b = a + 1; b < cell.positions.size() && parents.empty(); ++b) {
        if (cell.positions[a] != cell.positions[b]) continue;
        const std::uint32_t parent = cell.parents[b];
        std::uint32_t other = 0;  // of the same material, which is looked at, too
        while (other < above.positions.size() &&
               (above.positions[other] == above.positions[parent] ||
                above.attributes.materials[other] != above.attributes.materials[parent]))
          ++other;
        if (other == above.positions.size()) continue;
        parents.assign(cell.parents.begin(), cell.parents.end());
        parents[b] = other;
      }
    if (!parents.empty()) cell.parents = parents;
  }
  ASSERT_FALSE(parents.empty());
  (void)save_lode(h, name_, *scheduler_);
  const VerifyReport expected = verify_hierarchy(load_lode(name_, *scheduler_));
  for (const int ranks : {1, 3}) {
    const VerifyReport report = verified(ranks, 0);
    EXPECT_NE(report.find("wedges")->detail.find("than that of another wedge there"), std::string::npos);
    for (const VerifyCheck& check : report.checks)
      EXPECT_EQ(check.passed, expected.find(check.name)->passed) << check.name;
  }
}

}  // namespace
}  // namespace lodestone
