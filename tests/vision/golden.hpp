#pragma once

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cairn/vision/freak.hpp"

#include "grey_image.hpp"

namespace cairn::test {

/// Binary PGM (P5, 8 bits, no comments); empty when it cannot be read.
inline GreyImage read_pgm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int maximum = 0;
  GreyImage image;
  file >> magic >> image.width >> image.height >> maximum;
  file.get();
  if (!file || magic != "P5" || maximum != 255) return {};
  image.pixels.resize(static_cast<std::size_t>(image.width) * image.height);
  file.read(reinterpret_cast<char*>(image.pixels.data()),
            static_cast<std::streamsize>(image.pixels.size()));
  if (!file) return {};
  return image;
}

/// Rows of a CSV file without its header, each as its fields.
inline std::vector<std::vector<std::string>> read_csv(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> fields;
    std::istringstream cells(line);
    std::string cell;
    while (std::getline(cells, cell, ',')) fields.push_back(cell);
    rows.push_back(fields);
  }
  return rows;
}

inline std::string to_hex(const Descriptor& descriptor) {
  static const char* const digits = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : descriptor.bytes) {
    hex += digits[byte >> 4];
    hex += digits[byte & 15];
  }
  return hex;
}

}  // namespace cairn::test
