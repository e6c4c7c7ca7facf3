#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/runlog/csv_import.h"
#include "estimator/calibration.h"

namespace flexarm {

/// How many times larger measured strain is than it should be.
struct ScaleFit {
  double factor;       ///< 1: the scale is right; negative: the sign is wrong
  double sigma;        ///< its standard deviation
  double correlation;  ///< of measured and predicted strain, -1 .. 1
};

/// Verdict on the scale of one link's strain channels, or of one channel.
struct ScaleVerdict {
  enum class Kind : unsigned char {
    kRight,          ///< nothing speaks against the scale
    kWrong,          ///< fit->factor is far from 1 and certain
    kNotObservable,  ///< the joint hardly moves, or the link hardly bends: nothing can be said
    kNoMatch,        ///< measured strain does not follow the predicted one, whatever the scale
  };
  Kind kind = Kind::kNotObservable;
  std::optional<ScaleFit> fit{};  ///< none: not observable
};

struct StrainScaleResult {
  std::array<ScaleVerdict, 2> link;   ///< of the channels that agree with each other
  std::vector<ScaleVerdict> channel;  ///< in the order of the config
};

/// Compares the strains of a CSV file with those that the motion of the joints demands.
///
/// The innovation of the loop's own filter hides a wrong scale: the filter follows the gauges, and
/// then predicts what they will say. Here the prediction has no part of the gauges: the moment at
/// the root of a link is what hub and rotor pass on,
///   M = u - F sgn(th') - b th' - (J + I_h) th'',
/// with th from the counters, whatever the payload and the elbow's angle. Measured strain regressed
/// on M gives b_i, strain per N m, for each channel. Bent as the link's first modes, b_i follows
/// from one number a mode, and those give the moment at the root per M, which is 1 if the scale is
/// right. Channels that do not fit to most of their link have a factor of their own. Rests say
/// nothing, because a joint that sticks passes on any moment within its friction.
///
/// Where friction and the rotor take most of the torque, the prediction is how the links bend if
/// their joints move as measured. It depends on the payload: a scale is wrong only if it is with
/// the least and the greatest of controller.payload_range_kg.
/// @param config  of the rig; @param calibration  of the run
StrainScaleResult CheckStrainScales(const RigConfig& config, const Calibration& calibration,
                                    const CsvRun& run);

const char* ToString(ScaleVerdict::Kind kind);  ///< "right", "wrong", "not-observable", "no-match"

/// Beyond what may be an error of the model: below 0, or more than 1.5 times off.
bool IsFarFromOne(double factor);

}  // namespace flexarm
