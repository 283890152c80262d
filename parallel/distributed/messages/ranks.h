// Calls that all ranks of a job make together, made of the messages of a transport. Every rank has to make the same
// calls in the same order: a message carries the number of the call that it belongs to, and another one is an error,
// not a hang.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "parallel/distributed/messages/packed_words.h"
#include "parallel/distributed/messages/transport.h"

namespace lodestone {

// Messages to other ranks and from them.
struct Traffic {
  std::uint64_t bytes_sent = 0, bytes_received = 0;
  std::uint64_t messages_sent = 0;
  std::uint64_t rounds = 0;   // calls that all ranks make together
  double waited_seconds = 0;  // for messages

  Traffic& operator+=(const Traffic& other) {
    bytes_sent += other.bytes_sent, bytes_received += other.bytes_received;
    messages_sent += other.messages_sent, rounds += other.rounds;
    waited_seconds += other.waited_seconds;
    return *this;
  }
  [[nodiscard]] Traffic since(const Traffic& before) const {
    return {bytes_sent - before.bytes_sent, bytes_received - before.bytes_received,
            messages_sent - before.messages_sent, rounds - before.rounds, waited_seconds - before.waited_seconds};
  }
};

class Ranks {
 public:
  // More ranks than `most_direct` exchange by way of others: a message to each rank of the row of a square, which sends
  // what has come for its column on to them. That is twice the bytes, and 2 sqrt(R) messages of a rank instead of R.
  explicit Ranks(Transport& transport, int most_direct = 48) : transport_(transport), most_direct_(most_direct) {}
  [[nodiscard]] int rank() const { return transport_.rank(); }
  [[nodiscard]] int count() const { return transport_.ranks(); }
  [[nodiscard]] const std::string& host() const { return transport_.host(); }
  [[nodiscard]] const Traffic& traffic() const { return traffic_; }
  // For people: what all ranks do from now on, and the share of it that is done, in [0, 1], as far as this rank knows;
  // where they work in rounds all know the same. Less than what was told before is not told. From any thread.
  void begin(const std::string& work);
  void done(double share);
  // Called by both, one call at a time.
  void show(std::function<void(const std::string& work, double share)> on_progress) {
    on_progress_ = std::move(on_progress);
  }
  // Called after each wait for a message, with its duration and the rank that it was for.
  void watch(std::function<void(double seconds, int from)> on_wait) { on_wait_ = std::move(on_wait); }

  // One round: out[r] goes to rank r; returns what each rank has sent to this one. Throws Error when a message has
  // another size or belongs to another call than it should, and what the transport throws.
  [[nodiscard]] std::vector<Message> exchange(std::vector<Message>&& out);
  // The same for lists of items, in fewer bytes (packed_words.h).
  template <class Item>
  [[nodiscard]] std::vector<std::vector<Item>> exchange(const std::vector<std::vector<Item>>& out);

  // The values of all ranks, by rank, in log2 R steps of a message each, the last of which has half of them. These and
  // all below throw as exchange does.
  template <class Value>
  [[nodiscard]] std::vector<Value> gather(const Value& value);
  template <class Value>
  [[nodiscard]] std::vector<std::vector<Value>> gather_lists(const std::vector<Value>& values) {
    std::vector<Message> all = gather_messages(pack_words(std::as_bytes(std::span(values)), sizeof(Value)));
    for (Message& message : all) message = unpack_words(message, sizeof(Value));
    return items_of<Value>(all);
  }
  // Texts of all ranks, by rank, without zero characters.
  [[nodiscard]] std::vector<std::vector<std::string>> gather_texts(const std::vector<std::string>& own);
  [[nodiscard]] std::uint64_t sum(std::uint64_t value);  // modulo 2^64
  [[nodiscard]] std::uint64_t maximum(std::uint64_t value);
  [[nodiscard]] bool any(bool value) { return maximum(value) > 0; }
  // Rank 0 waits for all others, of which none waits for it: what it does after that, it does if none has failed.
  void tell_first();
  // Returns rank 0's text; those of the others do not count.
  [[nodiscard]] std::string from_first(const std::string& text);

 private:
  void send(int to, const Message& payload);
  [[nodiscard]] Message receive(int from);
  [[nodiscard]] std::vector<Message> exchange_directly(std::vector<Message>&& out);
  [[nodiscard]] std::vector<Message> exchange_by_way(std::vector<Message>&& out);
  [[nodiscard]] std::vector<Message> gather_messages(Message&& own);
  template <class Item>
  [[nodiscard]] static std::vector<std::vector<Item>> items_of(const std::vector<Message>& messages);

  Transport& transport_;
  int most_direct_;
  Traffic traffic_;
  std::function<void(double, int)> on_wait_;
  std::function<void(const std::string&, double)> on_progress_;
  std::mutex progress_mutex_;
  std::string work_;
  double share_ = 0;        // of the work
  std::uint64_t step_ = 0;  // messages between two ranks within it are of one kind
};

template <class Item>
std::vector<std::vector<Item>> Ranks::exchange(const std::vector<std::vector<Item>>& out) {
  static_assert(std::is_trivially_copyable_v<Item>);
  std::vector<Message> messages;
  for (const std::vector<Item>& items : out) {
    const auto bytes = std::as_bytes(std::span(items));
    const bool stays = messages.size() == static_cast<std::size_t>(rank());
    messages.push_back(stays ? Message(bytes.begin(), bytes.end()) : pack_words(bytes, sizeof(Item)));
  }
  messages = exchange(std::move(messages));
  for (std::size_t from = 0; from < messages.size(); ++from)
    if (from != static_cast<std::size_t>(rank())) messages[from] = unpack_words(messages[from], sizeof(Item));
  return items_of<Item>(messages);
}

template <class Item>
std::vector<std::vector<Item>> Ranks::items_of(const std::vector<Message>& messages) {
  std::vector<std::vector<Item>> in;
  for (const Message& message : messages) {
    if (message.size() % sizeof(Item) != 0) throw Error("a message of another kind than expected");
    std::vector<Item>& items = in.emplace_back(message.size() / sizeof(Item));
    if (!items.empty()) std::memcpy(static_cast<void*>(items.data()), message.data(), message.size());
  }
  return in;
}

template <class Value>
std::vector<Value> Ranks::gather(const Value& value) {
  std::vector<Value> all;
  for (const std::vector<Value>& of_rank : gather_lists(std::vector{value})) {
    if (of_rank.size() != 1) throw Error("a message of another size than expected");
    all.push_back(of_rank.front());
  }
  return all;
}

}  // namespace lodestone
