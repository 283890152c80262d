// The pictures of a flight in a folder.
#pragma once

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

  // Writes frame `index`; an empty image is passed over.
  void add(std::size_t index, Image image);
  void finish();

 private:
  std::string folder_;
  std::size_t frames_;
  std::vector<Image> sheet_;
  std::vector<std::string> written_;
  bool created_ = false, finished_ = false;
};

}  // namespace lodestone
