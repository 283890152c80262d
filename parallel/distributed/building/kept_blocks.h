// The blocks that a build by ranks has run, in files with names: when it is interrupted, the next one has them, with
// any number of ranks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/files/scratch_file.h"
#include "parallel/distributed/cell_owners.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/out_of_core/cell_store.h"
#include "parallel/out_of_core/journal.h"

namespace lodestone {

// The cells of a block, complete, and those that it has made, without parents.
struct KeptBlock {
  std::vector<StoredCell> children, parents;
};

// Each rank has a file of cells and a journal, named by the rank and by chance. The next build finds those that are
// there: each is taken by one rank that sees it, so that machines may share a disk or have one each.
class KeptBlocks {
 public:
  // Called by all ranks. Throws InputError where the folder has the files of another build, ResourceError where such a
  // build is at work, and FileError.
  KeptBlocks(std::filesystem::path folder, std::span<const std::byte> identity, Ranks& ranks);

  // Cells of this rank, to which others may be added.
  [[nodiscard]] ScratchFile& cells() { return *files_.front().cells; }

  // Called by all ranks: sends the blocks that an earlier build has left to the ranks that own them now.
  void settle(const CellOwners& owners, Ranks& ranks);

  // A block of a level is known by the first of its cells. Null if it has to be run.
  [[nodiscard]] const KeptBlock* find(int level, CellCode first) const;
  // From any thread: when the cells are in the file.
  void record(int level, CellCode first, const KeptBlock& block);
  [[nodiscard]] std::uint64_t resumed() const { return blocks_.size(); }  // that an earlier build has run

  // When the result is complete at this rank, or at rank 0 for all: the files that it sees are not needed any more.
  void remove();

 private:
  using Key = std::pair<int, CellCode>;
  struct Files {
    std::string name;
    std::unique_ptr<Journal> journal;
    std::unique_ptr<ScratchFile> cells;
    std::map<Key, KeptBlock> blocks;
  };

  [[nodiscard]] std::vector<std::string> list() const;
  [[nodiscard]] std::vector<std::string> taken(Ranks& ranks) const;
  void open(const std::string& name, std::span<const std::byte> identity);
  void send(const Files& from, const Key& key, KeptBlock block, Message& message) const;
  void receive(const Message& message);

  std::filesystem::path folder_;
  std::vector<Files> files_;  // of this rank, then those that it has taken from others, until they are sent
  std::map<Key, KeptBlock> blocks_;
  bool first_removes_ = false;  // rank 0 sees this folder
};

}  // namespace lodestone
