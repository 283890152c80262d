// Reader of OBJ: vertices, texture coordinates, normals, faces and their materials; every other statement is skipped.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/formats/common/lower_left.h"
#include "core/formats/common/polygon_fan.h"
#include "core/formats/obj/obj.h"
#include "core/formats/obj/obj_materials.h"
#include "core/mesh/raw_mesh.h"
#include "core/mesh/wedges.h"
#include "core/texture/colour.h"

namespace lodestone {
namespace {

// The largest index that was ahead of the values read so far. Faces may come before their vertices, so that its range
// can only be checked at the end of the file.
struct ForwardReference {
  std::uint64_t index = 0, line = 0;
};

// A corner "v", "v/vt", "v//vn" or "v/vt/vn".
struct Corner {
  std::uint32_t vertex = 0, uv = no_value, normal = no_value;
};

class ObjReader {
 public:
  ObjReader(ByteReader& input, const ReadConfig& config)
      : input_(&input), scan_(input), with_attributes_(config.attributes), fan_(mesh_), materials_(mesh_, input) {}

  RawMesh read() {
    do {
      const std::string_view keyword = scan_.token();
      if (keyword == "v") {
        read_vertex();
      } else if (keyword == "f") {
        read_face();
      } else if (with_attributes_) {
        read_attribute(keyword);
      }
    } while (scan_.next_line());
    check_vertex_indices();
    cut_polygons();
    if (with_attributes_) {
      finish_attributes();
      materials_.add_notes();
    }
    return std::move(mesh_);
  }

 private:
  void read_attribute(std::string_view keyword) {
    if (keyword == "vt") {
      read_uv();
    } else if (keyword == "vn") {
      read_normal();
    } else if (keyword == "mtllib") {
      materials_.add_libraries(scan_.rest_of_line(), scan_.place());
    } else if (keyword == "usemtl") {
      material_ = materials_.use(scan_.rest_of_line(), scan_.place());
    }
  }

  // "v x y z", "v x y z weight", "v x y z r g b" or "v x y z weight r g b".
  void read_vertex() {
    require_room(mesh_.positions.size());
    const double x = scan_.number(scan_.token(), "an x coordinate");
    const double y = scan_.number(scan_.token(), "a y coordinate");
    const double z = scan_.number(scan_.token(), "a z coordinate");
    mesh_.positions.push_back({x, y, z});
    if (with_attributes_ && scan_.line_continues()) read_colour();
  }

  void read_colour() {
    double values[4];
    std::size_t count = 0;
    for (; count < 4; ++count) {
      const std::string_view token = scan_.token();
      if (token.empty()) break;
      const std::optional<double> value = parse_number(token);
      if (!value) return;
      values[count] = *value;
    }
    if (count < 3) return;
    attributes_.colour.resize(mesh_.positions.size());
    const double* rgb = values + (count - 3);
    attributes_.colour.back() = {unit_to_byte(rgb[0]), unit_to_byte(rgb[1]), unit_to_byte(rgb[2]), 255};
  }

  void read_uv() {
    require_room(attributes_.uv.size());
    const double u = scan_.number(scan_.token(), "a texture coordinate");
    const std::string_view token = scan_.token();
    const double v = token.empty() ? 0 : scan_.number(token, "a texture coordinate");
    attributes_.uv.push_back(from_lower_left(u, v));
  }

  void read_normal() {
    require_room(attributes_.normal.size());
    const double x = scan_.number(scan_.token(), "an x component of a normal");
    const double y = scan_.number(scan_.token(), "a y component of a normal");
    const double z = scan_.number(scan_.token(), "a z component of a normal");
    attributes_.normal.push_back(unit_normal({x, y, z}));
  }

  void require_room(std::size_t count) const {
    if (count == no_value)
      throw ResourceError(describe(scan_.name(), scan_.place(), "more vertices than 32-bit indices reach",
                                   "split the model into several files"));
  }

  void read_face() {
    face_.clear();
    face_has_uv_ = face_has_normal_ = false;
    for (std::string_view token = scan_.token(); !token.empty(); token = scan_.token())
      face_.push_back(read_corner(token));
    const std::size_t before = mesh_.triangles.size();
    for (const Corner& corner : face_) fan_.add(corner.vertex);
    fan_.close();
    if (!with_attributes_ || mesh_.triangles.size() == before) return;
    if (face_has_uv_ || !attributes_.uv_of.empty()) add_values(attributes_.uv_of, &Corner::uv, before);
    if (face_has_normal_ || !attributes_.normal_of.empty()) add_values(attributes_.normal_of, &Corner::normal, before);
    if (material_ == no_material && mesh_.wedges.material.empty()) return;
    mesh_.wedges.material.resize(before, no_material);
    mesh_.wedges.material.resize(mesh_.triangles.size(), material_);
  }

  Corner read_corner(std::string_view token) {
    const std::size_t first = token.find('/');
    Corner corner;
    corner.vertex = read_index(token.substr(0, first), mesh_.positions.size(), furthest_, "vertex");
    if (first == std::string_view::npos || !with_attributes_) return corner;
    const std::string_view rest = token.substr(first + 1);
    const std::size_t second = rest.find('/');
    if (const std::string_view uv = rest.substr(0, second); !uv.empty()) {
      corner.uv = read_index(uv, attributes_.uv.size(), furthest_uv_, "texture coordinate");
      face_has_uv_ = true;
    }
    if (second == std::string_view::npos) return corner;
    if (const std::string_view normal = rest.substr(second + 1); !normal.empty()) {
      corner.normal = read_index(normal, attributes_.normal.size(), furthest_normal_, "normal");
      face_has_normal_ = true;
    }
    return corner;
  }

  // Counts from 1, or backwards from the latest value when negative.
  std::uint32_t read_index(std::string_view token, std::uint64_t count, ForwardReference& furthest, const char* kind) {
    const std::optional<std::int64_t> index = parse_integer(token);
    if (!index || *index <= 0) return index_from_latest(token, index, count, kind);
    const std::uint64_t id = static_cast<std::uint64_t>(*index) - 1;
    if (id >= count && id >= furthest.index) furthest = {id, scan_.line()};
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(id, no_value));
  }

  std::uint32_t index_from_latest(std::string_view token, std::optional<std::int64_t> index, std::uint64_t count,
                                  const char* kind) const {
    if (!index) scan_.fail(std::string("expected a ") + kind + " index, found " + quote(token));
    if (*index == 0) scan_.fail(std::string(kind) + " index 0", "OBJ counts from 1");
    const std::uint64_t back = 0 - static_cast<std::uint64_t>(*index);  // unsigned: -2^63 has no positive twin
    if (back > count)
      scan_.fail(std::string(kind) + " index " + std::to_string(*index) + " goes back beyond the first of " +
                 std::to_string(count));
    return static_cast<std::uint32_t>(count - back);
  }

  // Adds the values of an attribute at the corners of the latest face, whose triangles begin at `before`. Nothing is
  // stored before the first corner that has a value.
  void add_values(std::vector<Triangle>& values, std::uint32_t Corner::*value, std::size_t before) {
    values.resize(before, no_values);
    TriangleFan fan(values);
    for (const Corner& corner : face_) fan.add(corner.*value);
  }

  void check_vertex_indices() const {
    if (furthest_.line == 0 || furthest_.index < mesh_.positions.size()) return;
    throw InputError(describe(input_->name(), "line " + std::to_string(furthest_.line),
                              "vertex index " + std::to_string(furthest_.index + 1) +
                                  " is out of range, the file has " + std::to_string(mesh_.positions.size()) +
                                  " vertices",
                              "the file is damaged or truncated"));
  }

  void cut_polygons() {
    std::vector<std::span<Triangle>> values;
    for (auto* list : {&attributes_.uv_of, &attributes_.normal_of}) {
      if (list->empty()) continue;
      list->resize(mesh_.triangles.size(), no_values);
      values.push_back(*list);
    }
    fan_.cut(values);
  }

  void finish_attributes() {
    drop_out_of_range(attributes_.uv_of, attributes_.uv.size(), furthest_uv_, "texture coordinate");
    drop_out_of_range(attributes_.normal_of, attributes_.normal.size(), furthest_normal_, "normal");
    if (!attributes_.colour.empty()) attributes_.colour.resize(mesh_.positions.size());
    if (attributes_.uv_of.empty() && attributes_.normal_of.empty()) {
      mesh_.wedges.colour = std::move(attributes_.colour);  // one wedge per vertex
      return;
    }
    std::vector<std::uint32_t> material = std::move(mesh_.wedges.material);
    mesh_.wedges = make_wedges(mesh_.triangles, mesh_.positions.size(), attributes_);
    mesh_.wedges.material = std::move(material);
  }

  // The surface is valid without them.
  void drop_out_of_range(std::vector<Triangle>& values, std::size_t count, const ForwardReference& furthest,
                         const std::string& kind) {
    if (furthest.line == 0 || furthest.index < count) return;
    std::uint64_t dropped = 0;
    for (Triangle& t : values)
      for (std::uint32_t& id : t.v)
        if (id != no_value && id >= count) id = no_value, ++dropped;
    mesh_.warnings.push_back(describe(input_->name(), "line " + std::to_string(furthest.line),
                                      kind + " index " + std::to_string(furthest.index + 1) +
                                          " is out of range, the file has " + std::to_string(count) + "; " +
                                          std::to_string(dropped) + " corners have none"));
  }

  ByteReader* input_;
  TextScanner scan_;
  bool with_attributes_;
  RawMesh mesh_;
  PolygonFan fan_;
  ObjMaterials materials_;
  std::uint32_t material_ = no_material;
  CornerAttributes attributes_;
  std::vector<Corner> face_;  // the latest
  bool face_has_uv_ = false, face_has_normal_ = false;
  ForwardReference furthest_, furthest_uv_, furthest_normal_;
};

}  // namespace

RawMesh read_obj(ByteReader& input, const ReadConfig& config) { return ObjReader(input, config).read(); }

}  // namespace lodestone
