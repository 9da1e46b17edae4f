#include "host_sim/commands/vision_quality_command.hpp"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "host_sim/experiments/vision/matching_quality.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct QualityOptions {
  std::filesystem::path sets;
  Shard shard;
  std::filesystem::path out;
};

ExitCode run(const QualityOptions& options, const std::string& command_line) {
  PartialResult part = make_partial("vision-quality", nlohmann::json::object(), options.shard);
  for (const auto& [number, pair] : measure_matching_quality(options.sets, options.shard)) {
    part.pieces[number] = {{"group", pair.group}, {"percent", pair.percent}};
  }
  return conclude_or_leave(part, {options.out, command_line}, conclude_vision_quality);
}

}  // namespace

ExitCode conclude_vision_quality(const PartialResult& whole, const Conclusion& conclusion) {
  std::vector<PairQuality> pairs;
  for (const auto& [number, piece] : whole.pieces) {
    pairs.push_back(
        {piece.at("group").get<std::string>(), piece.at("percent").get<std::vector<double>>()});
  }
  const std::vector<QualityResult> results = mean_quality(pairs);
  make_folder(conclusion.out);
  write_quality(results, conclusion.out / "quality.csv");
  const std::string table = quality_table(results);
  write_text(conclusion.out / "quality.md", table);
  fmt::print("{}results in {}\n", table, conclusion.out.string());
  return ExitCode::kOk;
}

void register_vision_quality_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "vision-quality", "Matching quality of FREAK's modes and ORB on warped and recorded pairs");
  const auto options = std::make_shared<QualityOptions>();
  command->add_option("sets", options->sets, "Folder with the homography sets graf and churchill")
      ->required();
  add_shard_option(*command, options->shard);
  command->add_option("--out", options->out, "Folder for the results")->required();
  command->callback(
      [&context, options] { context.exit_code = run(*options, context.command_line); });
}

}  // namespace cairn::host
