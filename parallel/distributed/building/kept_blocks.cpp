#include "parallel/distributed/building/kept_blocks.h"

#include <algorithm>
#include <charconv>
#include <random>
#include <set>
#include <system_error>

#include "parallel/distributed/rank_blocks.h"
#include "parallel/out_of_core/build_journal.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view journal_prefix = "journal-", cells_prefix = "cells-";

fs::path path_of(const fs::path& folder, std::string_view prefix, const std::string& name) {
  return folder / (std::string(prefix) + name);
}

// RANK-CHANCE
std::string new_name(int rank) {
  std::random_device chance;
  return std::to_string(rank) + "-" + std::to_string((std::uint64_t{chance()} << 32) | chance());
}

int rank_in(const std::string& name) {
  int rank = -1;
  std::from_chars(name.data(), name.data() + name.size(), rank);
  return rank;
}

// Calls visit(offset, bytes) for the parts of the file that a block has.
template <class Visit>
void visit_parts(KeptBlock& block, const CellStore& store, const Visit& visit) {
  for (StoredCell& cell : block.children) {
    visit(cell.body, store.body_bytes(cell, false));
    visit(cell.parents, cell.vertices * sizeof(std::uint32_t));
  }
  for (StoredCell& cell : block.parents) visit(cell.body, store.body_bytes(cell, true));
}

void put(ByteWriter& out, int level, CellCode first, const KeptBlock& block) {
  out.put(level), out.put(first);
  out.put_vector(block.children), out.put_vector(block.parents);
}

std::pair<std::pair<int, CellCode>, KeptBlock> get(ByteSource& in) {
  std::pair<std::pair<int, CellCode>, KeptBlock> out;
  in.get(out.first.first), in.get(out.first.second);
  in.get_vector(out.second.children), in.get_vector(out.second.parents);
  return out;
}

}  // namespace

KeptBlocks::KeptBlocks(fs::path folder, std::span<const std::byte> identity, Ranks& ranks)
    : folder_(std::move(folder)) {
  create_scratch_folder(folder_);
  std::vector<std::string> names = taken(ranks);
  const auto own = std::ranges::find(names, ranks.rank(), rank_in);
  if (own == names.end())
    names.insert(names.begin(), new_name(ranks.rank()));
  else
    std::rotate(names.begin(), own, own + 1);
  for (const std::string& name : names) open(name, identity);
  const std::string first = ranks.from_first(names.front());
  first_removes_ = ranks.rank() > 0 && fs::exists(path_of(folder_, journal_prefix, first));
}

// By their numbers if the ranks share a disk; of others each is taken by the first rank that sees it.
std::vector<std::string> KeptBlocks::taken(Ranks& ranks) const {
  std::vector<std::string> own, others;
  for (const std::string& name : list()) (rank_in(name) % ranks.count() == ranks.rank() ? own : others).push_back(name);
  std::set<std::string> known;
  for (const std::vector<std::string>& of_rank : ranks.gather_texts(own)) known.insert(of_rank.begin(), of_rank.end());
  std::erase_if(others, [&](const std::string& name) { return known.contains(name); });
  const std::vector<std::vector<std::string>> seen = ranks.gather_texts(others);
  for (std::size_t rank = 0; rank < seen.size(); ++rank)
    for (const std::string& name : seen[rank])
      if (known.insert(name).second && rank == static_cast<std::size_t>(ranks.rank())) own.push_back(name);
  return own;
}

std::vector<std::string> KeptBlocks::list() const {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string file = entry.path().filename().string();
    if (file.starts_with(journal_prefix)) names.push_back(file.substr(journal_prefix.size()));
  }
  return names;
}

void KeptBlocks::open(const std::string& name, std::span<const std::byte> identity) {
  Files files{.name = name, .journal = {}, .cells = {}, .blocks = {}};
  files.journal = open_build_journal(path_of(folder_, journal_prefix, name), identity,
                                     [&](Journal::Kind, std::span<const std::byte> bytes) {
                                       ByteSource in(bytes);
                                       files.blocks.insert(get(in));
                                     });
  files.cells = ScratchFile::named(path_of(folder_, cells_prefix, name));
  files_.push_back(std::move(files));
}

void KeptBlocks::settle(const CellOwners& owners, Ranks& ranks) {
  ranks.begin("resuming");
  struct Leaving {
    const Files* from;
    const std::pair<const Key, KeptBlock>* block;
    int to;
  };
  std::vector<Leaving> leaving;
  for (const Files& files : files_)
    for (const auto& block : files.blocks) {
      const int owner = owners.owner(block.first.second, block.first.first);
      if (owner == ranks.rank() && &files == &files_.front())
        blocks_.insert(block);
      else
        leaving.push_back({&files, &block, owner});
    }
  std::size_t next = 0;
  do {
    std::vector<Message> messages(static_cast<std::size_t>(ranks.count()));
    for (std::size_t bytes = 0; next < leaving.size() && bytes < exchange_round_bytes; ++next) {
      Message& message = messages[static_cast<std::size_t>(leaving[next].to)];
      const std::size_t before = message.size();
      send(*leaving[next].from, leaving[next].block->first, leaving[next].block->second, message);
      bytes += message.size() - before;
    }
    for (const Message& message : ranks.exchange(std::move(messages))) receive(message);
  } while (ranks.any(next < leaving.size()));
  // All that was sent is in the journals of those who have it now.
  for (auto files = files_.begin() + 1; files != files_.end(); ++files)
    for (const std::string_view prefix : {journal_prefix, cells_prefix}) {
      std::error_code ignored;
      fs::remove(path_of(folder_, prefix, files->name), ignored);
    }
  files_.resize(1);
  files_.front().blocks.clear();
}

void KeptBlocks::send(const Files& from, const Key& key, KeptBlock block, Message& message) const {
  ByteWriter head;
  put(head, key.first, key.second, block);
  message.insert(message.end(), head.bytes().begin(), head.bytes().end());
  visit_parts(block, {*from.cells, {}}, [&](std::uint64_t offset, std::uint64_t bytes) {
    message.resize(message.size() + bytes);
    from.cells->read_at(offset, std::span(message).last(bytes));
  });
}

void KeptBlocks::receive(const Message& message) {
  ByteSource in(message);
  while (!in.left().empty()) {
    auto [key, block] = get(in);
    std::vector<std::byte> part;
    visit_parts(block, {cells(), {}}, [&](std::uint64_t& offset, std::uint64_t bytes) {
      part.resize(bytes);
      in.take(part);
      offset = cells().claim(bytes);
      cells().write_at(offset, part);
    });
    if (!blocks_.contains(key)) record(key.first, key.second, block);
    blocks_.insert({key, std::move(block)});
  }
}

const KeptBlock* KeptBlocks::find(int level, CellCode first) const {
  const auto found = blocks_.find({level, first});
  return found == blocks_.end() ? nullptr : &found->second;
}

void KeptBlocks::record(int level, CellCode first, const KeptBlock& block) {
  ByteWriter out;
  put(out, level, first, block);
  files_.front().journal->append(Journal::Kind::block, out.bytes());
}

void KeptBlocks::remove() {
  if (first_removes_) return;
  std::error_code ignored;
  for (const std::string& name : list())
    for (const std::string_view prefix : {journal_prefix, cells_prefix})
      fs::remove(path_of(folder_, prefix, name), ignored);
  fs::remove(folder_, ignored);  // unless it holds other files
}

}  // namespace lodestone
