// Streaming: whatever arrives when, the budget holds, what is drawn is there, and nothing cracks or pops.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_format.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/pops/pops.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "parallel/streaming/cell_stream.h"
#include "render/lod/resident_cells.h"
#include "tests/expect_error.h"
#include "tests/experiments/lod_frames.h"
#include "tests/experiments/naive_metrics.h"
#include "tests/test_bytes.h"
#include "tests/test_folder.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using namespace testing;
using namespace std::chrono_literals;

constexpr float rate = 0.2f;

bool same_arrays(const Cell& a, const Cell& b) {
  return test::same_bytes(a.positions, b.positions) && test::same_bytes(a.normals, b.normals) &&
         test::same_bytes(a.parents, b.parents) && test::same_bytes(a.shared_ids, b.shared_ids) &&
         test::same_bytes(a.triangles, b.triangles);
}

class Streaming : public ::testing::TestWithParam<LodeForm> {
 protected:
  void SetUp() override {
    IndexedMesh mesh = test::sphere_mesh(6);
    BuildConfig config;
    config.sigma0 = 0.8f;
    config.finest_level = 4;
    if (GetParam() == LodeForm::compressed) {
      Repairs repairs;
      mesh = prepare_mesh(test::raw_of(mesh), repairs, *scheduler_, {}, {16});
    }
    (void)save_lode(build_hierarchy(std::move(mesh), config, *scheduler_), file_, *scheduler_, GetParam());
    whole_ = load_lode(file_, *scheduler_);
    basis_ = make_crack_basis(whole_, *scheduler_);
  }

  // The frame as `resident` draws it, on the whole hierarchy, which has the same cells.
  Frame frame(const Radii& radii, Vec3f viewpoint, const ResidentCells& resident) {
    limits_.assign(resident.limits().begin(), resident.limits().end());
    Frame f{{&whole_, &radii, Blend::smoothstep, viewpoint, limits_}, {}};
    select_cells(resident.hierarchy(), radii, viewpoint, {.limits = limits_}, f.selection);
    return f;
  }

  void expect_drawable(const Frame& f, const ResidentCells& resident) {
    const Hierarchy& h = resident.hierarchy();
    for (const SelectedCell& s : f.selection.cells) {
      ASSERT_TRUE(same_arrays(h.cells[s.cell], whole_.cells[s.cell])) << "cell " << s.cell;
      const CellId parent = h.cells[s.cell].parent;
      if (parent == no_cell) continue;
      ASSERT_TRUE(same_arrays(h.cells[parent], whole_.cells[parent])) << "parent " << parent;
    }
  }

  std::uint64_t all_bytes(const CellStream& stream) const {
    std::uint64_t bytes = stream.family_bytes(no_cell);
    for (CellId c{0}; c < whole_.cells.size(); ++c) bytes += stream.family_bytes(c);
    return bytes;
  }

  std::unique_ptr<Scheduler> scheduler_ = make_tbb_scheduler(2);
  TestFolder folder_;
  const std::filesystem::path file_ = folder_ / "whole.lode";
  Hierarchy whole_;
  std::shared_ptr<const CrackBasis> basis_;
  CrackScratch scratch_;
  std::vector<DetailLimit> limits_;
};

TEST_P(Streaming, NothingCracksOrPopsUnderAnyBudgetWithASlowLoader) {
  const Radii radii = per_level_radii(whole_, DistanceMetric::euclidean);
  for (const double share : {0.06, 0.1, 0.2, 1.0}) {
    SCOPED_TRACE(share);
    std::atomic<unsigned> loads{0};
    CellStream stream(file_, {2, [&](std::uint32_t) { std::this_thread::sleep_for(++loads % 3 * 100us); }});
    const auto budget = std::max(static_cast<std::uint64_t>(share * static_cast<double>(all_bytes(stream))),
                                 stream.family_bytes(no_cell));
    ResidentCells resident(stream, {budget, rate});
    Vec3f viewpoint{0.5f, -0.4f, 0.5f};
    std::optional<Frame> before;
    std::vector<DetailLimit> limits_before;
    std::size_t came = 0, went = 0, finest = 0;
    for (int i = 0; i < 400; ++i) {
      const float angle = 0.05f * static_cast<float>(i);
      const float distance = 0.52f + 0.3f * std::abs(std::sin(0.04f * static_cast<float>(i)));
      viewpoint = {0.5f + distance * std::cos(angle), 0.5f + distance * std::sin(angle), 0.5f};
      resident.update(radii, viewpoint);
      came += resident.came().size(), went += resident.went().size();
      EXPECT_LE(resident.bytes(), budget);
      Frame after = frame(radii, viewpoint, resident);
      expect_drawable(after, resident);
      for (const SelectedCell& s : after.selection.cells) finest = std::max<std::size_t>(finest, s.level);
      EXPECT_EQ(residual_edges(after.context, after.selection, *basis_, *scheduler_, scratch_).open_edges, 0u);
      if (before) {
        before->context.limits = limits_before;
        const PopReport pops = largest_jump(before->context, before->selection, after.context, after.selection,
                                            *scheduler_, {.limit_rate = rate});
        EXPECT_LE(pops.jump_over_bound, 1) << "frame " << i;
      }
      before = std::move(after);
      limits_before = limits_;
      if (i % 4 == 0) stream.wait();  // now and then the loader is fast
    }
    EXPECT_GT(came, 10u);
    EXPECT_TRUE(went > 10 || share == 1);
    EXPECT_TRUE(finest == 4 || share < 0.2);
  }
}

TEST_P(Streaming, EndsWithWhatSelectionAsksFor) {
  const Radii radii = per_level_radii(whole_, DistanceMetric::euclidean);
  CellStream stream(file_);
  ResidentCells resident(stream, {all_bytes(stream), rate});
  const Vec3f viewpoint{0.5f, 0.5f, 1.02f};
  int frames = 0;
  do {
    resident.update(radii, viewpoint);
    stream.wait();
  } while (!resident.complete() && ++frames < 300);
  EXPECT_LT(frames, 300);
  EXPECT_EQ(drawn_cells(frame(radii, viewpoint, resident).selection),
            drawn_cells(make_frame(whole_, radii, Blend::smoothstep, viewpoint).selection));
}

// Families took turns for ever where a budget did not hold all that a view needs.
TEST_P(Streaming, CameraAtRestComesToRestUnderAnyBudget) {
  const Radii radii = per_level_radii(whole_, DistanceMetric::euclidean);
  for (int tenths = 1; tenths < 10; ++tenths) {
    SCOPED_TRACE(tenths);
    CellStream stream(file_);
    const std::uint64_t budget = tenths * all_bytes(stream) / 10;
    ResidentCells resident(stream, {budget, rate});
    for (int i = 0; i < 300; ++i) {
      const std::uint64_t revision = resident.revision();
      resident.update(radii, {0.5f, 0.5f, 1.02f});
      EXPECT_TRUE(i <= 200 || revision == resident.revision());
      if (i == 200) limits_.assign(resident.limits().begin(), resident.limits().end());
      if (i <= 200) {
        stream.wait();
        continue;
      }
      ASSERT_TRUE(resident.came().empty() && resident.went().empty()) << "frame " << i;
      ASSERT_TRUE(std::ranges::equal(limits_, resident.limits()));
    }
    EXPECT_TRUE(resident.complete() || resident.bytes() > budget * 9 / 10) << resident.bytes() << " of " << budget;
  }
}

TEST_P(Streaming, CoarseFamiliesComeFirst) {
  const Radii radii = per_level_radii(whole_, DistanceMetric::euclidean);
  std::vector<CellId> order;
  CellStream stream(file_, {1, [&](CellId parent) { order.push_back(parent); }});
  ResidentCells resident(stream, {all_bytes(stream), 1});
  for (int i = 0; i < 40; ++i) resident.update(radii, {0.5f, 0.5f, 1.02f}), stream.wait();
  std::set<CellId> there;
  for (const CellId parent : order) {
    EXPECT_TRUE(parent == 0 || there.contains(whole_.cells[parent].parent)) << "before the cells above it";
    EXPECT_TRUE(there.insert(parent).second) << "loaded twice";
  }
}

TEST_P(Streaming, RefusesABudgetWithoutRoomForTheRoot) {
  CellStream stream(file_);
  const std::uint64_t room = stream.family_bytes(no_cell);
  expect_error_of<InputError>([&] { ResidentCells(stream, {room - 1, rate}); }, {std::to_string(room)});
}

TEST_P(Streaming, TellsOfAnAlteredFileWhenItMeetsIt) {
  {
    std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
    LodeHeader header;
    file.read(reinterpret_cast<char*>(&header), sizeof header);
    file.seekp(static_cast<std::streamoff>(header.payload_offset + header.payload_bytes) - 40);
    file.put('\x5a').put('\x5a').put('\x5a').put('\x5a');
  }
  CellStream stream(file_);
  ResidentCells resident(stream, {all_bytes(stream), 1});
  const Radii radii = per_level_radii(whole_, DistanceMetric::euclidean);
  const auto look_everywhere = [&] {
    for (const Vec3f p : whole_.cells.back().positions)
      for (int i = 0; i < 20; ++i) resident.update(radii, p), stream.wait();
  };
  EXPECT_THROW(look_everywhere(), InputError);
}

INSTANTIATE_TEST_SUITE_P(Forms, Streaming, ::testing::Values(LodeForm::plain, LodeForm::compressed),
                         [](const auto& tested) { return tested.param == LodeForm::plain ? "plain" : "compressed"; });

}  // namespace
}  // namespace lodestone
