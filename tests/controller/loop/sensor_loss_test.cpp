// Every sensor lost in every way, in every state, with every estimator, at the frame between the
// simulated arm and the loop. Either the loop trips by name within three ticks of the first tick in
// which the fault can be seen, or it goes on, and until then tip and bending stay within bounds.
//
// What can be seen, by kind of fault:
// - invalid, late: the reading is not used. An encoder: in the first tick. Gauges: in the first
// tick
//   if those that are left do not determine the bending of their link; else the loop goes on.
// - every second lost: bridged, the loop goes on; with many sensors a limit may be reached.
// - frozen: an encoder once it is kSeenEncoder_rad from the truth: estimator.hub_rotor_limit_rad,
//   and a count of each encoder. One or two gauges of a link once one of them is kSeenStrain from
//   the truth: estimator.strain_stuck_limit by the fit to the others, which differs from the truth
//   by the modes that are not fitted and by noise. More gauges of a link: no bound on the delay; of
//   the whole link only the model tells. There the bounds on tip and bending must hold.
//
// Not covered: readings that are frozen, or lost in every second sample, with `difference` and
// `polynomial`. They have no model that could tell or bridge, and the loop follows or becomes
// unstable until a limit trips, beyond these bounds and under the name of that limit. Only that the
// loop trips once a frozen reading can be seen is checked for them.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/safety/safety_machine.h"
#include "estimator/strain_fit.h"
#include "tests/controller/loop/faulty_sensors.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/support/campaign.h"

namespace flexarm {
namespace {

constexpr double kSeenEncoder_rad = 0.11;
constexpr double kSeenStrain = 2.6e-4;
constexpr int kSeenTicks = 3;
constexpr int kWatchedTicks = 40;

// Bounds until the trip or for kWatchedTicks: distance of the tip from where it is without the
// fault, and the largest strain of a gauge, limits.strain_limit, beyond which the bending itself is
// the cause of the trip. The largest distance is that of a joint both of whose encoders freeze.
constexpr double kTipBound_m = 0.1;
constexpr double kBendingBound = 1.9e-3;

constexpr std::uint32_t kLinkGauges = 0x3FF;

enum class Situation : std::uint8_t { kIdle, kArmed, kRunning, kStopping };
constexpr std::array<const char*, 4> kSituations = {"Idle", "Armed", "Running", "Stopping"};

struct Estimator {
  const char* name;
  std::vector<std::string> overrides;
  bool has_model;
};

// The differences need gauges without a filter, and a smaller alpha
// (docs/theory/control-law.md 7.4).
const std::array<Estimator, 4> kEstimators = {{
    {"kalman", {}, true},
    {"ekf_payload", {"estimator.name=ekf-payload"}, true},
    {"difference",
     {"estimator.name=difference", "sensors.strain_input.filter_hz=0", "controller.alpha=2"},
     false},
    {"polynomial",
     {"estimator.name=polynomial", "sensors.strain_input.filter_hz=0", "controller.alpha=2"},
     false},
}};

std::string Text(const SensorFault& fault) {
  std::string text = ToString(fault.wrong);
  for (int i = 0; i < 20; ++i) {
    if ((fault.strain >> i & 1U) != 0) text += " strain" + std::to_string(i + 1);
  }
  for (int i = 0; i < kCounters; ++i) {
    if ((fault.counters >> i & 1U) != 0) text += std::string(" ") + CounterName(i);
  }
  return text;
}

class SensorLoss : public testing::TestWithParam<std::tuple<std::size_t, Situation>> {
 protected:
  SensorLoss()
      : estimator_(kEstimators[std::get<0>(GetParam())]),
        situation_(std::get<1>(GetParam())),
        config_(ShippedRig(estimator_.overrides)),
        design_(DesignFor(config_)),
        grid_(config_.loop),
        planned_(ShippedExperiment(), design_, grid_.period_s(), {0.0, 0.0},
                 MotionLimitsOf(config_)),
        fit_(config_.arm, config_.sensors, config_.estimator),
        healthy_(Play({})) {}

  std::int64_t first_tick() const { return fault_ns_ / kPeriodNs; }

  // A session up to the situation, with the fault from then on.
  std::unique_ptr<FaultyRun> Play(const SensorFault& fault) {
    auto run = std::make_unique<FaultyRun>(config_, design_, &planned_);
    fault_ns_ = 400 * kMs;
    if (situation_ != Situation::kIdle) {
      run->Until(700 * kMs);  // at rest for half a second
      run->Ask(RequestKind::kArm);
      fault_ns_ = 800 * kMs;
    }
    if (situation_ >= Situation::kRunning) {
      run->Until(800 * kMs);
      run->Ask(RequestKind::kRun);
      run->Until(840 * kMs);
      // In the middle of the first move, where both hubs turn. At 0.3 s, while the filter that was
      // reset when the run began is still unsure, frozen gauges of a whole link let ekf_payload
      // bend it to 2.0e-3 before the residual trips.
      fault_ns_ = grid_.ExperimentStart(run->permit().running_since_ns) + 420 * kMs;
    }
    if (situation_ == Situation::kStopping) {
      run->Until(fault_ns_ - 40 * kMs);
      run->Ask(RequestKind::kStop);
    }
    run->Until(fault_ns_);
    before_ = run->permit().state;
    run->Spoil(fault, fault_ns_);
    run->Until(fault_ns_ + kWatchedTicks * kPeriodNs);
    return run;
  }

  // Whether each link has enough gauges besides those in `lost`.
  std::array<bool, 2> Determined(std::uint32_t lost) {
    fit_.Reset({});
    SensorFrame frame{};
    frame.strain_valid = 0xFFFFF & ~lost;
    return fit_.Fit(frame).valid;
  }

  // Tick, from the first with the fault on, from which it can be seen; -1: it need not be.
  int SeenFrom(const SensorFault& fault, const FaultyRun& run) {
    if (fault.wrong == Wrong::kEverySecond) return -1;
    if (fault.wrong != Wrong::kFrozen) {
      const std::array<bool, 2> valid = Determined(fault.strain);
      return fault.counters != 0 || !valid[0] || !valid[1] ? 0 : -1;
    }
    const std::array<int, 2> gauges = {std::popcount(fault.strain & kLinkGauges),
                                       std::popcount(fault.strain >> 10)};
    const auto& frames = run.sampled();
    const auto first = static_cast<std::size_t>(first_tick());
    int in_a_row = 0;
    for (std::size_t k = first; k < frames.size(); ++k) {
      bool seen = false;
      for (std::size_t i = 0; i < 20; ++i) {
        if ((fault.strain >> i & 1U) == 0 || gauges[i / 10] > 2) continue;
        const double counts = frames[k].strain[i] - frames[first - 1].strain[i];
        const StrainChannelConfig& row = config_.sensors.strain[i];
        const double unit =
            config_.sensors.strain_input.volts_per_count() / std::fabs(row.gain_v_per_unit);
        seen = seen || std::fabs(counts * unit) > kSeenStrain;
      }
      for (const EncoderConfig& encoder : config_.sensors.encoder) {
        const auto i = static_cast<std::size_t>(encoder.counter);
        // Both encoders of a joint: there is nothing to compare.
        const std::uint32_t joint = 5U << (i % 2);
        if ((fault.counters >> i & 1U) == 0 || (fault.counters & joint) == joint) continue;
        const std::uint32_t modulus = 1U << encoder.counter_bits;
        const std::uint32_t apart =
            (frames[k].counter[i] - frames[first - 1].counter[i]) & (modulus - 1);
        const double counts = std::min(apart, modulus - apart);
        const double step_rad = 2.0 * std::numbers::pi / encoder.counts_per_turn;
        seen = seen || counts * step_rad > kSeenEncoder_rad;
      }
      in_a_row = seen ? in_a_row + 1 : 0;  // a check needs kSeenTicks of it
      if (in_a_row == kSeenTicks) return static_cast<int>(k - first) + 1 - kSeenTicks;
    }
    return -1;
  }

  // The polynomial through the other gauges says little of the root without the two beside it: the
  // tip is 0.09 to 0.11 m off then, or the bending reaches its limit, by the phase of the move.
  bool WithoutRoot(const SensorFault& fault) const {
    return std::string_view(estimator_.name) == "polynomial" &&
           ((fault.strain & 3U) == 3U || (fault.strain >> 10 & 3U) == 3U);
  }

  // More than all gauges of one link, or than one encoder, in every second frame.
  static bool Many(const SensorFault& fault) {
    return fault.wrong == Wrong::kEverySecond &&
           std::popcount(fault.counters) + (fault.strain != 0 ? 1 : 0) > 1;
  }

  // The causes that name a sensor, by what is spoilt; of frozen readings, and of many that are lost
  // in turn, also the limits, which the other sensors may show first.
  static TripCauses Names(const SensorFault& fault) {
    using enum TripCause;
    TripCauses names = CauseBit(kEstimatorResidual);
    if (fault.counters != 0) {
      names |= CauseBit(kEncoderJump) | CauseBit(kHubAgainstRotor) | CauseBit(kNoCounterReading);
    }
    if (fault.strain != 0) {
      names |= CauseBit(kStrainStuck) | CauseBit(kStrainSaturated) | CauseBit(kStrainOutOfFamily) |
               CauseBit(kNoStrainReading1) | CauseBit(kNoStrainReading2);
    }
    if (fault.wrong == Wrong::kFrozen || Many(fault)) {
      for (const TripCause cause :
           {kSoftLimit1, kSoftLimit2, kHubRate1, kHubRate2, kBendingStrain1, kBendingStrain2}) {
        names |= CauseBit(cause);
      }
    }
    return names;
  }

  TripCause Expected(const SensorFault& fault) {
    if (fault.counters != 0) return TripCause::kNoCounterReading;
    return Determined(fault.strain)[0] ? TripCause::kNoStrainReading2
                                       : TripCause::kNoStrainReading1;
  }

  void Check(const SensorFault& fault) {
    SCOPED_TRACE(Text(fault));
    const std::unique_ptr<FaultyRun> played = Play(fault);
    FaultyRun& run = *played;
    ASSERT_FALSE(run.refused);
    ASSERT_EQ(before_, kStateOf[static_cast<std::size_t>(situation_)]);
    const bool unbounded =
        !estimator_.has_model &&
        (fault.wrong == Wrong::kFrozen || fault.wrong == Wrong::kEverySecond || WithoutRoot(fault));
    int trip = -1;
    TripCauses faults = 0;
    for (const TickRecord& record : run.tick) {
      if (trip >= 0 || record.output.faults == 0) continue;
      trip = static_cast<int>(record.input.tick - first_tick());
      faults = record.output.faults;
      if (!unbounded && !Damped(faults, true)) {
        EXPECT_EQ(record.output.torque_nm, (std::array{0.0, 0.0})) << "category 0";
      }
    }
    const int seen = SeenFrom(fault, run);
    const bool lost = fault.wrong == Wrong::kInvalid || fault.wrong == Wrong::kLate;
    if (seen >= 0) {
      EXPECT_GE(trip, 0) << "no trip; seen from tick " << seen;
      EXPECT_LT(trip, seen + kSeenTicks);
    } else if (fault.wrong != Wrong::kFrozen && !Many(fault) && !unbounded) {
      EXPECT_EQ(trip, -1) << CauseNamesOf(faults);
    }
    if (unbounded) return;
    if (trip >= 0) {
      EXPECT_EQ(run.permit().state, SafetyState::kTripped);
      EXPECT_EQ(run.permit().cause, LowestCause(faults));
      if (lost) {
        EXPECT_EQ(trip, 1) << "the second tick without the reading";
        EXPECT_STREQ(ToString(run.permit().cause), ToString(Expected(fault)));
      } else {
        EXPECT_NE(CauseBit(run.permit().cause) & Names(fault), 0u) << ToString(run.permit().cause);
      }
    }
    const TripCauses bent =
        CauseBit(TripCause::kBendingStrain1) | CauseBit(TripCause::kBendingStrain2);
    ExpectWithinBounds(run, trip, (faults & bent) != 0);
  }

  static std::string CauseNamesOf(TripCauses faults) {
    std::string names;
    for (int i = 1; i < kTripCauses; ++i) {
      if ((faults >> i & 1U) != 0) names += std::string(ToString(static_cast<TripCause>(i))) + " ";
    }
    return names;
  }

  // @param bent  the bending is a cause of the trip: it is beyond its limit in that tick
  void ExpectWithinBounds(const FaultyRun& run, int trip, bool bent) {
    const auto first = static_cast<std::size_t>(first_tick());
    const std::size_t end =
        trip >= 0 ? first + static_cast<std::size_t>(trip) + 1 : first + kWatchedTicks;
    double tip_m = 0.0, strain = 0.0;
    for (std::size_t k = first; k < std::min({end, run.truth.size(), healthy_->truth.size()});
         ++k) {
      const std::array<double, 2>&at = run.truth[k].tip_m, &right = healthy_->truth[k].tip_m;
      tip_m = std::max(tip_m, std::hypot(at[0] - right[0], at[1] - right[1]));
      for (std::size_t i = 0; i < 20 && !(bent && k + 1 == end); ++i) {
        const double unit = config_.sensors.strain_input.volts_per_count() /
                            config_.sensors.strain[i].gain_v_per_unit;
        strain = std::max(strain, std::fabs(run.sampled()[k].strain[i] * unit));
      }
    }
    EXPECT_LT(tip_m, kTipBound_m) << "trip " << trip;
    EXPECT_LT(strain, kBendingBound) << "trip " << trip;
    worst_tip_m_ = std::max(worst_tip_m_, tip_m);
    worst_strain_ = std::max(worst_strain_, strain);
    ++cases_;
    if (trip >= 0) ++trips_;
  }

  void TearDown() override {
    std::printf("  %s, %s: %d cases, %d trips; tip at most %.1f mm off, strain at most %.2e\n",
                estimator_.name, kSituations[static_cast<std::size_t>(situation_)], cases_, trips_,
                1e3 * worst_tip_m_, worst_strain_);
  }

  static constexpr std::array<SafetyState, 4> kStateOf = {
      SafetyState::kIdle, SafetyState::kArmed, SafetyState::kRunning, SafetyState::kStopping};

  const Estimator& estimator_;
  const Situation situation_;
  const RigConfig config_;
  const Design design_;
  const LoopGrid grid_;
  const PlannedExperiment planned_;
  StrainFit fit_;
  std::int64_t fault_ns_ = 0;
  SafetyState before_ = SafetyState::kStarting;
  std::unique_ptr<FaultyRun> healthy_;
  double worst_tip_m_ = 0.0, worst_strain_ = 0.0;
  int cases_ = 0, trips_ = 0;
};

// Each encoder, all gauges of a link, all gauges; and each gauge while the arm runs. At rest the
// gauges of a link are alike: the first, one of the middle and the last.
TEST_P(SensorLoss, OfOneElementTripsByNameOrIsBridged) {
  EXPECT_TRUE(healthy_->tick.back().output.faults == 0 && !healthy_->refused);
  std::vector<SensorFault> elements = {
      {.strain = kLinkGauges}, {.strain = kLinkGauges << 10}, {.strain = 0xFFFFF}};
  for (std::uint32_t i = 0; i < kCounters; ++i) elements.push_back({.counters = 1U << i});
  for (std::uint32_t i = 0; i < 20; ++i) {
    if (situation_ != Situation::kRunning && i % 10 != 0 && i % 10 != 5 && i % 10 != 9) continue;
    elements.push_back({.strain = 1U << i});
  }
  for (const Wrong wrong : kAllWrongs) {
    for (SensorFault fault : elements) {
      fault.wrong = wrong;
      Check(fault);
    }
  }
}

// Pairs of gauges of one link, and any subsets of all sensors. The whole campaign has every gauge,
// every pair; its subsets are 512 in all, as each estimator in each situation has 32.
TEST_P(SensorLoss, CampaignOfPairsAndSubsets) {
  const bool whole = CampaignCases(0, 1) != 0;
  std::vector<SensorFault> sets;
  for (std::uint32_t i = 0; i < 20; ++i) {
    if (whole) sets.push_back({.strain = 1U << i});
    for (std::uint32_t j = i + 1; j < 20; ++j) {
      const bool adjacent_at_an_end = j == i + 1 && (i % 10 == 0 || j % 10 == 9);
      if (i / 10 != j / 10 || (!whole && !adjacent_at_an_end)) continue;
      sets.push_back({.strain = 1U << i | 1U << j});
    }
  }
  std::mt19937 random(1);
  const auto draw = [&random](std::uint32_t below) {
    return static_cast<std::uint32_t>(random() % below);
  };
  const long subsets = CampaignCases(2, 32);
  for (long k = 0; k < subsets; ++k) {
    // Sparse to dense, so that some leave the loop going.
    std::uint32_t lost = draw(1U << 20);
    for (std::uint32_t thin = draw(4); thin > 0; --thin) lost &= draw(1U << 20);
    sets.push_back({.strain = lost, .counters = draw(4) == 0 ? draw(16) : 0U});
    sets.back().wrong = kAllWrongs[draw(kAllWrongs.size())];
  }
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const bool subset = k + static_cast<std::size_t>(subsets) >= sets.size();
    for (const Wrong wrong : kAllWrongs) {
      SensorFault fault = sets[k];
      if (subset && fault.wrong != wrong) continue;  // has a kind of its own
      fault.wrong = wrong;
      Check(fault);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, SensorLoss,
                         testing::Combine(testing::Range<std::size_t>(0, kEstimators.size()),
                                          testing::Values(Situation::kIdle, Situation::kArmed,
                                                          Situation::kRunning,
                                                          Situation::kStopping)),
                         [](const auto& shown) {
                           return std::string(kEstimators[std::get<0>(shown.param)].name) +
                                  kSituations[static_cast<std::size_t>(std::get<1>(shown.param))];
                         });

}  // namespace
}  // namespace flexarm
