#include "parallel/distributed/generated_stream.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/files/checksum.h"

namespace lodestone {
namespace {

class GeneratedStream final : public MeshStream {
 public:
  explicit GeneratedStream(const GenerateConfig& config) : config_(config), surface_(config) {
    vertices_ = surface_.vertex_count();
    triangles_ = surface_.triangle_count();
  }
  [[nodiscard]] const std::string& name() const override { return name_; }
  void read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* /*wedges*/) const override {
    for (Vec3d& p : out) p = to_double(surface_.vertex(first++));
  }
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override {
    for (Triangle& t : out) t = surface_.triangle(first++);
  }
  [[nodiscard]] std::uint64_t identity() const override {
    const std::array<std::uint64_t, 3> all{static_cast<std::uint64_t>(config_.shape), config_.triangles, config_.seed};
    return checksum(std::as_bytes(std::span(all)));
  }

 private:
  GenerateConfig config_;
  GeneratedSurface surface_;
  const std::string name_ = "generated surface";
};

// A whole number, also as 4e9.
bool parse_count(std::string_view text, std::uint64_t& count) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= 0 && value < 0x1p53)) return false;
  count = static_cast<std::uint64_t>(value);
  return static_cast<double>(count) == value;
}

}  // namespace

std::unique_ptr<MeshStream> generated_stream(const GenerateConfig& config) {
  return std::make_unique<GeneratedStream>(config);
}

GenerateConfig parse_generator(std::string_view text) {
  const std::size_t colon = text.find(':'), second = std::min(text.find(':', colon + 1), text.size());
  GenerateConfig config;
  bool valid = colon != std::string_view::npos;
  if (valid) valid = parse_count(text.substr(colon + 1, second - colon - 1), config.triangles);
  if (valid && second < text.size()) valid = parse_count(text.substr(second + 1), config.seed);
  if (!valid)
    throw InputError("cannot read the generator '" + std::string(text) +
                     "'; give it as SHAPE:TRIANGLES or SHAPE:TRIANGLES:SEED, such as sphere:16e6:1");
  config.shape = shape_named(text.substr(0, colon));
  return config;
}

}  // namespace lodestone
