// Pictures one after the other in one file that every browser plays.
#pragma once

#include <span>
#include <string>

#include "render/frame/image.h"

namespace lodestone {

// An animated WebP that begins again at its end, a picture for `milliseconds` each, complete or not there; transparency
// is lost. Equal pictures give equal files. Throws InputError without pictures or where their sizes differ,
// ResourceError where libwebp fails, FileError where the file cannot be written.
void write_film(const std::string& file, std::span<const Image> pictures, int milliseconds);

}  // namespace lodestone
