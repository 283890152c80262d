// Messages between ranks: what arrives, in which order, and what happens when they do not.
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "parallel/distributed/messages/local_transport.h"
#include "parallel/distributed/messages/parcels.h"
#include "parallel/distributed/messages/pieces.h"
#include "parallel/distributed/messages/slices.h"
#include "tests/expect_error.h"

namespace lodestone {
namespace {

const LocalRanksConfig impatient{.timeout_seconds = 0.2};

// Between all ranks at once, or by way of others.
TEST(Ranks, ExchangeMessagesOfAnySize) {
  for (const int count : {1, 2, 3, 5, 7, 8, 9, 11, 12, 16, 23})
    for (const int most_direct : {0, count})
      run_local_ranks(count, [&](Transport& transport) {
        Ranks ranks(transport, most_direct);
        for (std::uint32_t round = 0; round < 3; ++round) {
          ByRank<std::uint32_t> out = by_rank<std::uint32_t>(ranks);
          const auto items = [&](int from, int to) {
            return std::vector(static_cast<std::size_t>(from * to) % 7,
                               static_cast<std::uint32_t>(from + 100 * to) + round);
          };
          for (int to = 0; to < count; ++to) out[static_cast<std::size_t>(to)] = items(ranks.rank(), to);
          const ByRank<std::uint32_t> in = ranks.exchange(out);
          for (int from = 0; from < count; ++from)
            EXPECT_EQ(in[static_cast<std::size_t>(from)], items(from, ranks.rank())) << from << " of " << count;
        }
        EXPECT_EQ(ranks.traffic().rounds, 3u);
        EXPECT_EQ(ranks.traffic().bytes_sent == 0, count == 1);
        if (most_direct == count) {
          EXPECT_EQ(ranks.traffic().messages_sent, 3u * static_cast<std::uint64_t>(count - 1));
        } else if (count == 16) {
          EXPECT_EQ(ranks.traffic().messages_sent, 3u * 6u);
        }
      });
}

TEST(Ranks, KnowWhatAllOthersKnow) {
  for (const int count : {1, 2, 3, 4, 5, 6, 7, 8, 13})
    run_local_ranks(count, [&](Transport& transport) {
      Ranks ranks(transport);
      const auto own = [](int rank) { return std::vector(static_cast<std::size_t>(rank % 3), rank); };
      const std::vector<std::vector<int>> lists = ranks.gather_lists(own(ranks.rank()));
      ASSERT_EQ(lists.size(), static_cast<std::size_t>(count));
      for (int rank = 0; rank < count; ++rank) EXPECT_EQ(lists[static_cast<std::size_t>(rank)], own(rank));
      EXPECT_EQ(ranks.sum(std::uint64_t(ranks.rank())), std::uint64_t(count * (count - 1) / 2));
      EXPECT_EQ(ranks.maximum(7 + std::uint64_t(ranks.rank())), std::uint64_t(6 + count));
      EXPECT_EQ(ranks.any(ranks.rank() == count - 1), true);
      EXPECT_EQ(ranks.any(false), false);
      const std::string text(static_cast<std::size_t>(5 + ranks.rank()), static_cast<char>('a' + ranks.rank()));
      EXPECT_EQ(ranks.from_first(text), "aaaaa");
      const auto texts = [&](int rank) {
        return std::vector(static_cast<std::size_t>(rank % 3), std::string(static_cast<std::size_t>(rank), 'x'));
      };
      const std::vector<std::vector<std::string>> all = ranks.gather_texts(texts(ranks.rank()));
      for (int rank = 0; rank < count; ++rank) EXPECT_EQ(all.at(static_cast<std::size_t>(rank)), texts(rank));
      EXPECT_EQ(ranks.traffic().rounds, 7u);
      EXPECT_TRUE(count != 8 || ranks.traffic().messages_sent <= 6 * 3 + 3);
    });
}

TEST(Ranks, TheFirstHearsOfAllOthers) {
  for (const int count : {1, 2, 3, 6, 8, 13}) {
    std::atomic<int> told{0};
    run_local_ranks(count, [&](Transport& transport) {
      Ranks ranks(transport);
      if (ranks.rank() > 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(ranks.rank()));
        ++told;
      }
      ranks.tell_first();
      EXPECT_TRUE(ranks.rank() > 0 || told == count - 1);
    });
  }
}

TEST(Ranks, ExchangeInPiecesKeepsTheOrderOfEachRank) {
  constexpr std::uint64_t items = 300'000;
  run_local_ranks(3, [&](Transport& transport) {
    Ranks ranks(transport);
    ByRank<std::uint64_t> came = by_rank<std::uint64_t>(ranks);
    // Ranks have different numbers of items.
    exchange_in_pieces<std::uint64_t>(
        ranks, items * static_cast<std::uint64_t>(ranks.rank()),
        [&](std::uint64_t i, const auto& emit) { emit(static_cast<int>(i % 3), i); },
        [&](int from, const std::vector<std::uint64_t>& some) {
          auto& all = came[static_cast<std::size_t>(from)];
          all.insert(all.end(), some.begin(), some.end());
        });
    for (std::uint64_t from = 0; from < 3; ++from) {
      ASSERT_EQ(came[from].size(), items * from / 3);
      for (std::size_t i = 0; i < came[from].size(); ++i)
        ASSERT_EQ(came[from][i], 3 * i + static_cast<std::uint64_t>(ranks.rank()));
    }
  });
}

TEST(Slices, MayBeTwoForEachRank) {
  const std::vector<std::uint64_t> sizes{3, 0, 2}, more{1, 4, 0};
  const Slices slices(sizes, more);
  EXPECT_EQ(slices.total(), 10u);
  const std::vector<int> owners{0, 0, 0, 2, 2, 0, 1, 1, 1, 1};
  const std::vector<std::uint64_t> places{0, 1, 2, 0, 1, 3, 0, 1, 2, 3}, all{4, 4, 2};
  for (std::uint64_t number = 0; number < slices.total(); ++number) {
    EXPECT_EQ(slices.owner(number), owners[number]) << number;
    EXPECT_EQ(slices.place(number).owner, owners[number]) << number;
    EXPECT_EQ(slices.place(number).before, places[number]) << number;
  }
  for (int rank = 0; rank < 3; ++rank) EXPECT_EQ(slices.size(rank), all[static_cast<std::size_t>(rank)]);
}

TEST(Slices, TellWhatOthersAskFor) {
  run_local_ranks(3, [&](Transport& transport) {
    Ranks ranks(transport);
    const auto rank = static_cast<std::uint32_t>(ranks.rank());
    const std::vector<std::uint32_t> numbers{7, rank, rank + 1, 90 + rank};  // 1 and 2: two of them each
    const std::vector<std::uint8_t> expected{1, rank > 0, rank < 2, 0};
    EXPECT_EQ(asked_by_others(Slices(100, 3), numbers, ranks), expected);
  });
}

TEST(Question, IsAnsweredByTheOwner) {
  run_local_ranks(4, [&](Transport& transport) {
    Ranks ranks(transport);
    const Slices slices(1003, 4);
    EXPECT_EQ(slices.total(), 1003u);
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < 1003; i += 7 + static_cast<std::uint32_t>(ranks.rank())) numbers.push_back(1002 - i);
    const auto squares = Question(ranks, slices, numbers).answer<std::uint64_t>([&](std::uint32_t local) {
      const std::uint64_t number = slices.begin(ranks.rank()) + local;
      return number * number;
    });
    ASSERT_EQ(squares.size(), numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(squares[i], std::uint64_t{numbers[i]} * numbers[i]);
  });
}

TEST(RankFailure, ReachesAllRanksAsTheErrorThatItWas) {
  std::atomic<int> told{0};
  const auto body = [&](Transport& transport) {
    Ranks ranks(transport);
    if (transport.rank() == 2) throw FileError("x.lode: cannot write: No space left on device");
    try {
      (void)ranks.sum(1);
    } catch (const FileError& error) {
      EXPECT_STREQ(error.what(), "rank 2 on this process: x.lode: cannot write: No space left on device");
      ++told;
      throw;
    }
  };
  expect_error_of<FileError>([&] { run_local_ranks(4, body); }, {"rank 2 on this process", "No space left"});
  EXPECT_EQ(told, 3);
}

TEST(RankFailure, KeepsItsKindInAMessage) {
  const auto travelled = [](const std::exception& error) {
    return RankFailure::decode(RankFailure::of(5, "node7", error).encode()).error();
  };
  EXPECT_THROW(std::rethrow_exception(travelled(InputError("a"))), InputError);
  EXPECT_THROW(std::rethrow_exception(travelled(UnsupportedError("a"))), UnsupportedError);
  expect_error_of<ResourceError>([&] { std::rethrow_exception(travelled(std::bad_alloc())); },
                                 {"rank 5 on node7", "out of memory"});
  expect_error_of<Error>([&] { std::rethrow_exception(travelled(std::logic_error("b"))); }, {"rank 5 on node7: b"});
  EXPECT_THROW(std::rethrow_exception(RankFailure::decode(Message(3)).error()), Error);
}

TEST(Transport, GivesUpAfterTheTimeOut) {
  const auto body = [](Transport& transport) {
    Ranks ranks(transport);
    if (transport.rank() != 1) (void)ranks.sum(1);
  };
  expect_error_of<ResourceError>([&] { run_local_ranks(2, body, impatient); }, {"rank 0", "no message of rank 1"});
}

// Alters, loses or repeats one message from rank 1 to rank 0.
void run_with_fault(const std::function<bool(Message&)>& fault) {
  std::atomic<int> sent{0};
  LocalRanksConfig config = impatient;
  config.on_send = [&](int from, int to, Message& message) {
    return from != 1 || to != 0 || ++sent != 2 || fault(message);
  };
  run_local_ranks(
      3,
      [](Transport& transport) {
        Ranks ranks(transport);
        for (std::uint64_t i = 0; i < 4; ++i) (void)ranks.exchange(ByRank<std::uint64_t>(3, {i}));
      },
      config);
}

TEST(Ranks, RefuseMessagesOfWrongSizeOrOrder) {
  expect_error_of<Error>([] { run_with_fault([](Message& m) { return m.resize(3), true; }); },
                         {"damaged or out of order"});
  expect_error_of<Error>([] { run_with_fault([](Message& m) { return m.resize(m.size() - 1), true; }); },
                         {"rank 0", "message of rank 1", "damaged or out of order"});
  expect_error_of<Error>([] { run_with_fault([](Message& m) { return m.resize(m.size() + 8), true; }); }, {"damaged"});
  // A lost one is noticed by the next.
  expect_error_of<Error>([] { run_with_fault([](Message&) { return false; }); }, {"message of rank 1"});
}

TEST(Parcels, OfOtherSizesOrRanksAreRefused) {
  Message message;
  append_parcel({3, Message(5)}, message);
  append_parcel({0, {}}, message);
  ParcelReader reader(message, 4);
  EXPECT_EQ(reader.read().content.size(), 5u);
  EXPECT_EQ(reader.read().rank, 0);
  EXPECT_TRUE(reader.at_end());
  expect_error_of<Error>([&] { (void)ParcelReader(message, 3).read(); }, {"names a rank that is none"});
  expect_error_of<Error>([&] { (void)ParcelReader(std::span(message).first(12), 4).read(); }, {"ends within a parcel"});
  expect_error_of<Error>([&] { (void)ParcelReader(std::span(message).first(7), 4).read(); }, {"ends within a parcel"});
}

}  // namespace
}  // namespace lodestone
