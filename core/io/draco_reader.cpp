// Draco compressed meshes, decoded by libdraco. The only file that names it.
#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

#include <array>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/io/mesh_readers.h"

namespace lodestone {
namespace {

std::vector<char> read_all(ByteReader& input) {
  std::vector<char> bytes;
  bytes.reserve(input.remaining());
  for (std::string_view part = input.window(1); !part.empty(); part = input.window(1)) {
    bytes.insert(bytes.end(), part.begin(), part.end());
    input.advance(part.size());
  }
  return bytes;
}

[[noreturn]] void fail(const ByteReader& input, const std::string& what) {
  throw InputError(describe(input.name(), "", what, "the file is damaged, or is no Draco mesh"));
}

}  // namespace

RawMesh read_draco(ByteReader& input) {
  const std::vector<char> bytes = read_all(input);
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) fail(input, std::string("cannot decode: ") + decoded.status().error_msg());
  const std::unique_ptr<draco::Mesh> source = std::move(decoded).value();
  const draco::PointAttribute* attribute = source->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (!attribute || attribute->num_components() != 3) fail(input, "has no positions of three coordinates");

  // The values of the position attribute are the vertices. Draco's points are finer: one per combination of attributes.
  RawMesh mesh;
  mesh.positions.resize(attribute->size());
  for (std::uint32_t i = 0; i < attribute->size(); ++i) {
    std::array<double, 3> value;
    if (!attribute->ConvertValue<double, 3>(draco::AttributeValueIndex(i), value.data()))
      fail(input, "position " + std::to_string(i) + " cannot be converted");
    mesh.positions[i] = {value[0], value[1], value[2]};
  }
  mesh.triangles.resize(source->num_faces());
  for (std::uint32_t i = 0; i < source->num_faces(); ++i) {
    const draco::Mesh::Face& face = source->face(draco::FaceIndex(i));
    for (std::size_t corner = 0; corner < 3; ++corner) {
      if (face[corner].value() >= source->num_points()) fail(input, "face " + std::to_string(i) + " is out of range");
      const std::uint32_t id = attribute->mapped_index(face[corner]).value();
      if (id >= mesh.positions.size()) fail(input, "face " + std::to_string(i) + " is out of range");
      mesh.triangles[i].v[corner] = id;
    }
  }
  return mesh;
}

}  // namespace lodestone
