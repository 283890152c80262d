#include "core/spherical/topology/handles.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <random>
#include <utility>

#include "core/spherical/topology/cycle_labels.h"
#include "core/spherical/topology/fill_holes.h"

namespace lodestone::spherical {
namespace {

constexpr std::size_t batch = 16;  // balls that grow side by side
constexpr double growth = 1.5;     // of the radius, from one round to the next
constexpr double golden_ratio = 0.6180339887498949;
constexpr int tries = 4;        // vertices of a loop from which a shorter one may be found
constexpr int refinement = 4;   // likewise seeds on either side of the centre, as far as the slack
constexpr double noise = 1e-6;  // relative; lengths nearer to each other are equal

// A loop that a ball has found; as cuts only make loops longer, its length remains a lower bound for the ball's seed.
struct Candidate {
  Loop loop;
  Id seed = 0;
  std::uint32_t found_at = 0;  // the number of cuts before
};

struct IsLonger {
  bool operator()(const Candidate& a, const Candidate& b) const {
    return a.loop.length != b.loop.length ? a.loop.length > b.loop.length : a.seed > b.seed;
  }
};

class HandleCutter {
 public:
  HandleCutter(Surface& surface, const HandleConfig& config, const Runner& runner, std::vector<BallSearch>& memory,
               std::size_t worker)
      : surface_(surface), config_(config), runner_(runner), memory_(memory), own_(memory[worker]), graph_(surface) {}

  std::vector<double> run();
  void cap();

 private:
  Generators relabel();
  void cut_any();
  void uncover_all();
  void add_seeds(std::span<const Id> chain);
  void cover();
  std::vector<Id> next_batch(std::size_t& at) const;
  void grow_balls(std::span<const Id> seeds);
  bool is_current(const Candidate& candidate) const;
  void cut_candidates();
  [[nodiscard]] Loop shorter(Loop loop, std::span<const Id> seeds);
  [[nodiscard]] Loop shorten(Loop loop);
  [[nodiscard]] Loop refine(Loop loop, Id seed);
  void cut(const Loop& loop);

  // A vertex on a chain of them, in the order of the chain.
  struct Seed {
    Id vertex = 0;
    float step = 0;  // from the seed before it; infinite if that is none of its neighbours
  };

  Surface& surface_;
  HandleConfig config_;
  const Runner& runner_;
  std::vector<BallSearch>& memory_;
  BallSearch& own_;
  SurfaceGraph graph_;
  XorBasis closed_;
  std::vector<Seed> seeds_;
  std::vector<std::uint32_t> place_;    // by vertex: of its seed; no_id: it is none
  std::vector<std::uint32_t> pending_;  // places of seeds that balls have yet to cover, ascending
  std::vector<bool> is_covered_;        // by vertex
  std::priority_queue<Candidate, std::vector<Candidate>, IsLonger> candidates_;
  double radius_ = 0;
  double whole_ = 0;  // a ball of this radius is the whole surface
  std::mt19937_64 random_;
  std::vector<double> lengths_;
};

Generators HandleCutter::relabel() {
  closed_.clear();
  seeds_.clear();
  place_.assign(graph_.vertex_count(), no_id);
  candidates_ = {};
  Generators generators = label_cycles(graph_, own_, random_);
  for (const std::vector<Id>& loop : generators) add_seeds(loop);
  whole_ = 2.0 * own_.distance(own_.reached().back());
  uncover_all();
  return generators;
}

// Cuts along a generator. Balls as large as the surface fail to find a loop only where random labels hide it, or
// lengths are below the precision of distances.
void HandleCutter::cut_any() {
  Loop loop{0, 0, relabel().front()};
  for (std::size_t k = 0; k < loop.vertices.size(); ++k) {
    const Id v = loop.vertices[k];
    const Link& link = graph_.links(v)[graph_.find(v, loop.vertices[(k + 1) % loop.vertices.size()])];
    loop.length += link.length;
    loop.label ^= graph_.label(link);
  }
  cut(shorten(std::move(loop)));
}

void HandleCutter::uncover_all() {
  is_covered_.assign(graph_.vertex_count(), false);
  pending_.resize(seeds_.size());
  std::iota(pending_.begin(), pending_.end(), 0u);
}

// Neighbours on the chain are neighbours on the surface.
void HandleCutter::add_seeds(std::span<const Id> chain) {
  for (std::size_t k = 0; k < chain.size(); ++k) {
    if (place_[chain[k]] != no_id) continue;
    const bool follows = k > 0 && place_[chain[k - 1]] + 1 == seeds_.size();
    place_[chain[k]] = static_cast<std::uint32_t>(seeds_.size());
    seeds_.push_back({chain[k], follows ? graph_.links(chain[k - 1])[graph_.find(chain[k - 1], chain[k])].length
                                        : std::numeric_limits<float>::infinity()});
  }
}

// The next centres among the pending seeds from `at` on, so far apart that all between are within the slack of one.
std::vector<Id> HandleCutter::next_batch(std::size_t& at) const {
  std::vector<Id> centres;
  const double reach = config_.slack * radius_;
  // Goes along a chain up to the last seed within reach that is not covered.
  const auto advance = [&] {
    double way = 0;
    std::size_t last = at;
    for (std::size_t next = at + 1; next < pending_.size() && pending_[next] == pending_[next - 1] + 1; ++next) {
      way += seeds_[pending_[next]].step;
      if (!(way <= reach)) break;
      if (!is_covered_[seeds_[pending_[next]].vertex]) last = next;
    }
    at = last;
  };
  for (; at < pending_.size() && centres.size() < batch; ++at) {
    if (is_covered_[seeds_[pending_[at]].vertex]) continue;
    advance();
    centres.push_back(seeds_[pending_[at]].vertex);
    advance();
  }
  return centres;
}

// Balls around all of them, one after the other as far as results are concerned.
void HandleCutter::grow_balls(std::span<const Id> seeds) {
  struct Ball {
    Loop loop;
    std::vector<Id> covered;
  };
  std::vector<Ball> balls(seeds.size());
  const auto reach = static_cast<float>(config_.slack * radius_);
  runner_.run(seeds.size(), [&](std::size_t k, std::size_t worker) {
    BallSearch& search = memory_[worker];
    balls[k].loop = search.find_loop(graph_, closed_, seeds[k], 2 * radius_);
    for (const Id v : search.reached()) {
      if (search.distance(v) > reach) break;
      if (place_[v] != no_id) balls[k].covered.push_back(v);
    }
  });
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    for (const Id v : balls[k].covered) is_covered_[v] = true;
    if (!balls[k].loop.vertices.empty()) candidates_.push({std::move(balls[k].loop), seeds[k], graph_.cut_count()});
  }
}

// Balls until each pending seed is within the slack of the centre of one.
void HandleCutter::cover() {
  while (!pending_.empty()) {
    for (std::size_t at = 0; at < pending_.size();) grow_balls(next_batch(at));
    std::erase_if(pending_, [&](std::uint32_t place) { return is_covered_[seeds_[place].vertex]; });
  }
}

// True if no cut has touched the loop and it still does not separate the surface.
bool HandleCutter::is_current(const Candidate& candidate) const {
  if (candidate.found_at == graph_.cut_count()) return true;
  return closed_.reduce(candidate.loop.label) != 0 &&
         std::none_of(candidate.loop.vertices.begin(), candidate.loop.vertices.end(),
                      [&](Id v) { return graph_.last_cut(v) > candidate.found_at; });
}

// The shortest loop through one of the vertices, if it is noticeably shorter than the given one; else that.
Loop HandleCutter::shorter(Loop loop, std::span<const Id> seeds) {
  std::vector<Loop> found(seeds.size());
  runner_.run(seeds.size(), [&](std::size_t k, std::size_t worker) {
    found[k] = memory_[worker].find_loop(graph_, closed_, seeds[k], (1 - noise) * loop.length);
  });
  for (Loop& other : found)
    if (other.length < loop.length) loop = std::move(other);
  return loop;
}

// Looks for a shorter loop through vertices of this one, until there is none.
Loop HandleCutter::shorten(Loop loop) {
  for (double before = std::numeric_limits<double>::infinity(); loop.length < before;) {
    before = loop.length;
    std::vector<Id> seeds;
    double place = 0.5;
    for (int k = 0; k < tries; ++k) {
      seeds.push_back(loop.vertices[static_cast<std::size_t>(place * static_cast<double>(loop.vertices.size()))]);
      place += place + golden_ratio < 1 ? golden_ratio : golden_ratio - 1;
    }
    loop = shorter(std::move(loop), seeds);
  }
  return loop;
}

// Looks for a shorter loop through seeds that the ball of this one has covered.
Loop HandleCutter::refine(Loop loop, Id seed) {
  const double reach = config_.slack * radius_, step = reach / refinement;
  std::vector<Id> seeds;
  for (const int direction : {1, -1}) {
    double way = 0, next = step;
    for (std::size_t at = place_[seed]; direction > 0 ? at + 1 < seeds_.size() : at > 0;) {
      way += seeds_[direction > 0 ? at + 1 : at].step;
      if (!(way <= reach)) break;
      at += static_cast<std::size_t>(direction);
      if (way < next) continue;
      seeds.push_back(seeds_[at].vertex);
      next = way + step;
    }
  }
  const double before = loop.length;
  loop = shorter(std::move(loop), seeds);
  return loop.length < before ? shorten(std::move(loop)) : loop;
}

// The seeds on the loop, and their copies, become pending.
void HandleCutter::cut(const Loop& loop) {
  lengths_.push_back(loop.length);
  const Id first_copy = graph_.vertex_count();
  graph_.cut(loop.vertices, surface_);
  closed_.add(loop.label);
  place_.resize(graph_.vertex_count(), no_id);
  is_covered_.resize(graph_.vertex_count());
  const std::size_t seeds = seeds_.size();
  std::vector<Id> chain;
  for (Id k = 0; k < loop.vertices.size(); ++k) {
    const Id v = loop.vertices[k];
    if (place_[v] != no_id) {
      is_covered_[v] = false;
      pending_.push_back(place_[v]);
      chain.push_back(first_copy + k);
    } else {
      add_seeds(std::exchange(chain, {}));
    }
  }
  add_seeds(chain);
  for (std::size_t place = seeds; place < seeds_.size(); ++place) pending_.push_back(static_cast<Id>(place));
  std::sort(pending_.begin(), pending_.end());
}

void HandleCutter::cut_candidates() {
  while (!candidates_.empty() && graph_.genus() > 0 && closed_.size() < most_cuts) {
    Candidate candidate = candidates_.top();
    candidates_.pop();
    if (!is_current(candidate)) {
      candidate.loop = own_.find_loop(graph_, closed_, candidate.seed, 2 * radius_);
      candidate.found_at = graph_.cut_count();
      if (!candidate.loop.vertices.empty()) candidates_.push(std::move(candidate));
      continue;
    }
    if (config_.slack > 0) candidate.loop = refine(shorten(std::move(candidate.loop)), candidate.seed);
    cut(candidate.loop);
    cover();
  }
}

std::vector<double> HandleCutter::run() {
  radius_ = 2.0 * graph_.mean_length();
  relabel();
  while (graph_.genus() > 0) {
    cover();
    cut_candidates();
    if (closed_.size() >= most_cuts) {
      relabel();
      continue;
    }
    if (radius_ > 2 * whole_) cut_any();
    radius_ *= growth;
    uncover_all();
  }
  return std::move(lengths_);
}

void HandleCutter::cap() {
  for (const std::vector<Id>& loop : graph_.cap_loops()) fill_loop(surface_, loop);
}

}  // namespace

ClosedHandles close_handles(Surface& surface, const HandleConfig& config, const Runner& runner,
                            std::vector<BallSearch>& memory, std::size_t worker) {
  const std::size_t triangles = surface.triangles.size();
  if (4 + triangles == 2 * surface.positions.size()) return {};  // no handle: V - 3/2 F + F = 2
  HandleCutter cutter(surface, config, runner, memory, worker);
  ClosedHandles closed{cutter.run(), 0};
  cutter.cap();
  closed.cap_triangles = surface.triangles.size() - triangles;
  return closed;
}

}  // namespace lodestone::spherical
