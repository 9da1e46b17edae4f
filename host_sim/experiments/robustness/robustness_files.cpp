#include "host_sim/experiments/robustness/robustness_files.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "host_sim/io/output_file.hpp"

namespace cairn::host {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// The windows of one source and one way to play it.
struct Group {
  std::string source;
  bool truth = false;
  Playback playback;
  std::vector<WindowResult> windows;
};

const char* direction(const Playback& playback) {
  return playback.backward ? "backward" : "forward";
}

std::vector<Group> groups_of(const std::vector<RobustnessResult>& results) {
  std::vector<Group> groups;
  for (const RobustnessResult& result : results) {
    for (const WindowResult& window : result.windows) {
      const bool same = !groups.empty() && groups.back().source == result.source &&
                        groups.back().playback.backward == window.playback.backward &&
                        groups.back().playback.every == window.playback.every;
      if (!same) groups.push_back({result.source, result.truth, window.playback, {}});
      groups.back().windows.push_back(window);
    }
  }
  return groups;
}

template <class Value>
std::vector<double> sorted(const std::vector<WindowResult>& windows, Value value) {
  std::vector<double> values;
  std::transform(windows.begin(), windows.end(), std::back_inserter(values), value);
  std::sort(values.begin(), values.end());
  return values;
}

template <class Value>
double share(const std::vector<WindowResult>& windows, Value value) {
  return static_cast<double>(std::count_if(windows.begin(), windows.end(), value)) /
         static_cast<double>(windows.size());
}

double median(const std::vector<double>& sorted_values) {
  return sorted_values[sorted_values.size() / 2];
}

struct Figures {
  double success = 0.0, silent = 0.0;
  double tracked_median = 0.0, tracked_least = 0.0;
  double ate_median = 0.0, ate_worst = 0.0;
  double rotation_median = 0.0, rotation_worst = 0.0;
  double losses_mean = 0.0;
  std::optional<double> attitude_inside;  ///< mean over the windows that have it
};

Figures figures_of(const std::vector<WindowResult>& windows) {
  Figures figures;
  figures.success = share(windows, [](const WindowResult& w) { return w.success; });
  figures.silent = share(windows, [](const WindowResult& w) { return w.silent; });
  const auto tracked = sorted(windows, [](const WindowResult& w) { return w.tracked; });
  const auto ate = sorted(windows, [](const WindowResult& w) { return w.ate_m.value_or(kNone); });
  const auto rotation =
      sorted(windows, [](const WindowResult& w) { return w.rotation_deg.value_or(kNone); });
  figures.tracked_median = median(tracked);
  figures.tracked_least = tracked.front();
  figures.ate_median = median(ate);
  figures.ate_worst = ate.back();
  figures.rotation_median = median(rotation);
  figures.rotation_worst = rotation.back();
  double inside = 0.0;
  int judged = 0;
  for (const WindowResult& window : windows) {
    figures.losses_mean += static_cast<double>(window.losses) / static_cast<double>(windows.size());
    if (!window.attitude_inside.has_value()) continue;
    inside += *window.attitude_inside;
    ++judged;
  }
  if (judged > 0) figures.attitude_inside = inside / judged;
  return figures;
}

nlohmann::json number(const std::optional<double>& value) {
  return value.has_value() && *value < kNone ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

std::string cell(const std::optional<double>& value, int digits) {
  return value.has_value() && *value < kNone ? fmt::format("{:.{}f}", *value, digits) : "-";
}

nlohmann::json to_json(const WindowResult& window) {
  return {{"first_frame", window.first_frame},
          {"frames", window.frames},
          {"seed", window.seed},
          {"success", window.success},
          {"silent", window.silent},
          {"tracked", window.tracked},
          {"says_tracking", window.sure},
          {"ate_rmse_m", number(window.ate_m)},
          {"rotation_rmse_deg", number(window.rotation_deg)},
          {"attitude_in_3_sigma", number(window.attitude_inside)},
          {"losses", window.losses}};
}

nlohmann::json to_json(const Group& group) {
  const Figures figures = figures_of(group.windows);
  nlohmann::json windows = nlohmann::json::array();
  for (const WindowResult& window : group.windows) windows.push_back(to_json(window));
  return {
      {"source", group.source},
      {"truth", group.truth},
      {"playback", direction(group.playback)},
      {"every", group.playback.every},
      {"runs", group.windows.size()},
      {"success", figures.success},
      {"silent", figures.silent},
      {"tracked", {{"median", figures.tracked_median}, {"least", figures.tracked_least}}},
      {"ate_rmse_m",
       {{"median", number(figures.ate_median)}, {"worst", number(figures.ate_worst)}}},
      {"rotation_rmse_deg",
       {{"median", number(figures.rotation_median)}, {"worst", number(figures.rotation_worst)}}},
      {"attitude_in_3_sigma", number(figures.attitude_inside)},
      {"losses_mean", figures.losses_mean},
      {"windows", std::move(windows)}};
}

}  // namespace

std::string robustness_table(const std::vector<RobustnessResult>& results) {
  std::string table =
      "| source | played | runs | success | silent | tracked: median, least | ATE: median, worst, "
      "m "
      "| rotation: median, worst, deg | attitude in 3 sigma | losses a window |\n"
      "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const Group& group : groups_of(results)) {
    const Figures f = figures_of(group.windows);
    table += fmt::format(
        "| {} | {}, every {} | {} | {:.0f} % | {:.0f} % | {:.0f} %, {:.0f} % | {}, {} | {}, {} | "
        "{} "
        "| {:.1f} |\n",
        group.source, direction(group.playback), group.playback.every, group.windows.size(),
        100.0 * f.success, 100.0 * f.silent, 100.0 * f.tracked_median, 100.0 * f.tracked_least,
        cell(f.ate_median, 3), cell(f.ate_worst, 3), cell(f.rotation_median, 2),
        cell(f.rotation_worst, 2),
        f.attitude_inside ? fmt::format("{:.0f} %", 100.0 * *f.attitude_inside) : "-",
        f.losses_mean);
  }
  return table;
}

nlohmann::json to_json(const std::vector<RobustnessResult>& results,
                       const RobustnessSettings& settings) {
  nlohmann::json sets = nlohmann::json::array();
  for (const Group& group : groups_of(results)) sets.push_back(to_json(group));
  return {{"window_frames", settings.window_frames},
          {"step_frames", settings.step_frames},
          {"seeds", settings.seeds},
          {"filter", settings.filter},
          {"limits",
           {{"least_tracked", settings.least_tracked},
            {"ate_rmse_m", settings.max_ate_m},
            {"rotation_rmse_deg", settings.max_rotation_deg}}},
          {"sets", std::move(sets)}};
}

nlohmann::json whole_window(const WindowResult& window) {
  nlohmann::json result = to_json(window);
  result["number"] = window.number;
  result["backward"] = window.playback.backward;
  result["every"] = window.playback.every;
  return result;
}

WindowResult read_window(const nlohmann::json& from) {
  const auto figure = [&](const char* key) {
    const nlohmann::json& value = from.at(key);
    return value.is_null() ? std::nullopt : std::optional<double>(value.get<double>());
  };
  WindowResult window;
  from.at("number").get_to(window.number);
  from.at("backward").get_to(window.playback.backward);
  from.at("every").get_to(window.playback.every);
  from.at("first_frame").get_to(window.first_frame);
  from.at("frames").get_to(window.frames);
  from.at("seed").get_to(window.seed);
  from.at("success").get_to(window.success);
  from.at("silent").get_to(window.silent);
  from.at("tracked").get_to(window.tracked);
  from.at("says_tracking").get_to(window.sure);
  from.at("losses").get_to(window.losses);
  window.ate_m = figure("ate_rmse_m");
  window.rotation_deg = figure("rotation_rmse_deg");
  window.attitude_inside = figure("attitude_in_3_sigma");
  return window;
}

void write_windows(const std::filesystem::path& file,
                   const std::vector<RobustnessResult>& results) {
  OutputFile out(file);
  out.print(
      "source,playback,every,first_frame,frames,seed,success,silent,tracked,says_tracking,"
      "ate_rmse_m,rotation_rmse_deg,attitude_in_3_sigma,losses\n");
  for (const RobustnessResult& result : results) {
    for (const WindowResult& w : result.windows) {
      const auto field = [](const std::optional<double>& value) {
        return value.has_value() ? fmt::format("{:.6f}", *value) : std::string();
      };
      out.print("\"{}\",{},{},{},{},{},{},{},{:.6f},{:.6f},{},{},{},{}\n", result.source,
                direction(w.playback), w.playback.every, w.first_frame, w.frames, w.seed,
                w.success ? 1 : 0, w.silent ? 1 : 0, w.tracked, w.sure, field(w.ate_m),
                field(w.rotation_deg), field(w.attitude_inside), w.losses);
    }
  }
  out.finish();
}

}  // namespace cairn::host
