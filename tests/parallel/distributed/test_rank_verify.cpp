// A file verified by several ranks, which are threads here: the report of one process.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/distributed/local_transport.h"
#include "parallel/distributed/rank_verify.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/hierarchy/save.h"
#include "tests/expect_error.h"
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
  VerifyReport verified(int ranks, int threads) const {
    VerifyReport first;
    run_local_ranks(ranks, [&](Transport& transport) {
      const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
      Ranks all(transport);
      const RankCells cells = load_rank_cells(name_, all.rank(), all.count(), *scheduler);
      const VerifyReport report = verify_ranks(cells, all, "m.lode");
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

TEST_F(RankVerify, RefusesWedges) {
  Hierarchy h = built(Shape::terrain);
  (void)save_lode(h, name_, *scheduler_);
  run_local_ranks(1, [&](Transport& transport) {
    Ranks all(transport);
    RankCells cells = load_rank_cells(name_, 0, 1, *scheduler_);
    cells.hierarchy.attributes.wedges = true;
    expect_error_of<UnsupportedError>([&] { return verify_ranks(cells, all, "m.lode"); },
                                      {"m.lode: has texture coordinates"});
  });
}

}  // namespace
}  // namespace lodestone
