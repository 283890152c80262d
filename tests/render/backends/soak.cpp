// Long use of one process: views under a random camera with streaming and changing parameters. usage: soak soft|gl
// SECONDS
//
// Flights of half of the time are flown again for the other half: then memory must not grow (on gl, whose driver keeps
// variants of shaders: objects of OpenGL). A view that is visited again must have the picture that it had; OpenGL must
// report no error. Prints a line now and then, and memory from the beginning of that half to its end. Status: 0, 1 for
// what went wrong, 77 where OpenGL cannot be had.
#include "tests/soak.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "parallel/scheduler/clock.h"
#include "parallel/streaming/cell_stream.h"
#include "render/backends/gl/gl_renderer.h"
#include "render/backends/make_renderer.h"
#include "render/lod/resident_cells.h"
#include "render/scene/scene_view.h"
#include "tests/render/backends/test_gl_messages.h"
#include "tests/render/textured_models.h"

namespace {

using namespace lodestone;
using namespace lodestone::soak;

// Objects of OpenGL that have been made and not deleted: its entry points are replaced by ones that count.
namespace objects {

long alive = 0;

#define LODESTONE_COUNTED(Name, change, parameters, arguments) \
  struct Name {                                                \
    static inline decltype(epoxy_gl##Name) real;               \
    static void APIENTRY call parameters {                     \
      alive += change;                                         \
      real arguments;                                          \
    }                                                          \
    static void count() {                                      \
      real = epoxy_gl##Name;                                   \
      epoxy_gl##Name = call;                                   \
    }                                                          \
  }
LODESTONE_COUNTED(CreateTextures, n, (GLenum target, GLsizei n, GLuint* names), (target, n, names));
LODESTONE_COUNTED(DeleteTextures, -n, (GLsizei n, const GLuint* names), (n, names));
LODESTONE_COUNTED(CreateBuffers, n, (GLsizei n, GLuint* names), (n, names));
LODESTONE_COUNTED(DeleteBuffers, -n, (GLsizei n, const GLuint* names), (n, names));
LODESTONE_COUNTED(CreateFramebuffers, n, (GLsizei n, GLuint* names), (n, names));
LODESTONE_COUNTED(DeleteFramebuffers, -n, (GLsizei n, const GLuint* names), (n, names));
LODESTONE_COUNTED(CreateVertexArrays, n, (GLsizei n, GLuint* names), (n, names));
LODESTONE_COUNTED(DeleteVertexArrays, -n, (GLsizei n, const GLuint* names), (n, names));
#undef LODESTONE_COUNTED

// With a context. A call beforehand lets the library find each entry point.
void count() {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name), glDeleteTextures(1, &name);
  glCreateBuffers(1, &name), glDeleteBuffers(1, &name);
  glCreateFramebuffers(1, &name), glDeleteFramebuffers(1, &name);
  glCreateVertexArrays(1, &name), glDeleteVertexArrays(1, &name);
  CreateTextures::count(), DeleteTextures::count(), CreateBuffers::count(), DeleteBuffers::count();
  CreateFramebuffers::count(), DeleteFramebuffers::count(), CreateVertexArrays::count(), DeleteVertexArrays::count();
}

}  // namespace objects

// A renderer, and the context that it draws in, current as long as this lives.
struct Backend {
  std::unique_ptr<Renderer> renderer;
  std::optional<CurrentContext> current;
  std::optional<test::GlMessages> messages;

  Backend(const std::string& name, Scheduler& scheduler) {
    if (name != "gl") {
      renderer = make_renderer(name, scheduler);
      return;
    }
    auto context = make_headless_context();
    GlContext& made = *context;
    renderer = make_gl_renderer(std::move(context), {.scheduler = &scheduler});
    current.emplace(made);
    messages.emplace();
    objects::count();
  }
  [[nodiscard]] int errors() const { return messages ? messages->errors() : 0; }
};

struct Streamed {
  CellStream stream;
  ResidentCells resident;
  Streamed(const fs::path& file, std::uint64_t budget) : stream(file), resident(stream, {.budget_bytes = budget}) {}
};

std::uint64_t all_bytes(const fs::path& file) {
  const CellStream stream(file);
  std::uint64_t bytes = stream.family_bytes(no_cell);
  for (CellId c{0}; c < stream.tables().cells.size(); ++c) bytes += stream.family_bytes(c);
  return bytes;
}

// A terrain and a torus with textures above it.
Scene make_scene(const fs::path& folder, Scheduler& scheduler) {
  BuildConfig config;
  config.finest_level = 4;
  Repairs repairs;
  IndexedMesh terrain =
      prepare_mesh(generate_mesh({Shape::terrain, 60'000, 7}), repairs, scheduler, "terrain", {Lattice::automatic});
  (void)save_lode(build_hierarchy(std::move(terrain), config, scheduler), folder / "terrain.lode", scheduler,
                  LodeForm::compressed);
  (void)save_lode(*test::textured_torus(true), folder / "torus.lode", scheduler);
  Scene scene;
  scene.models.resize(2);
  scene.models[0].name = "terrain", scene.models[0].file = (folder / "terrain.lode").string();
  scene.models[0].extent = 4, scene.models[0].anchor = Anchor::base;
  scene.models[1].name = "torus", scene.models[1].file = (folder / "torus.lode").string();
  scene.models[1].extent = 1.5, scene.models[1].position = {0, 0, 1.5}, scene.models[1].anchor = Anchor::centre;
  return scene;
}

// A place to come back to.
struct Station {
  Camera camera;
  ViewConfig config;
  std::optional<Image> picture;
};

[[noreturn]] void fail_by_pictures(const Station& station, const Image& image) {
  const std::string files = (fs::temp_directory_path() / ("soak-" + std::to_string(getpid()) + "-")).string();
  write_png(files + "before.png", *station.picture), write_png(files + "now.png", image);
  const ImageDifference difference = image_difference(*station.picture, image, 0);
  const ViewConfig& config = station.config;
  fail("a view that is visited again has another picture: " + std::to_string(difference.differing) +
       " pixels by up to " + std::to_string(difference.max) + ", " + std::to_string(config.samples) + " samples" +
       (config.cull_occluded ? ", culled" : "") + (config.select_on_device ? ", selected on device" : "") + "; see " +
       files + "*.png");
}

// A way to a station, with the parameters of another.
struct Flight {
  std::size_t station, settings;
  Camera from;
  int steps;
};

class Soak {
 public:
  Soak(const Scene& scene, const std::string& backend, Scheduler& scheduler) : backend_(backend, scheduler) {
    std::vector<OpenModel> models;
    for (const SceneModel& model : scene.models) {
      streamed_.push_back(std::make_unique<Streamed>(model.file, all_bytes(model.file) * 2 / 3));
      models.push_back({&streamed_.back()->resident.hierarchy(), &streamed_.back()->resident, nullptr});
    }
    view_.emplace(scene, models);
    view_->upload(*backend_.renderer);
    for (int i = 0; i < 24; ++i) stations_.push_back({random_camera(), random_config(), {}});
  }

  // New flights for half of the time, then the same again: what they need of memory they have needed before.
  void run(double seconds) {
    const Stopwatch clock;
    for (std::size_t s = 0; s < 2 * stations_.size(); ++s) visit(random_flight(s % stations_.size()));
    std::vector<Flight> flights;
    double told = 0;
    const auto fly = [&](const Flight& flight) {
      visit(flight);
      if (visits_ % 20 == 0) view_->upload(*backend_.renderer);
      if (clock.seconds() > told + seconds / 20 + 1) told = tell(clock.seconds());
    };
    while (flights.empty() || clock.seconds() < seconds / 2) {
      flights.push_back(random_flight(random_() % stations_.size()));
      fly(flights.back());
    }
    Growth growth(std::uint64_t{2} << 20, std::uint64_t{64} << 20);
    const long objects = objects::alive;
    do {
      for (const Flight& flight : flights) fly(flight);
      growth.middle();
    } while (clock.seconds() < seconds);
    growth.end(!backend_.messages);
    if (backend_.messages) std::printf("objects of OpenGL: %ld, %ld (beginning, end)\n", objects, objects::alive);
    if (objects::alive > objects + 8) fail("objects of OpenGL have become more");
    tell(clock.seconds());
    if (backend_.errors() > 0) fail("OpenGL reported " + std::to_string(backend_.errors()) + " errors");
  }

 private:
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  bool chance(double share) { return uniform(0, 1) < share; }

  Camera random_camera() {
    const double turn = uniform(0, 2 * std::numbers::pi), distance = std::exp(uniform(-1.2, 2.2));
    Camera camera;
    camera.target = {uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(0.3, 1.5)};
    camera.position = camera.target + distance * Vec3d{std::cos(turn), std::sin(turn), uniform(0.05, 1)};
    camera.vertical_fov = uniform(0.3, 1.5);
    return camera;
  }

  ViewConfig random_config() {
    constexpr ImageSize sizes[] = {{320, 240}, {257, 131}, {200, 200}};
    const std::span<const Blend> blends = all_blends();
    ViewConfig config;
    config.size = sizes[random_() % std::size(sizes)];
    config.samples = chance(0.3) ? 4 : 1;
    config.radii.pixel_error = static_cast<float>(std::exp(uniform(-1, 3)));
    if (chance(0.3)) config.radii.kappa0 = static_cast<float>(uniform(0.3, 6));
    if (chance(0.3)) config.radii.metric = DistanceMetric::chebyshev;
    config.blend = blends[random_() % blends.size()];
    FrameSettings& s = config.settings;
    s.lighting.ambient = static_cast<float>(uniform(0, 1));
    if (chance(0.3)) s.lighting.directional = {1, chance(0.5), 256};
    if (chance(0.2)) s.fog.density = static_cast<float>(uniform(0, 1));
    if (chance(0.2)) s.ambient_occlusion = {1, 0.2f};
    if (chance(0.2)) s.level_tint = 0.5f;
    if (chance(0.2)) s.wireframe = 1;
    if (chance(0.1)) s.overdraw = true;
    if (chance(0.3)) config.effects.kind = EffectRequest::Kind::all;
    if (chance(0.2)) config.hidden = {chance(0.5), false};
    if (chance(0.2)) config.clip = ClipPlane{{uniform(-1, 1), uniform(-1, 1), 1}, uniform(0, 0.5)};
    config.cull_occluded = chance(0.4), config.select_on_device = chance(0.3);
    return config;
  }

  bool draw(const Camera& camera, const ViewConfig& config) {
    const bool changed = view_->update(camera, config);
    (void)view_->draw(*backend_.renderer);
    ++frames_;
    return changed;
  }

  Flight random_flight(std::size_t station) {
    return {station, random_() % stations_.size(), random_camera(), 4 + static_cast<int>(random_() % 12)};
  }

  // A flight, in which cells come when they come; then rest at the station.
  void visit(const Flight& flight) {
    Station& station = stations_[flight.station];
    for (int i = 0; i < flight.steps; ++i) {
      const double share = static_cast<double>(i) / flight.steps;
      Camera camera = station.camera;
      camera.position = (1 - share) * flight.from.position + share * station.camera.position;
      if (camera.position == camera.target) continue;
      draw(camera, stations_[flight.settings].config);
    }
    for (int rest = 0, i = 0; rest < 3; ++i) {
      if (i > 3000) fail("a view does not come to rest");
      rest = draw(station.camera, station.config) ? 0 : rest + 1;
      for (const auto& streamed : streamed_) streamed->stream.wait();
    }
    const Image image = backend_.renderer->read_back();
    if (image.size != station.config.size) fail("a picture has another size");
    if (!station.picture) station.picture = image;
    if (station.picture->rgba != image.rgba) fail_by_pictures(station, image);
    ++visits_;
  }

  double tell(double seconds) const {
    const Memory memory = Memory::now();
    std::printf("%.0f s: %lld frames, %lld visits, %.1f MiB resident, %.3f MiB allocated, %.1f MiB of cells\n", seconds,
                frames_, visits_, mib(memory.resident), mib(memory.allocated), mib(view_->resident_bytes()));
    std::fflush(stdout);
    return seconds;
  }

  std::vector<std::unique_ptr<Streamed>> streamed_;
  Backend backend_;
  std::optional<SceneView> view_;
  std::vector<Station> stations_;
  std::mt19937_64 random_{23};
  long long frames_ = 0, visits_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::string backend = argc == 3 ? argv[1] : "";
  const double seconds = argc == 3 ? std::atof(argv[2]) : 0;
  if ((backend != "soft" && backend != "gl") || !(seconds > 0)) {
    std::fputs("usage: soak soft|gl SECONDS\n", stderr);
    return 2;
  }
  return soak::run([&](const fs::path& folder, Scheduler& scheduler) {
    Soak(make_scene(folder, scheduler), backend, scheduler).run(seconds);
  });
}
