#include "experiments/studies/viewpoints.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "core/base/error.h"
#include "experiments/metrics/cracks/adversary.h"
#include "experiments/studies/study_input.h"
#include "experiments/subjects/row.h"

namespace lodestone {
namespace {

// The same numbers on every machine, which std::uniform_real_distribution does not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double share() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // in [0, 1)
  Vec3d direction() {
    const double z = 2 * share() - 1, angle = 2 * std::numbers::pi * share(), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 engine_;
};

std::vector<Shot> path(const std::vector<Camera>& cameras) {
  std::vector<Shot> shots;
  for (const Camera& camera : cameras) shots.push_back({camera, !shots.empty()});
  return shots;
}

std::vector<Shot> random_pairs(const Hierarchy& hierarchy, int frames, double step, std::uint64_t seed) {
  const Sphere sphere = bounding_sphere(hierarchy);
  Random random(seed);
  std::vector<Shot> shots;
  while (static_cast<int>(shots.size()) + 1 < frames) {
    const double distance = sphere.radius * 1.1 * std::pow(8 / 1.1, random.share());
    Camera camera;
    camera.up = up_of(hierarchy);
    camera.position = sphere.centre + distance * random.direction();
    camera.target = sphere.centre + 0.5 * sphere.radius * std::cbrt(random.share()) * random.direction();
    shots.push_back({camera, false});
    camera.position = camera.position + step * distance * random.direction();
    shots.push_back({camera, true});
  }
  return shots;
}

std::vector<Shot> adversarial_pairs(const Hierarchy& hierarchy, const Radii& radii, int frames) {
  const AdversaryConfig config{.count = static_cast<std::size_t>(frames + 1) / 2};
  std::vector<Shot> shots;
  for (const AdversarialView& view : adversarial_views(hierarchy, radii, config)) {
    Camera camera;
    camera.up = up_of(hierarchy);
    camera.target = hierarchy.transform.to_model(hierarchy.cells[view.cell].positions[view.vertex]);
    camera.position = hierarchy.transform.to_model(view.viewpoint);
    shots.push_back({camera, false});
    camera.position = hierarchy.transform.to_model(view.across);
    shots.push_back({camera, true});
  }
  if (shots.empty()) throw InputError(why_no_adversary(hierarchy));
  if (shots.size() > static_cast<std::size_t>(frames)) shots.resize(static_cast<std::size_t>(frames));
  return shots;
}

std::vector<Camera> whole_path(const Hierarchy& hierarchy, const std::string& camera, int frames) {
  if (is_model_path(camera)) return model_path(camera, hierarchy, frames, {up_of(hierarchy), 1});
  return read_camera_path(camera, frames, up_of(hierarchy));
}

}  // namespace

ParameterInfo camera_parameter(const std::string& description, std::vector<std::string> more) {
  const auto usual_form = [](const std::string& text) -> std::optional<std::string> {
    if (!text.ends_with(".json")) return {};
    return std::filesystem::path(text).lexically_normal().string();
  };
  const auto look_into = [](const std::string& path) { (void)read_camera_keys(path); };
  std::vector<std::string> names = model_path_names();
  names.insert(names.end(), more.begin(), more.end());
  return as_condition({"camera", "fly-in", "", description, 0, 0, std::move(names),
                       OtherTexts{"or the file of a recorded path (.json)", usual_form, look_into}});
}

std::vector<ParameterInfo> path_parameters() {
  return {
      as_condition({"frames", 60, "", "of the path; of pairs, both count", 2, 100000, {}}),
      as_condition({"from", 0.0, "", "where on the path the frames begin: 0 is its begin, 1 its end", 0, 1, {}}),
      as_condition({"to", 1.0, "", "where on the path the frames end", 0, 1, {}}),
  };
}

void check_path(SettingVerdict& verdict, const Parameters& parameters) {
  verdict.require(parameters.number("from") < parameters.number("to"), {"from", "to"},
                  assignment(parameters, "from") + " must be less than " + assignment(parameters, "to") +
                      ": the part of the path that the frames are spread over");
}

std::vector<Camera> path_cameras(const Hierarchy& hierarchy, const Parameters& parameters) {
  const double from = parameters.number("from"), to = parameters.number("to");
  assert(from < to);
  const int frames = parameters.integer("frames");
  const auto all = static_cast<int>(std::min(std::ceil(frames / (to - from)), 1e6));
  std::vector<Camera> cameras = whole_path(hierarchy, parameters.text("camera"), all);
  const auto first = static_cast<std::ptrdiff_t>(from * (all - frames) / std::max(from + 1 - to, 1e-9));
  cameras.erase(cameras.begin(), cameras.begin() + std::clamp<std::ptrdiff_t>(first, 0, all - frames));
  cameras.resize(static_cast<std::size_t>(frames));
  return cameras;
}

std::vector<ParameterInfo> viewpoint_parameters() {
  std::vector<ParameterInfo> list{
      camera_parameter("path or viewpoints", {"random", "adversarial"}),
      as_condition({"step", 0.01, "", "of random pairs, over the distance from the model's middle", 1e-6, 0.5, {}}),
      as_condition({"seed", 1, "", "of random viewpoints", 0, 1e9, {}}),
  };
  append(list, path_parameters());
  return list;
}

void check_viewpoints(SettingVerdict& verdict, const Parameters& parameters) {
  const std::string name = parameters.text("camera"), camera = assignment(parameters, "camera");
  const bool path = name != "random" && name != "adversarial";
  for (const char* only : {"step", "seed"}) verdict.idle(name != "random", only, camera);
  for (const char* only : {"from", "to"}) verdict.idle(!path, only, camera);
  if (path) check_path(verdict, parameters);
}

std::vector<Shot> viewpoints(const Hierarchy& hierarchy, const Radii& radii, const Parameters& parameters) {
  const std::string camera = parameters.text("camera");
  const int frames = parameters.integer("frames");
  if (camera == "random")
    return random_pairs(hierarchy, frames, parameters.number("step"),
                        static_cast<std::uint64_t>(parameters.integer("seed")));
  if (camera == "adversarial") return adversarial_pairs(hierarchy, radii, frames);
  return path(path_cameras(hierarchy, parameters));
}

}  // namespace lodestone
