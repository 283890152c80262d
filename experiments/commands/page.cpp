// lodestone page: a folder that any web server shows, with models in it.
#include <fmt/core.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/atomic_folder.h"
#include "core/mesh/up_axis.h"
#include "core/progressive/progressive_file.h"
#include "experiments/command_line/data_folder.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/save.h"
#include "parallel/hierarchy/save_tiles.h"
#include "parallel/mesh/load.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/runner.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

struct PageOptions {
  std::vector<std::string> inputs;
  std::string output;
  std::optional<std::string> metric;
  InputOptions reading;
};

// The bundled page: $LODESTONE_PAGE, or beside the installed program, or where it was built.
fs::path page_folder() {
  const char* given = std::getenv("LODESTONE_PAGE");
  const fs::path folder =
      given != nullptr
          ? given
          : find_data_folder(LODESTONE_PAGE_INSTALLED, LODESTONE_PAGE_BUILT, "page.js").value_or(LODESTONE_PAGE_BUILT);
  for (const char* name : {"page.js", "index.html", "page.css"})
    if (!fs::exists(folder / name))
      throw FileError(describe((folder / name).string(), "", "the bundled page is not there",
                               "run scripts/setup page, build and install again, or set LODESTONE_PAGE to its folder"));
  return folder;
}

std::string extension_of(const fs::path& path) { return path.extension().string(); }

bool is_tileset(const fs::path& path) {
  return path.filename() == "tileset.json" || (fs::is_directory(path) && fs::exists(path / "tileset.json"));
}

bool is_progressive_glb(const fs::path& path) {
  if (extension_of(path) != ".glb") return false;
  try {
    (void)load_progressive(path);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

void copy_in(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy(from, to, fs::copy_options::recursive, error);
  if (error) throw FileError(describe(from.string(), "", "cannot be copied: " + error.message()));
}

class PageWriter {
 public:
  PageWriter(const PageOptions& options, Scheduler& scheduler, AtomicFolder& folder)
      : options_(options), scheduler_(scheduler), folder_(folder) {}

  Json write() {
    const fs::path page = page_folder();
    for (const char* name : {"page.js", "index.html", "page.css"}) copy_in(page / name, folder_.path() / name);
    folder_.add_folder("models");
    for (const std::string& input : options_.inputs) add(input);
    AtomicFile list(folder_.path() / "models.json");
    const std::string text = models_.dump(1) + "\n";
    list.write(std::as_bytes(std::span(text)));
    list.commit();
    return models_;
  }

 private:
  // A file name that is not taken yet, and safe in a URL.
  std::string name_for(const fs::path& input) {
    fs::path stem =
        is_tileset(input) && input.filename() == "tileset.json" ? input.parent_path().filename() : input.stem();
    std::string name;
    for (const char c : stem.string()) name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
    if (name.empty()) name = "model";
    std::string free = name;
    for (int k = 2; !taken_.insert(free).second; ++k) free = name + "_" + std::to_string(k);
    return free;
  }

  void add(const std::string& input) {
    check_interrupt();
    if (!fs::exists(input)) throw FileError(describe(input, "", "cannot be opened: no such file"));
    const std::string name = name_for(input);
    const auto list = [&](const std::string& file, const char* kind) {
      models_.push_back({{"name", name}, {"url", "models/" + file}, {"kind", kind}});
    };
    if (is_tileset(input)) {
      copy_in(fs::is_directory(input) ? fs::path(input) : fs::path(input).parent_path(),
              folder_.path() / "models" / name);
      list(name + "/tileset.json", "tiles");
    } else if (extension_of(input) == ".3tz") {
      copy_in(input, folder_.path() / "models" / (name + ".3tz"));
      list(name + ".3tz", "tiles");
    } else if (extension_of(input) == ".lode") {
      export_tiles(input, name);
      list(name + "/tileset.json", "tiles");
    } else if (extension_of(input) == ".lpm" || is_progressive_glb(input)) {
      (void)load_progressive(input);  // what is damaged is refused here, not in the browser
      copy_in(input, folder_.path() / "models" / (name + extension_of(input)));
      list(name + extension_of(input), "progressive");
    } else {
      make(input, folder_.path() / "models" / (name + ".lpm"));
      list(name + ".lpm", "progressive");
    }
  }

  void export_tiles(const std::string& input, const std::string& name) {
    Hierarchy hierarchy = load_lode(input, scheduler_);
    if (options_.reading.up) hierarchy.transform.up = {up_axis(*options_.reading.up), false};
    AtomicFolder tiles(folder_.path() / "models" / name);
    SaveTilesConfig config;
    config.tileset.morph = true;
    config.cancel = &interrupt_flag();
    (void)save_tiles(hierarchy, tiles, scheduler_, config);
    tiles.commit();
  }

  void make(const std::string& input, const fs::path& output) {
    Repairs repairs;
    RawMesh raw = load_mesh(input, scheduler_, read_config(options_.reading, {input}));
    if (!keeps_normals(output)) raw.wedges.normal.clear();
    const bool textured = !raw.wedges.uv.empty();
    IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, scheduler_, input);
    ProgressiveConfig config;
    config.metric = options_.metric ? progressive::metric_kind(*options_.metric) : fitting_metric(mesh.wedges);
    if (config.metric == progressive::MetricKind::parametric && !textured)
      config.metric = progressive::MetricKind::quadric;
    ProgressiveReport report;
    (void)save_progressive(make_progressive(std::move(mesh), config, scheduler_, report), output, {},
                           runner_over(scheduler_));
  }

  const PageOptions& options_;
  Scheduler& scheduler_;
  AtomicFolder& folder_;
  std::set<std::string> taken_;
  Json models_ = Json::array();
};

void run(const PageOptions& options, const CommonOptions& common) {
  if (options.output.empty()) throw UsageError("--output: the folder name is empty");
  if (options.metric) (void)progressive::metric_kind(*options.metric);
  check_files(common, file_arguments("IN", options.inputs));
  (void)interrupt_flag();  // the folder is removed when interrupted
  AtomicFolder folder(options.output);
  const auto scheduler = make_scheduler(common);
  Progress progress("making", common.quiet);
  progress.phase("making");
  const Json models = PageWriter(options, *scheduler, folder).write();
  check_interrupt();
  folder.commit();
  progress.clear();
  write_result(common, {{"folder", options.output}, {"models", models}});
  if (common.prints())
    fmt::print("{}: a page with {} models; show it with scripts/page {} or any web server\n", options.output,
               models.size(), options.output);
}

OptionTable declare(PageOptions& o) {
  return with_input_options(
      {OptionSpec{"IN", &o.inputs,
                  std::string("Models: progressive (.lpm, .glb), hierarchies (.lode), tilesets of `lodestone export "
                              "--tiles --morph` (folders or .3tz), or meshes to make progressive: ") +
                      mesh_formats}
           .must(),
       OptionSpec{"-o,--output", &o.output, "Folder to write, new or empty"}.must(),
       up_option(o.reading.up),
       {"--metric", &o.metric, "Metric for meshes that are made progressive, as for `lodestone progressive`"}},
      o.reading);
}

}  // namespace

void add_page(CommandTable& commands) {
  define_command<PageOptions>(commands,
                              {"page", "Write a static web page that shows models at any level",
                               "  lodestone page scan.ply statue.obj -o page\n"
                               "  lodestone page scan.lpm city.lode tileset -o page\n"},
                              declare, run);
}

}  // namespace lodestone
