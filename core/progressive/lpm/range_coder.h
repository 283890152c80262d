// An adaptive binary range coder (martin1979), with the carry kept aside as in LZMA.
//
// Both directions have the same calls: the encoder writes the value that it is given, the decoder ignores it, and both
// return the value that was coded. A codec is written once and is symmetric by construction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lodestone::progressive {

// The probability of a 0, in 1/2048, learnt from the bits so far.
struct BitModel {
  std::uint16_t zero = 1024;
  void learn(std::uint32_t bit) {
    constexpr int rate = 5;
    zero = static_cast<std::uint16_t>(bit == 0 ? zero + ((2048 - zero) >> rate) : zero - (zero >> rate));
  }
};

class RangeEncoder {
 public:
  std::uint32_t bit(BitModel& model, std::uint32_t value) {
    const std::uint32_t bound = (range_ >> 11) * model.zero;
    if (value == 0) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    model.learn(value);
    normalise();
    return value;
  }
  // A value of so many bits, all of them equally likely.
  std::uint32_t direct(std::uint32_t bits, std::uint32_t value) {
    for (std::uint32_t k = bits; k-- > 0;) {
      range_ >>= 1;
      if ((value >> k & 1) != 0) low_ += range_;
      normalise();
    }
    return value;
  }
  // Returns the bytes so far; the encoder starts anew.
  [[nodiscard]] std::vector<std::byte> finish() {
    for (int k = 0; k < 5; ++k) shift();
    std::vector<std::byte> out(bytes_.begin() + 1, bytes_.end());  // the first byte is always 0
    *this = RangeEncoder();
    return out;
  }

 private:
  void normalise() {
    while (range_ < 1u << 24) {
      range_ <<= 8;
      shift();
    }
  }
  void shift() {
    if (low_ < 0xff00'0000u || low_ > 0xffff'ffffu) {
      const auto carry = static_cast<std::uint8_t>(low_ >> 32);
      for (std::uint8_t byte = cache_; pending_ > 0; --pending_, byte = 0xff)
        bytes_.push_back(static_cast<std::byte>(byte + carry));
      cache_ = static_cast<std::uint8_t>(low_ >> 24);
    }
    ++pending_;
    low_ = (low_ & 0x00ff'ffffu) << 8;
  }

  std::vector<std::byte> bytes_;
  std::uint64_t low_ = 0, pending_ = 1;
  std::uint32_t range_ = 0xffff'ffffu;
  std::uint8_t cache_ = 0;
};

// After the end of the bytes it reads zeros: the caller has to check what is decoded.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int k = 0; k < 4; ++k) code_ = code_ << 8 | next();
  }
  std::uint32_t bit(BitModel& model, std::uint32_t = 0) {
    const std::uint32_t bound = (range_ >> 11) * model.zero;
    const std::uint32_t value = code_ < bound ? 0 : 1;
    if (value == 0) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    model.learn(value);
    normalise();
    return value;
  }
  std::uint32_t direct(std::uint32_t bits, std::uint32_t = 0) {
    std::uint32_t value = 0;
    for (std::uint32_t k = 0; k < bits; ++k) {
      range_ >>= 1;
      const std::uint32_t one = code_ >= range_ ? 1 : 0;
      if (one != 0) code_ -= range_;
      value = value << 1 | one;
      normalise();
    }
    return value;
  }

 private:
  void normalise() {
    while (range_ < 1u << 24) {
      range_ <<= 8;
      code_ = code_ << 8 | next();
    }
  }
  std::uint32_t next() { return at_ < bytes_.size() ? static_cast<std::uint32_t>(bytes_[at_++]) : 0; }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t code_ = 0, range_ = 0xffff'ffffu;
};

// A number of so many bits, every bit with a model that knows those above it.
template <std::uint32_t bits>
struct TreeModel {
  BitModel node[1u << bits];
  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value) {
    std::uint32_t at = 1;
    for (std::uint32_t k = bits; k-- > 0;) at = at << 1 | coder.bit(node[at], value >> k & 1);
    return at - (1u << bits);
  }
};

// Any number, small ones in few bits: its length, its second bit by a model, the rest directly.
struct NumberModel {
  TreeModel<5> length;
  BitModel second[33];
  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value) {
    std::uint32_t n = 0;
    while (n < 31 && value >> n != 0) ++n;
    n = length.code(coder, n);
    if (n < 2) return n;
    std::uint32_t out = 2 | coder.bit(second[n], value >> (n - 2) & 1);
    if (n > 2) out = out << (n - 2) | coder.direct(n - 2, value & ((1u << (n - 2)) - 1));
    return out;
  }
};

// A difference: its size, and its sign directly.
struct SignedModel {
  NumberModel size;
  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t value) {
    const auto n = static_cast<std::int32_t>(size.code(coder, static_cast<std::uint32_t>(value < 0 ? -value : value)));
    if (n == 0) return 0;
    return coder.direct(1, value < 0 ? 1 : 0) != 0 ? -n : n;
  }
};

}  // namespace lodestone::progressive
