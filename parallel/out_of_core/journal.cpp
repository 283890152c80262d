#include "parallel/out_of_core/journal.h"

#include <algorithm>
#include <string>

#include "core/base/error.h"
#include "core/files/checksum.h"

namespace lodestone {
namespace {

struct RecordHead {
  std::uint64_t bytes = 0, checksum = 0;
  std::uint64_t kind = 0;
  std::uint64_t own_checksum = 0;  // of the three above
  [[nodiscard]] std::uint64_t expected() const {
    return lodestone::checksum(std::as_bytes(std::span(this, 1)).first(3 * sizeof(std::uint64_t)));
  }
};

}  // namespace

Journal::Journal(const std::filesystem::path& path, const std::function<bool(Kind, std::span<const std::byte>)>& take)
    : file_(ScratchFile::named(path)) {
  if (!file_->lock())
    throw ResourceError(describe(path.parent_path().string(), "", "another build is at work with these temporary files",
                                 "wait for it, or give another --scratch"));
  std::uint64_t at = 0;
  std::vector<std::byte> bytes;
  while (file_->size() - at >= sizeof(RecordHead)) {
    RecordHead head;
    file_->read_at(at, std::as_writable_bytes(std::span(&head, 1)));
    if (head.own_checksum != head.expected() || head.bytes > file_->size() - at - sizeof(head)) break;
    bytes.resize(head.bytes);
    file_->read_at(at + sizeof(head), bytes);
    if (checksum(bytes) != head.checksum || !take(static_cast<Kind>(head.kind), bytes)) break;
    at += sizeof(head) + head.bytes;
  }
  file_->truncate(at);
}

void Journal::append(Kind kind, std::span<const std::byte> bytes) {
  RecordHead head{bytes.size(), checksum(bytes), static_cast<std::uint64_t>(kind), 0};
  head.own_checksum = head.expected();
  const std::lock_guard lock(writing_);
  const std::uint64_t at = file_->claim(sizeof(head) + bytes.size());
  file_->write_at(at + sizeof(head), bytes);
  file_->write_at(at, std::as_bytes(std::span(&head, 1)));
}

void ByteWriter::append(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

void ByteSource::take(std::span<std::byte> to) {
  if (bytes_.size() < to.size()) throw Error("a record ends too early");
  std::copy_n(bytes_.begin(), to.size(), to.begin());
  bytes_ = bytes_.subspan(to.size());
}

}  // namespace lodestone
