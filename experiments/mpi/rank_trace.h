// The record of a rank: of its workers, of its stages, and of its waits for messages.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "parallel/distributed/messages/ranks.h"
#include "parallel/scheduler/scheduler.h"
#include "parallel/scheduler/trace.h"

namespace lodestone {

class RankTrace {
 public:
  // Called by all ranks, whose records begin at the same time, nearly. Empty path: nothing is recorded. The scheduler
  // is replaced by one that records; neither it nor the ranks are used after this has ended.
  RankTrace(std::string path, Ranks& ranks, std::unique_ptr<Scheduler>& scheduler);
  void begin_stage(const std::string& name);
  // Called by all ranks at the end: the first gets the events of all.
  void gather();
  // At the first rank. Throws FileError.
  void write() const;

 private:
  void end_stage();

  std::string path_;
  Ranks& ranks_;
  std::shared_ptr<Trace> trace_;  // null: nothing is recorded
  int workers_ = 0;
  std::string stage_;
  double stage_begin_ = 0;
  std::vector<std::string> events_;  // by rank, at the first
};

}  // namespace lodestone
