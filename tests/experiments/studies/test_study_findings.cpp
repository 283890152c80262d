// Experiments that draw find the results that are known beforehand.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/error.h"
#include "tests/experiments/studies/study_case.h"

namespace lodestone {
namespace {

TEST_F(Studies, UniformRadiiCrackBelowTheBorderAndNotAbove) {
  const auto row = [&](double over_border) {
    return rows_of("flight", with(shallow, {{"radii", "uniform"},
                                            {"camera", "adversarial"},
                                            {"kappa0_over_rho", over_border},
                                            {"frames", 12}}))
        .front();
  };
  const Row below = row(0.4), above = row(1.05);
  EXPECT_EQ(below.at("admissible"), false);
  EXPECT_GT(number(below, "open_edges"), 0);
  EXPECT_GT(number(below, "gap_max"), 0);
  EXPECT_EQ(above.at("admissible"), true);
  EXPECT_EQ(number(above, "open_edges"), 0);
  EXPECT_EQ(number(above, "gap_max"), 0);
  EXPECT_NEAR(number(above, "over_border"), 1.05, 1e-6);
}

// Among the leaks are some of the background, which need the full model's silhouette.
TEST_F(Studies, LeaksDoNotDependOnWhichPicturesAreAskedFor) {
  generate_ply({Shape::sphere, 20000, 1}, sphere_, *make_serial_scheduler());
  const auto leaks = [&](bool image) {
    const Row row = rows_of("flight", {{"radii", "uniform"},
                                       {"camera", "adversarial"},
                                       {"kappa0_over_rho", 0.3},
                                       {"backend", "soft"},
                                       {"cell_triangles", 500},
                                       {"frames", 8},
                                       {"width", 320},
                                       {"height", 360},
                                       {"image", image}})
                        .front();
    return number(row, "leak_pixels");
  };
  const double without_pictures = leaks(false);
  EXPECT_GT(without_pictures, 0);
  EXPECT_EQ(without_pictures, leaks(true));
}

TEST_F(Studies, AStepPopsAndDoesNotCrack) {
  const auto row = [&](const char* blend) {
    return rows_of("flight", with(shallow, {{"kappa0", 1.0}, {"frames", 40}, {"blend", blend}})).front();
  };
  const Row linear = row("linear"), step = row("step");
  EXPECT_LE(number(linear, "jump_over_bound"), 1);
  EXPECT_GT(number(step, "jump_over_bound"), 1);
  EXPECT_GT(number(step, "jump_max"), number(linear, "jump_max"));
  EXPECT_EQ(number(step, "open_edges"), 0);
}

TEST_F(Studies, DiscreteLevelsCrackOnThePathOnWhichTheMorphDoesNot) {
  generate_ply({Shape::sphere, 30000, 1}, sphere_, *make_serial_scheduler());
  const auto row = [&](const char* system) {
    const Row path = {{"frames", 3}, {"from", 0.3}, {"to", 0.5}, {"pixel_error", 2.0}, {"sigma0", 0.2}};
    return rows_of("systems", with(path, {{"system", system}, {"cell_triangles", 200}})).front();
  };
  const Row morph = row("morph"), discrete = row("discrete");
  EXPECT_EQ(morph.at("admissible"), true);
  EXPECT_EQ(number(morph, "open_edges"), 0);
  EXPECT_EQ(discrete.at("admissible"), false);
  EXPECT_GT(number(discrete, "open_edges"), 0);
  EXPECT_GT(number(discrete, "gap_pixels"), 0);
  EXPECT_GT(number(discrete, "torn_pixels"), 0);
}

// A single round has one value, whatever its frames differ by.
TEST_F(Studies, FramesOfAPathAreNoRepetitions) {
  const Row path = {{"rounds", 1}, {"frames", 6}, {"width", 64}, {"height", 48}};
  for (const char* name : {"effects", "flight", "raster", "systems"})
    for (const Row& row : rows_of(name, name == std::string("effects") ? path : with(shallow, path), 1)) {
      EXPECT_EQ(row.at("frame_ms_min"), row.at("frame_ms_max")) << name;
      EXPECT_EQ(row.at("frame_cpu_ms_min"), row.at("frame_cpu_ms_max")) << name;
      EXPECT_GT(number(row, "frame_ms_worst"), number(row, "frame_ms_max")) << name;
    }
}

TEST_F(Studies, GainsAreThoseOfARound) {
  const std::vector<Row> rows = rows_of("effects", {{"rounds", 1}, {"frames", 3}, {"width", 64}, {"height", 48}});
  const Row& planned = rows.front();
  for (const Row& row : rows) {
    const double gain = number(planned, "frame_ms") - number(row, "frame_ms");
    EXPECT_EQ(row.at("gain_ms"), gain);
    EXPECT_EQ(row.at("gain_ms_min"), gain);
    EXPECT_EQ(row.at("gain_ms_max"), gain);
    EXPECT_DOUBLE_EQ(number(row, "gain"), 100 * gain / number(planned, "frame_ms"));
    EXPECT_EQ(row.at("gain_cpu_ms"), number(planned, "frame_cpu_ms") - number(row, "frame_cpu_ms"));
  }
}

TEST_F(Studies, PicturesHaveTheEffectsThatAreAskedForAndTheFullModelHasThem) {
  const auto row = [&](const char* effects) {
    const Row given = {{"frames", 3}, {"rounds", 1}, {"width", 64}, {"height", 48}, {"effects", effects}};
    const std::vector<Row> rows = rows_of("raster", with(shallow, given));
    EXPECT_EQ(joined(faults("raster", with(shallow, given), rows)), "") << effects;
    return rows.front();
  };
  const Row plan = row("auto"), all = row("all"), unlit = row("geomorph,smooth-normals");
  EXPECT_EQ(plan.at("hash"), all.at("hash"));
  EXPECT_NE(plan.at("hash"), unlit.at("hash"));
  EXPECT_LT(number(unlit, "image_error"), number(plan, "image_error"));  // flat colour differs at the outline alone
  const Row picture = {{"frames", 3}, {"width", 64}, {"height", 48}};
  const auto worst = [&](const char* effects) {
    return rows_of("systems", with(with(shallow, picture), {{"effects", effects}})).front();
  };
  EXPECT_EQ(worst("none").at("admissible"), true);  // the morph is the system's
  EXPECT_LT(number(worst("none"), "image_error"), number(worst("auto"), "image_error"));
}

TEST_F(Studies, WithoutGeomorphAFlightCracksAndPops) {
  generate_ply({Shape::sphere, 30000, 1}, sphere_, *make_serial_scheduler());
  const auto row = [&](const char* effects) {
    const Row path = {{"frames", 3}, {"from", 0.3}, {"to", 0.5}, {"pixel_error", 2.0}, {"sigma0", 0.2}};
    const Row given = with(path, {{"effects", effects}, {"cell_triangles", 200}});
    const std::vector<Row> rows = rows_of("flight", given);
    EXPECT_EQ(joined(faults("flight", given, rows)), "") << effects;
    return rows.front();
  };
  const Row morph = row("geomorph"), still = row("none");
  EXPECT_EQ(morph.at("admissible"), true);
  EXPECT_EQ(number(morph, "open_edges"), 0);
  EXPECT_EQ(still.at("admissible"), false);
  EXPECT_GT(number(still, "open_edges"), 0);
  EXPECT_GT(number(still, "torn_pixels"), 0);
  EXPECT_GT(number(still, "jump_max"), number(morph, "jump_max"));
  EXPECT_TRUE(still.at("jump_over_bound").is_null());
}

// Measured on another backend's pictures, a backend that draws nothing would be the cheapest of all.
TEST_F(Studies, PicturesAreThoseOfTheBackend) {
  const auto rows = [&](const char* backend) {
    return rows_of(
        "flight", with(shallow, {{"backend", backend}, {"image", true}, {"frames", 2}, {"width", 64}, {"height", 48}}));
  };
  EXPECT_THROW((void)rows("null"), InputError);
  EXPECT_GT(number(rows("soft").front(), "image_error"), 0);
}

}  // namespace
}  // namespace lodestone
