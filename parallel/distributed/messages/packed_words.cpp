#include "parallel/distributed/messages/packed_words.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "core/base/error.h"

namespace lodestone {
namespace {

static_assert(std::endian::native == std::endian::little, "the low bytes of a word are its first");

constexpr std::byte plain{0}, packed_form{1};  // first byte of a message that is not empty
constexpr std::size_t word_bytes = sizeof(std::uint32_t);
constexpr std::size_t head_bytes = 1 + word_bytes;  // the form, and the number of words

std::uint32_t word_at(const std::byte* from) {
  std::uint32_t word;
  std::memcpy(&word, from, word_bytes);
  return word;
}

// Small numbers for small differences of either sign.
std::uint32_t folded(std::uint32_t difference) { return (difference << 1) ^ (0u - (difference >> 31)); }
std::uint32_t unfolded(std::uint32_t folded) { return (folded >> 1) ^ (0u - (folded & 1)); }

std::uint32_t bytes_of(std::uint32_t word) { return (static_cast<std::uint32_t>(std::bit_width(word | 1u)) + 7) / 8; }

std::size_t controls_for(std::size_t words) { return (words + 3) / 4; }

Message as_they_are(std::span<const std::byte> items) {
  Message out(1 + items.size());
  out.front() = plain;
  std::memcpy(out.data() + 1, items.data(), items.size());
  return out;
}

[[noreturn]] void fail() { throw Error("a message of another kind than expected"); }

}  // namespace

Message pack_words(std::span<const std::byte> items, std::size_t item_bytes) {
  if (items.empty()) return {};
  if (item_bytes % word_bytes != 0) return as_they_are(items);
  const std::size_t words = items.size() / word_bytes, stride = item_bytes / word_bytes;
  Message out(head_bytes + controls_for(words) + items.size() + word_bytes);  // words are written whole
  out.front() = packed_form;
  const auto count = static_cast<std::uint32_t>(words);
  std::memcpy(out.data() + 1, &count, word_bytes);
  std::byte* const controls = out.data() + head_bytes;
  std::byte* to = controls + controls_for(words);
  for (std::size_t i = 0; i < words; ++i) {
    const std::uint32_t before = i < stride ? 0 : word_at(items.data() + (i - stride) * word_bytes);
    const std::uint32_t word = folded(word_at(items.data() + i * word_bytes) - before);
    const std::uint32_t bytes = bytes_of(word);
    controls[i / 4] |= static_cast<std::byte>((bytes - 1) << (2 * (i % 4)));
    std::memcpy(to, &word, word_bytes);
    to += bytes;
  }
  const auto size = static_cast<std::size_t>(to - out.data());
  if (size > items.size()) return as_they_are(items);
  out.resize(size);
  return out;
}

Message unpack_words(std::span<const std::byte> packed, std::size_t item_bytes) {
  if (packed.empty()) return {};
  if (packed.front() == plain) return {packed.begin() + 1, packed.end()};
  if (packed.front() != packed_form || packed.size() < head_bytes || item_bytes % word_bytes != 0) fail();
  const std::size_t words = word_at(packed.data() + 1), stride = item_bytes / word_bytes;
  if (controls_for(words) > packed.size() - head_bytes) fail();
  const std::byte* const controls = packed.data() + head_bytes;
  const std::byte* from = controls + controls_for(words);
  const std::byte* const end = packed.data() + packed.size();
  Message out(words * word_bytes);
  for (std::size_t i = 0; i < words; ++i) {
    const std::uint32_t bytes = 1 + (static_cast<std::uint32_t>(controls[i / 4] >> (2 * (i % 4))) & 3);
    if (bytes > static_cast<std::size_t>(end - from)) fail();
    std::uint32_t word = 0;
    if (static_cast<std::size_t>(end - from) >= word_bytes)
      word = word_at(from) & (0xffff'ffffu >> (32 - 8 * bytes));
    else
      std::memcpy(&word, from, bytes);
    from += bytes;
    const std::uint32_t before = i < stride ? 0 : word_at(out.data() + (i - stride) * word_bytes);
    word = unfolded(word) + before;
    std::memcpy(out.data() + i * word_bytes, &word, word_bytes);
  }
  if (from != end) fail();
  return out;
}

}  // namespace lodestone
