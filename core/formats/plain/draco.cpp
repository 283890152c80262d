// The only file that names libdraco.
#include "core/formats/plain/draco.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <array>
#include <type_traits>
#include <utility>

#include "core/base/error.h"
#include "core/formats/common/lower_left.h"
#include "core/mesh/raw_mesh.h"
#include "core/texture/colour.h"

namespace lodestone {

struct DracoMesh::Decoded {
  std::unique_ptr<draco::Mesh> mesh;
  std::string name, place;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(describe(name, place, what, "the file is damaged or not a Draco mesh"));
  }
  [[nodiscard]] const draco::PointAttribute& at(const Attribute& attribute) const {
    return *mesh->attribute(attribute.index);
  }
  [[nodiscard]] std::array<double, 4> value(const draco::PointAttribute& attribute, std::uint32_t id) const {
    std::array<double, 4> value{};
    const auto components = static_cast<std::int8_t>(std::min<int>(attribute.num_components(), 4));
    // The library loads truth values as bool, which is undefined for most bytes.
    if (id >= attribute.size() || attribute.data_type() == draco::DT_BOOL ||
        !attribute.ConvertValue<double>(draco::AttributeValueIndex(id), components, value.data()))
      fail("value " + std::to_string(id) + " of an attribute cannot be read");
    return value;
  }
};

namespace {

// The library allocates for as many faces, points and values as a file declares. A million triangles of a plane take 40
// for a byte; curved surfaces four or fewer.
constexpr std::uint64_t counted_always = 1 << 16, counted_per_byte = 64;
constexpr std::uint64_t bytes_of_values = 64;  // for each point that may be: positions, normals, colours and the like

struct Bound {
  std::uint64_t elements = 0;
  const std::string &name, &place;

  void check(std::uint64_t declared, std::uint64_t most, const char* what) const {
    if (declared <= most) return;
    throw InputError(describe(name, place,
                              "declares " + std::to_string(declared) + what + ", of at most " + std::to_string(most) +
                                  " for data of this size",
                              "the file is damaged, or split the mesh"));
  }
};

// The number that follows, of a version with numbers of four bytes or with numbers of as many bytes as they need. 0 where
// the data ends, which the library finds, too.
std::uint64_t number_from(draco::DecoderBuffer& buffer, bool short_form) {
  std::uint32_t number = 0;
  const bool there = short_form ? draco::DecodeVarint(&number, &buffer) : buffer.Decode(&number);
  return there ? number : 0;
}

template <class Decoder>
class BoundedDecoder : public Decoder {
 public:
  explicit BoundedDecoder(const Bound& bound) : bound_(bound) {}

 protected:
  bool DecodeConnectivity() override {
    draco::DecoderBuffer ahead = *this->buffer();
    const int version = this->bitstream_version();
    constexpr bool edges = std::is_same_v<Decoder, draco::MeshEdgebreakerDecoder>;
    const bool short_form = version >= (edges ? DRACO_BITSTREAM_VERSION(2, 0) : DRACO_BITSTREAM_VERSION(2, 2));
    if (edges && version < DRACO_BITSTREAM_VERSION(2, 2)) (void)number_from(ahead, short_form);  // new vertices
    for (int k = 0; k < 2; ++k)  // faces and points; vertices and faces
      bound_.check(number_from(ahead, short_form), bound_.elements, " faces or vertices");
    return Decoder::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    const draco::PointCloud& points = *this->point_cloud();
    std::uint64_t bytes = 0;
    for (int k = 0; k < points.num_attributes(); ++k)
      bytes += static_cast<std::uint64_t>(points.attribute(k)->num_components()) *
               static_cast<std::uint64_t>(draco::DataTypeLength(points.attribute(k)->data_type()));
    bound_.check(bytes * points.num_points(), bytes_of_values * bound_.elements, " bytes of values");
    return Decoder::DecodeAllAttributes();
  }

 private:
  Bound bound_;
};

std::unique_ptr<draco::MeshDecoder> make_decoder(const draco::DracoHeader& header, const Bound& bound) {
  if (header.encoder_type != draco::TRIANGULAR_MESH) return nullptr;
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
    return std::make_unique<BoundedDecoder<draco::MeshSequentialDecoder>>(bound);
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
    return std::make_unique<BoundedDecoder<draco::MeshEdgebreakerDecoder>>(bound);
  return nullptr;
}

}  // namespace

DracoMesh::DracoMesh(std::span<const char> bytes, const std::string& name, const std::string& place)
    : decoded_(new Decoded{nullptr, name, place}) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const auto require = [&](const draco::Status& status) {
    if (!status.ok()) decoded_->fail(std::string("cannot decode: ") + status.error_msg());
  };
  draco::DracoHeader header;
  draco::DecoderBuffer ahead = buffer;
  require(draco::PointCloudDecoder::DecodeHeader(&ahead, &header));
  const auto decoder = make_decoder(header, {counted_always + counted_per_byte * bytes.size(), name, place});
  if (!decoder) decoded_->fail("cannot decode: not a mesh");
  decoded_->mesh = std::make_unique<draco::Mesh>();
  require(decoder->Decode({}, &buffer, decoded_->mesh.get()));
}

DracoMesh::~DracoMesh() = default;
DracoMesh::DracoMesh(DracoMesh&&) noexcept = default;

namespace {

DracoMesh::Attribute describe_attribute(const draco::Mesh& mesh, int index) {
  const draco::PointAttribute& attribute = *mesh.attribute(index);
  const draco::DataType type = attribute.data_type();
  DracoMesh::Attribute result{.index = index, .components = attribute.num_components()};
  result.floating = type == draco::DT_FLOAT32 || type == draco::DT_FLOAT64;
  // Integers of attributes marked as normalised are divided while they are converted.
  result.largest = attribute.normalized()     ? 1
                   : type == draco::DT_UINT8  ? 255
                   : type == draco::DT_INT8   ? 127
                   : type == draco::DT_UINT16 ? 65535
                   : type == draco::DT_INT16  ? 32767
                                              : 1;
  return result;
}

}  // namespace

std::optional<DracoMesh::Attribute> DracoMesh::find(Kind kind) const {
  constexpr std::array types{draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL,
                             draco::GeometryAttribute::COLOR, draco::GeometryAttribute::TEX_COORD};
  const int index = decoded_->mesh->GetNamedAttributeId(types[static_cast<std::size_t>(kind)]);
  if (index < 0) return std::nullopt;
  return describe_attribute(*decoded_->mesh, index);
}

std::optional<DracoMesh::Attribute> DracoMesh::find(std::uint32_t unique_id) const {
  const int index = decoded_->mesh->GetAttributeIdByUniqueId(unique_id);
  if (index < 0) return std::nullopt;
  return describe_attribute(*decoded_->mesh, index);
}

std::size_t DracoMesh::point_count() const { return decoded_->mesh->num_points(); }

std::vector<Triangle> DracoMesh::triangles() const {
  const draco::Mesh& mesh = *decoded_->mesh;
  std::vector<Triangle> triangles(mesh.num_faces());
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
    for (std::size_t corner = 0; corner < 3; ++corner) {
      triangles[i].v[corner] = face[corner].value();
      if (triangles[i].v[corner] >= mesh.num_points()) decoded_->fail("face " + std::to_string(i) + " is out of range");
    }
  }
  return triangles;
}

std::vector<double> DracoMesh::values(const Attribute& attribute, int components) const {
  const draco::PointAttribute& source = decoded_->at(attribute);
  std::vector<double> values;
  values.reserve(point_count() * static_cast<std::size_t>(components));
  for (std::uint32_t point = 0; point < point_count(); ++point) {
    const std::array<double, 4> value = decoded_->value(source, source.mapped_index(draco::PointIndex(point)).value());
    values.insert(values.end(), value.begin(), value.begin() + components);
  }
  return values;
}

std::vector<Vec3d> DracoMesh::distinct_values(const Attribute& attribute) const {
  const draco::PointAttribute& source = decoded_->at(attribute);
  std::vector<Vec3d> values(source.size());
  for (std::uint32_t i = 0; i < source.size(); ++i) {
    const std::array<double, 4> value = decoded_->value(source, i);
    values[i] = {value[0], value[1], value[2]};
  }
  return values;
}

std::vector<std::uint32_t> DracoMesh::value_of_points(const Attribute& attribute) const {
  const draco::PointAttribute& source = decoded_->at(attribute);
  std::vector<std::uint32_t> ids(point_count());
  for (std::uint32_t point = 0; point < ids.size(); ++point) {
    ids[point] = source.mapped_index(draco::PointIndex(point)).value();
    if (ids[point] >= source.size()) decoded_->fail("point " + std::to_string(point) + " is out of range");
  }
  return ids;
}

namespace {

// Wedges are points; every attribute has a value at each.
RawWedges read_wedges(const DracoMesh& source, std::vector<Triangle>&& point_triangles) {
  using Kind = DracoMesh::Kind;
  RawWedges wedges;
  if (const auto normal = source.find(Kind::normal); normal && normal->components == 3) {
    const std::vector<double> values = source.values(*normal, 3);
    wedges.normal.reserve(source.point_count());
    for (std::size_t i = 0; i < values.size(); i += 3)
      wedges.normal.push_back(unit_normal({values[i], values[i + 1], values[i + 2]}));
  }
  if (const auto colour = source.find(Kind::colour); colour && colour->components >= 3) {
    const std::vector<double> values = source.values(*colour, 4);
    const auto byte = [&](double value) { return unit_to_byte(value / colour->largest); };
    wedges.colour.reserve(source.point_count());
    for (std::size_t i = 0; i < values.size(); i += 4)
      wedges.colour.push_back({byte(values[i]), byte(values[i + 1]), byte(values[i + 2]),
                               colour->components > 3 ? byte(values[i + 3]) : std::uint8_t{255}});
  }
  if (const auto uv = source.find(Kind::texture_coordinate); uv && uv->components >= 2) {
    const std::vector<double> values = source.values(*uv, 2);
    wedges.uv.reserve(source.point_count());
    for (std::size_t i = 0; i < values.size(); i += 2) wedges.uv.push_back(from_lower_left(values[i], values[i + 1]));
  }
  if (!wedges.empty()) wedges.corners = std::move(point_triangles);
  return wedges;
}

}  // namespace

RawMesh read_draco(ByteReader& input, const ReadConfig& config) {
  const std::vector<char> bytes = read_all(input);
  const DracoMesh source(bytes, input.name(), "");
  const auto position = source.find(DracoMesh::Kind::position);
  if (!position || position->components != 3)
    throw InputError(describe(input.name(), "", "has no positions of three coordinates", "give a mesh of triangles"));

  // The values of the position attribute are the vertices; points are finer.
  RawMesh mesh;
  mesh.positions = source.distinct_values(*position);
  mesh.triangles = source.triangles();
  const std::vector<std::uint32_t> vertex_of = source.value_of_points(*position);
  std::vector<Triangle> points;
  if (config.attributes) points = mesh.triangles;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& id : t.v) id = vertex_of[id];
  if (config.attributes) mesh.wedges = read_wedges(source, std::move(points));
  return mesh;
}

}  // namespace lodestone
