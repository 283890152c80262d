#include "parallel/distributed/messages/transport.h"

#include <algorithm>
#include <cstring>
#include <new>

namespace lodestone {
namespace {

RankFailure::Kind kind_of(const std::exception& error) {
  using enum RankFailure::Kind;
  if (dynamic_cast<const InputError*>(&error)) return input;
  if (dynamic_cast<const FileError*>(&error)) return file;
  if (dynamic_cast<const UnsupportedError*>(&error)) return unsupported;
  if (dynamic_cast<const ResourceError*>(&error) || dynamic_cast<const std::bad_alloc*>(&error)) return resource;
  return other;
}

constexpr std::size_t head_bytes = sizeof(int) + sizeof(RankFailure::Kind) + sizeof(std::uint32_t);

}  // namespace

RankFailure RankFailure::of(int rank, const std::string& host, const std::exception& error) {
  const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  return {rank, kind_of(error), host,
          memory ? "out of memory; use more machines, or fewer ranks on each" : error.what()};
}

std::exception_ptr RankFailure::error() const {
  const std::string what = "rank " + std::to_string(rank) + " on " + host + ": " + cause;
  switch (kind) {
    case Kind::input:
      return std::make_exception_ptr(InputError(what));
    case Kind::file:
      return std::make_exception_ptr(FileError(what));
    case Kind::unsupported:
      return std::make_exception_ptr(UnsupportedError(what));
    case Kind::resource:
      return std::make_exception_ptr(ResourceError(what));
    case Kind::other:
      break;
  }
  return std::make_exception_ptr(Error(what));
}

Message RankFailure::encode() const {
  Message message(head_bytes + host.size() + cause.size());
  std::byte* to = message.data();
  const auto put = [&](const void* from, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, from, bytes);
    to += bytes;
  };
  const auto host_bytes = static_cast<std::uint32_t>(host.size());
  put(&rank, sizeof(rank));
  put(&kind, sizeof(kind));
  put(&host_bytes, sizeof(host_bytes));
  put(host.data(), host.size());
  put(cause.data(), cause.size());
  return message;
}

RankFailure RankFailure::decode(const Message& message) {
  RankFailure failure;
  if (message.size() < head_bytes) return failure;
  const std::byte* from = message.data();
  std::uint32_t host_bytes = 0;
  std::memcpy(&failure.rank, from, sizeof(failure.rank));
  std::memcpy(&failure.kind, from += sizeof(failure.rank), sizeof(failure.kind));
  std::memcpy(&host_bytes, from += sizeof(failure.kind), sizeof(host_bytes));
  const auto* text = reinterpret_cast<const char*>(message.data() + head_bytes);
  const std::size_t bytes = message.size() - head_bytes, of_host = std::min<std::size_t>(host_bytes, bytes);
  failure.host.assign(text, of_host);
  failure.cause.assign(text + of_host, bytes - of_host);
  return failure;
}

void run_rank(Transport& transport, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    if (transport.failed()) throw;
    const RankFailure failure = RankFailure::of(transport.rank(), transport.host(), error);
    transport.fail(failure);
    std::rethrow_exception(failure.error());
  }
}

ResourceError silent_rank(int rank, const std::string& host, double seconds) {
  return ResourceError("no message of rank " + std::to_string(rank) + (host.empty() ? "" : " on " + host) + " for " +
                       std::to_string(static_cast<int>(seconds)) +
                       " s; see whether it was killed, or give a longer --timeout if it has that much to do");
}

}  // namespace lodestone
