#include "parallel/distributed/ranks.h"

#include <numeric>
#include <string>

namespace lodestone {
namespace {

struct Head {
  std::uint32_t sender = 0;
  std::uint64_t round = 0, bytes = 0;
  std::uint32_t magic = 0x4c4f'4445u;
  friend bool operator==(const Head&, const Head&) = default;
};

}  // namespace

void Ranks::send(int to, const Message& payload) {
  const Head head{static_cast<std::uint32_t>(rank()), traffic_.rounds, payload.size()};
  Message message(sizeof(head) + payload.size());
  std::memcpy(message.data(), &head, sizeof(head));
  if (!payload.empty()) std::memcpy(message.data() + sizeof(head), payload.data(), payload.size());
  traffic_.bytes_sent += message.size();
  transport_.send(to, std::move(message));
}

Message Ranks::receive(int from) {
  const Message message = transport_.receive(from);
  traffic_.bytes_received += message.size();
  Head head{.magic = 0};
  if (message.size() >= sizeof(head)) std::memcpy(&head, message.data(), sizeof(head));
  if (head != Head{static_cast<std::uint32_t>(from), traffic_.rounds, message.size() - sizeof(head)})
    throw Error("a message of rank " + std::to_string(from) + " is damaged or out of order (round " +
                std::to_string(traffic_.rounds) + "); run the job again, and report this if it happens twice");
  return {message.begin() + sizeof(head), message.end()};
}

std::vector<Message> Ranks::exchange(std::vector<Message>&& out) {
  assert(out.size() == static_cast<std::size_t>(count()));
  // Beginning with the next rank, so that not all of them write to the same one.
  for (int step = 1; step < count(); ++step) {
    const int to = (rank() + step) % count();
    send(to, out[static_cast<std::size_t>(to)]);
    Message().swap(out[static_cast<std::size_t>(to)]);
  }
  std::vector<Message> in(out.size());
  in[static_cast<std::size_t>(rank())] = std::move(out[static_cast<std::size_t>(rank())]);
  for (int step = 1; step < count(); ++step) {
    const int from = (rank() + count() - step) % count();
    in[static_cast<std::size_t>(from)] = receive(from);
  }
  ++traffic_.rounds;
  return in;
}

void Ranks::tell_first() {
  if (rank() != 0) send(0, {});
  for (int from = 1; rank() == 0 && from < count(); ++from) (void)receive(from);
  ++traffic_.rounds;
}

std::uint64_t Ranks::sum(std::uint64_t value) {
  const std::vector<std::uint64_t> all = gather(value);
  return std::accumulate(all.begin(), all.end(), std::uint64_t{0});
}

std::uint64_t Ranks::maximum(std::uint64_t value) { return std::ranges::max(gather(value)); }

Message Ranks::from_first(const Message& message) {
  std::vector<Message> out(static_cast<std::size_t>(count()));
  if (rank() == 0) std::ranges::fill(out, message);
  return exchange(std::move(out)).front();
}

}  // namespace lodestone
