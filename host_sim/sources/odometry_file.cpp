#include "host_sim/sources/odometry_file.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/io/csv_units.hpp"
#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

constexpr double kSpeedSigma_mps = 0.1;  // assumed: the file states no noise
constexpr double kYawRateSigma_radps = 0.05;
constexpr double kSteeringSigma_rad = 0.087;

constexpr double kLargestSpeed_mps = 100.0;
constexpr double kLargestYawRate_radps = 10.0;
constexpr double kLargestSteering_rad = 1.4;  // what the filters take
constexpr double kLargestWheelbase_m = 20.0;
constexpr double kLargestTurn_rad = 3.14;  // what the filters take in a step
constexpr double kLongestStep_s = 1.0;

/// A value within [-largest, largest]; throws InputError naming line, column and the domain.
double within(const CsvReader& csv, const QuantityColumn& column, double largest,
              const char* what) {
  const double value = column.value(csv);
  if (std::abs(value) <= largest) return value;
  csv.fail(column.index,
           fmt::format("expected {} of at most {} either way, found {:.6g}", what, largest, value));
}

double wheelbase(const CsvReader& csv, const QuantityColumn& column, double before) {
  const double value = column.value(csv);
  if (!(value > 0.0 && value <= kLargestWheelbase_m)) {
    csv.fail(column.index, fmt::format("expected a length above 0 and at most {} m, found {:.6g}",
                                       kLargestWheelbase_m, value));
  }
  if (before > 0.0 && value != before) {
    csv.fail(column.index, fmt::format("expected the same wheelbase in every row, found {:.6g} "
                                       "after {:.6g}",
                                       value, before));
  }
  return value;
}

/// A sample holds for the time since the one before it: in that time the vehicle turns by less than
/// half a circle. A longer gap is not integrated.
void check_turn(const CsvReader& csv, const QuantityColumn& column, const OdometryModel& model,
                const OdometrySample& before, const OdometrySample& sample) {
  const double dt_s = 1e-6 * static_cast<double>(sample.t_us - before.t_us);
  if (dt_s > kLongestStep_s) return;
  const double rate_radps = model.kind == OdometrySample::Kind::kTwist
                                ? static_cast<double>(sample.turn)
                                : static_cast<double>(sample.speed_mps) *
                                      std::tan(static_cast<double>(sample.turn)) /
                                      model.wheelbase_m;
  if (std::abs(rate_radps) * dt_s <= kLargestTurn_rad) return;
  csv.fail(column.index,
           fmt::format("expected a turn of at most {} rad since the row before, found {:.6g} rad",
                       kLargestTurn_rad, std::abs(rate_radps) * dt_s));
}

void check_order(const CsvReader& csv, const std::vector<OdometrySample>& samples,
                 std::int64_t t_us) {
  if (samples.empty() || t_us > samples.back().t_us) return;
  throw InputError(csv.path(), csv.line(),
                   fmt::format("expected times in increasing order, found {:.6f} s after {:.6f} s",
                               1e-6 * static_cast<double>(t_us),
                               1e-6 * static_cast<double>(samples.back().t_us)));
}

/// Whether the turn is a yaw rate, else it is a steering angle. A yaw rate of an unknown unit is
/// the one that the message is to name.
bool turns_by_yaw_rate(const CsvReader& csv) {
  if (has_quantity(csv, kYawRate)) return true;
  if (has_quantity(csv, kSteering)) return false;
  if (names_quantity(csv, kYawRate)) return true;
  if (names_quantity(csv, kSteering)) return false;
  throw InputError(csv.path(), 1,
                   fmt::format("expected a column '{}' or '{}' (with '{}') in the header, found {}",
                               kYawRate.column, kSteering.column, kWheelbase.column,
                               fmt::join(csv.header(), ", ")));
}

}  // namespace

OdometryFile read_odometry(const std::filesystem::path& path) {
  CsvReader csv(path);
  const TimeColumn time(csv);
  const QuantityColumn speed = find_quantity(csv, kSpeed);
  const bool twist = turns_by_yaw_rate(csv);
  const QuantityColumn turn = find_quantity(csv, twist ? kYawRate : kSteering);
  const QuantityColumn length = twist ? QuantityColumn{} : find_quantity(csv, kWheelbase);
  OdometryFile odometry;
  if (twist && has_quantity(csv, kSteering)) {
    odometry.warning =
        fmt::format("{}: has a yaw rate and a steering angle; the yaw rate is used", path.string());
  }
  OdometryModel& model = odometry.model;
  model.kind = twist ? OdometrySample::Kind::kTwist : OdometrySample::Kind::kAckermann;
  model.speed_sigma_mps = kSpeedSigma_mps;
  model.turn_sigma = twist ? kYawRateSigma_radps : kSteeringSigma_rad;
  while (csv.next()) {
    OdometrySample sample;
    sample.t_us = time.t_us(csv);
    check_order(csv, odometry.samples, sample.t_us);
    sample.kind = model.kind;
    sample.speed_mps = static_cast<float>(within(csv, speed, kLargestSpeed_mps, "a speed in m/s"));
    sample.turn =
        static_cast<float>(twist ? within(csv, turn, kLargestYawRate_radps, "a yaw rate in rad/s")
                                 : within(csv, turn, kLargestSteering_rad, "an angle in rad"));
    if (!twist) model.wheelbase_m = wheelbase(csv, length, model.wheelbase_m);
    if (!odometry.samples.empty()) {
      check_turn(csv, turn, model, odometry.samples.back(), sample);
    }
    odometry.samples.push_back(sample);
  }
  if (odometry.samples.size() < 2) throw InputError(path, "expected two or more odometry rows");
  const auto span =
      static_cast<double>(odometry.samples.back().t_us - odometry.samples.front().t_us);
  model.period_s = 1e-6 * span / static_cast<double>(odometry.samples.size() - 1);
  return odometry;
}

void take_samples(const std::vector<OdometrySample>& samples, bool first_frame, std::size_t& next,
                  Frame& frame) {
  constexpr std::int64_t kOldest_us = 200000;
  for (; next < samples.size() && samples[next].t_us <= frame.t_us; ++next) {
    if (first_frame) frame.odometry.clear();
    if (first_frame && frame.t_us - samples[next].t_us > kOldest_us) continue;
    frame.odometry.push_back(samples[next]);
  }
}

}  // namespace cairn::host
