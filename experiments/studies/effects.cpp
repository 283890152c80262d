// Experiment `effects`: what each effect costs in a scene, and what the planner saves by leaving out the others.
//
// One run draws the same cameras with the planned effects, with everything switched on, and once for each planned
// effect with all of them but that one; the rounds of all take turns.
#include <algorithm>

#include "core/base/error.h"
#include "experiments/studies/catalogue.h"
#include "experiments/studies/result_hash.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/row_verdict.h"
#include "experiments/studies/study_input.h"
#include "parallel/cpu_clock.h"
#include "render/effects/plan.h"
#include "render/scene/open_scene.h"

namespace lodestone {
namespace {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(3),
      {"backend", "soft", "", "that draws", 0, 0, {"soft", "gl"}},
      {"frames", 12, "", "on the scene's camera path", 2, 10000, {}},
  };
  append(list, picture_parameters());
  return list;
}

std::vector<ColumnInfo> columns() {
  using enum ColumnInfo::Kind;
  std::vector<ColumnInfo> list{
      {"effects", "", "planned; everything; or without one that is planned", label},
      {"effect", "", "the one that is left out", label},
      {"switched_on", "", "effects that run", label},
      {"triangles", "", "drawn in a frame, median", count},
      {"frame_cpu_ms", "ms", "processor time of a frame, all threads", cost},
      {"gain_ms", "ms", "of a frame, against the planned effects: what the effect costs; of everything, what is lost",
       cost},
      {"gain", "%", "the same as a share of the planned frame", cost},
      {"gain_cpu_ms", "ms", "likewise of the processor time of a frame", cost},
      {"hash", "", "of the last picture", label},
      {"differing", "%", "pixels of the last picture that differ visibly from those of the plan, with everything on",
       accuracy},
      {"same_picture", "", "with everything on it is that of the plan: to the bit on soft, but for rounding on gl",
       label},
  };
  add_spread_columns(list, "frame_ms", "ms", "a frame, from camera to picture");
  return list;
}

// One choice of effects, and its times.
struct Choice {
  std::string label, effect, switched_on;
  EffectRequest request;
  std::vector<double> milliseconds, cpu_milliseconds, triangles;
  Image last;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text.empty() ? "none" : text;
}

// What runs in any of the frames.
std::vector<std::string> planned_effects(SceneView& view, const ViewConfig& config,
                                         const std::vector<Camera>& cameras) {
  std::vector<std::string> names;
  for (const Camera& camera : cameras) {
    view.look(camera, config);
    for (const PlannedEffect& effect : explain_plan(view.frame()))
      if (effect.runs && std::ranges::find(names, name_of(effect.effect)) == names.end())
        names.emplace_back(name_of(effect.effect));
  }
  return names;
}

std::vector<Choice> choices(const std::vector<std::string>& planned) {
  std::vector<Choice> list{{"planned", "", joined(planned), parse_effects("auto"), {}, {}, {}, {}},
                           {"everything", "", "all", parse_effects("all"), {}, {}, {}, {}}};
  for (const std::string& name : planned) {
    std::vector<std::string> rest = planned;
    std::erase(rest, name);
    list.push_back({"without " + name, name, joined(rest), parse_effects(joined(rest)), {}, {}, {}, {}});
  }
  return list;
}

// The path once; the first frame uploads and compiles, so that it does not count.
void fly_once(Choice& choice, SceneView& view, ViewConfig config, const std::vector<Camera>& cameras,
              Renderer& renderer, bool timed) {
  config.effects = choice.request;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CpuClock clock;
    view.look(cameras[i], config);
    const FrameStats stats = view.draw(renderer);
    const StageTime time = clock.elapsed();
    if (!timed || i == 0) continue;
    choice.milliseconds.push_back(1000 * time.seconds);
    choice.cpu_milliseconds.push_back(1000 * time.cpu_seconds);
    choice.triangles.push_back(static_cast<double>(stats.triangles));
  }
  choice.last = renderer.read_back();
}

// Programs of other effects round otherwise on gl, which shows in single pixels of edges.
constexpr double most_differing = 0.005;

Row row_of(const Choice& choice, const Choice& planned, bool to_the_bit) {
  Row row;
  row["effects"] = choice.label, row["effect"] = choice.effect.empty() ? Row() : Row(choice.effect);
  row["switched_on"] = choice.switched_on;
  add_spread(row, "frame_ms", choice.milliseconds);
  row["frame_cpu_ms"] = spread_of(choice.cpu_milliseconds).median;
  row["triangles"] = spread_of(choice.triangles).median;
  const double base = spread_of(planned.milliseconds).median;
  const double gain = base - row["frame_ms"].get<double>();
  row["gain_ms"] = gain, row["gain"] = 100 * gain / base;
  row["gain_cpu_ms"] = spread_of(planned.cpu_milliseconds).median - row["frame_cpu_ms"].get<double>();
  row["hash"] = to_hex(hash_of(choice.last));
  if (choice.label != "everything") return row;
  const double differing = difference(choice.last, planned.last).differing_share;
  row["differing"] = 100 * differing;
  row["same_picture"] = to_the_bit ? choice.last.rgba == planned.last.rgba : differing <= most_differing;
  return row;
}

std::vector<Row> run(const Parameters& parameters, const RunContext& context) {
  if (context.input.empty()) throw InputError("the run has no scene; name data in its sweep");
  const auto scheduler = study_scheduler(parameters);
  Scene scene = OpenScene::read(context.input);
  scene.camera.frames = parameters.integer("frames");
  OpenSceneConfig opening;
  opening.cancel = context.cancel;
  const OpenScene opened(scene, opening, *scheduler);
  SceneView view(scene, opened.models());
  const std::vector<Camera> cameras = camera_path(view);
  ViewConfig config = view_config(scene, {parameters.integer("width"), parameters.integer("height")});
  config.samples = parameters.integer("samples");
  const auto renderer = make_renderer(parameters.text("backend"), *scheduler);
  view.upload(*renderer);

  std::vector<Choice> all = choices(planned_effects(view, config, cameras));
  const int rounds = parameters.integer("rounds");
  for (int round = 0; round <= rounds; ++round)  // the first one warms up
    for (Choice& choice : all) {
      check_cancelled(context);
      fly_once(choice, view, config, cameras, *renderer, round > 0);
      context.progress(static_cast<double>(round) / (rounds + 1));
    }
  std::vector<Row> rows;
  for (const Choice& choice : all) rows.push_back(row_of(choice, all.front(), parameters.text("backend") == "soft"));
  return rows;
}

std::vector<SettingFault> check(const Parameters& parameters) {
  SettingVerdict verdict;
  check_picture(verdict, parameters);
  return std::move(verdict).faults();
}

std::vector<std::string> verify(const Parameters&, const std::vector<Row>& rows) {
  RowVerdict verdict(columns(), rows);
  verdict.spread("frame_ms");
  verdict.present("effects");
  verdict.is_true("same_picture");
  const auto labelled = [&](const char* label) {
    return std::ranges::count_if(rows, [&](const Row& row) { return text_in(row, "effects") == label; });
  };
  verdict.require(labelled("planned") == 1 && labelled("everything") == 1,
                  "the rows of the planned effects and of everything are not there once each");
  for (const Row& row : rows)
    if (const std::string effect = text_in(row, "effect"); !effect.empty())
      verdict.require(text_in(row, "effects") == "without " + effect, "a row does not say which effect it leaves out");
  return std::move(verdict).messages();
}

}  // namespace

Experiment effects_experiment() {
  return {"effects", "What does each effect cost in a scene, and what does the planner save?",
          true,      parameters(),
          columns(), run,
          verify,    check};
}

}  // namespace lodestone
