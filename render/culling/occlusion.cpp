#include "render/culling/occlusion.h"

#include <algorithm>
#include <utility>

#include "render/culling/runs.h"

namespace lodestone {
namespace {

void append(std::vector<TriangleRange>& ranges, TriangleRange range) {
  if (!ranges.empty() && ranges.back().end == range.begin) {
    ranges.back().end = range.end;
  } else {
    ranges.push_back(range);
  }
}

// Percentage of the runs hidden in one frame that may come into sight in the next if they are to wait.
constexpr std::size_t most_revealed = 25;

}  // namespace

bool is_hidden(const DepthPyramid& pyramid, const Hierarchy& hierarchy, CellId cell, int level,
               const ViewProjection& view_projection, ImageSize size) {
  const auto box = screen_box(view_projection, drawn_bounds(hierarchy, cell, level), size);
  return box && pyramid.hides(*box);
}

void HiddenCells::reset(std::size_t cells) {
  hidden_.assign(cells, 0);
  runs_.assign(cells, {});
  frame_ = 2;
}

void HiddenCells::note_run(CellId cell, std::size_t run) {
  std::vector<std::uint32_t>& runs = runs_[cell];
  if (runs.size() <= run) runs.resize(run + 1);
  runs[run] = frame_;
}

bool HiddenCells::were_there(const Hierarchy& hierarchy, CellId cell) const {
  const Cell& c = hierarchy.cells[cell];
  if (was_hidden(cell) || (c.parent != no_cell && was_hidden(c.parent))) return true;
  for (CellId k = c.first_child; k < c.end_child(); ++k)
    if (!was_hidden(k)) return false;
  return c.child_count > 0;
}

void VisibleParts::clear() {
  parts_.clear();
  ends_.clear();
  ranges_.clear();
}

void VisibleParts::add(const VisiblePart& part, std::span<const TriangleRange> ranges) {
  parts_.push_back(part);
  ranges_.insert(ranges_.end(), ranges.begin(), ranges.end());
  ends_.push_back(ranges_.size());
}

void VisibleParts::finish() {
  std::size_t begin = 0;
  for (std::size_t k = 0; k < parts_.size(); begin = ends_[k++])
    if (ends_[k] > begin) parts_[k].ranges = std::span(ranges_).subspan(begin, ends_[k] - begin);
}

// Sorts the runs of a part: goes_to_rest(run) says which are rest_, the others are kept_.
template <class Test>
void OcclusionCulling::divide(const VisiblePart& part, const Test& goes_to_rest) {
  kept_.clear();
  rest_.clear();
  for_each_range(cell_of(part), part.ranges, [&](TriangleRange range) {
    while (range.begin < range.end) {
      const std::uint32_t run = range.begin / CullingRuns::length;
      const std::uint32_t end = std::min(range.end, (run + 1) * CullingRuns::length);
      append(goes_to_rest(run) ? rest_ : kept_, {range.begin, end});
      range.begin = end;
    }
  });
}

std::span<const VisiblePart> OcclusionCulling::first(const Frame& frame, std::span<const VisiblePart> visible) {
  frame_ = &frame;
  pyramid_.reset(frame.size);
  histories_.resize(frame.models.size());
  for (std::size_t m = 0; m < frame.models.size(); ++m) {
    History& history = histories_[m];
    const Hierarchy* const hierarchy = frame.models[m].morph.hierarchy;
    if (std::exchange(history.hierarchy, hierarchy) != hierarchy || history.cells.size() != hierarchy->cells.size())
      history.cells.reset(hierarchy->cells.size());
    history.cells.next_frame();
  }
  hidden_cells_ = divided_cells_ = hidden_triangles_ = 0;
  const bool runs_wait = most_revealed * (revealed_ + remained_) >= revealed_ * std::size_t{100};
  revealed_ = remained_ = 0;
  for (VisibleParts* parts : {&first_, &waiting_, &second_}) parts->clear();
  for (const VisiblePart& part : visible) {
    const HiddenCells& cells = histories_[part.model].cells;
    if (drawn_triangles(cell_of(part), part.ranges) > 0 &&
        cells.were_there(*histories_[part.model].hierarchy, part.cell)) {
      waiting_.add(part);
      continue;
    }
    divide(part, [&](std::size_t run) { return runs_wait && cells.was_run_hidden(part.cell, run); });
    if (rest_.empty()) {
      first_.add(part);
      continue;
    }
    VisiblePart rest = part;
    rest.is_rest = !kept_.empty();
    waiting_.add(rest, rest_);
    if (rest.is_rest) first_.add(part, kept_);
  }
  waiting_.finish();
  first_.finish();
  return first_.parts();
}

bool OcclusionCulling::hide_cell(const VisiblePart& part) {
  History& history = histories_[part.model];
  if (!is_hidden(pyramid_, *history.hierarchy, part.cell, part.level, frame_->models[part.model].view_projection,
                 frame_->size))
    return false;
  history.cells.note(part.cell);
  return true;
}

// Divides a part into what is hidden, which it notes, and what is kept.
void OcclusionCulling::hide_runs(const VisiblePart& part, bool counts_revealed) {
  History& history = histories_[part.model];
  const ModelFrame& model = frame_->models[part.model];
  if (!model.runs) return divide(part, [](std::size_t) { return false; });
  const std::span<const Box3f> boxes = model.runs->boxes(*history.hierarchy, part.cell);
  divide(part, [&](std::size_t run) {
    const auto box = screen_box(model.view_projection, boxes[run], frame_->size);
    const bool hidden = box && pyramid_.hides(*box);
    if (history.cells.was_run_hidden(part.cell, run)) {
      remained_ += hidden ? 1 : 0;
      revealed_ += !hidden && counts_revealed ? 1 : 0;
    }
    if (hidden) history.cells.note_run(part.cell, run);
    return hidden;
  });
}

// Hidden parts remain hidden: later depths are only nearer.
std::span<const VisiblePart> OcclusionCulling::second() {
  pyramid_.build();
  for (const VisiblePart& part : waiting_.parts()) {
    const std::size_t triangles = drawn_triangles(cell_of(part), part.ranges);
    kept_.clear();
    if (!hide_cell(part)) hide_runs(part, false);  // finish() looks at those that are drawn once more
    if (kept_.empty()) {
      hidden_triangles_ += triangles;
      hidden_cells_ += part.is_rest ? 0 : 1;
      continue;
    }
    hidden_triangles_ += triangles - drawn_triangles(cell_of(part), kept_);
    divided_cells_ += part.is_rest ? 1 : 0;
    second_.add(part, kept_);
  }
  second_.finish();
  return second_.parts();
}

void OcclusionCulling::finish() {
  if (has_second()) pyramid_.build();
  for (const VisibleParts* parts : {&first_, &second_})
    for (const VisiblePart& part : parts->parts())
      if (!hide_cell(part)) hide_runs(part, true);
}

}  // namespace lodestone
