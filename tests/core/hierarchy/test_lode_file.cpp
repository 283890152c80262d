// .lode files: what is written comes back, equal input gives equal bytes, and nothing altered is let in.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <tuple>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/lode/lode_format.h"
#include "core/hierarchy/model/find_signatures.h"
#include "core/mesh/clean.h"
#include "parallel/hierarchy/save.h"
#include "tests/core/hierarchy/lode_bytes.h"
#include "tests/expect_error.h"
#include "tests/old_lode.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

using namespace test;

TEST_F(LodeFile, GivesBackWhatWasWritten) {
  Hierarchy model = small_model();
  model.provenance.repairs = {1, 2, 3, 4, 5, 6, 7};
  model.provenance.simplifier = "cluster";
  model.provenance.cell_triangles = 2500;
  model.provenance.measured_errors = true;
  write_lode(model, path());
  expect_equal(model, open_lode(path()));
  EXPECT_EQ(files(), 1u);
}

TEST_F(LodeFile, IsToldByItsContentOrElseByItsName) {
  write_lode(small_model(), path("a.data"));
  write_lode(small_model(), path("b.ply"));
  std::ofstream(path("c.lode")) << "something else";
  std::ofstream(path("d.ply")) << "ply";
  for (const char* name : {"a.data", "b.ply", "c.lode", "none.lode"}) EXPECT_TRUE(is_lode_file(path(name))) << name;
  for (const char* name : {"d.ply", "none.ply"}) EXPECT_FALSE(is_lode_file(path(name))) << name;
}

TEST_F(LodeFile, GivesBackWhatWasCompressed) {
  for (const int finest : {0, 2}) {
    const Hierarchy model = test::lattice_sphere(4, {13}, finest).hierarchy;
    const std::uint64_t plain = write_lode(model, path("plain.lode"));
    expect_equal(model, open_lode(path("plain.lode")));
    const std::uint64_t packed = write_lode(model, path(), LodeForm::compressed);
    expect_equal(model, open_lode(path()));
    EXPECT_EQ(plain, fs::file_size(path("plain.lode")));
    EXPECT_EQ(packed, fs::file_size(path()));
    EXPECT_LT(packed, plain * 7 / 10);
  }
}

TEST_F(LodeFile, CompressesNothingThatIsOnNoLattice) {
  const auto scheduler = make_serial_scheduler();
  EXPECT_THROW(write_lode(small_model(), path(), LodeForm::compressed), InputError);
  EXPECT_THROW(save_lode(small_model(), path(), *scheduler, LodeForm::compressed), InputError);
  Hierarchy off = small_model();
  off.transform.lattice = {13};  // says so, but is not
  EXPECT_THROW(write_lode(off, path(), LodeForm::compressed), InputError);
  EXPECT_EQ(files(), 0u);
}

TEST_F(LodeFile, IsUsedInPlaceAndOutlivesTheHierarchyItCameFrom) {
  write_lode(small_model(), path());
  Hierarchy copy;
  {
    const Hierarchy opened = open_lode(path());
    copy = opened;
  }
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(copy.cells[0].positions.data()) % lode_alignment, 0u);
  expect_equal(small_model(), copy);
}

TEST_F(LodeFile, HasTheSameBytesFromEveryWriterAndAnyNumberOfThreads) {
  // Cells of several sizes, more than one chunk: about 5 MB.
  const Hierarchy model = test::naive_hierarchy(test::bumpy_sphere(7), 3, 0.05f).hierarchy;
  ASSERT_GT(lode_chunks(plan_lode(model)).size(), 1u);
  write_lode(model, path());
  const Bytes expected = read_bytes(path());
  const Signatures signatures = find_signatures(model);
  EXPECT_EQ(expected.size(), plan_lode(model).payload_end() + encode_assets(model, &signatures.table()).size());
  for (const int threads : {1, 2, 3, 7}) {
    const auto scheduler = make_tbb_scheduler(threads);
    save_lode(model, path("parallel.lode"), *scheduler);
    EXPECT_TRUE(read_bytes(path("parallel.lode")) == expected) << threads << " threads";
    expect_equal(model, load_lode(path("parallel.lode"), *scheduler));
  }
  const auto serial = make_serial_scheduler();
  save_lode(model, path("parallel.lode"), *serial);
  EXPECT_TRUE(read_bytes(path("parallel.lode")) == expected);
}

TEST_F(LodeFile, HasTheSameCompressedBytesFromEveryWriterAndAnyNumberOfThreads) {
  const Hierarchy model = test::lattice_sphere(7, {15}, 3).hierarchy;
  ASSERT_GT(lode_chunks(plan_lode(model), 1u << 20).size(), 1u);
  write_lode(model, path(), LodeForm::compressed);
  const Bytes expected = read_bytes(path());
  for (const int threads : {0, 1, 2, 3, 7}) {
    const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
    save_lode(model, path("parallel.lode"), *scheduler, LodeForm::compressed);
    EXPECT_TRUE(read_bytes(path("parallel.lode")) == expected) << threads << " threads";
    expect_equal(model, load_lode(path("parallel.lode"), *scheduler));
  }
}

TEST_F(LodeFile, CutsCellsIntoConsecutiveChunks) {
  const LodeLayout layout = plan_lode(small_model());
  for (const std::uint64_t size : {1u, 5000u, 1u << 30}) {
    std::uint32_t next = 0;
    for (const LodeChunk chunk : lode_chunks(layout, size)) {
      EXPECT_EQ(chunk.first_cell, next);
      EXPECT_GT(chunk.end_cell, chunk.first_cell);
      next = chunk.end_cell;
    }
    EXPECT_EQ(next + 1, layout.cell_offset.size());
  }
}

TEST_F(LodeFile, RefusesMissingForeignAndEmptyFiles) {
  EXPECT_THROW((void)open_lode(path("missing.lode")), FileError);
  EXPECT_THROW((void)open_lode(folder_), FileError);
  write_bytes(path(), {});
  EXPECT_THROW((void)open_lode(path()), InputError);
  write_bytes(path(), Bytes{'p', 'l', 'y', '\n', 'f', 'o', 'r', 'm', 'a', 't'});
  expect_error_of<InputError>([&] { return open_lode(path()); }, {"not a .lode file", path().string()});
}

class LodeFileOfEitherForm : public LodeFile, public ::testing::WithParamInterface<LodeForm> {};

INSTANTIATE_TEST_SUITE_P(Forms, LodeFileOfEitherForm, ::testing::Values(LodeForm::plain, LodeForm::compressed));

TEST_P(LodeFileOfEitherForm, RefusesEveryTruncationAndAnyExtension) {
  write_lode(lattice_model(), path(), GetParam());
  const Bytes whole = read_bytes(path());
  for (std::size_t size = 0; size < whole.size(); size += size < 2048 ? 1 : 997) {
    write_bytes(path("cut.lode"), Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_THROW((void)open_lode(path("cut.lode")), InputError) << size;
  }
  Bytes longer = whole;
  longer.push_back(0);
  write_bytes(path("long.lode"), longer);
  EXPECT_THROW((void)open_lode(path("long.lode")), InputError);
}

TEST_P(LodeFileOfEitherForm, RefusesEveryFlippedBitAndDoesSoInParallelToo) {
  write_lode(lattice_model(), path(), GetParam());
  const Bytes whole = read_bytes(path());
  const auto scheduler = make_tbb_scheduler(2);
  for (std::size_t at = 0; at < whole.size(); at += at < 2048 ? 1 : 499) {
    Bytes altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ (1 << (at % 8)));
    write_bytes(path("altered.lode"), altered);
    EXPECT_THROW((void)open_lode(path("altered.lode")), Error) << at;
    EXPECT_THROW((void)load_lode(path("altered.lode"), *scheduler), Error) << at;
  }
}

// Counts that would take more memory than any payload of that size can fill are refused before it is asked for.
TEST_F(LodeFile, RefusesCompressedCellsOfAbsurdSize) {
  write_lode(lattice_model(), path(), LodeForm::compressed);
  Bytes bytes = read_bytes(path());
  LodeHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  const std::size_t at = sizeof(LodeHeader) + header.level_count * sizeof(LodeLevel);
  for (const std::size_t field : {offsetof(LodeCell, vertices), offsetof(LodeCell, triangles)}) {
    Bytes changed = bytes;
    const std::uint32_t huge = 0xffff'fff0u;
    std::memcpy(changed.data() + at + field, &huge, sizeof(huge));
    write_bytes(path("changed.lode"), with_header(changed, [](LodeHeader&) {}));
    EXPECT_THROW((void)open_lode(path("changed.lode")), InputError);
  }
  for (const std::uint64_t offset : {std::uint64_t{0}, header.payload_offset + 8, std::uint64_t{1} << 60}) {
    Bytes changed = bytes;
    std::memcpy(changed.data() + at + sizeof(LodeCell) + offsetof(LodeCell, offset), &offset, sizeof(offset));
    write_bytes(path("changed.lode"), with_header(changed, [](LodeHeader&) {}));
    EXPECT_THROW((void)open_lode(path("changed.lode")), InputError) << offset;
  }
}

// Payloads that were altered on purpose, with checksums that fit: refused, or a hierarchy whose indices may be
// followed.
TEST_F(LodeFile, SurvivesHostilePayloadsWithGoodChecksums) {
  write_lode(lattice_model(), path(), LodeForm::compressed);
  const Bytes whole = read_bytes(path());
  LodeHeader header;
  std::memcpy(&header, whole.data(), sizeof(header));
  const std::size_t table = sizeof(LodeHeader) + header.level_count * sizeof(LodeLevel);
  unsigned random = 1, refused = 0;
  for (unsigned round = 0; round < 400; ++round) {
    Bytes bytes = whole;
    const auto next = [&] { return (random = random * 1664525u + 1013904223u) >> 8; };
    const std::size_t record = table + next() % header.cell_count * sizeof(LodeCell);
    LodeCell cell, after;
    std::memcpy(&cell, bytes.data() + record, sizeof(cell));
    std::memcpy(&after, bytes.data() + record + sizeof(cell), sizeof(after));
    const bool last = record + 2 * sizeof(cell) > header.payload_offset || after.offset <= cell.offset;
    const std::size_t end = last ? bytes.size() : after.offset;
    for (unsigned i = 0; i < 1 + round % 5; ++i)
      bytes[cell.offset + next() % std::min<std::size_t>(end - cell.offset, round % 2 ? 64 : 1u << 20)] =
          static_cast<char>(next());
    cell.checksum = XXH3_64bits(bytes.data() + cell.offset, end - cell.offset);
    std::memcpy(bytes.data() + record, &cell, sizeof(cell));
    write_bytes(path("changed.lode"), with_header(bytes, [](LodeHeader&) {}));
    try {
      const Hierarchy h = open_lode(path("changed.lode"));
      for (const Cell& c : h.cells)
        for (const Triangle& t : c.triangles) ASSERT_LT(std::max({t.v[0], t.v[1], t.v[2]}), c.positions.size());
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100u);
}

TEST_F(LodeFile, LeavesNothingBehindWhenTheTargetCannotBeWritten) {
  EXPECT_THROW(write_lode(small_model(), folder_ / "no_such_folder" / "model.lode"), FileError);
  EXPECT_THROW(write_lode(small_model(), folder_), FileError);
  const auto scheduler = make_serial_scheduler();
  EXPECT_THROW(save_lode(small_model(), folder_ / "no_such_folder" / "model.lode", *scheduler), FileError);
  EXPECT_EQ(files(), 0u);
}

// A file whose checksums fit can still be wrong, by mistake or on purpose: each rule is broken in memory, then written.
struct Breakage {
  const char* name;
  std::function<void(test::NaiveHierarchy&)> apply;
};

const Breakage breakages[] = {
    {"position is NaN", [](auto& t) { (*t.payloads)[1].positions[0].y = std::nanf(""); }},
    {"parent out of range", [](auto& t) { (*t.payloads)[2].parents[0] = 0xffff'ffffu; }},
    {"triangle out of range", [](auto& t) { (*t.payloads)[2].triangles[0].v[1] = 0xffff'ffffu; }},
    {"degenerate triangle", [](auto& t) { (*t.payloads)[2].triangles[0].v[1] = (*t.payloads)[2].triangles[0].v[0]; }},
    {"child range", [](auto& t) { t.hierarchy.cells[0].child_count -= 1; }},
    {"first child", [](auto& t) { ++t.hierarchy.cells[0].first_child; }},
    {"too many children", [](auto& t) { t.hierarchy.cells[1].child_count = 0xffff'ffffu; }},
    {"parent cell", [](auto& t) { t.hierarchy.cells.back().parent = CellId(0); }},
    {"child of finest", [](auto& t) { t.hierarchy.cells.back().child_count = 1; }},
    {"codes out of order", [](auto& t) { std::swap(t.hierarchy.cells[1].code, t.hierarchy.cells[2].code); }},
    {"code outside the grid", [](auto& t) { t.hierarchy.cells[0].code.morton = 8; }},
    {"box is NaN", [](auto& t) { t.hierarchy.cells[0].bounds.lo.x = std::nanf(""); }},
    {"box is empty", [](auto& t) { t.hierarchy.cells[0].bounds = {}; }},
    {"negative error", [](auto& t) { t.hierarchy.cells[1].error = -1; }},
    {"infinite displacement", [](auto& t) { t.hierarchy.cells[1].max_displacement = HUGE_VALF; }},
    {"level range", [](auto& t) { t.hierarchy.levels[1].first_cell = CellId(0); }},
    {"level count", [](auto& t) { t.hierarchy.levels[2].cell_count += 1; }},
    {"cells of no level", [](auto& t) { t.hierarchy.levels[2].cell_count -= 1; }},
    {"level triangles", [](auto& t) { t.hierarchy.levels[0].triangles += 1; }},
    {"level reach", [](auto& t) { t.hierarchy.levels[0].reach[1] = -1; }},
    {"no level", [](auto& t) { t.hierarchy.levels.clear(); }},
    {"sigma0", [](auto& t) { t.hierarchy.sigma0 = 0; }},
    {"scale", [](auto& t) { t.hierarchy.transform.scale = 0; }},
    {"origin", [](auto& t) { t.hierarchy.transform.origin.z = HUGE_VAL; }},
};

TEST_F(LodeFile, RefusesBrokenContentsWithGoodChecksums) {
  for (const Breakage& breakage : breakages) {
    test::NaiveHierarchy tiny = test::naive_hierarchy(test::bumpy_sphere(3), 2, 0.3f);
    tiny.hierarchy.signatures = signatures_of(tiny.hierarchy);
    breakage.apply(tiny);
    write_lode(tiny.attach(), path());
    EXPECT_THROW((void)open_lode(path()), InputError) << breakage.name;
  }
}

TEST_F(LodeFile, RefusesBrokenContentsInCompressedFilesToo) {
  for (const Breakage& breakage : breakages) {
    test::NaiveHierarchy tiny = test::lattice_sphere(3, {13});
    tiny.hierarchy.signatures = signatures_of(tiny.hierarchy);
    breakage.apply(tiny);
    // NaN is not on any lattice: refused on writing already.
    try {
      write_lode(tiny.attach(), path(), LodeForm::compressed);
    } catch (const InputError&) {
      continue;
    }
    EXPECT_THROW((void)open_lode(path()), InputError) << breakage.name;
  }
}

TEST_F(LodeFile, RefusesHugeDeclaredCounts) {
  write_lode(small_model(), path());
  const Bytes whole = read_bytes(path());
  for (const std::size_t field : {offsetof(LodeHeader, level_count), offsetof(LodeHeader, cell_count),
                                  offsetof(LodeHeader, payload_offset), offsetof(LodeHeader, payload_bytes)}) {
    Bytes bytes = whole;
    std::memset(bytes.data() + field, 0xfe, 4);
    std::memset(bytes.data() + offsetof(LodeHeader, table_checksum), 0, 8);
    write_bytes(path(), bytes);
    EXPECT_THROW((void)open_lode(path()), InputError) << field;
  }
}

}  // namespace
}  // namespace lodestone
