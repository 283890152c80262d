#include "experiments/command_line/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lodestone {
namespace {

// Below this share the time left is anybody's guess.
constexpr double least_share = 0.01;

// A number and the prefix of its order of magnitude: 17.4 M, 320 k, 12.
struct Scaled {
  double factor;
  const char* prefix;
};
Scaled scale_for(double amount) {
  if (amount >= 1e6) return {1e-6, " M"};
  if (amount >= 1e4) return {1e-3, " k"};
  return {1, ""};
}

std::string duration(double seconds) {
  const auto whole = static_cast<long long>(seconds + 0.5);
  if (whole < 100) return fmt::format("{} s", whole);
  if (whole < 6000) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string progress_line(const std::string& label, double share, double seconds, double amount,
                          const std::string& unit) {
  constexpr int width = 30;
  const auto filled = static_cast<std::size_t>(share * width);
  std::string line = fmt::format("{:<10} [{}{}] {:3.0f} %", label, std::string(filled, '#'),
                                 std::string(width - filled, '.'), 100 * share);
  const char* separator = "  ";
  if (amount > 0) {
    const Scaled all = scale_for(amount);
    line += fmt::format("  {:.3g} of {:.3g}{} {}", share * amount * all.factor, amount * all.factor, all.prefix, unit);
    const double rate = seconds > 0 ? share * amount / seconds : 0;
    const Scaled scaled = scale_for(rate);
    line += fmt::format(", {:.3g}{}/s", rate * scaled.factor, scaled.prefix);
    separator = ", ";
  }
  if (share >= least_share) line += fmt::format("{}{} left", separator, duration(seconds * (1 - share) / share));
  return line;
}

Progress::Progress(std::string label, bool quiet, Start start)
    : label_(std::move(label)), start_(Clock::now()), phase_start_(start_), last_(start_) {
  if (quiet) return;
  if (isatty(STDERR_FILENO))
    out_ = stderr;
  else if (start == Start::by_launcher)
    out_ = std::fopen("/dev/tty", "we");
}

Progress::~Progress() {
  clear();
  if (out_ && out_ != stderr) std::fclose(out_);
}

void Progress::phase(std::string label) {
  label_ = std::move(label);
  amount_ = 0;
  phase_start_ = Clock::now();
  if (!out_) return;
  fmt::print(out_, "\r{} ...\x1b[K", label_);
  std::fflush(out_);
  drawn_ = true;
}

void Progress::measure(double amount, std::string unit) {
  amount_ = amount;
  unit_ = std::move(unit);
}

void Progress::clear() {
  if (!drawn_) return;
  fmt::print(out_, "\r\x1b[K");
  std::fflush(out_);
  drawn_ = false;
}

void Progress::update(double share) {
  if (!out_) return;
  const Clock::time_point now = Clock::now();
  if (now - start_ < std::chrono::seconds(1) || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  const double seconds = std::chrono::duration<double>(now - phase_start_).count();
  fmt::print(out_, "\r{}\x1b[K", progress_line(label_, std::clamp(share, 0.0, 1.0), seconds, amount_, unit_));
  std::fflush(out_);
  drawn_ = true;
}

}  // namespace lodestone
