#include "parallel/distributed/rank_verify.h"

#include <utility>

#include "core/hierarchy/verify/verify_peers.h"

namespace lodestone {
namespace {

class RankPeers final : public VerifyPeers {
 public:
  RankPeers(const RankCells& cells, Ranks& ranks) : cells_(cells), ranks_(ranks) {}
  [[nodiscard]] std::size_t count() const override { return static_cast<std::size_t>(ranks_.count()); }
  [[nodiscard]] std::size_t index() const override { return static_cast<std::size_t>(ranks_.rank()); }
  [[nodiscard]] std::size_t owner(CellId cell) const override {
    return static_cast<std::size_t>(cells_.owner_of[cell]);
  }
  [[nodiscard]] std::vector<Bytes> exchange(std::vector<Bytes>&& out) override {
    return ranks_.exchange(std::move(out));
  }

 private:
  const RankCells& cells_;
  Ranks& ranks_;
};

}  // namespace

VerifyReport verify_ranks(const RankCells& cells, Ranks& ranks, const VerifyProgress& progress) {
  RankPeers peers(cells, ranks);
  return verify_by_peers(cells.hierarchy, peers, nullptr, progress);
}

}  // namespace lodestone
