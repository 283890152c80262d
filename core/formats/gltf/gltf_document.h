// A glTF 2.0 file as JSON and the bytes that it refers to: chunks, buffers, buffer views, compressed or not.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/files/json.h"
#include "core/files/json_view.h"
#include "core/formats/common/companion_files.h"
#include "core/math/affine.h"

namespace lodestone {

inline constexpr const char* damaged_file = "the file is damaged";  // what messages advise

struct GltfView {
  std::span<const char> bytes;  // decompressed
  std::size_t stride = 0;       // distance of the elements in bytes; 0: they are adjacent
};

class GltfDocument {
 public:
  // Text (.gltf) or binary (.glb), told apart by the first bytes. Checks chunks, version and required extensions.
  // Throws InputError for damaged files, UnsupportedError for glTF 1 and for an unknown required extension.
  explicit GltfDocument(ByteReader& input);
  GltfDocument(const GltfDocument&) = delete;  // views refer to it
  GltfDocument& operator=(const GltfDocument&) = delete;

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] JsonView root() const { return {json_, file_}; }
  // Item `index` of a top-level array; `reference` is the value that holds the index, for the message.
  [[nodiscard]] JsonView item(const char* array, const JsonView& reference) const;

  // The bytes of a buffer view, loaded and decompressed at the first call; they live as long as this object.
  // Throws InputError when the buffer is missing or the view reaches beyond it.
  [[nodiscard]] GltfView view(const JsonView& reference);

  // Bytes of the file and of the files that its buffers are in, as far as these have been used.
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  void read_binary(std::span<const char> bytes);
  void check_asset() const;
  [[nodiscard]] std::span<const char> buffer(const JsonView& reference);
  using Bytes = std::shared_ptr<const std::vector<char>>;
  [[nodiscard]] Bytes load_buffer(const JsonView& description, std::size_t index);
  [[nodiscard]] std::span<const char> part_of_buffer(const JsonView& range);

  std::string file_;
  CompanionFiles files_;
  std::vector<char> bytes_;       // of a binary file
  std::span<const char> binary_;  // its second chunk
  Json json_;
  std::uint64_t size_ = 0;
  std::map<std::size_t, Bytes> buffers_;                   // by index
  std::map<std::filesystem::path, Bytes> beside_;          // files, which several buffers may name
  std::map<std::size_t, std::vector<char>> decompressed_;  // by index of view
  std::uint64_t decompressed_bytes_ = 0;
};

// A 4 x 4 matrix by columns. Throws InputError when its last row is not (0, 0, 0, 1).
[[nodiscard]] Affine3d affine_of(const JsonView& matrix);

}  // namespace lodestone
