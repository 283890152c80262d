// How core hands out items that may be worked on side by side, without a scheduler of its own.
#pragma once

#include <cstddef>
#include <functional>

namespace lodestone {

// Runs body(item, worker) for the items [0, count), in any order, perhaps side by side; worker < workers, and no two
// bodies of one worker at the same time unless one is within the other. Results do not depend on it.
struct Runner {
  std::size_t workers = 1;
  using Body = std::function<void(std::size_t item, std::size_t worker)>;
  std::function<void(std::size_t count, const Body& body)> run = [](std::size_t count, const Body& body) {
    for (std::size_t item = 0; item < count; ++item) body(item, 0);
  };
};

}  // namespace lodestone
