// Headers of .lode files: what they keep of a hierarchy, and what is refused because it is newer, unknown or does not
// fit.
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/find_signatures.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "tests/core/hierarchy/lode_bytes.h"
#include "tests/expect_error.h"
#include "tests/old_lode.h"

namespace lodestone {
namespace {

using namespace test;

class LodeHeaders : public LodeFile {};

TEST_F(LodeHeaders, SaysSoWhenTheVersionIsNewer) {
  write_lode(small_model(), path());
  Bytes bytes = read_bytes(path());
  const std::uint32_t newer = lode_version + 1;
  std::memcpy(bytes.data() + offsetof(LodeHeader, version), &newer, sizeof(newer));
  write_bytes(path(), bytes);
  EXPECT_THROW((void)open_lode(path()), UnsupportedError);
}

// Files whose up axis is what older ones have are the same bytes as theirs.
TEST_F(LodeHeaders, KeepsTheUpAxis) {
  Hierarchy model = small_model();
  write_lode(model, path());
  const Bytes plain = read_bytes(path());
  LodeHeader header;
  std::memcpy(&header, plain.data(), sizeof(header));
  EXPECT_EQ(header.features & lode_up, 0);
  EXPECT_EQ(open_lode(path()).transform.up, Up{});
  for (const UpAxis axis : {UpAxis::z, UpAxis::y, UpAxis::minus_x, UpAxis::earth})
    for (const bool guessed : {false, true}) {
      model.transform.up = {axis, guessed};
      write_lode(model, path());
      expect_equal(open_lode(path()), model);
      EXPECT_EQ(read_bytes(path()).size(), plain.size());
    }
}

// Ours by a number, as in files of older programs; others by their name before the materials, if there are any.
TEST_F(LodeHeaders, KeepsTheNameOfASimplifier) {
  Hierarchy model = small_model();
  const auto header_of = [&] {
    const Bytes bytes = read_bytes(path());
    LodeHeader header;
    std::memcpy(&header, bytes.data(), sizeof(header));
    return header;
  };
  for (const bool materials : {false, true}) {
    if (materials) model.materials.push_back({.name = "stone"});
    for (const std::string name : {"quadric", "meshopt", "shortest-edge"}) {
      model.provenance.simplifier = name;
      model.provenance.placement = 1;
      write_lode(model, path());
      const Hierarchy back = open_lode(path());
      EXPECT_EQ(back.provenance.simplifier, name);
      EXPECT_EQ(back.provenance.placement, 1u);
      EXPECT_EQ(back.materials, model.materials);
      EXPECT_EQ((header_of().features & lode_named_simplifier) != 0, name == "shortest-edge");
    }
  }
  EXPECT_EQ(header_of().simplifier, 1u << 16 | 0xffff);
  model.provenance.simplifier = "two\nlines";
  write_lode(model, path());
  expect_error_of<InputError>([&] { (void)open_lode(path()); }, {"name of the simplifier is invalid"});
}

// Files of older programs have none.
TEST_F(LodeHeaders, KeepsHalfLevels) {
  BuildConfig config;
  config.cell_triangles = 60, config.sigma0 = 1, config.half_levels = true;
  const auto scheduler = make_serial_scheduler();
  write_lode(build_hierarchy(test::sphere_mesh(4), config, *scheduler), path());
  const Hierarchy h = open_lode(path());
  EXPECT_TRUE(h.grids.halves);
  EXPECT_EQ(h.cell_size(3), 0.25f);
  EXPECT_EQ(h.cell_size(4), 0.25f);
  write_bytes(path(),
              with_header(read_bytes(path()), [](LodeHeader& header) { header.features &= ~lode_half_levels; }));
  EXPECT_THROW((void)open_lode(path()), InputError);
}

TEST_F(LodeHeaders, KeepsSignatures) {
  const Hierarchy model = lattice_model();
  write_lode(model, path());
  const Hierarchy back = open_lode(path());
  ASSERT_NE(back.signatures, nullptr);
  EXPECT_EQ(back.signatures->table(), find_signatures(model).table());

  const Bytes bytes = read_bytes(path());
  test::drop_signatures(path());
  const Hierarchy old = open_lode(path());
  EXPECT_EQ(old.signatures, nullptr);
  write_lode(old, path("new.lode"));
  EXPECT_EQ(read_bytes(path("new.lode")), bytes);
}

TEST_F(LodeHeaders, RefusesSignaturesThatDoNotFit) {
  const Hierarchy model = lattice_model();
  const Signatures::Table whole = find_signatures(model).table();
  const auto fault = [&](const auto& change) {
    Signatures::Table table = whole;
    change(table);
    const char* found = Signatures::fault(model, table);
    return std::string(found ? found : "");
  };
  ASSERT_GT(whole.sizes.size(), 2u);
  EXPECT_EQ(fault([](auto&) {}), "");
  EXPECT_NE(fault([](auto& t) { t.sets.pop_back(); }), "");
  EXPECT_NE(fault([](auto& t) { ++t.sets.back(); }), "");
  EXPECT_NE(fault([](auto& t) { ++t.sizes.front(); }), "");
  EXPECT_NE(fault([](auto& t) { t.cells.front() = CellId(0xffff'ffff); }), "");
  EXPECT_NE(fault([](auto& t) { t.cells.back() = t.cells[t.cells.size() - 2]; }), "");
  EXPECT_NE(fault([](auto& t) { t.cells.front() = CellId(0); }), "");
  EXPECT_NE(fault([](auto& t) { t.errors.pop_back(); }), "");
  EXPECT_NE(fault([](auto& t) { t.errors.back() = -1; }), "");
  EXPECT_NE(fault([](auto& t) { t.errors.front() = HUGE_VALF; }), "");
  EXPECT_NE(fault([](auto& t) { t.places.push_back(0); }), "");
  EXPECT_NE(fault([](auto& t) { t.places.pop_back(); }), "");
  EXPECT_NE(fault([](auto& t) { t.places.front() = 255; }), "");
  // A table that is whole, behind which the bytes end or go on.
  const Signatures signatures = find_signatures(model);
  const std::vector<std::byte> bytes = encode_assets(model, &signatures.table());
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    Hierarchy to = model;
    EXPECT_EQ(decode_assets(std::span(bytes).first(size), lode_signatures, to) == nullptr, size == bytes.size());
  }
}

TEST_F(LodeHeaders, RefusesFeaturesThatItDoesNotKnowOrThatDoNotFit) {
  write_lode(lattice_model(), path(), LodeForm::compressed);
  const Bytes whole = read_bytes(path());
  const auto open_with = [&](const auto& change) {
    write_bytes(path("changed.lode"), with_header(whole, change));
    (void)open_lode(path("changed.lode"));
  };
  EXPECT_NO_THROW(open_with([](LodeHeader&) {}));
  EXPECT_THROW(open_with([](LodeHeader& h) { h.features |= 0x8000; }), UnsupportedError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.features |= lode_uv; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.asset_bytes = 16; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.asset_checksum ^= 1; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.features = 0; }), InputError);  // plain payloads are larger
  EXPECT_THROW(open_with([](LodeHeader& h) { h.lattice_bits = 0; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.lattice_bits = 25; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.lattice_bits = 12; }), InputError);  // vertices beyond the cube
  EXPECT_THROW(open_with([](LodeHeader& h) { h.simplifier = 4; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.simplifier = 2u << 16; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.features |= lode_named_simplifier, h.simplifier = 0xffff; }),
               InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.up = 1; }), InputError);
  EXPECT_THROW(open_with([](LodeHeader& h) { h.features |= lode_up, h.up = 7; }), InputError);
  EXPECT_NO_THROW(open_with([](LodeHeader& h) { h.features |= lode_up, h.up = 6; }));
}

}  // namespace
}  // namespace lodestone
