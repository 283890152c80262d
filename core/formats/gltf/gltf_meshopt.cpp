// The only file of core/ that names meshoptimizer.
#include "core/formats/gltf/gltf_meshopt.h"

#include <meshoptimizer.h>

#include <cstring>
#include <limits>
#include <string>

#include "core/files/text_scanner.h"
#include "core/formats/gltf/gltf_document.h"

namespace lodestone {
namespace {

// Checks what the decoders assume.
void check_layout(const JsonView& extension, const std::string& mode, std::uint64_t count, std::uint64_t stride) {
  if (mode == "ATTRIBUTES") {
    if (stride == 0 || stride > 256 || stride % 4 != 0)
      extension.fail("vertices of " + std::to_string(stride) + " bytes; the size has to be a multiple of 4 up to 256",
                     damaged_file);
  } else if (mode == "TRIANGLES" || mode == "INDICES") {
    if (stride != 2 && stride != 4) extension.fail("indices of " + std::to_string(stride) + " bytes", damaged_file);
    if (mode == "TRIANGLES" && count % 3 != 0)
      extension.fail(std::to_string(count) + " indices do not make triangles", damaged_file);
  } else {
    extension.fail("unknown mode " + quote(mode), damaged_file);
  }
}

void unfilter(const JsonView& extension, const std::string& filter, std::vector<char>& bytes, std::size_t count,
              std::size_t stride) {
  if (filter == "NONE") return;
  if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  } else if (filter == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  } else if (filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  } else {
    extension.fail("filter " + quote(filter) + " of " + std::to_string(stride) + " bytes", damaged_file);
  }
}

}  // namespace

std::vector<char> decompress_meshopt(const JsonView& extension, std::span<const char> packed) {
  const std::uint64_t count = extension.at("count").integer(), stride = extension.at("byteStride").integer();
  const std::string mode = extension.at("mode").string();
  check_layout(extension, mode, count, stride);
  if (count * stride > meshopt_densest * packed.size() + 4096 || count > (std::uint64_t{1} << 40))
    extension.fail("declares " + std::to_string(count) + " elements, more than " + std::to_string(packed.size()) +
                       " bytes can hold",
                   damaged_file);
  std::vector<char> bytes(count * stride);
  const auto* input = reinterpret_cast<const unsigned char*>(packed.data());
  int error = 0;
  if (mode == "ATTRIBUTES") {
    error = meshopt_decodeVertexBuffer(bytes.data(), count, stride, input, packed.size());
  } else if (mode == "TRIANGLES") {
    error = meshopt_decodeIndexBuffer(bytes.data(), count, stride, input, packed.size());
  } else {
    error = meshopt_decodeIndexSequence(bytes.data(), count, stride, input, packed.size());
  }
  if (error != 0) extension.fail("cannot be decoded", damaged_file);
  if (mode == "ATTRIBUTES") unfilter(extension, extension.string_or("filter", "NONE"), bytes, count, stride);
  return bytes;
}

std::vector<std::byte> compress_meshopt(std::span<const std::byte> bytes, std::size_t count, std::size_t stride,
                                        bool indices) {
  std::vector<std::byte> out;
  const auto to = [&] { return reinterpret_cast<unsigned char*>(out.data()); };
  if (indices) {
    std::vector<unsigned int> ids(count);
    for (std::size_t k = 0; k < count; ++k) std::memcpy(&ids[k], bytes.data() + k * stride, stride);
    meshopt_encodeIndexVersion(1);  // the version of the extension
    out.resize(meshopt_encodeIndexSequenceBound(count, std::numeric_limits<unsigned>::max()));
    out.resize(meshopt_encodeIndexSequence(to(), out.size(), ids.data(), count));
  } else {
    meshopt_encodeVertexVersion(0);
    out.resize(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(to(), out.size(), bytes.data(), count, stride));
  }
  return out;
}

}  // namespace lodestone
