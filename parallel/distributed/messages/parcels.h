// Several messages in one, each with the rank that it is for or comes from.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>

#include "core/base/error.h"
#include "parallel/distributed/messages/transport.h"

namespace lodestone {

struct Parcel {
  int rank = 0;
  std::span<const std::byte> content;
};

struct ParcelHead {
  std::uint32_t rank = 0, bytes = 0;  // a message has less than 2 GiB
};

inline void append_parcel(const Parcel& parcel, Message& message) {
  const ParcelHead head{static_cast<std::uint32_t>(parcel.rank), static_cast<std::uint32_t>(parcel.content.size())};
  const std::size_t before = message.size();
  message.resize(before + sizeof(head) + head.bytes);
  std::memcpy(message.data() + before, &head, sizeof(head));
  if (head.bytes > 0) std::memcpy(message.data() + before + sizeof(head), parcel.content.data(), head.bytes);
}

// Reads them one after the other. Throws Error where the bytes end within one, or it is of no rank.
class ParcelReader {
 public:
  // `ranks`: how many there are.
  ParcelReader(std::span<const std::byte> message, int ranks)
      : left_(message), ranks_(static_cast<std::uint32_t>(ranks)) {}
  [[nodiscard]] bool at_end() const { return left_.empty(); }
  [[nodiscard]] Parcel read() {
    ParcelHead head;
    if (left_.size() < sizeof(head)) throw Error("a message ends within a parcel");
    std::memcpy(&head, left_.data(), sizeof(head));
    left_ = left_.subspan(sizeof(head));
    if (head.bytes > left_.size() || head.rank >= ranks_)
      throw Error("a message ends within a parcel, or names a rank that is none");
    const Parcel parcel{static_cast<int>(head.rank), left_.first(head.bytes)};
    left_ = left_.subspan(head.bytes);
    return parcel;
  }

 private:
  std::span<const std::byte> left_;
  std::uint32_t ranks_;
};

}  // namespace lodestone
