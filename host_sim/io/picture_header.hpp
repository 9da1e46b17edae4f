#pragma once

#include <optional>
#include <string_view>

namespace cairn::host {

/// What the first bytes of a picture say, read without decoding it.
struct PictureHeader {
  int width = 0;  ///< as stored: a JPEG may say that it is to be turned
  int height = 0;
  int bits = 8;         ///< of a sample
  int brightest = 255;  ///< largest value of a sample that the file allows
  bool whole = false;   ///< the bytes reach the picture's end mark; more may follow behind it
};

/// Reads the header of a PNG, JPEG, PGM, PPM or BMP; empty for anything else, and where `bytes`
/// ends before it is complete. `bytes` is the file or its beginning.
std::optional<PictureHeader> read_picture_header(std::string_view bytes);

}  // namespace cairn::host
