#pragma once

#include <cstdint>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/health.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/tracking/angular_rate.hpp"
#include "cairn/tracking/input_clock.hpp"

namespace cairn {

/// Turns a gyroscope's samples, which come in their own rhythm, into the turn from one frame to the
/// next: late, early, in bursts, at 20 to 2,000 Hz.
///
/// The rate between two samples is linear. At a frame's time it is interpolated; beyond the newest
/// sample the last rate is held, and corrected when the next sample comes. Samples that are older
/// than the last knots (some 120 ms) cannot be asked for any more, so that a frame may come that
/// late. A gap, or a saturated sample, leaves the turn of its frames unknown.
class GyroIntegrator {
 public:
  static constexpr int kKnots = 32;
  static constexpr std::int64_t kKnotStep_us = 4000;
  static constexpr std::int64_t kLongestStep_us = 2000000;  ///< a later stamp is doubted

  /// Starts anew. Domain: valid parameters.
  void reset(const GyroParameters& parameters);

  /// Takes a sample. Refused, nothing changed but the counts: kNonFiniteInput; kInvalidArgument
  /// (beyond GyroParameters::kLargestRate_radps); kTimeBackwards, kDuplicate; kTimeGap and
  /// kTimeBackwards for a jump of the stamps that the next sample has not confirmed. Counted and
  /// taken as a gap: kGated, saturated. Cost: some 150 multiply-adds.
  Status add(const AngularRateSample& sample, Health& health);

  /// The turn since the frame before; the next one counts from here. Cost: some 300 multiply-adds.
  GyroTurn take_frame(std::int64_t t_us);

  /// Samples are late by so much, s: what is added to a frame's time to get theirs. The last
  /// frame's place among the samples moves with it.
  void set_time_offset(float seconds);
  /// What is subtracted from samples, camera axes, rad/s; of those to come.
  void set_bias(const Vector3<float>& radps) { bias_ = radps; }
  /// Forgets the frame before.
  void forget_frame() { anchor_ = Anchor(); }

  bool empty() const { return knots_.empty(); }
  std::uint32_t taken() const { return taken_; }
  std::uint32_t refused() const { return refused_; }
  std::uint32_t saturated() const { return saturated_; }
  std::uint32_t gaps() const { return gaps_; }

 private:
  struct Knot {
    std::int64_t t_us = 0;
    Quaternion<float> orientation = Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F);  ///< R_first_present
    Vector3<float> rate = Vector3<float>::Zero();  ///< camera axes, as read
  };
  /// Where the last frame stands among the samples.
  struct Anchor {
    bool known = false;
    std::int64_t frame_us = 0;
    std::int64_t held_us = 0;  ///< beyond the newest sample
    Knot at;
  };

  void begin(std::int64_t t_us, const Vector3<float>& rate);
  void append(const Knot& knot);
  bool at(std::int64_t t_us, Knot& place, std::int64_t& held_us) const;
  void place_anchor(std::int64_t frame_us);

  GyroParameters parameters_;
  InputClock clock_;
  FixedVector<Knot, kKnots> knots_;  ///< oldest first; the last is the newest sample
  Anchor anchor_;
  Vector3<float> bias_ = Vector3<float>::Zero();
  std::int64_t offset_us_ = 0;
  std::int64_t last_us_ = 0;  ///< of the newest sample, saturated or not
  bool has_last_ = false;
  std::uint32_t taken_ = 0;
  std::uint32_t refused_ = 0;
  std::uint32_t saturated_ = 0;
  std::uint32_t gaps_ = 0;
};

}  // namespace cairn
