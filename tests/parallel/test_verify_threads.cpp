// Several threads find what one finds, on hierarchies that are right and on those that are wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <new>
#include <string>

#include "core/hierarchy/model/find_signatures.h"
#include "parallel/hierarchy/verify_threads.h"
#include "tests/core/hierarchy/verify_breakages.h"

namespace lodestone {
namespace {

// But for which of several failures a check names.
std::string numbers_of(const VerifyCheck& check) {
  return check.name + (check.passed ? " " + check.detail : check.detail.substr(check.detail.rfind(" (")));
}

void expect_same(const Hierarchy& hierarchy, const IndexedMesh* input, std::initializer_list<int> threads,
                 const std::string& what) {
  const VerifyReport alone = verify_hierarchy(hierarchy, input);
  for (const int count : threads) {
    const VerifyReport report = verify_hierarchy(hierarchy, *make_tbb_scheduler(count), input);
    ASSERT_EQ(report.checks.size(), alone.checks.size()) << what;
    for (std::size_t i = 0; i < alone.checks.size(); ++i)
      EXPECT_EQ(numbers_of(report.checks[i]), numbers_of(alone.checks[i])) << what << ", " << count << " threads";
    EXPECT_EQ(report.error_ratio, alone.error_ratio) << what << ", " << count << " threads";
  }
}

TEST(VerifyThreads, SeeEveryBreakage) {
  const IndexedMesh mesh = test::bumpy_sphere(4);
  const test::NaiveHierarchy whole = test::naive_hierarchy(mesh, test::finest, test::sigma0);
  for (const test::Breakage& breakage : test::breakages) {
    test::NaiveHierarchy broken = whole;
    breakage.apply(broken);
    expect_same(broken.attach(), &mesh, {3}, breakage.what);
  }
}

TEST(VerifyThreads, SayWhatOneSays) {
  for (const int levels : {0, 1, 3}) {
    const std::string what = std::to_string(levels) + " levels";
    const IndexedMesh mesh = test::on_lattice(test::bumpy_sphere(4, true), {14});
    test::NaiveHierarchy model = test::naive_hierarchy(mesh, levels, 0.2f);
    model.attach();
    Hierarchy& h = model.hierarchy;
    expect_same(h, &mesh, {1, 2, 5}, what);
    h.signatures = std::make_shared<const Signatures>(find_signatures(h));
    expect_same(h, nullptr, {2, 5}, what + " with signatures");
    Signatures::Table table = h.signatures->table();
    std::rotate(table.places.begin(), table.places.begin() + static_cast<std::ptrdiff_t>(table.places.size() / 2),
                table.places.end());
    for (float& error : table.errors) error /= 2;
    if (Signatures::fault(h, table)) continue;
    h.signatures = std::make_shared<const Signatures>(h, std::move(table));
    EXPECT_EQ(verify_hierarchy(h).valid(), levels == 0);
    expect_same(h, nullptr, {2, 5}, what + " with wrong signatures");
  }
}

// An exception in one of them ends all.
TEST(VerifyThreads, EndWhenTheProgressThrows) {
  const test::NaiveHierarchy model = test::naive_hierarchy(test::bumpy_sphere(4), 2, 0.2f);
  const auto scheduler = make_tbb_scheduler(4);
  for (const int last : {1, 2, 4}) {
    int calls = 0;
    const auto stop = [&](double) {
      if (++calls == last) throw Cancelled();
    };
    EXPECT_THROW((void)verify_hierarchy(model.hierarchy, *scheduler, nullptr, stop), Cancelled);
    EXPECT_EQ(calls, last);
  }
}

}  // namespace
}  // namespace lodestone
