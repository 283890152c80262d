// Numbers in the order of appearance, against a standard map under random operations.
#include <gtest/gtest.h>

#include <random>
#include <unordered_map>

#include "core/base/key_numbers.h"

namespace lodestone {
namespace {

struct OneHash {
  std::uint64_t operator()(std::uint64_t) const { return 0; }
};

// Keys one by one and several at once, between clearings that expect too few or too many.
template <class Numbers, class Key>
void compare_with_map(Key kinds, int rounds) {
  std::mt19937_64 random(1);
  const auto any_key = [&] { return static_cast<Key>(random() % kinds * 0x0101'0101'0101'0101ull); };
  Numbers numbers;
  std::unordered_map<Key, std::uint32_t> twin;
  const auto expected = [&](Key key) {
    return twin.try_emplace(key, static_cast<std::uint32_t>(twin.size())).first->second;
  };
  for (int round = 0; round < rounds; ++round) {
    if (random() % 8 == 0) {
      numbers.clear(random() % 3 == 0 ? random() % 2000 : 0);
      twin.clear();
    }
    const Key one = any_key();
    ASSERT_EQ(numbers.number(one), expected(one));
    std::vector<Key> several(random() % 300);
    for (Key& key : several) key = any_key();
    std::vector<std::uint32_t> out(several.size());
    numbers.number(several, out.data());
    for (std::size_t i = 0; i < several.size(); ++i) ASSERT_EQ(out[i], expected(several[i]));
    ASSERT_EQ(numbers.size(), twin.size());
    for (const auto& [key, number] : twin) ASSERT_EQ(numbers.keys()[number], key);
  }
}

TEST(KeyNumbers, FollowTheOrderOfAppearance) {
  for (const std::uint32_t kinds : {1u, 3u, 1000u, 1'000'000u}) compare_with_map<KeyNumbers<std::uint32_t>>(kinds, 100);
  compare_with_map<KeyNumbers<std::uint64_t>>(std::uint64_t{1} << 40, 100);
}

TEST(KeyNumbers, MayAllHaveOneHash) { compare_with_map<KeyNumbers<std::uint64_t, OneHash>>(std::uint64_t{200}, 50); }

TEST(KeyNumbers, MayTakeThePlaceOfTheKeys) {
  std::mt19937 random(2);
  std::vector<std::uint32_t> ids(1500);
  for (std::uint32_t& id : ids) id = static_cast<std::uint32_t>(random() % 300) - 150;  // 0 and 2^32 - 1 among them
  const std::vector<std::uint32_t> before = ids;
  KeyNumbers<std::uint32_t> numbers;
  numbers.number(ids, ids.data());
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(numbers.keys()[ids[i]], before[i]);
}

TEST(KeyNumbers, HasNoneOfNothing) {
  KeyNumbers<std::uint32_t> numbers;
  EXPECT_EQ(numbers.size(), 0u);
  numbers.number({}, nullptr);
  numbers.clear(0);
  EXPECT_TRUE(numbers.keys().empty());
}

}  // namespace
}  // namespace lodestone
