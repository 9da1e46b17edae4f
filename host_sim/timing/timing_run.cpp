#include "host_sim/timing/timing_run.hpp"

#include <fmt/format.h>

#include "host_sim/base/names.hpp"
#include "host_sim/base/statistics.hpp"
#include "host_sim/io/output_file.hpp"
#include "host_sim/io/python_script.hpp"
#include "host_sim/reports/latency.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/running/runner.hpp"
#include "host_sim/timing/instruction_count.hpp"
#include "host_sim/timing/timing_picture.py.hpp"
#include "host_sim/trackers/host_ticks.hpp"
#include "host_sim/trackers/input_log_file.hpp"

namespace cairn::host {
namespace {

using nlohmann::json;

/// A tracker whose frames are also timed on the processor's own clock, which stands still while
/// other programs have the core.
class ClockedTracker : public Tracker {
 public:
  explicit ClockedTracker(Tracker& tracker) : tracker_(tracker) {}

  Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) override {
    const double start = core_clock_ms();
    const Status status = tracker_.process(frame, overlay, report);
    cpu_ms_.push_back(core_clock_ms() - start);
    return status;
  }
  std::vector<MapLandmark> landmarks() const override { return tracker_.landmarks(); }
  int landmark_capacity() const override { return tracker_.landmark_capacity(); }
  Health health() const override { return tracker_.health(); }
  json description() const override { return tracker_.description(); }
  const std::vector<double>& cpu_ms() const { return cpu_ms_; }

 private:
  Tracker& tracker_;
  std::vector<double> cpu_ms_;
};

/// Passes a source on and keeps its first frames.
class KeepingSource : public FrameSource {
 public:
  KeepingSource(FrameSource& source, const Frame& first, int count)
      : source_(source), count_(count) {
    keep(first);
  }

  const SourceInfo& info() const override { return source_.info(); }
  bool next(Frame& frame) override {
    if (!source_.next(frame)) return false;
    keep(frame);
    return true;
  }
  const std::vector<Frame>& kept() const { return kept_; }

 private:
  void keep(const Frame& frame) {
    if (static_cast<int>(kept_.size()) >= count_) return;
    kept_.push_back(frame);
    kept_.back().grey = frame.grey.clone();
  }

  FrameSource& source_;
  int count_;
  std::vector<Frame> kept_;
};

/// Frames that are there already.
class FrameList : public FrameSource {
 public:
  FrameList(const SourceInfo& info, const std::vector<Frame>& frames)
      : info_(info), frames_(frames) {}
  const SourceInfo& info() const override { return info_; }
  bool next(Frame& frame) override {
    if (++at_ >= frames_.size()) return false;
    frame = frames_[at_];
    return true;
  }

 private:
  SourceInfo info_;
  const std::vector<Frame>& frames_;
  std::size_t at_ = 0;
};

InstructionCounts counted(const TimedRun& run, const std::vector<Frame>& frames) {
  if (frames.empty()) return {};
  const std::filesystem::path log = run.options.out / "counted.log";
  FrameList list(run.source.info(), frames);
  RecordingSource recording(
      list, log, to_log_header(run.tracker_options, run.source.info(), frames.front().t_us),
      frames.front(), run.tracker_options.work_limit);
  for (Frame frame; recording.next(frame);) continue;
  InstructionCounts result = count_instructions(log, run.options.out);
  std::filesystem::remove(log);
  return result;
}

json times_json(const RunRecord& record, const std::vector<double>& cpu_ms, double budget) {
  std::vector<double> total;
  std::vector<std::vector<double>> stages(kStageCount);
  for (const FrameRecord& frame : record.frames) {
    total.push_back(frame.total_ms);
    for (int i = 0; i < kStageCount; ++i) stages[i].push_back(frame.stage_ms[i]);
  }
  json result = latency_json(total, budget);
  result["budget"] = budget;
  result["cpu"] = latency_json(cpu_ms, budget);
  result["budget_over_p99"] = budget / statistics_of(cpu_ms).p99;
  for (int i = 0; i < kStageCount; ++i) {
    result["stages"][kStageRows[i].key] = latency_json(stages[i], budget);
  }
  return result;
}

json instructions_json(const std::vector<FrameInstructions>& frames) {
  if (frames.empty()) return nullptr;
  std::vector<double> total;
  std::vector<std::vector<double>> stages(kStageCount);
  for (const FrameInstructions& frame : frames) {
    total.push_back(frame.total);
    for (int i = 0; i < kStageCount; ++i) stages[i].push_back(frame.stages[i]);
  }
  const auto row = [](const std::vector<double>& values) {
    const Statistics s = statistics_of(values);
    return json{{"worst", s.max}, {"p99", s.p99}, {"median", s.p50}};
  };
  json result = row(total);
  result["frames"] = frames.size();
  for (int i = 0; i < kStageCount; ++i) {
    result["stages"][kStageRows[i].key] = row(stages[i]);
  }
  return result;
}

void write_times(const std::filesystem::path& folder, const RunRecord& record,
                 const std::vector<double>& cpu_ms) {
  OutputFile out(folder / "frame_times.csv");
  out.print(
      "frame,preprocess_ms,pose_prediction_ms,features_ms,pose_update_ms,render_ms,total_ms,cpu_"
      "ms\n");
  for (std::size_t i = 0; i < record.frames.size(); ++i) {
    const FrameRecord& frame = record.frames[i];
    out.print("{}", frame.number);
    for (const double ms : frame.stage_ms) out.print(",{:.4f}", ms);
    out.print(",{:.4f},{:.4f}\n", frame.total_ms, cpu_ms[i]);
  }
  out.finish();
}

void write_counts(const std::filesystem::path& folder,
                  const std::vector<FrameInstructions>& frames) {
  const std::filesystem::path path = folder / "frame_instructions.csv";
  std::filesystem::remove(path);  // an earlier run's
  if (frames.empty()) return;
  OutputFile out(path);
  out.print("frame,preprocess,pose_prediction,features,pose_update,render,total\n");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    out.print("{}", i);
    for (const double stage : frames[i].stages) out.print(",{:.0f}", stage);
    out.print(",{:.0f}\n", frames[i].total);
  }
  out.finish();
}

std::string millions(const json& instructions, const char* stage, const char* what) {
  if (instructions.is_null()) return "-";
  const json& row = stage == nullptr ? instructions : instructions["stages"][stage];
  return fmt::format("{:.3f} M", row[what].get<double>() * 1e-6);
}

std::string line(const std::string& name, const json& ms, const json& instructions,
                 const char* stage, double paper_ms) {
  const auto value = [&ms](const char* key) { return ms[key].get<double>(); };
  return fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {} | {} | {:.2f} |\n", name,
                     value("p50"), value("p95"), value("p99"), value("max"),
                     millions(instructions, stage, "median"),
                     millions(instructions, stage, "worst"), paper_ms);
}

std::string table_of(const json& summary) {
  const json& ms = summary["latency_ms"];
  const json& instructions = summary["instructions"];
  std::string text =
      "| per frame, ms | p50 | p95 | p99 | max | instructions, median | worst | paper |\n"
      "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const StageRow& row : kStageRows) {
    text += line(row.name, ms["stages"][row.key], instructions, row.key, row.paper_iekf_ms);
  }
  return text + line("whole frame", ms, instructions, nullptr, kPaperTotalMs) +
         line("whole frame, time on the core", ms["cpu"], instructions, nullptr, kPaperTotalMs);
}

}  // namespace

ExitCode time_frames(const TimedRun& run) {
  const TimingOptions& timing = *run.options.timing;
  const std::filesystem::path& folder = run.options.out;
  KeepingSource source(run.source, run.first, timing.counted_frames);
  RunnerSettings settings;
  settings.out = folder;
  settings.video = false;
  settings.pictures = 0;
  ClockedTracker tracker(run.tracker);
  const RunRecord record = run_frames(source, run.first, tracker, settings);
  const InstructionCounts counts = counted(run, source.kept());

  const json summary = {{"source", run.options.source},
                        {"tracker", record.tracker},
                        {"build", build_manifest()},
                        {"frames", record.frames.size()},
                        {"latency_ms", times_json(record, tracker.cpu_ms(), run.options.budget_ms)},
                        {"instructions", instructions_json(counts.frames)}};
  write_times(folder, record, tracker.cpu_ms());
  write_counts(folder, counts.frames);
  write_json(folder / "timing.json", summary);
  const std::string table = table_of(summary);
  write_text(folder / "timing.md", table);
  fmt::print("\n{}", table);
  if (!counts.problem.empty()) fmt::print("{}\n", counts.problem);
  if (const auto problem = draw_with_python("timing.png", kTimingScript, folder)) {
    fmt::print("{}\n", *problem);
  }

  const json& ms = summary["latency_ms"];
  const double p99 = ms["cpu"]["p99"].get<double>();
  fmt::print(
      "{} frames; 99 % within {:.3f} ms on the core, {:.1f} times below {:.2f} ms; results in {}\n",
      record.frames.size(), p99, ms["budget_over_p99"].get<double>(), run.options.budget_ms,
      folder.string());
  if (timing.p99_below_ms > 0.0 && p99 > timing.p99_below_ms) {
    fmt::print("above the limit of {:.3f} ms\n", timing.p99_below_ms);
    return ExitCode::kCheckFailed;
  }
  return ExitCode::kOk;
}

}  // namespace cairn::host
