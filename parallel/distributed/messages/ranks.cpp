#include "parallel/distributed/messages/ranks.h"

#include <numeric>
#include <string>

#include "parallel/distributed/messages/parcels.h"
#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

struct Head {
  std::uint32_t sender = 0;
  std::uint64_t step = 0, bytes = 0;
  std::uint32_t magic = 0x4c4f'4445u;
  friend bool operator==(const Head&, const Head&) = default;
};

std::size_t at(int rank) { return static_cast<std::size_t>(rank); }

// The ranks in rows of a square, of which the last may be shorter.
class Square {
 public:
  explicit Square(int ranks) : ranks_(ranks) {
    while (width_ * width_ < ranks) ++width_;
  }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int column(int rank) const { return rank % width_; }
  // The rank of a column to which this rank gives what is for that column: in its own row, or else in that before.
  [[nodiscard]] int way(int rank, int column) const {
    const int own = rank / width_ * width_ + column;
    return own < ranks_ ? own : own - width_;
  }
  // Those that give something to this one.
  [[nodiscard]] std::vector<int> givers(int rank) const {
    std::vector<int> list;
    for (int giver = rank / width_ * width_; giver < std::min(ranks_, (rank / width_ + 2) * width_); ++giver)
      if (way(giver, column(rank)) == rank) list.push_back(giver);
    return list;
  }
  [[nodiscard]] std::vector<int> members(int column) const {
    std::vector<int> list;
    for (int rank = column; rank < ranks_; rank += width_) list.push_back(rank);
    return list;
  }

 private:
  int ranks_, width_ = 1;
};

}  // namespace

void Ranks::begin(const std::string& work) {
  const std::lock_guard lock(progress_mutex_);
  work_ = work, share_ = 0;
  if (on_progress_) on_progress_(work_, share_);
}

void Ranks::done(double share) {
  const std::lock_guard lock(progress_mutex_);
  if (!on_progress_ || share <= share_) return;
  share_ = share;
  on_progress_(work_, share_);
}

void Ranks::send(int to, const Message& payload) {
  const Head head{static_cast<std::uint32_t>(rank()), step_, payload.size()};
  Message message(sizeof(head) + payload.size());
  std::memcpy(message.data(), &head, sizeof(head));
  if (!payload.empty()) std::memcpy(message.data() + sizeof(head), payload.data(), payload.size());
  traffic_.bytes_sent += message.size();
  ++traffic_.messages_sent;
  transport_.send(to, std::move(message));
}

Message Ranks::receive(int from) {
  const Stopwatch clock;
  const Message message = transport_.receive(from);
  const double waited = clock.seconds();
  traffic_.waited_seconds += waited;
  if (on_wait_) on_wait_(waited, from);
  traffic_.bytes_received += message.size();
  Head head{.magic = 0};
  if (message.size() >= sizeof(head)) std::memcpy(&head, message.data(), sizeof(head));
  if (head != Head{static_cast<std::uint32_t>(from), step_, message.size() - sizeof(head)})
    throw Error("a message of rank " + std::to_string(from) + " is damaged or out of order (step " +
                std::to_string(step_) + "); run the job again, and report this if it happens twice");
  return {message.begin() + sizeof(head), message.end()};
}

std::vector<Message> Ranks::exchange(std::vector<Message>&& out) {
  assert(out.size() == at(count()));
  ++traffic_.rounds;
  return count() > most_direct_ ? exchange_by_way(std::move(out)) : exchange_directly(std::move(out));
}

std::vector<Message> Ranks::exchange_directly(std::vector<Message>&& out) {
  // Beginning with the next rank, so that not all of them write to the same one.
  for (int step = 1; step < count(); ++step) {
    const int to = (rank() + step) % count();
    send(to, out[at(to)]);
    Message().swap(out[at(to)]);
  }
  std::vector<Message> in(out.size());
  in[at(rank())] = std::move(out[at(rank())]);
  for (int step = 1; step < count(); ++step) {
    const int from = (rank() + count() - step) % count();
    in[at(from)] = receive(from);
  }
  ++step_;
  return in;
}

// First along the rows, then along the columns. Parcels say whom they are for, and whom they are from.
std::vector<Message> Ranks::exchange_by_way(std::vector<Message>&& out) {
  const Square square(count());
  std::vector<Message> onward(out.size());  // by rank of the own column: parcels for it
  const auto sort = [&](int giver, const Message& parcels) {
    for (ParcelReader reader(parcels, count()); !reader.at_end();) {
      const Parcel parcel = reader.read();
      if (square.column(parcel.rank) != square.column(rank()))
        throw Error("a message of rank " + std::to_string(giver) + " is for another rank than it came to");
      append_parcel({giver, parcel.content}, onward[at(parcel.rank)]);
    }
  };
  Message own;
  for (int step = 0; step < square.width(); ++step) {
    const int column = (square.column(rank()) + step) % square.width();
    const int way = square.way(rank(), column);
    Message parcels;
    for (const int to : square.members(column)) {
      if (!out[at(to)].empty()) append_parcel({to, out[at(to)]}, parcels);
      Message().swap(out[at(to)]);
    }
    if (way == rank())
      own = std::move(parcels);
    else
      send(way, parcels);
  }
  for (const int giver : square.givers(rank())) sort(giver, giver == rank() ? own : receive(giver));
  ++step_;

  std::vector<Message> in(out.size());
  const auto take = [&](const Message& parcels) {
    for (ParcelReader reader(parcels, count()); !reader.at_end();) {
      const Parcel parcel = reader.read();
      in[at(parcel.rank)].assign(parcel.content.begin(), parcel.content.end());
    }
  };
  const std::vector<int> column = square.members(square.column(rank()));
  for (const int to : column)
    if (to != rank()) send(to, onward[at(to)]);
  for (const int from : column) take(from == rank() ? onward[at(rank())] : receive(from));
  ++step_;
  return in;
}

// Every rank passes on what it knows, twice as much at each step.
std::vector<Message> Ranks::gather_messages(Message&& own) {
  std::vector<Message> all(at(count()));
  all[at(rank())] = std::move(own);
  for (int known = 1; known < count(); known *= 2) {  // of this rank and those after it
    Message parcels;
    for (int i = 0; i < std::min(known, count() - known); ++i) {
      const int of = (rank() + i) % count();
      append_parcel({of, all[at(of)]}, parcels);
    }
    send((rank() + count() - known) % count(), parcels);
    const Message came = receive((rank() + known) % count());
    for (ParcelReader reader(came, count()); !reader.at_end();) {
      const Parcel parcel = reader.read();
      all[at(parcel.rank)].assign(parcel.content.begin(), parcel.content.end());
    }
    ++step_;
  }
  ++traffic_.rounds;
  return all;
}

// A tree: each rank hears of those below it before it is heard.
void Ranks::tell_first() {
  for (int distance = 1; distance < count(); distance *= 2) {
    if ((rank() & distance) != 0) {
      send(rank() - distance, {});
      break;
    }
    if (rank() + distance < count()) (void)receive(rank() + distance);
  }
  ++step_;
  ++traffic_.rounds;
}

std::string Ranks::from_first(const std::string& text) {
  Message known;
  if (const auto bytes = std::as_bytes(std::span(text)); rank() == 0) known.assign(bytes.begin(), bytes.end());
  int distance = 1;
  while (distance < count() && (rank() & distance) == 0) distance *= 2;
  if (rank() != 0) known = receive(rank() - distance);
  for (distance /= 2; distance > 0; distance /= 2)
    if (rank() + distance < count()) send(rank() + distance, known);
  ++step_;
  ++traffic_.rounds;
  return {reinterpret_cast<const char*>(known.data()), known.size()};
}

std::vector<std::vector<std::string>> Ranks::gather_texts(const std::vector<std::string>& own) {
  std::vector<char> ended;
  for (const std::string& text : own) ended.insert(ended.end(), text.c_str(), text.c_str() + text.size() + 1);
  std::vector<std::vector<std::string>> all;
  for (const std::vector<char>& of_rank : gather_lists(ended)) {
    std::vector<std::string>& texts = all.emplace_back();
    for (auto first = of_rank.begin(); first != of_rank.end();) {
      const auto last = std::find(first, of_rank.end(), '\0');
      texts.emplace_back(first, last);
      first = last == of_rank.end() ? last : last + 1;
    }
  }
  return all;
}

std::uint64_t Ranks::sum(std::uint64_t value) {
  const std::vector<std::uint64_t> all = gather(value);
  return std::accumulate(all.begin(), all.end(), std::uint64_t{0});
}

std::uint64_t Ranks::maximum(std::uint64_t value) { return std::ranges::max(gather(value)); }

}  // namespace lodestone
