#include "experiments/command_line/picture_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/temporaries.h"

namespace lodestone {

PictureWriter::PictureWriter(std::string folder, std::size_t frames) : folder_(std::move(folder)), frames_(frames) {
  std::error_code error;
  created_ = std::filesystem::create_directories(folder_, error);
  if (error)
    throw FileError(
        describe(folder_, "", "cannot create the folder: " + error.message(), "name a folder you may write to"));
  remove_orphans(folder_, [](std::string_view name) {
    return name == "contact.png" || (name.starts_with("frame") && name.ends_with(".png"));
  });
}

PictureWriter::~PictureWriter() {
  if (finished_) return;
  std::error_code ignored;
  for (const std::string& file : written_) std::filesystem::remove(file, ignored);
  if (created_) std::filesystem::remove(folder_, ignored);
}

void PictureWriter::add(std::size_t index, Image image) {
  if (image.rgba.empty()) return;
  const std::string file = fmt::format("{}/frame{:04}.png", folder_, index);
  encode(image);
  AtomicFile out(file);
  out.write(bytes_);
  out.commit();
  written_.push_back(file);
  constexpr std::size_t on_sheet = 12;
  const std::size_t steps = std::min(frames_, on_sheet);
  if (sheet_.size() < steps && index * (steps - 1) >= sheet_.size() * (frames_ - 1)) sheet_.push_back(std::move(image));
}

void PictureWriter::encode(const Image& image) {
  if (image.size == last_.size && image.rgba == last_.rgba) return;
  bytes_ = encode_png(image);
  last_ = image;
  ++encoded_;
}

void PictureWriter::finish() {
  if (!sheet_.empty()) write_png(folder_ + "/contact.png", contact_sheet(sheet_));
  finished_ = true;
}

}  // namespace lodestone
