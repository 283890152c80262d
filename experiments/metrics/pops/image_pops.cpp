#include "experiments/metrics/pops/image_pops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <iterator>
#include <limits>
#include <optional>

#include "core/base/disjoint_sets.h"
#include "core/base/error.h"
#include "render/camera/projection.h"

namespace lodestone {
namespace {

constexpr std::size_t rows_per_chunk = 8;

std::size_t pixel_count(ImageSize size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

void check(const ErrorFrame& before, const ErrorFrame& now, const ImagePopConfig& config) {
  const ImageSize size = now.full->size;
  if (now.errors.empty() || now.errors.size() != before.errors.size())
    throw InputError("pops need error maps, as many of one frame as of the other");
  for (const ErrorFrame* frame : {&before, &now}) {
    for (const ErrorMap* error : frame->errors)
      if (error->size != size || frame->full->size != size || error->value.size() != pixel_count(size))
        throw InputError("pops need error maps and two pictures of one size");
    if (frame->full->depth.size() != pixel_count(size))
      throw InputError("pops need pictures of the full model with depth");
  }
  if (!(config.depth_tolerance > 0 && config.depth_tolerance < 1) || !(config.threshold >= 0))
    throw InputError("pops: the tolerance of depths lies between 0 and 1, the threshold is at least 0");
  if (config.neighbourhood < 0 || config.neighbourhood > 8)
    throw InputError("pops: the neighbourhood is 0 to 8 pixels");
}

glm::dmat4 matrix_of(const ViewProjection& vp) {
  glm::dmat4 m;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) m[column][row] = vp.m[static_cast<std::size_t>(4 * row + column)];
  return m;
}

glm::dmat4 inverse_of(const ViewProjection& vp) {
  const glm::dmat4 inverse = glm::inverse(matrix_of(vp));
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(inverse[column][row])) throw InputError("pops: a view projection that cannot be inverted");
  return inverse;
}

// From the window (x and y in pixels from the upper left corner, depth, 1) to clip coordinates.
glm::dmat4 window_to_clip(ImageSize size) {
  glm::dmat4 m(1);
  m[0][0] = 2.0 / size.width, m[3][0] = -1;
  m[1][1] = -2.0 / size.height, m[3][1] = 1;
  m[2][2] = 2, m[3][2] = -1;
  return m;
}

// The point of a pixel in the frame before: a place in its picture and the depth along the view; infinite for the
// background.
struct Origin {
  double x = 0, y = 0, w = 0;
};

// Reprojection of the pixels of one frame into the frame before. One matrix leads from window to window, another one
// does for the background: the way through space is in them.
class Reprojection {
 public:
  Reprojection(const ErrorFrame& before, const ErrorFrame& now) : size_(now.full->size), depth_(now.full->depth) {
    const glm::dmat4 to_space = inverse_of(now.view_projection) * window_to_clip(size_);
    const glm::dmat4 to_before = glm::inverse(window_to_clip(size_)) * matrix_of(before.view_projection);
    point_ = to_before * to_space;
    weight_ = glm::transpose(to_space)[3];
    // The background is infinitely far away, in the direction from the eye: what both are divided by falls out of the
    // difference of eye_.w * point and weight * eye.
    const Eye eye = eye_of(now.view_projection);
    eye_w_ = eye.w;
    glm::dmat4 direction = eye_w_ * to_space - glm::outerProduct(glm::dvec4(eye.at.x, eye.at.y, eye.at.z, 0), weight_);
    for (int column = 0; column < 4; ++column) direction[column][3] = 0;
    background_ = to_before * direction;
  }

  [[nodiscard]] std::optional<Origin> origin(int x, int y) const {
    const double depth =
        depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(x)];
    const bool background = !(depth < 1);
    const glm::dvec4 window(x + 0.5, y + 0.5, std::min(depth, 1.0), 1);
    const double weight = glm::dot(weight_, window);
    const glm::dvec4 at = (background ? background_ : point_) * window;
    const bool turned = background ? weight * eye_w_ < 0 : weight < 0;
    if (!((turned ? -at.w : at.w) > 0)) return std::nullopt;
    const double by_w = 1 / at.w;
    return Origin{at.x * by_w, at.y * by_w, background ? std::numeric_limits<double>::infinity() : at.w / weight};
  }

 private:
  ImageSize size_;
  const std::vector<float>& depth_;
  glm::dmat4 point_, background_;  // from the window to the window before, homogeneous with its depth along the view
  glm::dvec4 weight_;              // what the point in space is to be divided by
  double eye_w_ = 0;
};

// Pixels of the frame before that see one point, and what each counts.
struct Predecessors {
  std::array<std::size_t, 4> pixel{};
  std::array<double, 4> weight{};
  std::size_t count = 0;
  double weights = 0;

  void add(std::size_t at, double w) {
    pixel[count] = at, weight[count] = w;
    ++count;
    weights += w;
  }
  [[nodiscard]] float interpolate(const std::vector<float>& values) const {
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) sum += weight[k] * values[pixel[k]];
    return static_cast<float>(sum / weights);
  }
};

// The points that the pixels of the frame before see.
class PastView {
 public:
  PastView(const ErrorFrame& frame, double tolerance)
      : size_(frame.full->size), depth_(frame.full->depth), tolerance_(tolerance) {
    // For the point at window depth d, 1 / w = ((row of w) of the inverse) . (x, y, z, 1), which is linear in z alone
    // for a perspective or parallel projection.
    const glm::dmat4 inverse = inverse_of(frame.view_projection);
    near_ = inverse[2][3], far_ = inverse[3][3];
  }

  // Around the place, of those that see the same depth. None: no predecessor.
  [[nodiscard]] Predecessors around(const Origin& origin) const {
    Predecessors found;
    if (!in_picture(origin)) return found;
    const double x = origin.x - 0.5, y = origin.y - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    for (int k = 0; k < 4; ++k) {
      const int px = x0 + (k & 1), py = y0 + (k >> 1);
      const double weight = (1 - std::abs(x - px)) * (1 - std::abs(y - py));
      if (weight > 0 && sees(px, py, origin.w)) found.add(index(px, py), weight);
    }
    if (!(found.weights > least_weight)) found.count = 0;
    return found;
  }

  // Calls use(pixel) for those within `reach` of the one that the place lies in.
  template <class Use>
  void within(const Origin& origin, int reach, const Use& use) const {
    if (!in_picture(origin)) return;
    const int x = static_cast<int>(std::floor(origin.x)), y = static_cast<int>(std::floor(origin.y));
    for (int py = y - reach; py <= y + reach; ++py)
      for (int px = x - reach; px <= x + reach; ++px)
        if (sees(px, py, origin.w)) use(index(px, py));
  }

 private:
  static constexpr double least_weight = 1e-3;
  [[nodiscard]] bool in_picture(const Origin& origin) const {
    return origin.x > -0.5 && origin.y > -0.5 && origin.x < size_.width + 0.5 && origin.y < size_.height + 0.5;
  }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool sees(int x, int y, double w) const {
    return x >= 0 && y >= 0 && x < size_.width && y < size_.height && same_surface(depth_[index(x, y)], w);
  }
  [[nodiscard]] bool same_surface(float depth, double w) const {
    if (!(depth < 1)) return std::isinf(w);
    if (std::isinf(w)) return false;
    const double by_seen = near_ * (2.0 * depth - 1) + far_;  // one over the depth seen, which spares the division
    return std::abs(1 - by_seen * w) <= tolerance_ * w * by_seen;
  }

  ImageSize size_;
  const std::vector<float>& depth_;
  double tolerance_, near_ = 0, far_ = 1;
};

// The pops of one pixel by all of the maps. Where it was is found once: that takes most of the time.
class PixelPops {
 public:
  PixelPops(const ErrorFrame& before, const ErrorFrame& now, const ImagePopConfig& config)
      : before_(before), now_(now), past_(before, config.depth_tolerance), neighbourhood_(config.neighbourhood) {}

  void measure(std::size_t pixel, const Origin& origin, std::vector<std::vector<float>>& maps) const {
    if (neighbourhood_ > 0) return measure_range(pixel, origin, maps);
    const Predecessors found = past_.around(origin);
    if (found.count == 0) return;
    for (std::size_t m = 0; m < maps.size(); ++m)
      maps[m][pixel] = now_.errors[m]->value[pixel] - found.interpolate(before_.errors[m]->value);
  }

 private:
  // Distance of the error from the range of the errors of the neighbours.
  void measure_range(std::size_t pixel, const Origin& origin, std::vector<std::vector<float>>& maps) const {
    for (std::size_t m = 0; m < maps.size(); ++m) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      past_.within(origin, neighbourhood_, [&](std::size_t there) {
        const float e = before_.errors[m]->value[there];
        low = std::min(low, e), high = std::max(high, e);
      });
      const float e = now_.errors[m]->value[pixel];
      if (low <= high) maps[m][pixel] = e - std::clamp(e, low, high);
    }
  }

  const ErrorFrame &before_, &now_;
  PastView past_;
  int neighbourhood_;
};

}  // namespace

std::vector<std::vector<float>> change_maps(const ErrorFrame& before, const ErrorFrame& now, Scheduler& scheduler,
                                            const ImagePopConfig& config) {
  check(before, now, config);
  const Reprojection reprojection(before, now);
  const PixelPops pops(before, now, config);
  const ImageSize size = now.full->size;
  std::vector<std::vector<float>> maps(now.errors.size(), std::vector<float>(pixel_count(size), no_predecessor));
  scheduler.for_chunks(static_cast<std::size_t>(size.height), rows_per_chunk, [&](ChunkRange rows) {
    std::size_t pixel = rows.begin * static_cast<std::size_t>(size.width);
    for (std::size_t y = rows.begin; y < rows.end; ++y)
      for (int x = 0; x < size.width; ++x, ++pixel)
        if (const auto origin = reprojection.origin(x, static_cast<int>(y))) pops.measure(pixel, *origin, maps);
  });
  return maps;
}

ImagePops summarise_pops(std::span<const float> changes, ImageSize size, double threshold) {
  std::vector<float> map, followed;
  map.reserve(changes.size()), followed.reserve(changes.size());
  for (const float change : changes) {
    const bool known = change != no_predecessor;
    map.push_back(known ? std::abs(change) : 0);
    if (known) followed.push_back(map.back());
  }
  const ErrorSummary summary = summarise(followed, threshold);
  ImagePops pops;
  pops.p50 = summary.p50, pops.p99 = summary.p99, pops.max = summary.max, pops.mean = summary.mean;
  pops.changed_share = summary.share_above;
  pops.changed = static_cast<std::uint64_t>(std::ranges::count_if(followed, [&](float v) { return v > threshold; }));
  pops.largest_changed = largest_connected_area(map, size, threshold);
  pops.pixels = followed.size();
  pops.without_predecessor = map.size() - followed.size();
  return pops;
}

// Each pixel above the threshold is united with its neighbours to the left and above.
std::uint64_t largest_connected_area(std::span<const float> values, ImageSize size, double threshold) {
  const auto width = static_cast<std::uint32_t>(size.width);
  DisjointSets sets(values.size());
  const auto above = [&](std::uint32_t i) { return values[i] > threshold; };
  const auto join = [&](std::uint32_t i, std::uint32_t k) {
    if (above(k)) sets.unite(i, k);
  };
  std::vector<std::uint32_t> area(values.size(), 0);
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    if (!above(i)) continue;
    const std::uint32_t x = i % width;
    if (x > 0) join(i, i - 1);
    if (i < width) continue;
    if (x > 0) join(i, i - width - 1);
    join(i, i - width);
    if (x + 1 < width) join(i, i - width + 1);
  }
  std::uint64_t largest = 0;
  for (std::uint32_t i = 0; i < values.size(); ++i)
    if (above(i)) largest = std::max<std::uint64_t>(largest, ++area[sets.find(i)]);
  return largest;
}

}  // namespace lodestone
