// Lists of items on their way between ranks: what arrives is what was sent, in fewer bytes where neighbours are alike.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "parallel/distributed/messages/packed_words.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

template <class T>
Message bytes_of(const std::vector<T>& items) {
  const auto bytes = std::as_bytes(std::span(items));
  return {bytes.begin(), bytes.end()};
}

TEST(PackedWords, ArriveAsTheyWere) {
  std::mt19937 random(1);
  for (const std::size_t item_bytes : {1, 3, 4, 6, 8, 12, 16, 20})
    for (const std::size_t items : {0, 1, 2, 3, 5, 8, 1000})
      for (const std::uint32_t spread : {0u, 1u, 200u, 70'000u, 20'000'000u, 0xffff'ffffu}) {
        Message sent(items * item_bytes);
        std::vector<std::uint32_t> words(sent.size() / 4);
        for (std::size_t i = 0; i < words.size(); ++i)
          words[i] = static_cast<std::uint32_t>(77 * i + (spread == 0 ? 0 : random() % spread));
        std::ranges::copy(std::as_bytes(std::span(words)), sent.begin());
        const Message packed = pack_words(sent, item_bytes);
        EXPECT_LE(packed.size(), sent.empty() ? 0 : sent.size() + 1);
        EXPECT_EQ(unpack_words(packed, item_bytes), sent) << item_bytes << " " << items << " " << spread;
      }
}

TEST(PackedWords, TakeFewerBytesWhereNeighboursAreAlike) {
  std::vector<std::uint32_t> strip;  // triangles of a grid
  for (std::uint32_t i = 0; i < 1000; ++i) strip.insert(strip.end(), {i, i + 1, i + 1001});
  EXPECT_LT(pack_words(bytes_of(strip), 12).size(), strip.size() * 4 / 3);
  std::mt19937 random(2);
  std::vector<std::uint32_t> noise(3000);
  for (std::uint32_t& word : noise) word = static_cast<std::uint32_t>(random());
  EXPECT_EQ(pack_words(bytes_of(noise), 12).size(), noise.size() * 4 + 1);
}

TEST(PackedWords, RefusesBytesOfAnotherKind) {
  std::mt19937 random(3);
  std::vector<std::uint32_t> words(300);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<std::uint32_t>(i * i);
  const Message packed = pack_words(bytes_of(words), 12);
  for (std::size_t size = 1; size < packed.size(); ++size)
    expect_error_of<Error>([&] { (void)unpack_words(std::span(packed).first(size), 12); }, {"another kind"});
  Message longer = packed, other = packed;
  longer.push_back(std::byte{0});
  other.front() = std::byte{2};
  for (const Message& wrong : {longer, other})
    expect_error_of<Error>([&] { (void)unpack_words(wrong, 12); }, {"another kind"});
  expect_error_of<Error>([&] { (void)unpack_words(packed, 3); }, {"another kind"});
  for (int trial = 0; trial < 2000; ++trial) {  // within its bytes, whatever they say
    Message damaged = packed;
    damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    try {
      EXPECT_LE(unpack_words(damaged, 12).size(), 16 * damaged.size());
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace lodestone
