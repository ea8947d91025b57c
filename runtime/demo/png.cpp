// SPDX-License-Identifier: MIT
//
// libpng's simplified interface (png_image), which needs neither setjmp nor callbacks.
#include "png.hpp"

#include <png.h>

#include <string>
#include <system_error>

namespace crowded_room {

using spheretree::Done;
using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;

namespace {

png_image blank() {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  return image;
}

}  // namespace

Result<Done> writePng(const std::filesystem::path& path, const Image& image) {
  png_image header = blank();
  header.width = static_cast<png_uint_32>(image.size.width);
  header.height = static_cast<png_uint_32>(image.size.height);
  header.format = PNG_FORMAT_RGB;
  std::filesystem::path part = path;
  part += ".part";
  std::string reason;
  if (png_image_write_to_file(&header, part.c_str(), 0, image.rgb.data(), 0, nullptr) == 0) {
    reason = header.message;
  } else {
    std::error_code error;
    std::filesystem::rename(part, path, error);
    if (!error) return Done{};
    reason = error.message();
  }
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  return Error{ErrorCode::UnwritableOutput, path.string() + ": cannot be written: " + reason};
}

Result<Image> readPng(const std::filesystem::path& path) {
  png_image header = blank();
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0)
    return Error{ErrorCode::UnreadableInput, path.string() + ": " + header.message};
  header.format = PNG_FORMAT_RGB;
  Image image{{static_cast<int>(header.width), static_cast<int>(header.height)}, {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  if (png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr) == 0)
    return Error{ErrorCode::UnreadableInput, path.string() + ": " + header.message};
  return image;
}

}  // namespace crowded_room
