#include <fmt/core.h>

#include <fstream>
#include <sstream>

#include "core/base/error.h"
#include "experiments/report/number_text.h"
#include "experiments/report/page_parts.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[three >> (18 - 6 * k) & 63];
  }
  return text;
}

std::string read_picture(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file || !bytes) throw FileError(describe(path.string(), "", "cannot be read"));
  return std::move(bytes).str();
}

std::string setting_of(const SettingTable& table, std::size_t run) {
  for (const SettingRow& setting : table.settings)
    if (setting.run == run) return setting_label(setting, table.varied);
  return {};
}

void add_picture(Html& page, const fs::path& path, const std::string& label) {
  const std::string name = path.filename().string();
  page.add(
      "<figure class=\"picture\"><button type=\"button\" aria-label=\"Enlarge {0}\"><img decoding=\"async\" alt=\"{0}, "
      "{1}\" "
      "src=\"data:image/png;base64,{2}\"></button><figcaption>{0}</figcaption></figure>\n",
      name, label, Html::Raw{base64(read_picture(path))});
}

// Pictures of a run go together: a picture without its difference map tells half.
void add_run(Html& page, const RunRecord& run, const std::string& label, PictureBudget& budget) {
  std::uint64_t bytes = 0;
  for (const fs::path& path : run.pictures) bytes += fs::file_size(path);
  if (bytes > budget.bytes) {
    budget.left_out += run.pictures.size();
    return;
  }
  budget.bytes -= bytes;
  page.add("<div class=\"pictures\"><p><code title=\"runs/{}\">{}</code> {}</p>\n<div class=\"row\">\n", run.id,
           run.id.substr(0, 8), label);
  for (const fs::path& path : run.pictures) add_picture(page, path, label);
  page.raw("</div></div>\n");
}

}  // namespace

void add_pictures(Html& page, const StudyReport& entry, PictureBudget& budget, const SectionPlace& place) {
  add_heading(page, place.level, "Pictures", place.prefix + "-pictures");
  bool any = false;
  const std::size_t left_out_before = budget.left_out;
  for (std::size_t i = 0; i < entry.tables.size(); ++i) {
    const SweepRecord& sweep = entry.study.sweeps[i];
    for (std::size_t k = 0; k < sweep.runs.size(); ++k) {
      const RunRecord& run = sweep.runs[k];
      if (run.pictures.empty() || !is_reported(state_of(run)) || !budget.seen.insert(run.id).second) continue;
      any = true;
      add_run(page, run, sweep.name + ": " + setting_of(entry.tables[i], k), budget);
    }
  }
  if (!any) page.raw("<p class=\"aside\">The runs left no pictures.</p>\n");
  if (const std::size_t left_out = budget.left_out - left_out_before; left_out > 0)
    page.add("<p class=\"aside\">Left out for their size (--pictures): {}; they lie in {}/runs.</p>\n",
             counted(left_out, "picture"), entry.study.folder.string());
}

}  // namespace lodestone
