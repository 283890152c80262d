// Point-to-point messages alone: a rank that waits can look for the failure of any other one, and for the time, which
// it cannot inside of a collective call of MPI.
#include "parallel/distributed/messages/mpi_transport.h"

#include <mpi.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <list>
#include <thread>
#include <utility>

#include "parallel/scheduler/clock.h"

namespace lodestone {
namespace {

constexpr int data_tag = 1, failure_tag = 2;

// Waiting for others leaves the processor to them: there may be more ranks than processors.
class Patience {
 public:
  void wait() {
    if (++tries_ < 64) return std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(std::min(50 * (tries_ - 63), 1000)));
  }

 private:
  int tries_ = 0;
};

int size_of(const Message& message) {
  if (message.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw ResourceError("a message of more than 2 GiB");
  return static_cast<int>(message.size());
}

}  // namespace

// Messages under way: they are kept until they have arrived.
class MpiTransport::Sends {
 public:
  void add(int to, int tag, Message&& message) {
    forget_done();
    Sent& sent = sent_.emplace_back(Sent{std::move(message), MPI_REQUEST_NULL});
    MPI_Isend(sent.message.data(), size_of(sent.message), MPI_BYTE, to, tag, MPI_COMM_WORLD, &sent.request);
  }
  void forget_done() {
    std::erase_if(sent_, [](Sent& sent) {
      int done = 0;
      MPI_Test(&sent.request, &done, MPI_STATUS_IGNORE);
      return done != 0;
    });
  }
  [[nodiscard]] bool empty() const { return sent_.empty(); }
  // After a failure, when some will never be received.
  void give_up() {
    static std::list<Sent> abandoned;
    abandoned.splice(abandoned.end(), sent_);
  }

 private:
  struct Sent {
    Message message;
    MPI_Request request;
  };
  std::list<Sent> sent_;
};

MpiTransport::MpiTransport(int* argc, char*** argv) : sends_(std::make_unique<Sends>()) {
  int provided = 0;
  if (MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS || provided < MPI_THREAD_FUNNELED)
    throw UnsupportedError("MPI does not start with threads in the process; use an MPI with MPI_THREAD_FUNNELED");
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
  std::array<char, MPI_MAX_PROCESSOR_NAME> name{};
  int length = 0;
  MPI_Get_processor_name(name.data(), &length);
  host_.assign(name.data(), static_cast<std::size_t>(length));
}

MpiTransport::~MpiTransport() {
  const Stopwatch clock;
  for (Patience patience; !sends_->empty() && clock.seconds() < (failed_ ? 2 : timeout_seconds_); patience.wait())
    sends_->forget_done();
  sends_->give_up();
  MPI_Finalize();
}

void MpiTransport::send(int to, Message&& message) { sends_->add(to, data_tag, std::move(message)); }

Message MpiTransport::receive(int from) {
  const Stopwatch clock;
  for (Patience patience;; patience.wait()) {
    int there = 0;
    MPI_Message handle = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Improbe(from, data_tag, MPI_COMM_WORLD, &there, &handle, &status);
    if (there) {
      int bytes = 0;
      MPI_Get_count(&status, MPI_BYTE, &bytes);
      Message message(static_cast<std::size_t>(bytes));
      MPI_Mrecv(message.data(), bytes, MPI_BYTE, &handle, &status);
      return message;
    }
    look_for_failure();
    sends_->forget_done();
    if (clock.seconds() > timeout_seconds_) throw silent_rank(from, {}, timeout_seconds_);
  }
}

void MpiTransport::look_for_failure() {
  int there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, failure_tag, MPI_COMM_WORLD, &there, &status);
  if (!there) return;
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  Message message(static_cast<std::size_t>(bytes));
  MPI_Recv(message.data(), bytes, MPI_BYTE, status.MPI_SOURCE, failure_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  failed_ = true;
  std::rethrow_exception(RankFailure::decode(message).error());
}

void MpiTransport::fail(const RankFailure& failure) noexcept {
  if (failed_) return;  // all know of the one that failed first
  failed_ = true;
  try {
    for (int to = 0; to < ranks_; ++to)
      if (to != rank_) sends_->add(to, failure_tag, failure.encode());
  } catch (const std::exception&) {  // they will wait for the time-out
  }
}

}  // namespace lodestone
