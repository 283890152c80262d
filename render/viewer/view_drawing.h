// The frames of the viewer: selection, freezing, streaming, and the call of the backend. No window, no clock of its
// own.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/renderer.h"
#include "render/viewer/model_loader.h"
#include "render/viewer/projection.h"
#include "render/viewer/view_state.h"

namespace lodestone::viewer {

// What a picture depends on: as long as it stays the same, nothing has to be selected or drawn.
struct FrameKey {
  Camera camera;
  ViewSettings settings;
  DistanceMetric metric = DistanceMetric::euclidean;
  ImageSize size;
  bool frozen = false;
  std::uint64_t freezes = 0, loads = 0, model = 0, backend = 0;  // revisions
  friend bool operator==(const FrameKey&, const FrameKey&) = default;
};

struct ViewReport {
  FrameStats stats;
  double select_milliseconds = 0, total_milliseconds = 0;
  std::uint32_t visited = 0;  // cells that the selection looked at
  bool admissible = true;
};

class ViewDrawing {
 public:
  explicit ViewDrawing(Scheduler& scheduler) : scheduler_(scheduler) {}

  // Both must outlive their use; the model is uploaded when both are there.
  void set_renderer(Renderer* renderer);
  void set_model(Model* model);
  [[nodiscard]] bool ready() const { return renderer_ && model_; }
  [[nodiscard]] const Model* model() const { return model_; }

  [[nodiscard]] FrameKey key(const ViewState& state, std::size_t settings, ImageSize size) const;

  // Of a streamed model: takes in what has been loaded and asks for what these views need, before they are drawn.
  // Whole models and frozen views need nothing. Throws what loading throws.
  struct View {
    std::size_t settings = 0;
    ImageSize size;
  };
  void stream(const ViewState& state, const std::vector<View>& views);
  // Nothing is on its way that the last stream() asked for.
  [[nodiscard]] bool complete() const;
  // The last stream() changed what is drawn.
  [[nodiscard]] bool streaming() const { return streaming_; }
  [[nodiscard]] std::uint64_t resident_bytes() const;

  // Selects and draws; the renderer has the picture. `full_size` is that of the view at full resolution: a selection
  // that is frozen now is made for it. Throws InputError for a camera that cannot be drawn.
  const ViewReport& draw(const ViewState& state, std::size_t settings, ImageSize size, ImageSize full_size);
  // Paints lambda over the picture of the last draw() with these settings.
  void tint_band(std::size_t settings, Image& image) const;

  // Over the picture of the last draw() with these settings: boxes of its cells, what the frozen camera sees.
  [[nodiscard]] std::vector<Line> box_lines(std::size_t settings, ImageSize size) const;
  [[nodiscard]] std::vector<Line> frozen_lines(std::size_t settings, ImageSize size) const;
  [[nodiscard]] const Selection& selection(std::size_t settings) const { return views_[settings].shown().selection; }
  [[nodiscard]] const ViewReport& report(std::size_t settings) const { return views_[settings].report; }

  // Draws the view once more and looks what is seen at a pixel, in model space.
  [[nodiscard]] std::optional<Vec3d> pick(const ViewState& state, std::size_t settings, ImageSize size, int x, int y);

  struct Counts {
    std::uint64_t uploads = 0, selections = 0, draws = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  // A selection and what it was made with.
  struct Selected {
    Radii radii;
    Vec3f viewpoint;
    ViewProjection vp;
    std::vector<DetailLimit> limits;
    Selection selection;
  };
  struct PerView {
    Selected live;
    std::optional<Selected> frozen;
    std::uint64_t freezes = 0;  // that `frozen` belongs to
    ViewProjection vp;          // of the picture
    Blend blend = Blend::smoothstep;
    ViewReport report;
    [[nodiscard]] const Selected& shown() const { return frozen ? *frozen : live; }
  };
  void upload();
  void select(const ViewState& state, const ViewSettings& settings, const Camera& camera, ImageSize size,
              Selected& out);
  [[nodiscard]] Frame frame_of(const ViewState& state, const ViewSettings& settings, const PerView& view,
                               ImageSize size) const;
  [[nodiscard]] MorphContext morph(const PerView& view) const;

  Scheduler& scheduler_;
  Renderer* renderer_ = nullptr;
  Model* model_ = nullptr;
  std::array<PerView, 2> views_;
  std::uint64_t model_revision_ = 0, backend_revision_ = 0, load_revision_ = 0;
  bool streaming_ = false;
  std::vector<DetailLimit> last_limits_;
  Counts counts_;
};

}  // namespace lodestone::viewer
