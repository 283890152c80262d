#include "experiments/subjects/tile_archive.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/checksum.h"
#include "core/files/input_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t narrow = std::numeric_limits<std::uint32_t>::max();  // stands for "see the ZIP64 field"
constexpr std::uint16_t first_of_1980 = 0x21;                                // no time of writing
constexpr std::uint16_t version = 45;                                        // ZIP64
constexpr const char* index_name = "@3dtilesIndex1@";

struct Entry {
  std::string path;
  std::uint64_t offset = 0;
  std::uint32_t size = 0, crc = 0;
};

// Little-endian fields of the given sizes.
class Record {
 public:
  template <class T>
  Record& add(std::uint64_t value) {
    for (std::size_t k = 0; k < sizeof(T); ++k) bytes_.push_back(static_cast<std::byte>(value >> (8 * k)));
    return *this;
  }
  Record& u16(std::uint64_t v) { return add<std::uint16_t>(v); }
  Record& u32(std::uint64_t v) { return add<std::uint32_t>(v); }
  Record& u64(std::uint64_t v) { return add<std::uint64_t>(v); }
  Record& text(const std::string& s) {
    const auto bytes = std::as_bytes(std::span(s));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

// As the index orders them: two numbers of 64 bits, read little-endian.
std::array<std::uint64_t, 2> md5(const std::string& path) {
  std::array<std::uint64_t, 2> sum{};
  static_assert(std::endian::native == std::endian::little);
  if (EVP_Digest(path.data(), path.size(), reinterpret_cast<unsigned char*>(sum.data()), nullptr, EVP_md5(), nullptr) !=
      1)
    throw UnsupportedError("the OpenSSL of this machine refuses MD5, which .3tz needs; see its openssl.cnf");
  return sum;
}

std::vector<std::string> paths_below(const fs::path& folder) {
  std::vector<std::string> paths;
  for (const auto& file : fs::recursive_directory_iterator(folder))
    if (file.is_regular_file()) paths.push_back(file.path().lexically_relative(folder).generic_string());
  std::ranges::sort(paths);
  return paths;
}

class ArchiveWriter {
 public:
  explicit ArchiveWriter(const fs::path& target) : file_(target), name_(target.string()) {}

  void add(const std::string& path, std::span<const std::byte> bytes) {
    if (bytes.size() >= narrow)
      throw ResourceError(describe(name_, path, "a file of 4 GiB does not fit into the format",
                                   "write a folder, or build with smaller --cell-triangles"));
    const Entry entry{path, file_.position(), static_cast<std::uint32_t>(bytes.size()), crc32(bytes)};
    Record local;
    local.u32(0x0403'4b50).u16(version).u16(0).u16(0).u16(0).u16(first_of_1980);
    local.u32(entry.crc).u32(entry.size).u32(entry.size).u16(path.size()).u16(0).text(path);
    file_.write(local.bytes());
    file_.write(bytes);
    entries_.push_back(entry);
  }

  std::uint64_t finish() {
    add_index();
    const std::uint64_t begin = file_.position();
    for (const Entry& entry : entries_) write_central(entry);
    write_end(begin, file_.position());
    const std::uint64_t size = file_.position();
    file_.commit();
    return size;
  }

 private:
  void add_index() {
    std::vector<std::pair<std::array<std::uint64_t, 2>, std::uint64_t>> sums;
    for (const Entry& entry : entries_) sums.emplace_back(md5(entry.path), entry.offset);
    std::ranges::sort(sums);
    Record index;
    for (const auto& [sum, offset] : sums) index.u64(sum[0]).u64(sum[1]).u64(offset);
    add(index_name, index.bytes());
  }

  void write_central(const Entry& entry) {
    const bool wide = entry.offset >= narrow;
    Record central;
    central.u32(0x0201'4b50).u16(version).u16(version).u16(0).u16(0).u16(0).u16(first_of_1980);
    central.u32(entry.crc).u32(entry.size).u32(entry.size).u16(entry.path.size()).u16(wide ? 12 : 0).u16(0);
    central.u16(0).u16(0).u32(0).u32(wide ? narrow : entry.offset).text(entry.path);
    if (wide) central.u16(1).u16(8).u64(entry.offset);
    file_.write(central.bytes());
  }

  // The ZIP64 records are always there: readers of large archives are those of small ones.
  void write_end(std::uint64_t begin, std::uint64_t end) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint16_t>::max();
    const std::uint64_t count = entries_.size(), few = std::min(count, most);
    Record last;
    last.u32(0x0606'4b50).u64(44).u16(version).u16(version).u32(0).u32(0);
    last.u64(count).u64(count).u64(end - begin).u64(begin);
    last.u32(0x0706'4b50).u32(0).u64(end).u32(1);
    last.u32(0x0605'4b50).u16(0).u16(0).u16(few).u16(few);
    last.u32(std::min(end - begin, narrow)).u32(std::min(begin, narrow)).u16(0);
    file_.write(last.bytes());
  }

  AtomicFile file_;
  std::string name_;
  std::vector<Entry> entries_;
};

}  // namespace

std::uint64_t write_tile_archive(const fs::path& folder, const fs::path& target, const CancelFlag& cancel) {
  ArchiveWriter archive(target);
  for (const std::string& path : paths_below(folder)) {
    if (cancel) throw Cancelled{};
    const MappedFile file(folder / path);
    archive.add(path, file.bytes());
  }
  return archive.finish();
}

}  // namespace lodestone
