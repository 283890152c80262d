// Mesh files in memory, for the tests of the readers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/formats/mesh_reader.h"
#include "tests/core/mesh/wedge_checks.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone {

// Every mesh read by a test is checked for what readers promise of attributes.
[[nodiscard]] inline RawMesh read_bytes(std::string_view bytes, MeshFormat format, const ReadConfig& config = {},
                                        const std::string& name = "file") {
  ByteReader input({bytes.data(), bytes.size()}, name);
  RawMesh mesh = read_mesh(input, format, config);
  EXPECT_EQ(wedge_mistake(mesh), "");
  return mesh;
}

// The bytes of a file that passes for a PNG image, as far as readers look.
[[nodiscard]] inline std::string png_bytes(const std::string& rest = "pixels") { return "\x89PNG\r\n\x1a\n" + rest; }

// Puts binary values together, in either byte order.
class Bytes {
 public:
  explicit Bytes(std::string text = {}, std::endian order = std::endian::little)
      : text_(std::move(text)), order_(order) {}

  template <class T>
  Bytes& put(T value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (order_ == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    text_.append(bytes.data(), bytes.size());
    return *this;
  }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  std::string text_;
  std::endian order_;
};

// Expects an error of reading bytes.
template <class E>
void expect_error(std::string_view bytes, MeshFormat format, std::initializer_list<std::string_view> parts,
                  const std::string& name = "file") {
  expect_error_of<E>([&] { return read_bytes(bytes, format, {}, name); }, parts, bytes);
}

// Expects a warning with all of `parts`.
inline void expect_warning(const RawMesh& mesh, std::initializer_list<std::string_view> parts) {
  for (const std::string& warning : mesh.warnings)
    if (std::all_of(parts.begin(), parts.end(), [&](auto part) { return warning.find(part) != std::string::npos; }))
      return;
  ADD_FAILURE() << "no such warning" << (mesh.warnings.empty() ? "" : ", the first is: " + mesh.warnings.front());
}

}  // namespace lodestone
