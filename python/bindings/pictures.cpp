// Pictures of a hierarchy as arrays, flights with their proof, and how much two pictures differ.
#include <pybind11/stl.h>

#include "experiments/command_line/exit_status.h"
#include "experiments/metrics/pictures/image_quality.h"
#include "experiments/subjects/render.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/docs.h"
#include "python/bindings/json_values.h"
#include "python/bindings/views.h"
#include "render/backends/make_renderer.h"

namespace lodestone::python {
namespace {

// Colours of shape (height, width, 3): a view of the picture's four bytes a pixel, without alpha.
py::array picture_array(Image&& picture) {
  if (picture.rgba.empty()) return py::array(py::dtype::of<std::uint8_t>(), {0, 0, 3});
  auto* const kept = new Image(std::move(picture));
  const py::capsule owner(kept, [](void* memory) { delete static_cast<Image*>(memory); });
  const py::ssize_t width = kept->size.width, height = kept->size.height;
  return py::array(py::dtype::of<std::uint8_t>(), {height, width, py::ssize_t{3}},
                   {4 * width, py::ssize_t{4}, py::ssize_t{1}}, kept->rgba.data(), owner);
}

Image image_of(const py::object& values, const std::string& name) {
  const auto array = py::array_t<std::uint8_t>::ensure(values);
  if (!array) throw py::error_already_set();
  if (array.ndim() != 3 || (array.shape(2) != 3 && array.shape(2) != 4))
    throw InputError(name + ": not an array of shape (height, width, 3 or 4)");
  Image image{.size = {static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0))}, .rgba = {}, .depth = {}};
  const auto pixels = array.unchecked<3>();
  for (py::ssize_t y = 0; y < array.shape(0); ++y)
    for (py::ssize_t x = 0; x < array.shape(1); ++x)
      for (py::ssize_t c = 0; c < 4; ++c)
        image.rgba.push_back(c < array.shape(2) ? pixels(y, x, c) : std::uint8_t{255});
  return image;
}

struct Flight {
  RenderJob job;
  std::string backend = "soft";
};

Flight take_flight(Options& options) {
  Flight flight;
  flight.job.view = take_view(options);
  options.take("backend", flight.backend);
  return flight;
}

RenderResult draw(Flight& flight, const Model& model, LongCall& call) {
  flight.job.cancel = call.cancel();
  const auto renderer = make_renderer(flight.backend, call.scheduler());
  SceneView view = view_of_model(model);
  return lodestone::run(flight.job, view, *renderer, call.scheduler());
}

py::array render_picture(const ModelPtr& model, const Camera& camera, const py::kwargs& given) {
  Options options("render", given);
  Flight flight = take_flight(options);
  LongCall call(options);
  options.finish();
  Image picture;
  flight.job.cameras = {camera};
  flight.job.on_frame = [&](std::size_t, Renderer& renderer) { picture = renderer.read_back(); };
  call.run([&] { static_cast<void>(draw(flight, *model, call)); });
  return picture_array(std::move(picture));
}

py::object fly(const ModelPtr& model, const std::vector<Camera>& cameras, const py::kwargs& given) {
  Options options("fly", given);
  Flight flight = take_flight(options);
  flight.job.measure = true;
  options.take("measure", flight.job.measure);
  py::object on_frame = py::none();
  options.take("on_frame", on_frame);
  LongCall call(options);
  options.finish();
  flight.job.cameras = cameras;
  flight.job.on_frame = [&](std::size_t index, Renderer& renderer) {
    call.report("rendering", static_cast<double>(index + 1) / static_cast<double>(cameras.size()));
    if (on_frame.is_none()) return;
    Image picture = renderer.read_back();
    const py::gil_scoped_acquire held;
    on_frame(index, picture_array(std::move(picture)));
  };
  const RenderResult result = call.run([&] { return draw(flight, *model, call); });
  Row row = without_nulls(to_row(result));
  row["frames"] = Json::array();
  for (const FrameResult& frame : result.frames) {
    row["frames"].push_back(without_nulls(to_row(frame)));
    row["frames"].back()["milliseconds"] = frame.milliseconds;
  }
  row["warnings"] = result.warnings;
  return to_python(row);
}

Json to_json(const ErrorSummary& error) {
  return {{"mean", error.mean},
          {"p50", error.p50},
          {"p99", error.p99},
          {"max", error.max},
          {"share_above", error.share_above}};
}

py::object compare_pictures(const py::object& reference, const py::object& picture, const py::kwargs& given) {
  Options options("compare_pictures", given);
  ImageQualityConfig config;
  options.take("pixels_per_degree", config.flip.pixels_per_degree);
  LongCall call(options);
  options.finish();
  const Image a = image_of(reference, "reference"), b = image_of(picture, "picture");
  const ImageQuality quality = call.run([&] { return image_quality(a, b, call.scheduler(), config); });
  return to_python({{"mean_absolute", quality.mean_absolute},
                    {"absolute", to_json(quality.absolute)},
                    {"psnr", quality.psnr},
                    {"ssim", quality.ssim},
                    {"flip", to_json(quality.flip)}});
}

}  // namespace

void bind_pictures(py::module_& module) {
  module.def("render", &render_picture, py::arg("hierarchy"), py::arg("camera"), doc::render);
  module.def("fly", &fly, py::arg("hierarchy"), py::arg("cameras"), doc::fly);
  module.def("compare_pictures", &compare_pictures, py::arg("reference"), py::arg("picture"), doc::compare_pictures);
}

}  // namespace lodestone::python
