#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

/// Sides that a picture may have, px.
inline constexpr int kLeastImageSide = 16;
inline constexpr int kLargestImageSide = 16384;

/// Keys of one object of a camera file. It keeps the path to them for messages, and remembers which
/// were read, so that what a format does not know can be told from what it does not need.
class CameraSection {
 public:
  CameraSection(std::filesystem::path file, const nlohmann::json& object, std::string path = {});

  bool has(const std::string& key) const;
  /// Whether `key` is there and holds keys.
  bool has_child(const std::string& key) const;
  /// First of `keys` that is there, or empty. Two of them are refused: they may differ.
  std::string one_of(std::initializer_list<const char*> keys) const;
  std::vector<std::string> keys() const;
  std::vector<std::string> unread_keys() const;

  // Each of these throws InputError naming the key, `what` was expected and what was found.
  double number(const std::string& key, const std::string& what) const;
  std::string text(const std::string& key, const std::string& what) const;
  /// A list; lists in it are joined, and of a matrix {rows, cols, data} the data are taken.
  std::vector<double> numbers(const std::string& key, const std::string& what) const;
  /// rows x cols numbers, row by row: as one list, a list of rows, or {rows, cols, data}.
  std::vector<double> matrix(const std::string& key, int rows, int cols,
                             const std::string& what) const;
  /// A 4x4 pose, row by row, of at most 50 m; empty where the key is not there.
  std::optional<Rigid<double>> find_pose(const std::string& key) const;
  /// An image side.
  int extent(const std::string& key, const std::string& what) const;
  int to_extent(double value, const std::string& key) const;
  CameraSection child(const std::string& key) const;
  /// Element of a list of objects.
  CameraSection element(const std::string& key, std::size_t index) const;
  std::size_t length(const std::string& key) const;

  [[noreturn]] void fail(const std::string& key, const std::string& problem) const;
  /// The value of a key as it stands in the file, for messages.
  std::string shown(const std::string& key) const;
  /// Whether all numbers of a value are 0 (or it is empty, or says no); marks nothing as read.
  bool is_zero(const std::string& key) const;

 private:
  const nlohmann::json& take(const std::string& key, const std::string& what) const;
  double to_number(const nlohmann::json& value, const std::string& key,
                   const std::string& what) const;
  void collect(const nlohmann::json& list, const std::string& key, const std::string& what,
               std::vector<double>& values) const;

  std::filesystem::path file_;
  const nlohmann::json* object_;
  std::string path_;
  std::shared_ptr<std::set<std::string>> read_ = std::make_shared<std::set<std::string>>();
};

}  // namespace cairn::host
