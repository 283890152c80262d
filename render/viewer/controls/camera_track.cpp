#include "render/viewer/controls/camera_track.h"

#include <algorithm>
#include <utility>

#include "render/viewer/controls/camera_control.h"

namespace lodestone::viewer {
namespace {

constexpr std::size_t most_keys = 1'000'000;  // nine hours
constexpr double transition_seconds = 0.25;

}  // namespace

void CameraRecorder::start(double now, const Camera& camera) {
  started_ = now;
  last_ = camera;
  keys_.assign(1, camera);
}

// The ticks up to now, at which the last camera was looking.
void CameraRecorder::fill(double now) {
  const double ticks = (now - started_) * ticks_per_second;
  if (!(ticks > 0)) return;
  const std::size_t count = static_cast<std::size_t>(std::min(ticks, static_cast<double>(most_keys - 1))) + 1;
  if (count > keys_.size()) keys_.resize(count, last_);
}

void CameraRecorder::add(double now, const Camera& camera) {
  if (!recording()) return;
  fill(now);
  last_ = camera;
}

std::vector<Camera> CameraRecorder::stop(double now) {
  if (!recording()) return {};
  fill(now);
  keys_.push_back(last_);
  return std::exchange(keys_, {});
}

void CameraPlayer::start(double now, std::vector<Camera> keys) {
  keys_ = std::move(keys);
  started_ = now;
  seconds_per_key_ = keys_.size() <= few_keys ? 2 : 1 / ticks_per_second;
}

std::optional<Camera> CameraPlayer::advance(double now) {
  if (!playing()) return {};
  const double at = std::max(0.0, (now - started_) / seconds_per_key_);
  if (!(at < static_cast<double>(keys_.size() - 1))) {
    const Camera last = keys_.back();
    stop();
    return last;
  }
  const Camera camera = camera_at(keys_, at);
  return is_valid(camera) ? camera : keys_[static_cast<std::size_t>(at)];
}

void CameraTransition::start(double now, const Camera& from, const Camera& to) {
  moving_ = is_valid(to);
  started_ = now;
  from_ = from;
  to_ = to;
}

std::optional<Camera> CameraTransition::advance(double now) {
  if (!moving_) return {};
  const double t = std::clamp((now - started_) / transition_seconds, 0.0, 1.0);
  if (t >= 1) moving_ = false;
  return between(from_, to_, t * t * (3 - 2 * t));
}

}  // namespace lodestone::viewer
