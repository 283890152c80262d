#include "parallel/distributed/building/received_triangles.h"

#include <algorithm>
#include <bit>

namespace lodestone {

std::vector<std::uint32_t> NumberSet::finish() {
  std::uint32_t count = 0;
  for (std::size_t w = 0; w < words_.size(); ++w) {
    if (w % words_per_count == 0) before_.push_back(count);
    count += static_cast<std::uint32_t>(std::popcount(words_[w]));
  }
  std::vector<std::uint32_t> numbers;
  numbers.reserve(count);
  for (std::size_t w = 0; w < words_.size(); ++w)
    for (std::uint64_t left = words_[w]; left != 0; left &= left - 1)
      numbers.push_back(static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(left)));
  return numbers;
}

std::uint32_t NumberSet::place(std::uint32_t number) const {
  const std::size_t word = number / 64, group = word / words_per_count;
  std::uint32_t place = before_[group];
  for (std::size_t w = group * words_per_count; w < word; ++w)
    place += static_cast<std::uint32_t>(std::popcount(words_[w]));
  const std::uint64_t below = (std::uint64_t{1} << (number % 64)) - 1;
  return place + static_cast<std::uint32_t>(std::popcount(words_[word] & below));
}

ReceivedTriangles::ReceivedTriangles(const std::filesystem::path& folder, int ranks, std::uint64_t vertices)
    : file_(ScratchFile::nameless(folder)), by_source_(static_cast<std::size_t>(ranks)), numbers_(vertices) {}

void ReceivedTriangles::append(const ByRank<Triangle>& came) {
  for (std::size_t from = 0; from < came.size(); ++from) {
    const std::span<const Triangle> triangles = came[from];
    if (triangles.empty()) continue;
    const std::uint64_t at = file_->claim(triangles.size_bytes());
    file_->write_at(at, std::as_bytes(triangles));
    by_source_[from].push_back({0, at / sizeof(Triangle), triangles.size()});
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t.v) numbers_.add(v);
  }
}

std::vector<std::uint32_t> ReceivedTriangles::finish() {
  for (std::vector<Extent>& extents : by_source_) {
    for (Extent& extent : extents) {
      extent.first = triangles_;
      triangles_ += extent.count;
      extents_.push_back(extent);
    }
    std::vector<Extent>().swap(extents);
  }
  std::vector<std::uint32_t> ids = numbers_.finish();
  vertices_ = ids.size();
  return ids;
}

void ReceivedTriangles::read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* /*wedges*/) const {
  for (Vec3d& p : out) p = to_double(positions_[first++]);
}

void ReceivedTriangles::read_triangles(std::uint64_t first, std::span<Triangle> out) const {
  auto extent = std::ranges::upper_bound(extents_, first, {}, &Extent::first) - 1;
  for (std::span<Triangle> left = out; !left.empty(); ++extent) {
    const std::uint64_t skipped = first - extent->first;
    const std::span<Triangle> here = left.first(std::min<std::uint64_t>(left.size(), extent->count - skipped));
    file_->read_at((extent->in_file + skipped) * sizeof(Triangle), std::as_writable_bytes(here));
    left = left.subspan(here.size());
    first += here.size();
  }
  for (Triangle& t : out)
    for (std::uint32_t& v : t.v) v = numbers_.place(v);
}

}  // namespace lodestone
