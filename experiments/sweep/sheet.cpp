#include "experiments/sweep/sheet.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/files/text_file.h"
#include "experiments/sweep/files.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// Checks of a file that a person may have changed.
class SheetChecker {
 public:
  explicit SheetChecker(fs::path path) : path_(std::move(path)) {}

  void require(bool holds, const std::string& what) const {
    if (!holds)
      throw InputError(describe(path_.string(), "", what, "remove it and run the sweep with --resume to have it anew"));
  }
  [[nodiscard]] const Json& member(const Json& object, const char* key) const {
    require(object.is_object() && object.contains(key), std::string("has no '") + key + "' where one belongs");
    return object.at(key);
  }
  [[nodiscard]] const Json& list(const Json& object, const char* key) const {
    const Json& value = member(object, key);
    require(value.is_array(), std::string("'") + key + "' is not a list");
    return value;
  }
  [[nodiscard]] std::string text(const Json& object, const char* key) const {
    const Json& value = member(object, key);
    require(value.is_string(), std::string("'") + key + "' is not a text");
    return value.get<std::string>();
  }
  [[nodiscard]] int repetitions(const Json& object) const {
    const Json& value = member(object, "repetitions");
    require(value.is_number_unsigned() && value.get<std::uint64_t>() <= 1'000'000, "'repetitions' is not a count");
    return value.get<int>();
  }
  // Identity of a run, which is the name of a folder.
  [[nodiscard]] std::string id(const Json& object) const {
    const std::string id = text(object, "id");
    require(id.size() == 16 && id.find_first_not_of("0123456789abcdef") == std::string::npos,
            "'id' is not that of a run");
    return id;
  }

 private:
  fs::path path_;
};

void add_run(std::vector<SheetRun>& runs, const SheetRun& run) {
  const auto known = std::ranges::find(runs, run.id, &SheetRun::id);
  if (known == runs.end())
    runs.push_back(run);
  else
    known->repetitions = std::max(known->repetitions, run.repetitions);
}

}  // namespace

std::optional<SweepSheet> read_sheet(const fs::path& folder) {
  const fs::path path = folder / "sweep.json";
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  const SheetChecker check(path);
  SweepSheet sheet;
  sheet.content = json_or_null(read_text(path));
  check.require(sheet.content.is_object(), "is not a JSON object");
  sheet.name = check.text(sheet.content, "name");
  for (const Json& section : check.list(sheet.content, "sweeps"))
    for (const Json& run : check.list(section, "runs"))
      add_run(sheet.runs, {check.id(run), check.repetitions(section)});
  if (Json* const data = sheet.content.find("data"); data && data->is_object())
    for (auto& [name, source] : data->items())
      if (source.is_object()) source.erase("path");
  return sheet;
}

}  // namespace lodestone
