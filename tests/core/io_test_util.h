// Mesh files in memory, for the tests of the readers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/io/mesh_file.h"

namespace lodestone {

[[nodiscard]] inline RawMesh read_bytes(std::string_view bytes, MeshFormat format) {
  ByteReader input({bytes.data(), bytes.size()}, "file");
  return read_mesh(input, format);
}

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

// Expects that reading throws E with all of `parts` in its message.
template <class E>
void expect_error(std::string_view bytes, MeshFormat format, std::initializer_list<std::string_view> parts) {
  try {
    (void)read_bytes(bytes, format);
    ADD_FAILURE() << "no error for: " << bytes.substr(0, 200);
  } catch (const E& error) {
    for (const std::string_view part : parts)
      EXPECT_NE(std::string_view(error.what()).find(part), std::string_view::npos) << error.what();
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << "one line, please";
  }
}

}  // namespace lodestone
