// Internals of verify: a hierarchy, the cells of it that are verified here, and what is asked of the other peers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/hierarchy/verify/verify_peers.h"
#include "core/mesh/clean_kernels.h"

namespace lodestone::verify {

// The same for -0 and +0.
[[nodiscard]] inline std::uint64_t key_of(Vec3f p) { return hash_of(Vec3f{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}); }

class Part {
 public:
  Part(const Hierarchy& whole, VerifyPeers& peers) : hierarchy(whole), peers_(peers) {}
  const Hierarchy& hierarchy;

  // True for the one peer that checks the tables.
  [[nodiscard]] bool has_tables() const { return peers_.index() == 0; }
  [[nodiscard]] bool has(CellId cell) const { return peers_.owner(cell) == peers_.index(); }
  [[nodiscard]] const Level& level(int l) const { return hierarchy.levels[static_cast<std::size_t>(l)]; }

  // Calls body(cell) for the cells here, and for the coarse cells whose children are here.
  template <class Body>
  void for_cells(int l, Body&& body) const {
    for (CellId c = level(l).first_cell; c < level(l).end_cell(); ++c)
      if (has(c)) body(c);
  }
  template <class Body>
  void for_parents(int l, Body&& body) const {
    for (CellId c = level(l).first_cell; c < level(l).end_cell(); ++c)
      if (has(hierarchy.cells[c].first_child)) body(c);
  }

  // The functions below are called by all peers together. sort_out: each item goes to the peer of its key (any number,
  // equal for items that are to meet); returns those that have come here. share: the items of each peer, at all of
  // them.
  template <class Item, class Key>
  [[nodiscard]] std::vector<Item> sort_out(std::vector<Item>&& items, const Key& key) const {
    if (peers_.count() == 1) return std::move(items);
    std::vector<std::vector<Item>> out(peers_.count());
    for (const Item& item : items) out[key(item) % peers_.count()].push_back(item);
    items = {};
    std::vector<Item> all;
    for (const std::vector<Item>& in : exchange(out)) all.insert(all.end(), in.begin(), in.end());
    return all;
  }
  template <class Item>
  [[nodiscard]] std::vector<std::vector<Item>> share(const std::vector<Item>& items) const {
    return exchange(std::vector<std::vector<Item>>(peers_.count(), items));
  }
  // Items for each peer, and from each.
  template <class Item>
  [[nodiscard]] std::vector<std::vector<Item>> exchange(const std::vector<std::vector<Item>>& out) const {
    static_assert(std::is_trivially_copyable_v<Item>);
    if (peers_.count() == 1) return out;
    std::vector<VerifyPeers::Bytes> messages(out.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      messages[i].resize(out[i].size() * sizeof(Item));
      if (!out[i].empty()) std::memcpy(messages[i].data(), out[i].data(), messages[i].size());
    }
    messages = peers_.exchange(std::move(messages));
    std::vector<std::vector<Item>> in(messages.size());
    for (std::size_t i = 0; i < in.size(); ++i) {
      in[i].resize(messages[i].size() / sizeof(Item));
      if (!in[i].empty()) std::memcpy(static_cast<void*>(in[i].data()), messages[i].data(), messages[i].size());
    }
    return in;
  }
  // Combines the values of all peers: combine(a, b) of two of them.
  template <class Value, class Combine>
  [[nodiscard]] std::vector<Value> reduce(const std::vector<Value>& values, const Combine& combine) const {
    std::vector<Value> all = values;
    const std::vector<std::vector<Value>> of_peers = share(values);
    for (std::size_t p = 0; p < of_peers.size(); ++p)
      for (std::size_t i = 0; i < all.size() && p != peers_.index(); ++i) all[i] = combine(all[i], of_peers[p][i]);
    return all;
  }
  [[nodiscard]] std::vector<double> maxima(const std::vector<double>& values) const {
    return reduce(values, [](double a, double b) { return std::max(a, b); });
  }
  [[nodiscard]] std::uint64_t sum(std::uint64_t value) const {
    return reduce(std::vector{value}, std::plus<>()).front();
  }

  [[nodiscard]] std::size_t owner(CellId cell) const { return peers_.owner(cell); }
  [[nodiscard]] std::size_t peers() const { return peers_.count(); }
  [[nodiscard]] std::size_t index() const { return peers_.index(); }

 private:
  VerifyPeers& peers_;
};

}  // namespace lodestone::verify
