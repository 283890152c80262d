// Long calls that are watched: ended from outside, and asked how far they are, whatever they do.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct Watch {
  const CancelFlag* cancel = nullptr;
  // Gets the name of the work (Scheduler::name_work; empty before the first), and the share that is done of the loop or
  // graph which runs, in [0, 1] and never less than before within one. Called in steps of a hundredth, from any thread
  // but one at a time, outside of nested loops. What it throws ends the work like an exception of the work's own.
  std::function<void(const std::string& work, double share)> progress = {};
};

// Passes all work on to `inner`, and throws Cancelled out of it soon after the flag is set: before the next chunk or
// task. So load_mesh, prepare_mesh, save_lode, load_lode, compare_meshes, make_progressive, reconstruct and every other
// function that takes a scheduler can be cancelled and tell how far it is. Files are written completely or not at all
// then, too. Reading a text file ends within a mebibyte of it; another step that runs on one thread alone ends before
// the flag is noticed. `inner` and the flag outlive the result.
[[nodiscard]] std::unique_ptr<Scheduler> make_watched_scheduler(Scheduler& inner, Watch watch);

}  // namespace lodestone
