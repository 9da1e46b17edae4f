#include "host_sim/io/picture_folder.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/picture_name.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 6> kRead = {".png", ".jpg", ".jpeg", ".pgm", ".ppm", ".bmp"};
constexpr std::array<const char*, 6> kVideos = {".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v"};
constexpr std::array<const char*, 10> kNotRead = {".tif",  ".tiff", ".webp", ".heic", ".heif",
                                                  ".avif", ".dng",  ".raw",  ".exr",  ".jp2"};
constexpr std::int64_t kYear2001_s = 1000000000;
constexpr std::int64_t kYear2100_s = 4100000000;
constexpr std::int64_t kLargestFrameNumberStep = 1000;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

template <std::size_t N>
bool ends_in_one_of(const fs::path& path, const std::array<const char*, N>& endings) {
  const std::string ending = lower(path.extension().string());
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

std::vector<fs::path> paths_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::optional<fs::path> not_read;
  std::optional<fs::path> video;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().front() == '.') continue;
    if (ends_in_one_of(entry.path(), kRead)) paths.push_back(entry.path());
    if (ends_in_one_of(entry.path(), kNotRead)) not_read = entry.path();
    if (ends_in_one_of(entry.path(), kVideos)) video = entry.path();
  }
  if (not_read.has_value()) {
    throw InputError(*not_read, "expected pictures as PNG, JPEG, PGM, PPM or BMP: convert it");
  }
  if (paths.empty()) {
    throw InputError(folder,
                     fmt::format("expected images named NUMBER{}{}", fmt::join(kRead, " or "),
                                 video ? "; a video is given by its own name: " + video->string()
                                       : std::string()));
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Which number of the names is the frame's: the one in which they differ, the last of one name.
std::size_t counting_number(const std::vector<PictureName>& names) {
  const PictureName& first = names.front();
  for (const PictureName& name : names) {
    if (name.numbers.empty()) throw InputError(name.path, "expected a number in an image's name");
    if (name.texts == first.texts) continue;
    throw InputError(name.path,
                     fmt::format("expected images whose names differ in one number alone, found "
                                 "'{}' beside '{}'",
                                 name.shown(), first.shown()));
  }
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < first.numbers.size(); ++i) {
    const auto other = std::find_if(names.begin(), names.end(), [&](const PictureName& name) {
      return name.numbers[i] != first.numbers[i];
    });
    if (other == names.end()) continue;
    if (found.has_value()) {
      throw InputError(other->path,
                       fmt::format("expected images whose names differ in one number alone, found "
                                   "'{}' beside '{}'",
                                   other->shown(), first.shown()));
    }
    found = i;
  }
  return found.value_or(first.numbers.size() - 1);
}

/// Which numbers of all names are seconds with decimals, where the names are alike otherwise.
std::optional<std::size_t> common_decimal_seconds(const std::vector<PictureName>& names) {
  const PictureName& first = names.front();
  const std::optional<std::size_t> seconds = first.decimal_seconds();
  if (!seconds.has_value()) return std::nullopt;
  for (const PictureName& name : names) {
    if (name.texts != first.texts || name.decimal_seconds() != seconds) return std::nullopt;
    for (std::size_t i = 0; i < name.numbers.size(); ++i) {
      const bool of_time = i == *seconds || i == *seconds + 1;
      if (!of_time && name.numbers[i] != first.numbers[i]) return std::nullopt;
    }
  }
  return seconds;
}

/// How unevenly times follow one another, us; a gap counts as a second at most.
std::int64_t unevenness_us(std::vector<std::int64_t> times_us) {
  std::sort(times_us.begin(), times_us.end());
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < times_us.size(); ++i) steps.push_back(times_us[i] - times_us[i - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const std::int64_t median = *middle;
  std::int64_t sum = 0;
  for (const std::int64_t step : steps) {
    sum += std::min<std::int64_t>(std::abs(step - median), 1000000);
  }
  return sum;
}

/// SECONDS.NANOSECONDS without leading zeros (1.5000000 for 1.005) is no decimal number. Told by
/// the order that it makes: whole nanoseconds, or microseconds, follow one another more evenly. A
/// fraction that begins with 0 has kept its zeros.
void refuse_lost_zeros(const std::vector<PictureName>& names, std::size_t seconds) {
  constexpr std::size_t kFewest = 5;  // to see an order
  if (names.size() < kFewest) return;
  std::size_t longest = 0;
  std::size_t shortest = std::numeric_limits<std::size_t>::max();
  for (const PictureName& name : names) {
    const std::string& fraction = name.numbers[seconds + 1];
    if (fraction.size() > 1 && fraction.front() == '0') return;
    longest = std::max(longest, fraction.size());
    shortest = std::min(shortest, fraction.size());
  }
  if (longest == shortest || longest > 9) return;
  std::vector<std::int64_t> decimal_us;
  std::vector<std::int64_t> counted_us;
  const PictureName* short_one = nullptr;
  for (const PictureName& name : names) {
    const std::string& fraction = name.numbers[seconds + 1];
    if (fraction.size() == shortest) short_one = &name;
    const std::int64_t count = to_number(name.path, fraction);
    decimal_us.push_back(decimal_time_us(name, seconds));
    counted_us.push_back(1000000 * to_number(name.path, name.numbers[seconds]) +
                         (longest > 6   ? count / 1000
                          : longest > 3 ? count
                                        : 1000 * count));
  }
  if (2 * unevenness_us(std::move(counted_us)) >= unevenness_us(std::move(decimal_us))) return;
  throw InputError(short_one->path,
                   fmt::format("expected seconds with decimals as name; the digits behind the "
                               "point seem to be {} without their leading zeros: rename the images",
                               longest > 6   ? "nanoseconds"
                               : longest > 3 ? "microseconds"
                                             : "milliseconds"));
}

/// Digits behind a point are a fraction where their count varies, and then no frame number.
void refuse_fractions(const std::vector<PictureName>& names, std::size_t index) {
  if (index == 0 || names.front().texts[index] != ".") return;
  for (const PictureName& name : names) {
    if (name.numbers[index].size() == names.front().numbers[index].size()) continue;
    throw InputError(name.path,
                     fmt::format("expected frame numbers of one length behind the point, or times "
                                 "alone, as names; found '{}' beside '{}'",
                                 name.shown(), names.front().shown()));
  }
}

struct Entry {
  std::int64_t value = 0;  ///< a number, or a time in us
  fs::path path;
};

void sort_by_value(std::vector<Entry>& entries) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.value < b.value || (a.value == b.value && a.path < b.path);
  });
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (entries[i].value != entries[i - 1].value) continue;
    throw InputError(entries[i].path,
                     fmt::format("expected one image for each number, found a second one beside "
                                 "'{}'",
                                 entries[i - 1].path.filename().string()));
  }
}

/// Units in a second of a number that is a time since 1970 by its size; 0: it is none.
std::int64_t units_per_second(std::int64_t number) {
  for (std::int64_t units : {1, 1000, 1000000, 1000000000}) {
    if (number / units >= kYear2001_s && number / units < kYear2100_s) return units;
  }
  return 0;
}

/// The same for numbers of another origin: by their steps.
std::int64_t units_per_second_by_step(const fs::path& folder, const std::vector<Entry>& entries) {
  if (entries.size() < 2) return 0;
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    steps.push_back(entries[i].value - entries[i - 1].value);
  }
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  const std::int64_t step = steps[steps.size() / 2];
  if (step < kLargestFrameNumberStep) return 0;
  if (step < 1000000) return 1000000;
  if (step < 1000000000) return 1000000000;
  throw InputError(folder, fmt::format("expected frame numbers, or times in us or ns, as names; "
                                       "found numbers that step by {}",
                                       step));
}

std::int64_t to_us(std::int64_t value, std::int64_t units) {
  if (units <= 1000000) return value * (1000000 / units);
  const std::int64_t divisor = units / 1000000;
  return value / divisor + (value % divisor >= divisor / 2 ? 1 : 0);
}

const char* unit_name(std::int64_t units) {
  return units == 1 ? "s" : units == 1000 ? "ms" : units == 1000000 ? "us" : "ns";
}

PictureFolder timed(std::vector<Entry> entries, const std::string& unit) {
  sort_by_value(entries);
  PictureFolder folder;
  for (Entry& entry : entries) {
    folder.files.push_back({static_cast<int>(folder.files.size()), std::move(entry.path)});
    folder.t_us.push_back(entry.value);
  }
  folder.note = fmt::format("times from the names of the pictures ({})", unit);
  return folder;
}

PictureFolder numbered(const std::vector<Entry>& entries) {
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  const std::int64_t offset = entries.back().value > kMost ? entries.front().value : 0;
  if (entries.back().value - offset > kMost) {
    throw InputError(entries.back().path,
                     fmt::format("expected a frame number at most {} above the first one", kMost));
  }
  PictureFolder folder;
  for (const Entry& entry : entries) {
    folder.files.push_back({static_cast<int>(entry.value - offset), entry.path});
  }
  if (offset > 0) folder.note = fmt::format("frames counted from number {} on", offset);
  return folder;
}

/// A clock's digits are no frame numbers, and its seconds no times of frames.
void refuse_dates(const std::vector<PictureName>& names) {
  if (!std::all_of(names.begin(), names.end(), ends_in_date_time)) return;
  throw InputError(names.front().path,
                   "expected a frame number, or a time in s, ms, us or ns, as name; found a date "
                   "with time of day: rename the images to their frame numbers");
}

}  // namespace

std::vector<fs::path> list_picture_files(const fs::path& folder) {
  require_folder(folder, "a folder of images");
  return paths_in(folder);
}

PictureFolder list_pictures(const fs::path& folder) {
  require_folder(folder, "a folder of images");
  const std::vector<fs::path> paths = paths_in(folder);
  const std::vector<PictureName> names(paths.begin(), paths.end());
  std::vector<Entry> entries;
  if (const auto seconds = common_decimal_seconds(names)) {
    refuse_lost_zeros(names, *seconds);
    for (const PictureName& name : names) {
      entries.push_back({decimal_time_us(name, *seconds), name.path});
    }
    return timed(std::move(entries), "s");
  }
  refuse_dates(names);
  const std::size_t index = counting_number(names);
  refuse_fractions(names, index);
  std::int64_t units =
      units_per_second(to_number(names.front().path, names.front().numbers[index]));
  for (const PictureName& name : names) {
    entries.push_back({to_number(name.path, name.numbers[index]), name.path});
    if (units_per_second(entries.back().value) != units) units = 0;
  }
  sort_by_value(entries);
  if (units == 0) units = units_per_second_by_step(folder, entries);
  if (units == 0) return numbered(entries);
  for (Entry& entry : entries) entry.value = to_us(entry.value, units);
  return timed(std::move(entries), unit_name(units));
}

std::vector<NumberedFile> list_numbered_files(const fs::path& folder, const std::string& prefix,
                                              const std::vector<std::string>& suffixes) {
  require_folder(folder, "a folder of images");
  std::vector<Entry> entries;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    for (const std::string& suffix : suffixes) {
      if (name.size() <= prefix.size() + suffix.size() || name.rfind(prefix, 0) != 0) continue;
      const std::size_t end = name.size() - suffix.size();
      if (lower(name.substr(end)) != suffix) continue;
      const std::string digits = name.substr(prefix.size(), end - prefix.size());
      if (!std::all_of(digits.begin(), digits.end(), is_digit)) continue;
      const std::int64_t number = to_number(entry.path(), digits);
      if (number > std::numeric_limits<int>::max()) {
        throw InputError(entry.path(), fmt::format("expected a frame number of at most {}",
                                                   std::numeric_limits<int>::max()));
      }
      entries.push_back({number, entry.path()});
    }
  }
  if (entries.empty()) {
    throw InputError(folder, fmt::format("expected images named {}NUMBER{}", prefix,
                                         fmt::join(suffixes, " or ")));
  }
  sort_by_value(entries);
  return numbered(entries).files;
}

}  // namespace cairn::host
