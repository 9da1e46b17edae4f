#include "host_sim/commands/relocalisation_command.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/base/statistics.hpp"
#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/progress.hpp"
#include "host_sim/experiments/relocalisation/cut.hpp"
#include "host_sim/experiments/relocalisation/kidnap.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/reports/build_info.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/sources/data_sets.hpp"

namespace cairn::host {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(KidnapTrial, number, kind, length, start, frames_to_recovery,
                                   relocalised, error_m, undisturbed_error_m, claimed_squared,
                                   jump_squared, claimed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CutTrial, number, kind, length, start, library, said_lost,
                                   frames_to_seen, frames_to_recovery, tracking, recovery_error_m,
                                   error_m, undisturbed_error_m)

namespace {

constexpr int kFramesPerSecond = 30;

struct RelocalisationOptions {
  KidnapSettings kidnap;
  CutSettings cut;
  std::string source;         ///< empty: the built-in hall
  std::optional<int> trials;  ///< of each kind and length
  std::vector<int> lengths;
  Shard shard;
  std::filesystem::path out;
};

bool recovered(const KidnapTrial& trial) {
  return trial.frames_to_recovery >= 0 && trial.frames_to_recovery <= 2 * kFramesPerSecond;
}

/// 3 sigma of the normal distribution in 3 degrees of freedom.
double three_sigma_squared() {
  static const double value = chi_square_quantile(3.0, 0.9973);
  return value;
}

bool is_false(const KidnapTrial& trial) {
  return trial.claimed && trial.jump_squared > three_sigma_squared();
}

bool is_overconfident(const KidnapTrial& trial) {
  return trial.claimed && trial.claimed_squared > three_sigma_squared();
}

nlohmann::json summarise(const std::vector<KidnapTrial>& trials, KidnapKind kind, int length) {
  int count = 0, in_time = 0, wrong = 0, overconfident = 0, by_library = 0;
  std::vector<double> frames;
  double worst_error = 0.0, worst_undisturbed = 0.0;
  for (const KidnapTrial& trial : trials) {
    if (trial.kind != kind || trial.length != length) continue;
    ++count;
    in_time += recovered(trial) ? 1 : 0;
    wrong += is_false(trial) ? 1 : 0;
    overconfident += is_overconfident(trial) ? 1 : 0;
    by_library += trial.relocalised ? 1 : 0;
    if (trial.frames_to_recovery >= 0) frames.push_back(trial.frames_to_recovery);
    worst_error = std::max(worst_error, trial.error_m);
    worst_undisturbed = std::max(worst_undisturbed, trial.undisturbed_error_m);
  }
  std::sort(frames.begin(), frames.end());
  return {{"kind", to_string(kind)},
          {"frames_blind", length},
          {"trials", count},
          {"recovered_in_2_s", in_time},
          {"false_recoveries", wrong},
          {"outside_own_3_sigma", overconfident},
          {"by_library", by_library},
          {"median_frames",
           frames.empty() ? nlohmann::json(nullptr) : nlohmann::json(frames[frames.size() / 2])},
          {"worst_error_m", worst_error},
          {"worst_undisturbed_error_m", worst_undisturbed}};
}

void write_trials(const std::filesystem::path& folder, const std::vector<KidnapTrial>& trials) {
  OutputFile file(folder / "kidnapped.csv");
  file.print(
      "kind,frames_blind,start,frames_to_recovery,relocalised,tracking,"
      "recovery_error_m,error_m,undisturbed_error_m,claimed_squared,jump_squared\n");
  for (const KidnapTrial& t : trials) {
    file.print("{},{},{},{},{},{},{:.4f},{:.4f},{:.3f},{:.3f}\n", to_string(t.kind), t.length,
               t.start, t.frames_to_recovery, t.relocalised ? 1 : 0, t.claimed ? 1 : 0, t.error_m,
               t.undisturbed_error_m, t.claimed_squared, t.jump_squared);
  }
  file.finish();
}

nlohmann::json summarise(const std::vector<CutTrial>& trials, CutKind kind, int length) {
  constexpr double kFalse_m = 0.3;
  int count = 0, seen = 0, in_time = 0, wrong = 0, silent = 0;
  std::vector<double> errors, undisturbed;
  for (const CutTrial& trial : trials) {
    if (trial.kind != kind || trial.length != length) continue;
    ++count;
    seen += trial.frames_to_seen >= 0;
    in_time += trial.frames_to_recovery >= 0 && trial.frames_to_seen >= 0 &&
               trial.frames_to_recovery - trial.frames_to_seen <= 2 * kFramesPerSecond;
    wrong += trial.frames_to_recovery >= 0 && trial.recovery_error_m > kFalse_m ? 1 : 0;
    silent += trial.said_lost ? 0 : 1;
    if (!trial.tracking) continue;
    errors.push_back(trial.error_m);
    undisturbed.push_back(trial.undisturbed_error_m);
  }
  const auto median = [](std::vector<double>& v) {
    if (v.empty()) return nlohmann::json(nullptr);
    std::sort(v.begin(), v.end());
    return nlohmann::json(v[v.size() / 2]);
  };
  return {{"kind", to_string(kind)},
          {"frames_blind", length},
          {"trials", count},
          {"seen_again", seen},
          {"recovered_in_2_s", in_time},
          {"false_recoveries", wrong},
          {"loss_not_reported", silent},
          {"median_error_m", median(errors)},
          {"median_undisturbed_error_m", median(undisturbed)}};
}

void write_trials(const std::filesystem::path& folder, const std::vector<CutTrial>& trials) {
  OutputFile file(folder / "cut.csv");
  file.print(
      "kind,frames_blind,start,library,said_lost,frames_to_seen,frames_to_recovery,tracking,"
      "recovery_error_m,error_m,undisturbed_error_m\n");
  for (const CutTrial& t : trials) {
    file.print("{},{},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f}\n", to_string(t.kind), t.length,
               t.start, t.library, t.said_lost ? 1 : 0, t.frames_to_seen, t.frames_to_recovery,
               t.tracking ? 1 : 0, t.recovery_error_m, t.error_m, t.undisturbed_error_m);
  }
  file.finish();
}

template <class Trial>
std::vector<Trial> trials_of(const PartialResult& whole) {
  std::vector<Trial> trials;
  for (const auto& [number, trial] : whole.pieces) trials.push_back(trial.template get<Trial>());
  return trials;
}

template <class Trial>
void add_pieces(const std::vector<Trial>& trials, PartialResult& part) {
  for (const Trial& trial : trials) part.pieces[trial.number] = trial;
}

nlohmann::json summary_of(const PartialResult& whole, const Conclusion& conclusion) {
  return {{"command", conclusion.command_line},
          {"seed", whole.settings.at("seed")},
          {"version", build_info().version},
          {"compiler", build_info().compiler}};
}

/// Writes the trials and their summary, with a row for each kind and length. `print_row` prints
/// one; whether it holds.
template <class Trial, class Kinds, class PrintRow>
ExitCode conclude_trials(const PartialResult& whole, const Conclusion& conclusion, const char* name,
                         const Kinds& kinds, const PrintRow& print_row) {
  const auto trials = trials_of<Trial>(whole);
  write_trials(conclusion.out, trials);
  nlohmann::json summary = summary_of(whole, conclusion);
  summary[name] = nlohmann::json::array();
  bool holds = true;
  for (const auto kind : kinds) {
    for (const int length : whole.settings.at("lengths").get<std::vector<int>>()) {
      const nlohmann::json row = summarise(trials, kind, length);
      holds = print_row(row) && holds;
      summary[name].push_back(row);
    }
  }
  summary["holds"] = holds;
  write_json(conclusion.out / "summary.json", summary);
  fmt::print("results in {}\n", conclusion.out.string());
  return holds ? ExitCode::kOk : ExitCode::kCheckFailed;
}

/// Hand-held trials on a recording. They hold where no recovery is false and every loss is said:
/// how many recover depends on whether the camera returns to what it has mapped.
ExitCode run_cut(const RelocalisationOptions& options, const std::string& command_line) {
  constexpr const char* kSevenScenes = "seven-scenes:";
  if (options.source.rfind(kSevenScenes, 0) != 0) {
    throw UsageError("--source: expected seven-scenes:DIR");
  }
  CutSettings settings = options.cut;
  settings.seed = options.kidnap.seed;
  if (options.trials.has_value()) settings.trials = *options.trials;
  if (!options.lengths.empty()) settings.lengths = options.lengths;
  const auto source =
      make_seven_scenes_source(options.source.substr(std::string(kSevenScenes).size()), {}, {});
  make_folder(options.out);
  PartialResult part = make_partial("relocalisation",
                                    {{"trials_of", "cut"},
                                     {"source", options.source},
                                     {"seed", settings.seed},
                                     {"trials", settings.trials},
                                     {"lengths", settings.lengths},
                                     {"filter", settings.filter}},
                                    options.shard);
  add_pieces(run_cut_trials(*source, settings, options.shard, [](int, int) {}), part);
  return conclude_or_leave(part, {options.out, command_line}, conclude_relocalisation);
}

ExitCode conclude_cut(const PartialResult& whole, const Conclusion& conclusion) {
  fmt::print("{:<8} {:>6} {:>7} {:>11} {:>12} {:>6} {:>18} {:>15} {:>15}\n", "kind", "blind",
             "trials", "seen again", "back in 2 s", "false", "loss not reported", "median error m",
             "undisturbed m");
  const auto print_row = [](const nlohmann::json& row) {
    fmt::print("{:<8} {:>6} {:>7} {:>11} {:>12} {:>6} {:>18} {:>15} {:>15}\n",
               row["kind"].get<std::string>(), row["frames_blind"].get<int>(),
               row["trials"].get<int>(), row["seen_again"].get<int>(),
               row["recovered_in_2_s"].get<int>(), row["false_recoveries"].get<int>(),
               row["loss_not_reported"].get<int>(), row["median_error_m"].dump().substr(0, 6),
               row["median_undisturbed_error_m"].dump().substr(0, 6));
    return row["false_recoveries"] == 0 && row["loss_not_reported"] == 0;
  };
  return conclude_trials<CutTrial>(whole, conclusion, "cut", kCutKinds, print_row);
}

ExitCode run_kidnapped(RelocalisationOptions options, const std::string& command_line) {
  if (options.trials.has_value()) options.kidnap.trials = *options.trials;
  if (!options.lengths.empty()) options.kidnap.lengths = options.lengths;
  if (options.kidnap.last_frame < options.kidnap.first_frame) {
    throw UsageError("--last-frame lies before --first-frame");
  }
  make_folder(options.out);
  PartialResult part = make_partial("relocalisation",
                                    {{"trials_of", "hall"},
                                     {"seed", options.kidnap.seed},
                                     {"trials", options.kidnap.trials},
                                     {"lengths", options.kidnap.lengths},
                                     {"first_frame", options.kidnap.first_frame},
                                     {"last_frame", options.kidnap.last_frame}},
                                    options.shard);
  add_pieces(run_kidnap_trials(options.kidnap, options.shard,
                               [](int done, int total) {
                                 if (done % 10 == 0 || done == total)
                                   show_progress("frame", done, total);
                               }),
             part);
  return conclude_or_leave(part, {options.out, command_line}, conclude_relocalisation);
}

ExitCode conclude_kidnapped(const PartialResult& whole, const Conclusion& conclusion) {
  constexpr KidnapKind kKinds[] = {KidnapKind::kBlack, KidnapKind::kOtherPlace};
  fmt::print("{:<12} {:>6} {:>7} {:>14} {:>6} {:>14} {:>11} {:>14} {:>11}\n", "kind", "blind",
             "trials", "back in 2 s", "false", "overconfident", "by library", "median frames",
             "worst m");
  const auto print_row = [](const nlohmann::json& row) {
    const int count = row["trials"];
    fmt::print("{:<12} {:>6} {:>7} {:>14} {:>6} {:>14} {:>11} {:>14} {:>11.2f}\n",
               row["kind"].get<std::string>(), row["frames_blind"].get<int>(), count,
               row["recovered_in_2_s"].get<int>(), row["false_recoveries"].get<int>(),
               row["outside_own_3_sigma"].get<int>(), row["by_library"].get<int>(),
               row["median_frames"].dump(), row["worst_error_m"].get<double>());
    return row["false_recoveries"] == 0 && 100 * row["recovered_in_2_s"].get<int>() >= 95 * count;
  };
  return conclude_trials<KidnapTrial>(whole, conclusion, "kidnapped", kKinds, print_row);
}

}  // namespace

ExitCode conclude_relocalisation(const PartialResult& whole, const Conclusion& conclusion) {
  return whole.settings.at("trials_of") == "cut" ? conclude_cut(whole, conclusion)
                                                 : conclude_kidnapped(whole, conclusion);
}

void register_relocalisation_command(CommandContext& context) {
  auto options = std::make_shared<RelocalisationOptions>();
  CLI::App* command = context.app.add_subcommand("relocalisation",
                                                 "Trials in which the picture goes and comes back");
  command->alias("faults");
  command->add_option("--source", options->source,
                      "seven-scenes:DIR for the hand-held tracker; the hall without it");
  command->add_option("--trials", options->trials, "Trials of each kind and length")
      ->check(CLI::Range(1, 10000));
  command
      ->add_option("--lengths", options->lengths,
                   "Frames without the true picture, separated by commas")
      ->delimiter(',')
      ->check(CLI::Range(1, 2000));
  command->add_option("--first-frame", options->kidnap.first_frame, "Earliest start of a trial")
      ->check(not_negative());
  command->add_option("--last-frame", options->kidnap.last_frame, "Latest start of a trial")
      ->check(not_negative());
  command->add_option("--seed", options->kidnap.seed, "Seed of the hall and of the trials")
      ->check(seed_number());
  command->add_option("--filter", options->cut.filter, "Hand-held estimator")
      ->check(CLI::IsMember({"window", "mono"}))
      ->capture_default_str();
  add_shard_option(*command, options->shard);
  command->add_option("--out", options->out, "Folder of the results")->required();
  command->callback([options, &context] {
    context.exit_code = options->source.empty() ? run_kidnapped(*options, context.command_line)
                                                : run_cut(*options, context.command_line);
  });
}

}  // namespace cairn::host
