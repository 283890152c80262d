// Which samples triangles cover: watertight, and the same as a slow obvious twin, for every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "render/backends/soft/setup_stage.h"

namespace lodestone::soft {
namespace {

constexpr int width = 100, height = 70;  // several tiles, the last ones cut
using Counts = std::vector<int>;         // by pixel and sample
using Corners = std::array<SnappedPoint, 3>;

// How often the stages 2 and 3 draw each sample; all triangles at once, as a cell.
template <int Samples>
class Coverage {
 public:
  explicit Coverage(const Kernels& kernels) : kernels_(kernels.of<Samples>()) {}

  void add(SnappedPoint a, SnappedPoint b, SnappedPoint c) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (const SnappedPoint p : {a, b, c}) vertices_.push_back({p.x, p.y, 0.5f, 1.0f});
    triangles_.push_back({{first, first + 1, first + 2}});
  }

  [[nodiscard]] Counts counts() {
    TileBins bins;
    bins.fragments.reset(grid_.count());
    bins.triangles.reset(grid_.count());
    const DrawnCell drawn;
    setup_cell<Samples>({nullptr, nullptr, &grid_}, kernels_, drawn, {triangles_, vertices_.data()}, *lists_, bins);
    Counts counts(static_cast<std::size_t>(width * height * Samples));
    for (std::size_t t = 0; t < grid_.count(); ++t) {
      bins.fragments.for_each_run(t, [&](const Fragment* first, const Fragment* last) {
        for (; first != last; ++first) ++counts[place(t, first->sample)];
      });
      bins.triangles.for_each_run(t, [&](const TriangleRecord* first, const TriangleRecord* last) {
        for (; first != last; ++first) count(t, *first, counts);
      });
    }
    return counts;
  }

 private:
  // Drawn in a tile of its own.
  void count(std::size_t t, const TriangleRecord& record, Counts& counts) {
    const PixelRect rect = grid_.rect(t);
    tile_->clear();
    kernels_.draw_triangles(&record, &record + 1, rect, *tile_);
    for (std::uint32_t i = 0; i < TileBuffer<Samples>::samples; ++i) {
      const bool in_picture = rect.x0 + static_cast<int>(i % tile_size) < width &&
                              rect.y0 + static_cast<int>(i % tile_pixels) / tile_size < height;
      if (in_picture && tile_->depth[i] < 1) ++counts[place(t, i)];
    }
  }
  [[nodiscard]] std::size_t place(std::size_t t, std::uint32_t sample) const {
    const PixelRect rect = grid_.rect(t);
    const auto pixel = static_cast<int>(sample % tile_pixels), s = static_cast<int>(sample / tile_pixels);
    const int x = rect.x0 + pixel % tile_size, y = rect.y0 + pixel / tile_size;
    return static_cast<std::size_t>((y * width + x) * Samples + s);
  }

  const SampleKernels<Samples>& kernels_;
  TileGrid grid_{{width, height}};
  std::vector<WindowVertex> vertices_;
  std::vector<Triangle> triangles_;
  std::unique_ptr<SetupLists> lists_ = std::make_unique<SetupLists>();
  std::unique_ptr<TileBuffer<Samples>> tile_ = std::make_unique<TileBuffer<Samples>>();
};

// The twin: the top-left rule as what it means. The sample moves by an infinitesimal step to the right and a much
// smaller one downwards; then it lies on no edge any more and is inside where all three edge functions are positive.
bool covered_by_definition(SnappedPoint a, SnappedPoint b, SnappedPoint c, SnappedPoint sample) {
  if (doubled_area(a, b, c) < 0) std::swap(b, c);
  const auto positive = [&](SnappedPoint from, SnappedPoint to) {
    const auto value = static_cast<__int128>(doubled_area(from, to, sample));
    constexpr __int128 infinity = __int128{1} << 40;
    const std::int64_t dx = to.x - from.x, dy = to.y - from.y;
    return value * infinity * infinity - dy * infinity + dx > 0;
  };
  return positive(a, b) && positive(b, c) && positive(c, a);
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  int in(int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(engine_); }
  // Half of the points are on samples or corners of pixels, where the rule decides.
  SnappedPoint near(int x, int y, int reach) {
    SnappedPoint p{in(x - reach, x + reach) * subpixels, in(y - reach, y + reach) * subpixels};
    if (in(0, 1)) return {p.x + in(0, subpixels - 1), p.y + in(0, subpixels - 1)};
    const SnappedPoint sample = sample_offsets<4>[static_cast<std::size_t>(in(0, 3))];
    switch (in(0, 2)) {
      case 0:
        return p;
      case 1:
        return {p.x + subpixels / 2, p.y + subpixels / 2};
      default:
        return {p.x + subpixels / 2 + sample.x, p.y + subpixels / 2 + sample.y};
    }
  }
  SnappedPoint around_canvas(int margin) { return near(in(-margin, width + margin), in(-margin, height + margin), 0); }

 private:
  std::mt19937 engine_;
};

class SoftCoverage : public ::testing::TestWithParam<std::tuple<InstructionSet, int>> {
 protected:
  void SetUp() override {
    if (!is_available(std::get<0>(GetParam()))) GTEST_SKIP() << "this processor has no AVX2";
    kernels_ = &find_kernels(std::get<0>(GetParam()));
  }
  [[nodiscard]] int samples() const { return std::get<1>(GetParam()); }
  [[nodiscard]] Counts draw(const std::vector<Corners>& triangles) const {
    return samples() == 1 ? draw<1>(triangles) : draw<4>(triangles);
  }
  [[nodiscard]] SnappedPoint sample(std::size_t i) const {
    const auto pixel = static_cast<int>(i) / samples();
    const SnappedPoint offset = samples() == 1 ? SnappedPoint{} : sample_offsets<4>[i % 4];
    return {pixel % width * subpixels + subpixels / 2 + offset.x, pixel / width * subpixels + subpixels / 2 + offset.y};
  }
  const Kernels* kernels_ = nullptr;

 private:
  template <int Samples>
  [[nodiscard]] Counts draw(const std::vector<Corners>& triangles) const {
    Coverage<Samples> coverage(*kernels_);
    for (const auto& [a, b, c] : triangles) coverage.add(a, b, c);
    return coverage.counts();
  }
};

TEST_P(SoftCoverage, EqualsItsDefinition) {
  Random random(1);
  for (int round = 0; round < 12; ++round) {
    std::vector<Corners> triangles;
    for (int i = 0; i < 40; ++i) {
      // From a fraction of a pixel to some 4,000 pixels long.
      const int reach = std::array{0, 1, 2, 4, 20, 4000}[static_cast<std::size_t>(i % 6)];
      const int x = random.in(-3, width + 3), y = random.in(-3, height + 3);
      triangles.push_back(
          {random.near(x, y, reach), random.near(x, y, reach), random.near(x, y, i % 12 < 6 ? reach : 2)});
    }
    Counts expected(static_cast<std::size_t>(width * height * samples()));
    for (std::size_t i = 0; i < expected.size(); ++i)
      for (const auto& [a, b, c] : triangles)
        expected[i] += doubled_area(a, b, c) != 0 && covered_by_definition(a, b, c, sample(i));
    ASSERT_EQ(draw(triangles), expected) << round;
  }
}

// A fan around a point, closed by a polygon that goes once around the canvas: every sample exactly once. With many
// parts a side most triangles are slivers, thinner than a subpixel along most of their length.
TEST_P(SoftCoverage, ClosedFanCoversEverySampleOnce) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const SnappedPoint hub = random.around_canvas(-20);
    const int margin = i % 3 == 2 ? 3000 : 3, parts = i % 2 ? 9 : 2000;
    std::vector<SnappedPoint> rim;
    const int left = -margin * subpixels, right = (width + margin) * subpixels, top = -margin * subpixels,
              bottom = (height + margin) * subpixels;
    const auto side = [&](SnappedPoint from, SnappedPoint to, int n) {
      for (int k = 0; k < n; ++k)
        rim.push_back({from.x + static_cast<int>(std::int64_t{to.x - from.x} * k / n),
                       from.y + static_cast<int>(std::int64_t{to.y - from.y} * k / n)});
    };
    side({left, top}, {right, top}, random.in(1, parts));
    side({right, top}, {right, bottom}, random.in(1, parts));
    side({right, bottom}, {left, bottom}, random.in(1, parts));
    side({left, bottom}, {left, top}, random.in(1, parts));
    std::vector<Corners> triangles;
    for (std::size_t k = 0; k < rim.size(); ++k) triangles.push_back({hub, rim[k], rim[(k + 1) % rim.size()]});
    const Counts counts = draw(triangles);
    EXPECT_TRUE(std::ranges::all_of(counts, [](int n) { return n == 1; })) << i;
  }
}

// A jittered grid of small triangles, most of them smaller than a pixel: no sample twice, none missed.
TEST_P(SoftCoverage, TriangulationCoversEverySampleOnce) {
  Random random(4);
  for (const int step : {29, 97, 150, 256, 700, 1000, 9000}) {  // subpixels
    const int columns = width * subpixels / step + 3, rows = height * subpixels / step + 3;
    std::vector<SnappedPoint> grid;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i)
        grid.push_back({(i - 1) * step + random.in(0, step / 3), (j - 1) * step + random.in(0, step / 3)});
    std::vector<Corners> triangles;
    const auto at = [&](int i, int j) { return grid[static_cast<std::size_t>(j * columns + i)]; };
    for (int j = 0; j + 1 < rows; ++j)
      for (int i = 0; i + 1 < columns; ++i) {
        const bool flip = random.in(0, 1);
        triangles.push_back({at(i, j), at(i + 1, j), flip ? at(i, j + 1) : at(i + 1, j + 1)});
        triangles.push_back({flip ? at(i + 1, j) : at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    const Counts counts = draw(triangles);
    EXPECT_TRUE(std::ranges::all_of(counts, [](int n) { return n == 1; })) << step;
  }
}

// Two triangles that share a long edge, in every direction and of every width down to a subpixel.
TEST_P(SoftCoverage, SliversLeaveNoSeam) {
  Random random(5);
  for (int i = 0; i < 60; ++i) {
    std::vector<SnappedPoint> strip;  // a quadrilateral cut into slivers by lines from one side to the other
    const SnappedPoint a = random.around_canvas(40), b = random.around_canvas(40);
    for (int k = 0; k <= 20; ++k)
      for (const SnappedPoint end : {a, b}) strip.push_back({end.x + random.in(k, k + 1), end.y + 2 * k});
    std::vector<Corners> slivers;
    for (std::size_t k = 2; k < strip.size(); ++k) slivers.push_back({strip[k - 2], strip[k - 1], strip[k]});
    // However often they fold over each other, a sample is covered as often as the definition says.
    const Counts counts = draw(slivers);
    for (std::size_t s = 0; s < counts.size(); s += 7) {
      int expected = 0;
      for (const auto& [p, q, r] : slivers)
        expected += doubled_area(p, q, r) != 0 && covered_by_definition(p, q, r, sample(s));
      ASSERT_EQ(counts[s], expected) << i;
    }
  }
}

TEST_P(SoftCoverage, TrianglesBetweenSamplesLeaveNothing) {
  const SnappedPoint a{10, 10}, b{20, 10}, c{15, 25};  // no sample has a coordinate below 32
  EXPECT_TRUE(std::ranges::all_of(draw({{a, b, c}, {a, c, b}, {a, a, b}}), [](int n) { return n == 0; }));
}

INSTANTIATE_TEST_SUITE_P(Kernels, SoftCoverage,
                         ::testing::Combine(::testing::Values(InstructionSet::plain, InstructionSet::avx2),
                                            ::testing::Values(1, 4)),
                         [](const auto& instance) {
                           return std::string(std::get<0>(instance.param) == InstructionSet::avx2 ? "avx2" : "plain") +
                                  (std::get<1>(instance.param) == 4 ? "_4x" : "");
                         });

}  // namespace
}  // namespace lodestone::soft
