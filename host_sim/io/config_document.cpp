#include "host_sim/io/config_document.hpp"

#include <cctype>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/text_file.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kLargestFile = 8U << 20U;
constexpr std::size_t kMostLevels = 32;
constexpr int kMostValues = 500000;

/// Builds the tree from the parser's events: no alias is followed, and nothing grows beyond limits.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(fs::path file) : file_(std::move(file)) {}

  json take() { return std::move(root_); }
  bool is_empty() const { return root_.is_null() || root_ == json(json::value_t::string); }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { add(mark, ""); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    Level* const level = levels_.empty() ? nullptr : &levels_.back();
    if (level != nullptr && level->value.is_object() && !level->has_key) {
      if (level->value.contains(value)) {
        fail(mark, fmt::format("key '{}': expected it once, found it again", value));
      }
      level->key = value;
      level->has_key = true;
      return;
    }
    add(mark, value);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    fail(mark, "expected values, found a YAML alias (*name), which is not read");
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {
    open(mark, json::array());
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    open(mark, json::object());
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    json value;
    std::string key;
    bool has_key = false;
  };

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& problem) const {
    throw InputError(file_, mark.line + 1, problem);
  }

  void open(const YAML::Mark& mark, json value) {
    if (!levels_.empty() && levels_.back().value.is_object() && !levels_.back().has_key) {
      fail(mark, "expected a word as key, found a list or keys");
    }
    if (levels_.size() == kMostLevels) {
      fail(mark, fmt::format("expected at most {} levels of keys and lists", kMostLevels));
    }
    count(mark);
    levels_.push_back({std::move(value), {}, false});
  }

  void close() {
    json value = std::move(levels_.back().value);
    levels_.pop_back();
    put(std::move(value));
  }

  void add(const YAML::Mark& mark, const std::string& text) {
    count(mark);
    put(text);
  }

  void count(const YAML::Mark& mark) {
    if (++values_ > kMostValues) {
      fail(mark, fmt::format("expected at most {} values in a calibration", kMostValues));
    }
  }

  void put(json value) {
    if (levels_.empty()) {
      root_ = std::move(value);
    } else if (levels_.back().value.is_array()) {
      levels_.back().value.push_back(std::move(value));
    } else {
      levels_.back().value[levels_.back().key] = std::move(value);
      levels_.back().has_key = false;
    }
  }

  fs::path file_;
  std::vector<Level> levels_;
  json root_;
  int values_ = 0;
};

/// OpenCV writes the directive `%YAML:1.0`, which is not YAML; directives carry nothing we need.
std::string without_directives(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind('%', 0) != 0) result += line;
    result += '\n';
  }
  return result;
}

json parse_yaml(const fs::path& path, const std::string& text) {
  try {
    std::istringstream stream(without_directives(text));
    YAML::Parser parser(stream);
    TreeBuilder builder(path);
    parser.HandleNextDocument(builder);
    TreeBuilder after(path);
    if (parser.HandleNextDocument(after) && !after.is_empty()) {
      throw InputError(path, "expected one YAML document, found a second one after '---'");
    }
    return builder.take();
  } catch (const YAML::Exception& error) {
    throw InputError(path, error.mark.line + 1,
                     fmt::format("expected YAML, JSON or OpenCV's XML: {}", error.msg));
  }
}

/// OpenCV's reader of XML calls itself for every level.
void check_levels_of_xml(const fs::path& path, const std::string& text) {
  std::size_t level = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    const bool opens = text[i] == '<' && (std::isalpha(static_cast<unsigned char>(text[i + 1])) ||
                                          text[i + 1] == '_');
    const bool closes =
        (text[i] == '<' && text[i + 1] == '/') || (text[i] == '/' && text[i + 1] == '>');
    if (opens && ++level > kMostLevels) {
      throw InputError(path, fmt::format("expected at most {} levels of XML", kMostLevels));
    }
    if (closes && level > 0) --level;
  }
}

std::string text_of(const cv::FileNode& node) {
  if (node.isInt()) return fmt::format("{}", static_cast<int>(node));
  if (node.isReal()) return fmt::format("{}", static_cast<double>(node));
  return node.isString() ? static_cast<std::string>(node) : std::string();
}

json tree_of(const fs::path& path, const cv::FileNode& node) {
  if (node.isSeq()) {
    json list = json::array();
    for (const cv::FileNode& item : node) list.push_back(tree_of(path, item));
    return list;
  }
  if (!node.isMap()) return text_of(node);
  json object = json::object();
  for (const cv::FileNode& item : node) {
    if (object.contains(item.name())) {
      throw InputError(path, item.name(), "expected it once, found it again");
    }
    object[item.name()] = tree_of(path, item);
  }
  return object;
}

json parse_xml(const fs::path& path, const std::string& text) {
  check_levels_of_xml(path, text);
  try {
    const cv::FileStorage storage(
        text, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_XML);
    if (storage.isOpened()) return tree_of(path, storage.root());
  } catch (const cv::Exception& error) {
    throw InputError(path, fmt::format("expected OpenCV's XML (<opencv_storage>): {}", error.err));
  }
  throw InputError(path, "expected OpenCV's XML (<opencv_storage>)");
}

/// `[image]` of an INI file's first line that is no comment; empty where the text is none. A list
/// of YAML or JSON begins with more than one word.
std::string ini_section(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.front() == ';') continue;
    const bool bracketed = content.size() > 2 && content.front() == '[' && content.back() == ']' &&
                           std::isalpha(static_cast<unsigned char>(content[1])) != 0;
    const bool list = content.find_first_of(",:{\"") != std::string_view::npos;
    return bracketed && !list ? std::string(content) : std::string();
  }
  return {};
}

}  // namespace

std::string read_config_text(const fs::path& path, const std::string& what) {
  const std::string text = read_text(path, kLargestFile, what);
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {  // line ends of any system
    if (text[i] != '\r') {
      result += text[i];
    } else if (i + 1 == text.size() || text[i + 1] != '\n') {
      result += '\n';
    }
  }
  return result;
}

json parse_config_document(const fs::path& path, const std::string& text) {
  const std::string ini = ini_section(text);
  if (!ini.empty()) {
    throw InputError(path, fmt::format("expected YAML, JSON or OpenCV's XML, found an INI file "
                                       "({}); calibration programs write YAML as well",
                                       ini));
  }
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '<' ? parse_xml(path, text)
                                                          : parse_yaml(path, text);
}

}  // namespace cairn::host
