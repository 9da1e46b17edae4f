#include "host_sim/commands/sharding.hpp"

#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

std::optional<Shard> parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec != std::errc() || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, shard.count);
  if (count.ec != std::errc() || count.ptr != end) return std::nullopt;
  if (shard.count < 1 || shard.index < 1 || shard.index > shard.count) return std::nullopt;
  return shard;
}

}  // namespace

void add_shard_option(CLI::App& command, Shard& shard) {
  command.add_option_function<std::string>(
      "--shard",
      [&shard](const std::string& text) {
        const std::optional<Shard> parsed = parse_shard(text);
        if (!parsed.has_value()) {
          throw UsageError(
              fmt::format("--shard '{}': expected i/n with 1 <= i <= n, for example 3/8", text));
        }
        shard = *parsed;
      },
      "Part i/n of the experiment, for cairn_sim merge");
}

ExitCode conclude_or_leave(const PartialResult& part, const Conclusion& conclusion,
                           ConcludeExperiment conclude) {
  if (part.shard_count == 1) return conclude(part, conclusion);
  write_partial(part, conclusion.out);
  fmt::print("shard {}/{}: {} pieces\nresults in {}\n", part.shards.front(), part.shard_count,
             part.pieces.size(), conclusion.out.string());
  return ExitCode::kOk;
}

}  // namespace cairn::host
