// Which share of the full resolution is drawn: all of it at rest, less while the camera moves and frames are slow.
#pragma once

namespace lodestone::viewer {

class ResolutionGovernor {
 public:
  static constexpr double least_scale = 0.25;

  // `target`: milliseconds that a frame may take while the camera moves.
  explicit ResolutionGovernor(double target = 30) : target_(target) {}

  void moved(double now) { last_move_ = now; }  // seconds
  // A frame was drawn at this scale, in so many milliseconds.
  void drawn(double scale, double milliseconds);

  // The scale of width and height, in [least_scale, 1], a multiple of 1/8.
  [[nodiscard]] double scale(double now) const { return resting(now) ? 1 : moving_scale_; }
  [[nodiscard]] bool resting(double now) const { return !(now - last_move_ < rest_after); }
  // Seconds until a camera that does not move any more counts as resting; 0: it does.
  [[nodiscard]] double until_rest(double now) const { return resting(now) ? 0 : last_move_ + rest_after - now; }

 private:
  static constexpr double rest_after = 0.15;  // seconds
  double target_;
  double moving_scale_ = 1;
  double last_move_ = -1e9;
};

}  // namespace lodestone::viewer
