// Messages between the ranks of a job: processes, here or on other machines, that build one file together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error_kinds.h"

namespace lodestone {

using Message = std::vector<std::byte>;

// The end of a rank, as the others are told: its error, and who it was.
struct RankFailure {
  enum class Kind : std::uint8_t { other, input, file, unsupported, resource };
  int rank = 0;
  Kind kind = Kind::other;
  std::string host, cause;

  [[nodiscard]] static RankFailure of(int rank, const std::string& host, const std::exception& error);
  // Throws the error with "rank R on HOST: " before it, as what it was: an InputError remains one on every rank.
  [[nodiscard]] std::exception_ptr error() const;

  [[nodiscard]] Message encode() const;
  [[nodiscard]] static RankFailure decode(const Message& message);
};

// One rank's access to the others. Messages from one rank to another arrive in the order in which they were sent.
// To be used by one thread alone.
class Transport {
 public:
  virtual ~Transport() = default;
  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int ranks() const = 0;
  [[nodiscard]] virtual const std::string& host() const = 0;

  // Hands the message over, and does not wait until it has arrived. `to` is another rank.
  virtual void send(int to, Message&& message) = 0;
  // Waits for the next message of that rank. Throws the error of a rank that has failed, whichever it was, and
  // ResourceError when nothing comes within the time-out.
  [[nodiscard]] virtual Message receive(int from) = 0;
  // Tells all other ranks that this one ends with an error.
  virtual void fail(const RankFailure& failure) noexcept = 0;
  // True once this rank knows that another one has ended with an error.
  [[nodiscard]] virtual bool failed() const = 0;
};

// The work of a rank: an error of its own is told to the others, and thrown with rank and host as they throw it.
void run_rank(Transport& transport, const std::function<void()>& work);

// The error for a rank that does not answer.
[[nodiscard]] ResourceError silent_rank(int rank, const std::string& host, double seconds);

}  // namespace lodestone
