// Experiment `effects`: what each effect costs in a scene, and what the planner saves by leaving out the others.
//
// One run draws the same cameras with the planned effects, with everything switched on, and once for each planned
// effect with all of them but that one; the rounds of all take turns.
#include <algorithm>

#include "core/base/error.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/study_input.h"
#include "experiments/studies/verdict.h"
#include "experiments/subjects/frame_times.h"
#include "experiments/subjects/result_hash.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/effects/plan.h"
#include "render/scene/open_scene.h"

namespace lodestone {
namespace effects_study {

std::vector<ParameterInfo> parameters() {
  std::vector<ParameterInfo> list{
      threads_parameter(),
      rounds_parameter(3),
      as_condition({"backend", "soft", "", "that draws", 0, 0, picture_backend_names()}),
      as_condition({"frames", 12, "", "on the scene's camera path", 2, 10000, {}}),
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
      {"hash", "", "of the last picture", label},
      {"differing", "%", "pixels of the last picture that differ visibly from those of the plan, with everything on",
       accuracy},
      {"same_picture", "", "with everything on it is that of the plan: to the bit on soft, but for rounding on gl",
       label},
  };
  append(list, frame_columns("a frame, from camera to picture"));
  add_spread_columns(list, "gain_ms", "ms",
                     "frame of the planned effects less this one, of the rounds: what the effect costs; of everything, "
                     "what is lost");
  add_spread_columns(list, "gain", "%", "the same as a share of the planned frame");
  add_spread_columns(list, "gain_cpu_ms", "ms", "likewise of the processor time of a frame");
  return list;
}

// One choice of effects, and its times.
struct Choice {
  std::string label, effect, switched_on;
  EffectRequest request;
  FrameRounds times;
  std::vector<double> triangles;
  Image last;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text.empty() ? "none" : text;
}

// The effects that run in any of the frames.
std::vector<std::string> planned_effects(SceneView& view, const ViewConfig& config,
                                         const std::vector<Camera>& cameras) {
  std::vector<std::string> names;
  for (const Camera& camera : cameras) {
    view.update(camera, config);
    for (const PlannedEffect& effect : explain_plan(view.frame()))
      if (effect.runs && std::ranges::find(names, name_of(effect.effect)) == names.end())
        names.emplace_back(name_of(effect.effect));
  }
  return names;
}

std::vector<Choice> choices(const std::vector<std::string>& planned) {
  std::vector<Choice> list{{"planned", "", joined(planned), parse_effects("auto"), {}, {}, {}},
                           {"everything", "", "all", parse_effects("all"), {}, {}, {}}};
  for (const std::string& name : planned) {
    std::vector<std::string> rest = planned;
    std::erase(rest, name);
    list.push_back({"without " + name, name, joined(rest), parse_effects(joined(rest)), {}, {}, {}});
  }
  return list;
}

// The path once; the first frame uploads and compiles, so that it does not count.
void fly_once(Choice& choice, SceneView& view, ViewConfig config, const std::vector<Camera>& cameras,
              Renderer& renderer, bool timed) {
  config.effects = choice.request;
  std::vector<StageTime> frames;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CpuClock clock;
    view.update(cameras[i], config);
    const FrameStats stats = view.draw(renderer);
    const StageTime time = clock.elapsed();
    if (!timed || i == 0) continue;
    frames.push_back(time);
    choice.triangles.push_back(static_cast<double>(stats.triangles));
  }
  if (timed) choice.times.add(frames);
  choice.last = renderer.read_back();
}

// Gains by round, in which all choices took their turns: other work of the machine is in both times.
void add_gains(Row& row, const FrameRounds& choice, const FrameRounds& planned) {
  std::vector<double> gain, share, cpu;
  for (std::size_t round = 0; round < planned.wall_ms.size(); ++round) {
    gain.push_back(planned.wall_ms[round] - choice.wall_ms[round]);
    share.push_back(100 * gain.back() / planned.wall_ms[round]);
    cpu.push_back(planned.cpu_ms[round] - choice.cpu_ms[round]);
  }
  add_spread(row, "gain_ms", gain);
  add_spread(row, "gain", share);
  add_spread(row, "gain_cpu_ms", cpu);
}

// Programs of other effects round otherwise on gl, which shows in single pixels of edges.
constexpr double most_differing = 0.005;

Row row_of(const Choice& choice, const Choice& planned, bool to_the_bit) {
  Row row;
  row["effects"] = choice.label, row["effect"] = choice.effect.empty() ? Row() : Row(choice.effect);
  row["switched_on"] = choice.switched_on;
  add_frames(row, choice.times);
  add_gains(row, choice.times, planned.times);
  row["triangles"] = spread_of(choice.triangles).median;
  row["hash"] = to_hex(hash_of(choice.last));
  if (choice.label != "everything") return row;
  const double differing = image_difference(choice.last, planned.last).differing_share;
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
  ViewConfig config = view_config(scene, {parameters.integer("width"), parameters.integer("height")});
  const std::vector<Camera> cameras = camera_path(view, config.size);
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
  check_frames(verdict);
  for (const std::string gain : {"gain_ms", "gain", "gain_cpu_ms"}) {
    verdict.in_order(gain + "_min", gain);
    verdict.in_order(gain, gain + "_max");
  }
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

}  // namespace effects_study

Experiment effects_experiment() {
  using namespace effects_study;
  return {"effects", "What does each effect cost in a scene, and what does the planner save?",
          true,      parameters(),
          columns(), effects_study::run,
          verify,    check};
}

}  // namespace lodestone
