// Several messages in one, each with the rank that it is for or comes from.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>

#include "core/base/error.h"
#include "parallel/distributed/transport.h"

namespace lodestone {

struct Parcel {
  int rank = 0;
  std::span<const std::byte> content;
};

struct ParcelHead {
  std::uint64_t rank = 0, bytes = 0;
};

inline void append_parcel(const Parcel& parcel, Message& message) {
  const ParcelHead head{static_cast<std::uint64_t>(parcel.rank), parcel.content.size()};
  const std::size_t before = message.size();
  message.resize(before + sizeof(head) + head.bytes);
  std::memcpy(message.data() + before, &head, sizeof(head));
  if (head.bytes > 0) std::memcpy(message.data() + before + sizeof(head), parcel.content.data(), head.bytes);
}

// Reads them one after the other. Throws Error where the bytes end within one.
class ParcelReader {
 public:
  explicit ParcelReader(std::span<const std::byte> message) : left_(message) {}
  [[nodiscard]] bool at_end() const { return left_.empty(); }
  [[nodiscard]] Parcel read() {
    ParcelHead head;
    if (left_.size() < sizeof(head)) throw Error("a message ends within a parcel");
    std::memcpy(&head, left_.data(), sizeof(head));
    left_ = left_.subspan(sizeof(head));
    if (head.bytes > left_.size() || head.rank > 0x7fff'ffffu) throw Error("a message ends within a parcel");
    const Parcel parcel{static_cast<int>(head.rank), left_.first(head.bytes)};
    left_ = left_.subspan(head.bytes);
    return parcel;
  }

 private:
  std::span<const std::byte> left_;
};

}  // namespace lodestone
