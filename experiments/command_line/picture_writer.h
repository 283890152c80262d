// The pictures of a flight in a folder.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/frame/image.h"

namespace lodestone {

// The frames on disk, and a sheet of some of them. Unless finish() is reached, the frames are removed again: a folder
// holds a whole flight or nothing of it.
class PictureWriter {
 public:
  // Throws FileError when the folder cannot be made.
  PictureWriter(std::string folder, std::size_t frames);
  ~PictureWriter();
  PictureWriter(const PictureWriter&) = delete;
  PictureWriter& operator=(const PictureWriter&) = delete;

  // Writes frame `index`; an empty image is passed over. One that equals the frame before, as those of a camera at rest
  // do, is not encoded again.
  void add(std::size_t index, Image image);
  void finish();
  [[nodiscard]] std::size_t encoded() const { return encoded_; }  // frames so far

 private:
  void encode(const Image& image);

  std::string folder_;
  std::size_t frames_, encoded_ = 0;
  Image last_;
  std::vector<std::byte> bytes_;  // of last_ as a file
  std::vector<Image> sheet_;
  std::vector<std::string> written_;
  bool created_ = false, finished_ = false;
};

}  // namespace lodestone
