// Recording a camera and playing a path of cameras, by time. Both work in ticks, 30 a second. Recordings are written by
// write_camera_path, and `lodestone render --camera` flies them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/camera/camera.h"

namespace lodestone::viewer {

inline constexpr double ticks_per_second = 30;

class CameraRecorder {
 public:
  void start(double now, const Camera& camera);  // seconds
  // Records the camera from `now` on. Between calls it is at rest.
  void add(double now, const Camera& camera);
  // The keys; empty when nothing was being recorded.
  [[nodiscard]] std::vector<Camera> stop(double now);

  [[nodiscard]] bool recording() const { return !keys_.empty(); }
  [[nodiscard]] std::span<const Camera> keys() const { return keys_; }  // so far

 private:
  void fill(double now);

  double started_ = 0;
  Camera last_;
  std::vector<Camera> keys_;
};

class CameraPlayer {
 public:
  // Keys are a tick apart, or two seconds for a path of at most `few_keys`, which was written by hand.
  static constexpr std::size_t few_keys = 10;
  void start(double now, std::vector<Camera> keys);
  void stop() { keys_.clear(); }

  [[nodiscard]] bool playing() const { return !keys_.empty(); }
  // The camera at this time; the last one ends the playback. Empty if nothing is being played.
  [[nodiscard]] std::optional<Camera> advance(double now);

 private:
  double started_ = 0, seconds_per_key_ = 1;
  std::vector<Camera> keys_;
};

// A quarter of a second from one camera to another.
class CameraTransition {
 public:
  void start(double now, const Camera& from, const Camera& to);
  void stop() { moving_ = false; }
  [[nodiscard]] bool moving() const { return moving_; }
  [[nodiscard]] std::optional<Camera> advance(double now);

 private:
  bool moving_ = false;
  double started_ = 0;
  Camera from_, to_;
};

}  // namespace lodestone::viewer
