// Prints the tables of docs/stability.md on the rounding of kernels, and on what 64 bits cost and gain over 32.
// usage: precision_table
#include <fmt/format.h>

#include "experiments/metrics/pictures/flip.h"
#include "tests/experiments/metrics/naive_images.h"
#include "tests/stability/kernel_errors.h"

namespace lodestone::test {
namespace {

struct Row {
  std::string kernel, precision;
  bool used = false;  // by the program
  KernelError error;
  double cost = 0;  // nanoseconds
};

void print(const std::vector<Row>& rows) {
  fmt::print("| kernel | precision | too small by | too large by | worst on | ns |\n");
  fmt::print("| --- | --- | ---: | ---: | --- | ---: |\n");
  for (const Row& row : rows)
    fmt::print("| {} | {}{} | {:.1e} | {:.1e} | {} | {} |\n", row.kernel, row.precision, row.used ? " (used)" : "",
               row.error.below, row.error.above, row.error.worst.empty() ? "-" : row.error.worst,
               row.cost > 0 ? fmt::format("{:.0f}", row.cost) : "-");
}

template <class Cases, class Kernel>
Row row_of(const std::string& kernel, const std::string& precision, bool used, const Cases& cases,
           std::span<const long double> exact, const Kernel& run) {
  return {kernel, precision, used, errors_of(cases, exact, run), nanoseconds(cases, run)};
}

float program_lambda(const BandView& view) {
  Radii radii;
  radii.band_begin = {HUGE_VALF, view.begin};
  radii.band_end = {HUGE_VALF, view.end};
  return morph_lambda({nullptr, &radii, Blend::smoothstep, view.from}, 1, view.vertex);
}

std::vector<Row> rows() {
  std::vector<Row> rows;
  {
    const auto cases = points_and_triangles(100);
    const auto exact = exact_of(cases, exact_distance);
    const auto add = [&](const char* precision, bool used, const auto& run) {
      rows.push_back(row_of("closest point, lengths", precision, used, cases, exact, run));
    };
    add("double, with slivers", true, program_distance);
    add("float, plain", false, plain_distance<float>);
    add("double, plain", false, plain_distance<double>);
    add("long double, plain", false, plain_distance<long double>);
  }
  {
    const auto cases = stars(100);
    const auto exact = exact_of(cases, exact_quadric);
    const auto add = [&](const char* precision, bool used, const auto& run) {
      rows.push_back(row_of("quadric, root of the cost", precision, used, cases, exact, run));
    };
    add("float, about the vertex", true, centred_quadric_in_float);
    add("double, about the origin", true, quadric_in_double);
    add("float, about the origin", false, plain_quadric_root<float>);
    add("long double, about the origin", false, plain_quadric_root<long double>);
  }
  {
    const auto cases = band_views(20'000);
    const auto exact = exact_of(cases, plain_lambda<long double>);
    const auto add = [&](const char* precision, bool used, const auto& run) {
      rows.push_back(row_of("lambda", precision, used, cases, exact, run));
    };
    add("float", false, plain_lambda<float>);
    add("double", false, plain_lambda<double>);
    rows.push_back({"lambda", "float, selected ends", true, errors_of(cases, exact, program_lambda), 0});
  }
  {
    const auto cases = sphere_triangles(60);
    const auto exact = exact_of(cases, plain_stretch<long double>);
    // Relative to the exact figure, whose size is anything.
    const auto add = [&](const char* precision, bool used, const auto& run) {
      KernelError error;
      for (std::size_t k = 0; k < cases.size(); ++k)
        error.add(static_cast<long double>(run(cases[k])) / exact[k], 1, cases[k].name);
      rows.push_back({"stretch, relative", precision, used, error, nanoseconds(cases, run)});
    };
    add("double", true, program_stretch);
    add("float", false, plain_stretch<float>);
    add("double, plain", false, plain_stretch<double>);
  }
  {
    const auto scheduler = make_serial_scheduler();
    const Image a = testing::pattern({96, 64}, 1), b = testing::pattern({96, 64}, 8);
    const ErrorMap fast = flip_error(a, b, *scheduler);
    const std::vector<double> slow = testing::NaiveFlip(FlipConfig{}.pixels_per_degree)(a, b);
    KernelError error;
    for (std::size_t i = 0; i < slow.size(); ++i) error.add(fast.value[i], slow[i], "pattern");
    rows.push_back({"FLIP, a pixel", "float", true, error, 0});
  }
  return rows;
}

}  // namespace
}  // namespace lodestone::test

int main() { lodestone::test::print(lodestone::test::rows()); }
