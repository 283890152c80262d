// Compressed payloads: what goes in comes out, and whatever the bytes are, nothing outside of them is touched.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <random>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_payload.h"
#include "core/mesh/clean.h"
#include "tests/core/hierarchy/lattice_meshes.h"
#include "tests/test_bytes.h"

namespace lodestone {
namespace {

constexpr Lattice lattice{14};

// Memory that ends where an unreadable page begins: one step beyond the end stops the test.
class Guarded {
 public:
  explicit Guarded(std::size_t size) : size_(size), page_(static_cast<std::size_t>(::sysconf(_SC_PAGESIZE))) {
    mapped_ = (size + page_ - 1) / page_ * page_ + page_;
    void* const at = ::mmap(nullptr, mapped_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    base_ = static_cast<std::byte*>(at);
    ::mprotect(base_ + mapped_ - page_, page_, PROT_NONE);
  }
  ~Guarded() { ::munmap(base_, mapped_); }
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;
  [[nodiscard]] std::span<std::byte> bytes() const { return {base_ + mapped_ - page_ - size_, size_}; }

 private:
  std::size_t size_, page_, mapped_ = 0;
  std::byte* base_ = nullptr;
};

std::vector<std::byte> plain(const Cell& cell) {
  std::string bytes;
  visit_arrays(cell, counts_of(cell), [&](const auto& items, std::size_t) { test::append_bytes(bytes, items); });
  const auto raw = std::as_bytes(std::span(bytes));
  return {raw.begin(), raw.end()};
}

// Triangles may begin with another corner.
std::vector<std::byte> with_canonical_triangles(std::vector<std::byte> bytes, const PayloadCounts& n) {
  for (std::size_t at = bytes.size() - n.triangles * sizeof(Triangle); at < bytes.size(); at += sizeof(Triangle)) {
    Triangle t;
    std::memcpy(&t, bytes.data() + at, sizeof(t));
    t = canonical(t);
    std::memcpy(bytes.data() + at, &t, sizeof(t));
  }
  return bytes;
}

void expect_round_trip(const Cell& cell) {
  std::vector<std::byte> packed(3);  // appends
  compress_payload(cell, lattice, packed);
  packed.erase(packed.begin(), packed.begin() + 3);
  const PayloadCounts n = counts_of(cell);
  const Guarded in(packed.size()), out(plain_bytes(n));
  std::copy(packed.begin(), packed.end(), in.bytes().begin());
  const char* const fault = decompress_payload(in.bytes(), n, lattice, out.bytes());
  EXPECT_EQ(fault, nullptr) << fault;
  const auto got = out.bytes();
  EXPECT_TRUE(with_canonical_triangles(plain(cell), n) == with_canonical_triangles({got.begin(), got.end()}, n));
}

TEST(LodeCompress, GivesBackEveryCell) {
  const Hierarchy h = test::lattice_sphere(4, lattice).hierarchy;
  for (const Cell& cell : h.cells) expect_round_trip(cell);
}

TEST(LodeCompress, GivesBackOddPayloads) {
  Cell cell;
  expect_round_trip(cell);  // nothing at all, and the root
  std::mt19937 random(3);
  for (const std::size_t count : {1u, 2u, 15u, 17u, 255u, 256u, 257u, 5000u}) {
    test::NaivePayload payload;
    for (std::size_t i = 0; i < count; ++i) {
      const auto coordinate = [&] { return static_cast<float>(random() % (lattice.last() + 1)) * lattice.step(); };
      payload.positions.push_back({coordinate(), coordinate(), coordinate()});
      payload.normals.push_back({static_cast<std::int16_t>(random()), static_cast<std::int16_t>(random())});
      payload.parents.push_back(static_cast<std::uint32_t>(random()));  // any word: ranges are checked elsewhere
      if (i % 3 == 0) payload.shared_ids.push_back(static_cast<std::uint32_t>(random()));
      const auto vertex = [&] { return static_cast<std::uint32_t>(random() % count); };
      const Triangle t{{vertex(), vertex(), vertex()}};
      if (!is_degenerate(t)) payload.triangles.push_back(t);
    }
    payload.positions[0] = {0, 1, lattice.step()};  // both ends
    cell.positions = payload.positions, cell.normals = payload.normals, cell.shared_ids = payload.shared_ids;
    cell.triangles = {};
    cell.parent = no_cell, cell.parents = {};
    expect_round_trip(cell);
    cell.parent = CellId(0), cell.parents = payload.parents;
    expect_round_trip(cell);
    cell.triangles = payload.triangles;
    expect_round_trip(cell);
  }
}

TEST(LodeCompress, RefusesVerticesOffTheLattice) {
  const Vec3f off{0.3f, 0, 0}, outside{2, 0, 0}, on{0.5f, 0, 0};
  const PackedNormal normal;
  std::vector<std::byte> out;
  for (const Vec3f& p : {off, outside}) {
    Cell cell;
    cell.positions = {&p, 1};
    cell.normals = {&normal, 1};
    EXPECT_THROW(compress_payload(cell, lattice, out), InputError);
  }
  Cell cell;
  cell.positions = {&on, 1};
  cell.normals = {&normal, 1};
  EXPECT_THROW(compress_payload(cell, {}, out), InputError);
  EXPECT_NO_THROW(compress_payload(cell, lattice, out));
}

TEST(LodeCompress, RefusesWhatIsNotOneStreamPerArray) {
  const Hierarchy h = test::lattice_sphere(3, lattice).hierarchy;
  const Cell& cell = h.cells[1];
  const PayloadCounts n = counts_of(cell);
  std::vector<std::byte> packed, out(plain_bytes(n));
  compress_payload(cell, lattice, packed);
  const auto fault = [&](std::span<const std::byte> bytes, Lattice on = lattice) {
    return decompress_payload(bytes, n, on, out) != nullptr;
  };
  EXPECT_FALSE(fault(packed));
  EXPECT_TRUE(fault({}));
  EXPECT_TRUE(fault(std::span(packed).first(19)));
  for (std::size_t size = 0; size < packed.size(); size += 7) EXPECT_TRUE(fault(std::span(packed).first(size))) << size;
  EXPECT_TRUE(fault(packed, {13}));  // coordinates beyond the end of the cube
  for (std::size_t array = 0; array < payload_arrays; ++array) {
    std::vector<std::byte> changed = packed;
    changed[4 * array] ^= std::byte{1};
    EXPECT_TRUE(fault(changed)) << array;
    changed[4 * array + 3] = std::byte{0xff};
    EXPECT_TRUE(fault(changed)) << array;
  }
}

// The codecs are somebody else's: their promise to survive any bytes is tried on the sizes and streams we make.
TEST(LodeCompress, SurvivesHostileBytes) {
  const Hierarchy h = test::lattice_sphere(4, lattice).hierarchy;
  std::mt19937 random(11);
  std::size_t refused = 0, taken = 0;
  for (CellId c{0}; c < h.cells.size(); ++c) {
    std::vector<std::byte> packed;
    compress_payload(h.cells[c], lattice, packed);
    const PayloadCounts n = counts_of(h.cells[c]);
    const Guarded in(packed.size()), out(plain_bytes(n));
    for (int round = 0; round < 200; ++round) {
      std::copy(packed.begin(), packed.end(), in.bytes().begin());
      const std::size_t changes = 1 + random() % (round % 4 == 0 ? 200 : 3);
      for (std::size_t i = 0; i < changes; ++i) {
        const std::size_t at = random() % (round % 3 == 0 ? std::min<std::size_t>(40, packed.size()) : packed.size());
        in.bytes()[at] = static_cast<std::byte>(random());
      }
      (decompress_payload(in.bytes(), n, lattice, out.bytes()) ? refused : taken) += 1;
    }
  }
  EXPECT_GT(refused, 100u);
  EXPECT_GT(taken, 100u);  // most changes give other values: the checksum is there for them
}

}  // namespace
}  // namespace lodestone
