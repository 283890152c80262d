#include "parallel/clean/stream_clean.h"

#include <atomic>
#include <span>
#include <utility>

#include "parallel/clean/cleaning.h"

namespace lodestone {
namespace {

// A mesh in its file: a bit for each triangle tells if it is dropped, and a number for each vertex what it has become.
class StreamCleaning final : public Cleaning {
 public:
  StreamCleaning(const MeshStream& stream, std::size_t working_bytes, Scheduler& scheduler)
      : Cleaning(stream.name(), stream.vertex_count(), stream.triangle_count(), scheduler),
        stream_(stream),
        dropped_triangles_(stream.triangle_count()) {
    working_bytes_ = working_bytes;
    shrink_ratio_ = 4;  // both copies then fit where the states and numbers are
    transform_.up = stream.up();
  }

  [[nodiscard]] CleanStream result() && {
    return {std::move(positions_),      std::move(numbers_), std::move(dropped_triangles_),
            triangle_count_ - dropped_, transform_,          repairs_};
  }

 private:
  void read_vertices(ChunkRange range, const VisitVertices& visit) const override {
    std::vector<Vec3d> positions(range.end - range.begin);
    stream_.read_vertices(range.begin, positions);
    visit(positions);
  }
  void update_triangles(ChunkRange range, const VisitTriangles& visit) override {
    std::vector<Triangle> triangles(range.end - range.begin);
    stream_.read_triangles(range.begin, triangles);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (dropped_triangles_[range.begin + i]) triangles[i] = {};
    visit(triangles);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      if (is_degenerate(triangles[i])) dropped_triangles_.set(range.begin + i);
  }
  [[nodiscard]] Vec3d position(std::uint32_t vertex) const override {
    Vec3d position;
    stream_.read_vertices(vertex, {&position, 1});
    return position;
  }
  [[nodiscard]] Triangle triangle(std::uint64_t index) const override {
    return dropped_triangles_[index] ? Triangle{} : welded(index, 1).front();
  }

  std::uint64_t drop_duplicate_triangles() override {
    return find_repeats(
        triangle_count_, working_bytes_,
        [&](ChunkRange range, const auto& emit) {
          const std::vector<Triangle> triangles = welded(range.begin, range.end - range.begin);
          for (std::size_t i = 0; i < triangles.size(); ++i)
            if (!dropped_triangles_[range.begin + i]) emit(range.begin + i, hash_of(triangles[i]));
        },
        [&](std::uint32_t a, std::uint32_t b) {
          return canonical(welded(a, 1).front()) == canonical(welded(b, 1).front());
        },
        [&](std::uint32_t repeat, std::uint32_t) { dropped_triangles_.set_shared(repeat); }, scheduler_);
  }

  void compact_triangles() override {}  // they are when they are read

  // Triangles by the vertices that theirs have become.
  [[nodiscard]] std::vector<Triangle> welded(std::uint64_t first, std::size_t count) const {
    std::vector<Triangle> triangles(count);
    stream_.read_triangles(first, triangles);
    if (!numbers_.empty())
      for (Triangle& t : triangles)
        for (std::uint32_t& v : t.v) v = numbers_[v];
    return triangles;
  }

  const MeshStream& stream_;
  BitSet dropped_triangles_;
};

}  // namespace

void BitSet::set_shared(std::size_t i) {
  std::atomic_ref(words_[i / 64]).fetch_or(std::uint64_t{1} << (i % 64), std::memory_order_relaxed);
}

std::vector<Triangle> CleanStream::read(const MeshStream& stream, std::uint64_t first, std::size_t count) const {
  std::vector<Triangle> left(count);
  stream.read_triangles(first, left);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (!dropped[first + i]) left[kept++] = left[i];
  left.resize(kept);
  if (!numbers.empty())
    for (Triangle& t : left)
      for (std::uint32_t& v : t.v) v = numbers[v];
  return left;
}

CleanStream clean_stream(const MeshStream& stream, Lattice lattice, std::size_t working_bytes, Scheduler& scheduler,
                         const std::function<void(double)>& progress) {
  StreamCleaning cleaning(stream, working_bytes, scheduler);
  cleaning.run(lattice, progress);
  return std::move(cleaning).result();
}

}  // namespace lodestone
