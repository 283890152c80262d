// Suggestions for misspelt names.
#include <gtest/gtest.h>

#include "core/base/known_names.h"

namespace lodestone {
namespace {

const std::vector<std::string> keys{"colour", "opacity", "position", "rotation", "scale", "fov_degrees", "head-light"};

TEST(KnownNames, SuggestTheNearest) {
  for (const auto& [word, meant] : {std::pair{"color", "colour"},
                                    {"colur", "colour"},
                                    {"colr", "colour"},
                                    {"oapcity", "opacity"},
                                    {"Position", "position"},
                                    {"postion", "position"},
                                    {"rotations", "rotation"},
                                    {"fov", "fov_degrees"},
                                    {"head_light", "head-light"},
                                    {"headlight", "head-light"}})
    EXPECT_EQ(nearest_name(word, keys), meant) << word;
  for (const char* word : {"", "x", "texture", "fo", "thickness"}) EXPECT_EQ(nearest_name(word, keys), "") << word;
  EXPECT_EQ(nearest_name(std::string(1000, 'a'), std::vector(1, std::string(1001, 'a'))), "");
}

TEST(KnownNames, AreListedInTheirOrder) {
  EXPECT_EQ(known_names("grpah", {"serial", "levels", "graph"}),
            "known are serial, levels, graph; did you mean graph?");
  EXPECT_EQ(known_names("fast", {"serial", "levels"}), "known are serial, levels");
  EXPECT_EQ(did_you_mean("fast", {"serial"}), "");
}

}  // namespace
}  // namespace lodestone
