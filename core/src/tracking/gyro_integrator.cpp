#include "cairn/tracking/gyro_integrator.hpp"

#include "cairn/base/time.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr float kSecond_us = 1e-6F;
constexpr float kUnknownAcceleration_radps2 = 30.0F;  // of a hand that shakes

float seconds_between(std::int64_t later_us, std::int64_t earlier_us) {
  return static_cast<float>(difference_us(later_us, earlier_us)) * kSecond_us;
}

Quaternion<float> turned(const Quaternion<float>& orientation, const Vector3<float>& turn) {
  Quaternion<float> result = orientation * rotation_exp(turn);
  result.coeffs() *= 1.0F / sqrt(result.squaredNorm());
  return result;
}

/// What a rate that changes at random while it is held makes of a turn.
float held_variance(std::int64_t held_us) {
  const float held_s = static_cast<float>(held_us) * kSecond_us;
  return square(0.5F * kUnknownAcceleration_radps2 * held_s * held_s);
}

}  // namespace

void GyroIntegrator::reset(const GyroParameters& parameters) {
  *this = GyroIntegrator();
  parameters_ = parameters;
  clock_.reset(kLongestStep_us);
}

Status GyroIntegrator::add(const AngularRateSample& sample, Health& health) {
  const Vector3<float>& read = sample.rate_radps;
  float most = 0.0F;
  for (int i = 0; i < 3; ++i) {
    if (!is_finite(read(i))) {
      ++health.non_finite_inputs;
      ++refused_;
      return Status::kNonFiniteInput;
    }
    most = abs(read(i)) > most ? abs(read(i)) : most;
  }
  if (most > GyroParameters::kLargestRate_radps) {
    ++refused_;
    return Status::kInvalidArgument;
  }
  Status status = clock_.take(InputClock::Source::kGyro, sample.t_us);
  const bool jumped = ok(status) && clock_.jumped();
  if (ok(status) && has_last_ && !jumped && sample.t_us <= last_us_) {
    status = sample.t_us == last_us_ ? Status::kDuplicate : Status::kTimeBackwards;
  }
  if (!ok(status)) {
    ++health.time_errors;
    ++refused_;
    return status;
  }
  ++taken_;
  const bool gap =
      has_last_ && (jumped || difference_us(sample.t_us, last_us_) > parameters_.max_gap_us);
  last_us_ = sample.t_us;
  has_last_ = true;
  gaps_ += gap ? 1 : 0;
  if (most >= parameters_.range_radps) {
    knots_.clear();
    anchor_.known = false;
    ++saturated_;
    return Status::kGated;
  }
  const Vector3<float> rate = parameters_.R_camera_gyro * read;
  if (gap || knots_.empty()) {
    begin(sample.t_us, rate);
    return Status::kOk;
  }
  const Knot& before = knots_.back();
  Knot knot;
  knot.t_us = sample.t_us;
  knot.rate = rate;
  const float dt_s = seconds_between(sample.t_us, before.t_us);
  knot.orientation = turned(before.orientation, dt_s * (0.5F * (before.rate + rate) - bias_));
  append(knot);
  if (anchor_.known && anchor_.held_us > 0) place_anchor(anchor_.frame_us);
  return Status::kOk;
}

/// Nothing is known of the time before: frames of it have no turn.
void GyroIntegrator::begin(std::int64_t t_us, const Vector3<float>& rate) {
  Knot knot;
  knot.t_us = t_us;
  knot.rate = rate;
  knots_.clear();
  static_cast<void>(knots_.push_back(knot));
  anchor_.known = false;
}

/// Samples closer together than a knot's step are joined with the one before.
void GyroIntegrator::append(const Knot& knot) {
  const int size = knots_.size();
  if (size >= 2 && difference_us(knot.t_us, knots_[size - 2].t_us) < kKnotStep_us) {
    knots_.back() = knot;
    return;
  }
  if (knots_.full()) {
    for (int i = 0; i + 1 < size; ++i) knots_[i] = knots_[i + 1];
    knots_.back() = knot;
    return;
  }
  static_cast<void>(knots_.push_back(knot));
}

/// Orientation and rate at a time of the samples. False where they do not cover it.
bool GyroIntegrator::at(std::int64_t t_us, Knot& place, std::int64_t& held_us) const {
  held_us = 0;
  if (knots_.empty() || t_us < knots_[0].t_us) return false;
  int next = knots_.size();
  while (next > 0 && knots_[next - 1].t_us > t_us) --next;
  const Knot& before = knots_[next - 1];
  place.t_us = t_us;
  const float since_s = seconds_between(t_us, before.t_us);
  if (next == knots_.size()) {
    held_us = difference_us(t_us, before.t_us);
    if (held_us > parameters_.max_gap_us) return false;
    place.rate = before.rate;
    place.orientation = turned(before.orientation, since_s * (before.rate - bias_));
    return true;
  }
  const Knot& after = knots_[next];
  const float step_s = seconds_between(after.t_us, before.t_us);
  const float share = since_s / step_s;
  const Vector3<float> change = after.rate - before.rate;
  const Vector3<float> turn = rotation_log(before.orientation.conjugate() * after.orientation);
  place.rate = before.rate + share * change;
  place.orientation =
      turned(before.orientation, share * turn + 0.5F * step_s * (share * share - share) * change);
  return true;
}

void GyroIntegrator::place_anchor(std::int64_t frame_us) {
  Knot place;
  std::int64_t held_us = 0;
  if (!at(frame_us + offset_us_, place, held_us)) return;
  anchor_.at = place;
  anchor_.held_us = held_us;
}

void GyroIntegrator::set_time_offset(float seconds) {
  const auto offset_us = static_cast<std::int64_t>(round_to_int(seconds * 1e6F));
  if (offset_us == offset_us_) return;
  offset_us_ = offset_us;
  if (anchor_.known) place_anchor(anchor_.frame_us);
}

GyroTurn GyroIntegrator::take_frame(std::int64_t t_us) {
  constexpr std::int64_t kFarAway_us = std::int64_t{1} << 62U;
  GyroTurn turn;
  Anchor now;
  now.frame_us = t_us;
  const bool near = t_us < kFarAway_us && t_us > -kFarAway_us;
  now.known = near && at(t_us + offset_us_, now.at, now.held_us);
  if (now.known && anchor_.known && t_us > anchor_.frame_us) {
    turn.known = true;
    turn.rotation = rotation_log(anchor_.at.orientation.conjugate() * now.at.orientation);
    turn.seconds = seconds_between(t_us, anchor_.frame_us);
    turn.variance = square(parameters_.noise_density) * turn.seconds + held_variance(now.held_us) +
                    held_variance(anchor_.held_us);
    turn.rate_before = anchor_.at.rate - bias_;
    turn.rate_after = now.at.rate - bias_;
  }
  anchor_ = now;
  return turn;
}

}  // namespace cairn
