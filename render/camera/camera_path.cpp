// Camera paths through key frames, which are read from and written to JSON.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "core/files/atomic_file.h"
#include "core/files/json.h"
#include "core/files/text_file.h"
#include "render/camera/camera.h"

namespace lodestone {
namespace {

constexpr double degree = std::numbers::pi / 180;
// ---- JSON ----

double number(const Json& value, const std::string& file, const std::string& place) {
  if (!value.is_number()) throw InputError(describe(file, place, "is not a number"));
  return value.get<double>();
}

Vec3d vector(const Json& value, const std::string& file, const std::string& place) {
  if (!value.is_array() || value.size() != 3)
    throw InputError(describe(file, place, "is not an array of three numbers", "write [x, y, z]"));
  const Vec3d v{number(value[0], file, place), number(value[1], file, place), number(value[2], file, place)};
  constexpr double most = 1e100;  // squares of lengths, and curves between keys, remain finite
  if (std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > most)
    throw InputError(describe(file, place, "has a coordinate beyond 1e100"));
  return v;
}

// Keys that are not known would be ignored, as misspelt ones are.
void refuse_others(const Json& object, const std::string& file, const std::string& place,
                   const std::vector<std::string>& known) {
  for (const auto& [key, value] : object.items())
    if (std::ranges::find(known, key) == known.end())
      throw InputError(describe(file, place, "unknown key \"" + key + "\"", known_names(key, known)));
}

Camera camera_from(const Json& key, const std::string& file, std::size_t index, Vec3d up) {
  const std::string place = "frame " + std::to_string(index);
  if (!key.is_object()) throw InputError(describe(file, place, "is not an object"));
  refuse_others(key, file, place, {"position", "target", "up", "fov_degrees"});
  Camera camera;
  camera.up = up;
  for (const char* required : {"position", "target"})
    if (!key.contains(required)) throw InputError(describe(file, place, std::string("has no \"") + required + "\""));
  camera.position = vector(key["position"], file, place + ", position");
  camera.target = vector(key["target"], file, place + ", target");
  if (key.contains("up")) camera.up = vector(key["up"], file, place + ", up");
  if (key.contains("fov_degrees")) {
    const double fov = number(key["fov_degrees"], file, place + ", fov_degrees");
    if (!(fov > 0 && fov < 180)) throw InputError(describe(file, place, "fov_degrees must lie between 0 and 180"));
    camera.vertical_fov = fov * degree;
  }
  if (camera.position == camera.target)
    throw InputError(describe(file, place, "position and target are the same point", "move one of them"));
  return camera;
}

Json parse(const std::string& file) {
  try {
    return Json::parse(read_text(file));
  } catch (const JsonError& error) {
    if (error.byte == 0) throw InputError(describe(file, {}, error.what()));
    throw InputError(describe(file, "byte " + std::to_string(error.byte), "is not valid JSON"));
  }
}

// ---- between keys ----

double size_of(double v) { return std::abs(v); }
double size_of(Vec3d v) { return length(v); }

// Way per key at a key between two steps: their mean, the shorter one weighing more. On a line that is the harmonic
// mean of fritsch1984, and 0 where the path turns back, so that nothing is beyond the keys; beside a key that stands it
// is 0.
template <class V>
V speed_between(V before, V after) {
  const double a = size_of(before), b = size_of(after);
  if (!(a > 0 && b > 0)) return {};
  return (b / (a + b)) * before + (a / (a + b)) * after;
}

// A cubic between the keys k and k + 1 (Hermite); values(i) are those of the keys, t the share of the way.
template <class V, class Values>
V cubic_at(const Values& values, std::size_t keys, std::size_t k, double t) {
  const auto step = [&](std::size_t i) -> V { return values(i + 1) + -1.0 * values(i); };
  const V here = step(k);
  const bool first = k == 0, last = k + 2 == keys;
  V from = first ? here : speed_between(step(k - 1), here), to = last ? here : speed_between(here, step(k + 1));
  // At an end of the path the curve is bent evenly.
  if (first && !last) from = 1.5 * here + -0.5 * to;
  if (last && !first) to = 1.5 * here + -0.5 * from;
  return values(k) + (t * t * (3 - 2 * t)) * here + (t * (1 - t) * (1 - t)) * from + (t * t * (t - 1)) * to;
}

}  // namespace

void check_frames(int frames) {
  constexpr int most_frames = 1'000'000;  // catches a mistyped number before it becomes memory
  if (frames < 1 || frames > most_frames)
    throw InputError("a camera path needs between 1 and " + std::to_string(most_frames) + " frames");
}

Camera camera_at(std::span<const Camera> keys, double place) {
  const std::size_t last = keys.size() - 1;
  const auto k = static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(last)));
  const double t = place - static_cast<double>(k);
  if (k == last || !(t > 0)) return keys[k];
  const auto at = [&]<class V>(V Camera::*member) {
    return cubic_at<V>([&](std::size_t i) { return keys[i].*member; }, keys.size(), k, t);
  };
  return {at(&Camera::position), at(&Camera::target), at(&Camera::up), at(&Camera::vertical_fov)};
}

std::vector<Camera> resample_path(std::span<const Camera> keys, int frames, const std::string& keys_of) {
  check_frames(frames);
  if (keys.empty()) throw InputError(describe(keys_of, {}, "holds no camera"));
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double at = frames == 1 ? 0 : static_cast<double>(i) * static_cast<double>(keys.size() - 1) / (frames - 1);
    path.push_back(camera_at(keys, at));
    if (const auto key = static_cast<std::size_t>(at); path.back().position == path.back().target)
      throw InputError(describe(keys_of, "between frames " + std::to_string(key) + " and " + std::to_string(key + 1),
                                "the position passes through the target", "add a frame between them"));
  }
  return path;
}

std::vector<Camera> read_camera_keys(const std::string& file, Vec3d up) {
  const Json document = parse(file);
  if (document.is_object()) refuse_others(document, file, {}, {"frames"});
  if (!document.is_object() || !document.contains("frames") || !document["frames"].is_array())
    throw InputError(describe(file, {}, "has no array \"frames\""));
  std::vector<Camera> keys;
  for (const Json& key : document["frames"]) keys.push_back(camera_from(key, file, keys.size(), up));
  if (keys.empty()) throw InputError(describe(file, {}, "\"frames\" is empty", "give at least one camera"));
  return keys;
}

std::vector<Camera> read_camera_path(const std::string& file, int frames, Vec3d up) {
  check_frames(frames);
  return resample_path(read_camera_keys(file, up), frames, file);
}

void write_camera_path(const std::string& file, std::span<const Camera> path) {
  const auto array = [](Vec3d v) { return Json::array({v.x, v.y, v.z}); };
  Json frames = Json::array();
  for (const Camera& camera : path)
    frames.push_back({{"position", array(camera.position)},
                      {"target", array(camera.target)},
                      {"up", array(camera.up)},
                      {"fov_degrees", camera.vertical_fov / degree}});
  const std::string text = Json{{"frames", frames}}.dump(1) + '\n';
  AtomicFile out(file);
  out.write(std::as_bytes(std::span(text)));
  out.commit();
}

}  // namespace lodestone
