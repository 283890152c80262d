#include "parallel/mesh/joined_stream.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/mesh/up_axis.h"

namespace lodestone {
namespace {

class JoinedStream final : public MeshStream {
 public:
  JoinedStream(std::vector<std::unique_ptr<MeshStream>>&& parts, std::string name)
      : parts_(std::move(parts)), name_(std::move(name)) {
    up_ = parts_.front()->up();
    for (const std::unique_ptr<MeshStream>& part : parts_) {
      vertices_ += part->vertex_count(), triangles_ += part->triangle_count();
      end_vertex_.push_back(vertices_), end_triangle_.push_back(triangles_);
      has_attributes_ |= part->has_attributes();
      warnings_.insert(warnings_.end(), part->warnings().begin(), part->warnings().end());
    }
    if (vertices_ > std::numeric_limits<std::uint32_t>::max())
      throw ResourceError(describe(name_, "", "have more vertices together than 32-bit ids reach", "leave some out"));
  }

  [[nodiscard]] const std::string& name() const override { return name_; }

  void read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* /*wedges*/) const override {
    for_parts(end_vertex_, first, out, [&](std::size_t part, std::uint64_t at, std::span<Vec3d> some) {
      parts_[part]->read_vertices(at, some);
    });
  }
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override {
    for_parts(end_triangle_, first, out, [&](std::size_t part, std::uint64_t at, std::span<Triangle> some) {
      parts_[part]->read_triangles(at, some);
      const auto before = static_cast<std::uint32_t>(part == 0 ? 0 : end_vertex_[part - 1]);
      for (Triangle& t : some)
        for (std::uint32_t& v : t.v) v += before;
    });
  }

  [[nodiscard]] std::uint64_t identity() const override {
    std::vector<std::uint64_t> all;
    for (const std::unique_ptr<MeshStream>& part : parts_) all.push_back(part->identity());
    return checksum(std::as_bytes(std::span(all)));
  }

 private:
  // Calls visit(part, first item in it, its share of `out`) for the parts that have some of the items.
  template <class Item, class Visit>
  static void for_parts(const std::vector<std::uint64_t>& ends, std::uint64_t first, std::span<Item> out,
                        const Visit& visit) {
    auto part = static_cast<std::size_t>(std::ranges::upper_bound(ends, first) - ends.begin());
    for (; !out.empty(); ++part) {
      const std::uint64_t begin = part == 0 ? 0 : ends[part - 1];
      const std::size_t count = std::min<std::uint64_t>(ends[part] - first, out.size());
      if (count > 0) visit(part, first - begin, out.first(count));
      first += count;
      out = out.subspan(count);
    }
  }

  std::vector<std::unique_ptr<MeshStream>> parts_;
  std::vector<std::uint64_t> end_vertex_, end_triangle_;  // by part
  std::string name_;
};

}  // namespace

std::string name_of_files(std::span<const std::filesystem::path> files) {
  if (files.size() == 1) return files.front().string();
  return files.front().string() + " and " + std::to_string(files.size() - 1) +
         (files.size() == 2 ? " other" : " others");
}

void require_same_up(Up up, Up of_file, const std::string& name) {
  if (up.axis != of_file.axis)
    throw InputError(describe(name, "",
                              "has " + std::string(name_of(of_file.axis)) +
                                  " as its up axis, and the files before it " + std::string(name_of(up.axis)),
                              "say which one it is for all of them (--up)"));
}

std::unique_ptr<MeshStream> join_streams(std::vector<std::unique_ptr<MeshStream>>&& parts, std::string name) {
  for (const std::unique_ptr<MeshStream>& part : parts) require_same_up(parts.front()->up(), part->up(), part->name());
  if (parts.size() == 1) return std::move(parts.front());
  return std::make_unique<JoinedStream>(std::move(parts), std::move(name));
}

}  // namespace lodestone
