#include "host_sim/recorded/recording.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "cairn/numeric/math.hpp"

#include "host_sim/io/input_error.hpp"
#include "host_sim/recorded/number_table.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;

NumberTable read(Recording& recording, const fs::path& file, const TableFormat& format) {
  recording.inputs.push_back(file);
  return read_number_table(file, format);
}

TableFormat csv(const std::string& header, int columns, bool increasing = true) {
  return {header, true, columns, increasing};
}

TableFormat dat(int columns, bool increasing = true) {
  return {"", false, columns, increasing};
}

int integer_at(const NumberTable& table, std::size_t row, std::size_t column, int low, int high,
               const char* what) {
  const double value = table.rows[row][column];
  if (value != std::floor(value) || value < low || value > high) {
    throw InputError(table.file, table.lines[row],
                     fmt::format("column {}: expected {}, an integer from {} to {}", column + 1,
                                 what, low, high));
  }
  return static_cast<int>(value);
}

void check_sighting(const NumberTable& table, std::size_t row, double range, double bearing) {
  if (!(range > 0.0 && range < 1000.0)) {
    throw InputError(table.file, table.lines[row], "expected a range between 0 and 1000 m");
  }
  if (!(std::fabs(bearing) < 2.0 * kPi<double>)) {
    throw InputError(table.file, table.lines[row], "expected a bearing between -2 pi and 2 pi rad");
  }
}

/// Adds to the scan of the same time stamp, or starts one.
void append_sighting(Recording& recording, double t, const RecordedSighting& sighting) {
  if (recording.scans.empty() || recording.scans.back().t_s != t) {
    recording.scans.push_back({t, {}});
  }
  recording.scans.back().sightings.push_back(sighting);
}

/// Makes time zero the time `start` and drops what lies before it.
void start_at(Recording& recording, double start) {
  const auto shift = [start](auto& items) {
    for (auto& item : items) item.t_s -= start;
  };
  shift(recording.odometry);
  shift(recording.scans);
  shift(recording.truth);
  const auto before = [](const auto& item) { return item.t_s < 0.0; };
  auto& scans = recording.scans;
  scans.erase(std::remove_if(scans.begin(), scans.end(), before), scans.end());
  // The sample in force at time zero stays, moved there.
  auto& odometry = recording.odometry;
  auto in_force = odometry.begin();
  while (in_force + 1 != odometry.end() && (in_force + 1)->t_s <= 0.0) ++in_force;
  odometry.erase(odometry.begin(), in_force);
  if (odometry.front().t_s < 0.0) odometry.front().t_s = 0.0;
}

/// The end of the drive, checked: a wrong stamp must not make a run that does not end.
void end_at(Recording& recording, double end_s) {
  constexpr double kLongest_s = 7.0 * 86400.0;
  if (!(end_s >= 0.0 && end_s <= kLongest_s)) {
    throw InputError(recording.inputs.front(),
                     fmt::format("expected a drive of 0 to {} s, found one of {:.6g} s: check the "
                                 "first and last time",
                                 kLongest_s, end_s));
  }
  recording.end_s = end_s;
}

void shift_times(Recording& recording, double odometry_s, double scans_s) {
  for (auto& sample : recording.odometry) sample.t_s += odometry_s;
  for (auto& scan : recording.scans) scan.t_s += scans_s;
}

std::map<int, int> subjects_by_barcode(const NumberTable& barcodes) {
  std::map<int, int> subjects;
  for (std::size_t i = 0; i < barcodes.rows.size(); ++i) {
    const int subject = integer_at(barcodes, i, 0, 1, 1000, "a subject");
    const int barcode = integer_at(barcodes, i, 1, 0, 100000, "a barcode");
    subjects[barcode] = subject;
  }
  return subjects;
}

/// The wheels drive 0.081 rad to the right of the heading that truth and laser share (regression of
/// the true motion over windows of 2 to 20 s), turn rates read 4 % high, and the laser's stamps are
/// 0.065 s late. The tracked frame becomes that of the wheels; the truth's heading follows.
void calibrate_lost_in_the_woods(Recording& recording) {
  constexpr double kDriveAngle = -0.081;
  constexpr double kTurnScale = 0.959;
  shift_times(recording, 0.0, -0.065);
  for (auto& sample : recording.odometry) sample.turn_radps *= kTurnScale;
  for (auto& sample : recording.truth) sample.heading = wrap_angle(sample.heading + kDriveAngle);
  for (auto& scan : recording.scans) {
    for (auto& sighting : scan.sightings) sighting.bearing_rad -= kDriveAngle;
  }
  recording.note =
      "calibrated on the truth: drive axis 0.081 rad right of the heading, turn rate x 0.959, "
      "laser "
      "stamps 0.065 s earlier, no slip noise";
}

}  // namespace

Recording read_lost_in_the_woods(const fs::path& folder, RecordingProfile profile) {
  Recording recording;
  recording.name = "lost-in-the-woods";
  recording.sensor_offset_m = 0.219;
  constexpr double kPeriod = 0.1;
  if (profile == RecordingProfile::kPlain) {
    recording.slip_density = kPeriod * 0.0665 * 0.0665;  // across the axle as much as along it
  }
  const Eigen::Matrix2d density =
      kPeriod * Eigen::Vector2d(0.0665 * 0.0665, 0.0905 * 0.0905).asDiagonal().toDenseMatrix();
  recording.noise.range_sigma_m = 0.03;
  recording.noise.bearing_sigma_rad = 0.0259;

  const NumberTable motion =
      read(recording, folder / "odom_gt.csv",
           csv("t_s,v_mps,om_radps,x_true_m,y_true_m,th_true_rad,true_valid", 7));
  for (std::size_t i = 0; i < motion.rows.size(); ++i) {
    const auto& row = motion.rows[i];
    recording.odometry.push_back({row[0], row[1], row[2], density});
    if (integer_at(motion, i, 6, 0, 1, "true_valid") == 1) {
      recording.truth.push_back({row[0], {row[3], row[4]}, wrap_angle(row[5])});
    }
  }
  const NumberTable sightings =
      read(recording, folder / "obs.csv", csv("t_s,landmark_id(1..17),range_m,bearing_rad", 4));
  for (std::size_t i = 0; i < sightings.rows.size(); ++i) {
    const auto& row = sightings.rows[i];
    check_sighting(sightings, i, row[2], row[3]);
    append_sighting(recording, row[0],
                    {integer_at(sightings, i, 1, 1, 17, "a landmark"), row[2], row[3]});
  }
  const NumberTable landmarks =
      read(recording, folder / "landmarks.csv", csv("landmark_id,x_m,y_m", 3, false));
  for (std::size_t i = 0; i < landmarks.rows.size(); ++i) {
    const auto& row = landmarks.rows[i];
    recording.true_landmarks[integer_at(landmarks, i, 0, 1, 17, "a landmark")] = {row[1], row[2]};
  }
  if (recording.truth.empty()) {
    throw InputError(folder / "odom_gt.csv", "expected at least one row with true_valid 1");
  }
  recording.note = "slip noise as large as the speed's";
  if (profile == RecordingProfile::kCalibrated) calibrate_lost_in_the_woods(recording);
  start_at(recording, recording.truth.front().t_s);
  end_at(recording, recording.odometry.back().t_s);
  return recording;
}

Recording read_mrclam(const fs::path& folder, int robot, RecordingProfile profile) {
  Recording recording;
  recording.name = fmt::format("mrclam-robot{}", robot);
  const Eigen::Matrix2d density =
      Eigen::Vector2d(0.02 * 0.02, 0.05 * 0.05).asDiagonal().toDenseMatrix();
  recording.noise.range_sigma_m = 0.2;
  recording.noise.bearing_sigma_rad = 0.02;
  const std::string prefix = fmt::format("Robot{}_", robot);

  const NumberTable motion = read(recording, folder / (prefix + "Odometry.dat"), dat(3));
  for (const auto& row : motion.rows) {
    recording.odometry.push_back({row[0], row[1], row[2], density});
  }
  const NumberTable truth = read(recording, folder / (prefix + "Groundtruth.dat"), dat(4));
  for (const auto& row : truth.rows) {
    recording.truth.push_back({row[0], {row[1], row[2]}, wrap_angle(row[3])});
  }
  const NumberTable barcodes = read(recording, folder / "Barcodes.dat", dat(2, false));
  const std::map<int, int> subjects = subjects_by_barcode(barcodes);
  const NumberTable landmarks = read(recording, folder / "Landmark_Groundtruth.dat", dat(5, false));
  for (std::size_t i = 0; i < landmarks.rows.size(); ++i) {
    const auto& row = landmarks.rows[i];
    recording.true_landmarks[integer_at(landmarks, i, 0, 6, 1000, "a subject")] = {row[1], row[2]};
  }
  const NumberTable sightings = read(recording, folder / (prefix + "Measurement.dat"), dat(4));
  int dropped = 0;
  for (std::size_t i = 0; i < sightings.rows.size(); ++i) {
    const auto& row = sightings.rows[i];
    check_sighting(sightings, i, row[2], row[3]);
    const auto subject = subjects.find(integer_at(sightings, i, 1, 0, 100000, "a barcode"));
    if (subject == subjects.end() || recording.true_landmarks.count(subject->second) == 0) {
      ++dropped;
      continue;
    }
    append_sighting(recording, row[0], {subject->second, row[2], row[3]});
  }
  recording.note = fmt::format("{} sightings of robots or unknown barcodes dropped", dropped);
  if (profile == RecordingProfile::kCalibrated) {
    shift_times(recording, 0.2, -0.05);
    recording.noise.range_sigma_m = 0.07;
    recording.noise.range_sigma_per_m = 0.025;
    recording.note +=
        "; calibrated: odometry 0.2 s later, sightings 0.05 s earlier, range noise "
        "growing with range";
  }
  start_at(recording, std::max(recording.odometry.front().t_s, recording.truth.front().t_s));
  end_at(recording, std::min(recording.odometry.back().t_s, recording.truth.back().t_s));
  return recording;
}

Recording read_victoria_park(const fs::path& folder) {
  constexpr double kWheelbase = 2.83;
  constexpr double kEncoderOffset = 0.76;
  constexpr double kLaserAhead = 3.78;
  constexpr double kLaserLeft = 0.5;
  constexpr double kPeriod = 0.025;
  constexpr double kSpeedSigma = 0.5;
  constexpr double kSteeringSigma = 0.05;
  Recording recording;
  recording.name = "victoria-park";
  recording.known_landmarks = false;
  recording.truth_has_heading = false;
  recording.sensor_offset_m = kLaserAhead;
  recording.noise.range_sigma_m = 0.3;
  recording.noise.bearing_sigma_rad = 0.02;
  recording.note = "laser foot on the rear axle tracked; truth is GPS, position alone";

  const NumberTable motion =
      read(recording, folder / "odom.csv", csv("t,speed_mps,steering_rad", 3));
  for (std::size_t i = 0; i < motion.rows.size(); ++i) {
    const auto& row = motion.rows[i];
    if (!(std::fabs(row[2]) < 1.4)) {
      throw InputError(motion.file, motion.lines[i], "expected a steering angle below 1.4 rad");
    }
    // The encoder sits on the left rear wheel.
    const double slope = std::tan(row[2]);
    const double scale = 1.0 / (1.0 - kEncoderOffset / kWheelbase * slope);
    const double turn = row[1] * scale * slope / kWheelbase;
    const double speed = row[1] * scale - kLaserLeft * turn;
    // d (speed, turn) / d (encoder, slope), and d slope / d angle = 1 + slope^2.
    const double turn_by_slope = row[1] * scale * scale / kWheelbase;
    Eigen::Matrix2d b;
    b.col(1) << kEncoderOffset * turn_by_slope - kLaserLeft * turn_by_slope, turn_by_slope;
    b.col(1) *= (1.0 + slope * slope) * kSteeringSigma;
    b.col(0) << scale - kLaserLeft * scale * slope / kWheelbase, scale * slope / kWheelbase;
    b.col(0) *= kSpeedSigma;
    recording.odometry.push_back({row[0], speed, turn, kPeriod * b * b.transpose()});
  }
  const NumberTable trees = read(recording, folder / "trees.csv", csv("t,z0,z1,z2", 4));
  for (std::size_t i = 0; i < trees.rows.size(); ++i) {
    const auto& row = trees.rows[i];
    check_sighting(trees, i, row[1], row[2]);
    append_sighting(recording, row[0], {0, row[1], wrap_angle(row[2] - kHalfPi<double>)});
  }
  const NumberTable gps = read(recording, folder / "gps.csv", csv("t_s,east_m,north_m", 3));
  for (const auto& row : gps.rows) recording.truth.push_back({row[0], {row[1], row[2]}, 0.0});
  start_at(recording, recording.odometry.front().t_s);
  end_at(recording, recording.odometry.back().t_s);
  return recording;
}

bool truth_at(const Recording& recording, double t_s, double largest_gap_s, RecordedTruth& truth) {
  const auto& samples = recording.truth;
  const auto after =
      std::lower_bound(samples.begin(), samples.end(), t_s,
                       [](const RecordedTruth& sample, double t) { return sample.t_s < t; });
  if (after == samples.end()) return false;
  if (after->t_s == t_s || after == samples.begin()) {
    if (after->t_s - t_s > 1e-9) return false;
    truth = *after;
    return true;
  }
  const RecordedTruth& a = *(after - 1);
  const double gap = after->t_s - a.t_s;
  if (gap > largest_gap_s) return false;
  const double share = (t_s - a.t_s) / gap;
  truth.t_s = t_s;
  truth.position = a.position + share * (after->position - a.position);
  truth.heading = wrap_angle(a.heading + share * wrap_angle(after->heading - a.heading));
  return true;
}

}  // namespace cairn::host
