#include "experiments/commands/input.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/mesh/up_axis.h"
#include "experiments/command_line/exit_status.h"

namespace lodestone {
namespace {

[[noreturn]] void fail_grid(const std::string& text) {
  throw UsageError(describe("--grid", "", "'" + text + "' is not the size and type of a grid",
                            "give WIDTHxHEIGHT[:TYPE[:SPACING]], TYPE one of i16, u16, i32, f32, f64, with 'be' for "
                            "big-endian, such as 1197x643:i16:30"));
}

// The part up to the separator; the text is left with what follows it.
std::string_view cut(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

template <class T>
bool parse(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

// "WxH[:TYPE[:SPACING]]". Throws InputError for anything else.
RawGridFormat parse_raw_grid(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, ScalarType>, 5> types{{{"i16", ScalarType::int16},
                                                                          {"u16", ScalarType::uint16},
                                                                          {"i32", ScalarType::int32},
                                                                          {"f32", ScalarType::float32},
                                                                          {"f64", ScalarType::float64}}};
  constexpr std::size_t most = 1'000'000'000;
  RawGridFormat format;
  std::string_view rest = text;
  std::string_view size = cut(rest, ':'), type = cut(rest, ':'), spacing = rest;
  const std::string_view width = cut(size, 'x');
  if (!parse(width, format.width) || !parse(size, format.height)) fail_grid(text);
  if (format.width < 2 || format.height < 2 || format.width > most || format.height > most) fail_grid(text);
  if (type.ends_with("be")) {
    format.byte_order = std::endian::big;
    type.remove_suffix(2);
  } else if (type.ends_with("le")) {
    type.remove_suffix(2);
  }
  const auto found = std::find_if(types.begin(), types.end(), [&](const auto& t) { return t.first == type; });
  if (found != types.end()) format.type = found->second;
  if (found == types.end() && !type.empty()) fail_grid(text);
  if (!spacing.empty() && !parse(spacing, format.spacing)) fail_grid(text);
  if (!(format.spacing > 0) || !std::isfinite(format.spacing)) fail_grid(text);
  return format;
}

}  // namespace

OptionTable with_input_options(OptionTable table, InputOptions& options) {
  table.push_back({"--fill-voids", &options.fill_voids,
                   "Height grids: interpolate posts without a height instead of leaving the surface open there"});
  table.push_back({"--allow-outside", &options.allow_outside,
                   "Read buffers, images, materials and tiles that a model names also outside of its own folder"});
  table.push_back({"--grid", &options.grid,
                   "A file of bare heights (of no extension known): WxH[:TYPE[:SPACING]], rows from the north, TYPE "
                   "i16 (default), u16, i32, f32 or f64, little-endian unless 'be' follows; SPACING of posts, default "
                   "1"});
  return table;
}

OptionSpec up_option(std::optional<std::string>& up) {
  return {"--up", &up,
          "The axis that is up: x, y, z, -x, -y or -z. Otherwise as the format has it (glTF y, tilesets and terrain z, "
          "on the Earth away from its middle), or guessed: y of OBJ, z of the others"};
}

void print_up_note(Up up) {
  if (const std::string note = guess_note(up); !note.empty()) fmt::print("note: {}\n", note);
}

ReadConfig read_config(const InputOptions& options, const std::vector<std::string>& files) {
  ReadConfig config{.allow_outside = options.allow_outside, .fill_voids = options.fill_voids};
  if (options.up) config.up = up_axis(*options.up);
  if (options.grid.empty()) return config;
  config.raw_grid = parse_raw_grid(options.grid);
  if (!files.empty() &&
      std::all_of(files.begin(), files.end(), [](const std::string& file) { return has_mesh_extension(file); }))
    throw UsageError(describe("--grid", "", "'" + files.front() + "' is read by its extension",
                              "leave --grid out, or give the file another name"));
  return config;
}

void print_warnings(const std::vector<std::string>& warnings) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < std::min(most, warnings.size()); ++i) fmt::print("note: {}\n", warnings[i]);
  if (warnings.size() > most) fmt::print("note: {} more of the kind\n", warnings.size() - most);
}

}  // namespace lodestone
