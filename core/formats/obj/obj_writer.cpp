// Writer of OBJ and MTL.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <charconv>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "core/base/key_numbers.h"
#include "core/formats/common/lower_left.h"
#include "core/formats/obj/obj.h"

namespace lodestone {
namespace {

// The numbers of a corner of a face besides its position.
struct CornerParts {
  bool uv = false, normal = false;
};

// Assembles a line of text in place: a keyword, numbers, corners of faces.
class Line {
 public:
  explicit Line(std::string_view keyword) { append(keyword); }
  template <class Number>
  Line& operator<<(Number value) {
    append(" ");
    return number(value);
  }
  // "v/vt/vn" from indices that count from 0; absent attributes are left out.
  Line& corner(std::uint64_t v, std::uint64_t wedge, CornerParts parts) {
    *this << v + 1;
    if (parts.uv || parts.normal) append("/");
    if (parts.uv) number(wedge + 1);
    if (!parts.normal) return *this;
    append("/");
    return number(wedge + 1);
  }
  [[nodiscard]] std::span<const std::byte> bytes() {
    text_[length_] = '\n';
    return std::as_bytes(std::span(text_).first(length_ + 1));
  }

 private:
  void append(std::string_view text) {
    std::copy(text.begin(), text.end(), text_.begin() + static_cast<std::ptrdiff_t>(length_));
    length_ += text.size();
  }
  template <class Number>
  Line& number(Number value) {
    const auto [end, error] = std::to_chars(text_.data() + length_, text_.data() + text_.size() - 1, value);
    assert(error == std::errc{});
    length_ = static_cast<std::size_t>(end - text_.data());
    return *this;
  }

  std::array<char, 256> text_;  // six doubles take at most 25 characters each, a corner 33
  std::size_t length_ = 0;
};

// The values of a line "v": wedges that agree in them are one vertex to programs that know positions only.
struct ObjVertex {
  std::array<std::uint64_t, 3> place{};
  Rgba8 colour;
  friend bool operator==(const ObjVertex&, const ObjVertex&) = default;
};

struct HashObjVertex {
  std::uint64_t operator()(const ObjVertex& v) const {
    std::uint64_t hash = std::bit_cast<std::uint32_t>(v.colour);
    for (const std::uint64_t word : v.place) hash = (std::rotl(hash, 23) ^ word) * 0x9e37'79b9'7f4a'7c15ull;
    return hash;
  }
};

std::string line_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 127 || c == '#' || c == '\\'; }, '_');
  return name;
}

class ObjWriter {
 public:
  ObjWriter(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions)
      : file_(file), mesh_(mesh), companions_(companions) {
    if (mesh.wedges == nullptr) return;
    uv_ = !mesh.wedges->uv.empty();
    normals_ = !mesh.wedges->normal.empty();
    colours_ = !mesh.wedges->colour.empty();
    materials_ = !mesh.wedges->material.empty() && !mesh.materials.empty() && companions.possible();
  }

  void write() {
    if (materials_) write_materials();
    write_vertices();
    write_wedges();
    write_faces();
  }

 private:
  void put(std::string_view text) { file_.write(std::as_bytes(std::span(text))); }

  void write_materials() {
    std::set<std::string> taken;
    for (std::size_t m = 0; m < mesh_.materials.size(); ++m) {
      std::string name = line_name(mesh_.materials[m].name);
      if (name.empty() || !taken.insert(name).second) taken.insert(name += "material_" + std::to_string(m));
      names_.push_back(std::move(name));
    }
    const std::string library = library_text();
    put("mtllib " + companions_.add(".mtl", std::as_bytes(std::span(library))) + "\n");
  }

  std::string library_text() {
    std::vector<std::string> images(mesh_.textures.size());
    std::string text;
    const auto number = [&](float value) {
      std::array<char, 32> digits{};
      text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
    };
    const auto map = [&](const char* statement, std::uint32_t texture) {
      if (texture >= mesh_.textures.size()) return;
      const Texture& t = mesh_.textures[texture];
      if (images[texture].empty()) images[texture] = companions_.add_texture(t, texture);
      text += statement;
      if (t.wrap_u == TextureWrap::clamp && t.wrap_v == TextureWrap::clamp) text += " -clamp on";
      text += " " + images[texture] + "\n";
    };
    for (std::size_t m = 0; m < mesh_.materials.size(); ++m) {
      const Material& material = mesh_.materials[m];
      text += "newmtl " + names_[m] + "\nKd";
      for (std::size_t k = 0; k < 3; ++k) text += ' ', number(material.base_colour[k]);
      text += "\nd ";
      number(material.base_colour[3]);
      text += '\n';
      if (material.roughness != 1) text += "Pr ", number(material.roughness), text += '\n';
      if (material.metallic != 0) text += "Pm ", number(material.metallic), text += '\n';
      if (material.emissive != std::array<float, 3>{}) {
        text += "Ke";
        for (const float value : material.emissive) text += ' ', number(value);
        text += '\n';
      }
      map("map_Kd", material.texture);
      map("norm", material.normal_map);
      map("map_Ke", material.emissive_map.texture);
    }
    return text;
  }

  void write_vertices() {
    KeyNumbers<ObjVertex, HashObjVertex> known;
    for (std::size_t i = 0; i < mesh_.vertex_count; ++i) {
      const Vec3d p = mesh_.position(i);
      const Rgba8 colour = colours_ ? mesh_.wedges->colour[i] : Rgba8{};
      if (uv_ || normals_ || colours_) {
        const ObjVertex vertex{
            {std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y), std::bit_cast<std::uint64_t>(p.z)},
            colour};
        const std::uint32_t next = known.size();
        vertex_of_.push_back(known.number(vertex));
        if (vertex_of_.back() != next) continue;
      }
      Line line("v");
      line << p.x << p.y << p.z;
      if (colours_)
        for (const std::uint8_t c : {colour.r, colour.g, colour.b}) line << static_cast<float>(c) / 255;
      file_.write(line.bytes());
    }
  }

  void write_wedges() {
    if (uv_)
      for (const Vec2f uv : mesh_.wedges->uv) {
        const auto [s, t] = to_lower_left<double>(uv);
        file_.write((Line("vt") << s << t).bytes());
      }
    if (normals_)
      for (const Vec3f n : mesh_.wedges->normal) file_.write((Line("vn") << n.x << n.y << n.z).bytes());
  }

  void write_faces() {
    std::vector<std::uint32_t> order(mesh_.triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto material_of = [&](std::uint32_t t) {
      return materials_ && mesh_.wedges->material[t] < names_.size() ? mesh_.wedges->material[t] : no_material;
    };
    // No statement ends a material.
    std::stable_partition(order.begin(), order.end(), [&](std::uint32_t t) { return material_of(t) == no_material; });
    std::uint32_t latest = no_material;
    for (const std::uint32_t t : order) {
      if (const std::uint32_t material = material_of(t); material != latest) {
        put("usemtl " + names_[material] + "\n");
        latest = material;
      }
      Line line("f");
      for (const std::uint32_t v : mesh_.triangles[t].v)
        line.corner(vertex_of_.empty() ? v : vertex_of_[v], v, {.uv = uv_, .normal = normals_});
      file_.write(line.bytes());
    }
  }

  AtomicFile& file_;
  const MeshView& mesh_;
  MeshCompanions& companions_;
  bool uv_ = false, normals_ = false, colours_ = false, materials_ = false;
  std::vector<std::string> names_;        // of the materials
  std::vector<std::uint32_t> vertex_of_;  // by wedge; empty: the wedge itself
};

}  // namespace

void write_obj(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions) {
  ObjWriter(file, mesh, companions).write();
}

}  // namespace lodestone
