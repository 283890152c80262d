#include "parallel/streaming/cell_stream.h"

#include <algorithm>
#include <utility>

#include "core/files/input_file.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/lode/lode_payload.h"

namespace lodestone {
namespace {

// Offset at which the next cell's arrays begin.
constexpr std::uint64_t aligned(std::uint64_t bytes) { return (bytes + 15) / 16 * 16; }

void end_threads(std::mutex& mutex, std::condition_variable& changed, bool& ending, std::vector<std::thread>& threads) {
  {
    const std::lock_guard lock(mutex);
    ending = true;
  }
  changed.notify_all();
  for (std::thread& thread : threads) thread.join();
}

}  // namespace

CellStream::CellStream(const std::filesystem::path& path, CellStreamConfig config)
    : map_(std::make_shared<const MappedFile>(path)),
      reader_(std::make_unique<const LodeReader>(map_->bytes(), map_, path.string())),
      tables_(reader_->tables()),
      config_(std::move(config)) {
  const auto threads = static_cast<std::size_t>(std::max(config_.threads, 1));
  loading_.reserve(threads);  // a loading thread has nobody to tell that there is no memory
  threads_.reserve(threads);
  try {
    while (threads_.size() < threads) threads_.emplace_back([this] { work(); });
  } catch (...) {
    end_threads(mutex_, changed_, ending_, threads_);
    throw;
  }
}

CellStream::~CellStream() { end_threads(mutex_, changed_, ending_, threads_); }

std::uint64_t CellStream::family_bytes(CellId parent) const {
  const FamilyCells range = family_cells(tables(), parent);
  std::uint64_t bytes = 0;
  for (CellId c = range.begin; c < range.end; ++c) bytes += aligned(reader_->plain_size(c));
  return bytes;
}

LoadedFamily CellStream::load(CellId parent) const {
  LoadedFamily family;
  family.parent = parent;
  family.bytes = family_bytes(parent);
  family.memory = std::make_unique_for_overwrite<std::byte[]>(family.bytes);
  const FamilyCells range = family_cells(tables(), parent);
  std::uint64_t at = 0;
  for (CellId c = range.begin; c < range.end; ++c) {
    family.cells.push_back(reader_->load(c, {family.memory.get() + at, reader_->plain_size(c)}));
    at += aligned(reader_->plain_size(c));
    map_->forget(reader_->payload(c));
  }
  return family;
}

std::uint64_t CellStream::busy_bytes() const {
  std::uint64_t bytes = 0;
  for (const CellId parent : loading_) bytes += family_bytes(parent);
  for (const LoadedFamily& family : loaded_) bytes += family.bytes;
  return bytes;
}

void CellStream::request(std::span<const CellId> parents, std::uint64_t room) {
  {
    const std::lock_guard lock(mutex_);
    queue_.clear();
    std::uint64_t bytes = busy_bytes();
    for (const CellId parent : parents) {
      const auto is_it = [&](const LoadedFamily& family) { return family.parent == parent; };
      if (std::find(loading_.begin(), loading_.end(), parent) != loading_.end() ||
          std::any_of(loaded_.begin(), loaded_.end(), is_it))
        continue;
      bytes += family_bytes(parent);
      if (bytes > room) break;
      queue_.push_back(parent);
    }
  }
  changed_.notify_all();
}

std::vector<LoadedFamily> CellStream::collect() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(loaded_, {});
}

void CellStream::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return (queue_.empty() && loading_.empty()) || failure_; });
}

void CellStream::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ending_ || !queue_.empty(); });
    if (ending_) return;
    const CellId parent = queue_.front();
    queue_.pop_front();
    loading_.push_back(parent);
    lock.unlock();
    LoadedFamily family;
    std::exception_ptr failure;
    try {
      if (config_.before_load) config_.before_load(parent);
      family = load(parent);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    loading_.erase(std::find(loading_.begin(), loading_.end(), parent));
    try {
      if (!failure) loaded_.push_back(std::move(family));
    } catch (...) {
      failure = std::current_exception();
    }
    if (failure) failure_ = failure;
    changed_.notify_all();
  }
}

}  // namespace lodestone
