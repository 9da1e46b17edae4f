#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cairn::host {

/// A file of a numbered sequence.
struct NumberedFile {
  int number = 0;
  std::filesystem::path path;
};

/// Files in `folder` whose name is `prefix`, digits and one of `suffixes`, by number. Numbers may
/// start anywhere and have gaps; `suffixes` are compared without regard to case. Throws InputError
/// when there is no such file, or a number that is there twice or has more than 31 bits.
std::vector<NumberedFile> list_numbered_files(const std::filesystem::path& folder,
                                              const std::string& prefix,
                                              const std::vector<std::string>& suffixes);

/// Pictures (.png, .jpg, .jpeg, .pgm, .ppm, .bmp in any case) of a folder by name, whatever the
/// names are. Throws InputError where there is none, or one of a format that is not read.
std::vector<std::filesystem::path> list_picture_files(const std::filesystem::path& folder);

/// The pictures of a folder in order.
struct PictureFolder {
  std::vector<NumberedFile> files;
  /// Of each file, strictly increasing, where the names are times; else empty.
  std::vector<std::int64_t> t_us;
  std::string note;  ///< what was made of the names
};

/// Pictures (.png, .jpg, .jpeg, .pgm, .ppm, .bmp in any case) of a folder, in the order of the
/// numbers in their names. Other files and hidden ones are left alone.
///
/// All names are alike but for one number of at most 64 bits:
/// - a frame number, whatever it starts at;
/// - a time since 1970 of 10 (s), 13 (ms), 16 (us) or 19 (ns) digits, or 1305031102.975304 (s);
/// - a time of another origin in us or ns, told by steps of 1000 or more: the unit in which the
///   middle step is from 1 ms to 1 s.
/// Pictures that are named by times are numbered from 0.
///
/// Throws InputError, naming the files, for names without a number or that differ in more than one,
/// for a number that is there twice or does not fit, for dates with a time of day, and for pictures
/// of another format among them.
PictureFolder list_pictures(const std::filesystem::path& folder);

}  // namespace cairn::host
