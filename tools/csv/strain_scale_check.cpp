#include "tools/csv/strain_scale_check.h"

#include <algorithm>
#include <cmath>

#include "estimator/strain_scale.h"
#include "model/beam/link_modes.h"
#include "model/math/dense_decompositions.h"
#include "tools/csv/predicted_strain.h"

namespace flexarm {
namespace {

constexpr double kBlock_s = 0.5;           // errors of the prediction are correlated over less
constexpr double kLeastSignal = 3.0;       // of the predicted strain's rms over the noise
constexpr double kLeastMoving_s = 0.3;     // time in which the joint moves
constexpr double kLeastOfStrongest = 0.2;  // strain at a channel, of that at the link's strongest
constexpr std::size_t kChannelsForTwoModes = 5;
constexpr double kLeastCorrelation = 0.75;
constexpr double kLargestRight = 1.5;  // a factor between its inverse and this may be model error
constexpr double kCertainSigmas = 4.0;

// Measured and predicted strain of a channel where both are known, without their means.
struct StrainPair {
  Signal predicted, measured;  // unit strain
  std::vector<std::size_t> sample;
  double noise;  // of both, by the config, unit strain
};

double MeanSquare(const Signal& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

void TakeAwayMean(Signal* values) {
  double sum = 0.0;
  for (const double value : *values) sum += value;
  for (double& value : *values) value -= sum / static_cast<double>(values->size());
}

// Regression of predicted on measured strain, inverted: the prediction has the larger error, of
// friction and accelerations, and the other way round it would make the factor too small.
ScaleFit Regress(const StrainPair& pair, double period_s) {
  const auto block = std::max<std::size_t>(1, static_cast<std::size_t>(kBlock_s / period_s));
  double pp = 0.0, pm = 0.0, mm = 0.0;
  for (std::size_t k = 0; k < pair.predicted.size(); ++k) {
    pp += pair.predicted[k] * pair.predicted[k];
    pm += pair.predicted[k] * pair.measured[k];
    mm += pair.measured[k] * pair.measured[k];
  }
  if (!(mm > 0.0) || pm == 0.0) return {.factor = 0.0, .sigma = 0.0, .correlation = 0.0};
  const double share = pm / mm;
  double variance = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < pair.predicted.size(); ++k) {
    sum += pair.measured[k] * (pair.predicted[k] - share * pair.measured[k]);
    const bool last = k + 1 == pair.predicted.size();
    if (!last && pair.sample[k + 1] / block == pair.sample[k] / block) continue;
    variance += sum * sum;
    sum = 0.0;
  }
  return {.factor = 1.0 / share,
          .sigma = std::sqrt(variance) / mm / (share * share),
          .correlation = pm / std::sqrt(pp * mm)};
}

bool IsObservable(const StrainPair& pair, double period_s) {
  const bool enough = static_cast<double>(pair.predicted.size()) * period_s >= kLeastMoving_s;
  const double least = kLeastSignal * pair.noise;
  return enough && MeanSquare(pair.predicted) > least * least;
}

ScaleVerdict::Kind KindOf(const ScaleFit& fit) {
  const bool certain = std::abs(fit.factor - 1.0) > kCertainSigmas * fit.sigma;
  return IsFarFromOne(fit.factor) && certain ? ScaleVerdict::Kind::kWrong
                                             : ScaleVerdict::Kind::kRight;
}

// Unit strain of a channel for each N m at the root, bent as one of the modes; negative, because a
// torque bends the link backwards.
double StrainOfMoment(const RigConfig& config, const StrainChannelConfig& row,
                      const LinkModes& modes, std::size_t mode) {
  const LinkParameters& link = config.arm.link[static_cast<std::size_t>(row.link - 1)];
  const BeamSection& root = link.section.front();
  const BeamMode& shape = modes.mode[mode];
  return -link.HalfThicknessAt_m(row.position_m) * shape.Curvature(row.position_m) /
         (root.youngs_modulus_pa * root.second_moment_m4 * shape.Curvature(0.0));
}

// What strain a channel should have, smoothed, and where that is known.
struct Prediction {
  Signal strain;
  const std::vector<bool>* known;
  double noise;
};

// Measured and predicted strain where both are known for a whole window.
StrainPair PairOf(std::size_t channel, const RigConfig& config, const Calibration& calibration,
                  const CsvRun& run, const Prediction& prediction) {
  const StrainScale scale =
      Calibrated(StrainScaleOf(config.sensors, channel), calibration, channel);
  const double period_s = config.loop.period_s();
  Signal strain(run.input.size());
  for (std::size_t k = 0; k < strain.size(); ++k) {
    strain[k] = (run.strain_counts[k][channel] - scale.offset_counts) * scale.unit_per_count;
  }
  const Signal measured = Smoothed(strain, period_s);
  const double counts = std::hypot(config.sensors.strain_input.noise_counts, std::sqrt(1.0 / 12.0));
  StrainPair pair{.predicted = {},
                  .measured = {},
                  .sample = {},
                  .noise = std::hypot(counts * scale.unit_per_count, prediction.noise)};
  const std::size_t half = HalfWindow(period_s), margin = half + 1;
  for (std::size_t k = margin; k + margin < strain.size(); ++k) {
    bool use = true;
    for (std::size_t i = k - half; use && i <= k + half; ++i) {
      use = (*prediction.known)[i] && (run.input[i].frame.strain_valid >> channel & 1U) != 0;
    }
    if (!use) continue;
    pair.predicted.push_back(prediction.strain[k]);
    pair.measured.push_back(measured[k]);
    pair.sample.push_back(k);
  }
  TakeAwayMean(&pair.predicted);
  TakeAwayMean(&pair.measured);
  return pair;
}

// A channel of a link whose strain follows the moment.
struct Follower {
  std::size_t channel;
  ScaleFit fit;             // of its strain on that of the first mode
  Eigen::Vector2d of_mode;  // that of each mode, in units of the first
  double weight;            // mean square of the predicted strain
};

// Shares of the modes in the moment, by least squares over some of the followers.
Eigen::Vector2d SharesOf(const std::vector<Follower>& all, const std::vector<std::size_t>& used,
                         Eigen::Index modes) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(used.size()), modes);
  Eigen::VectorXd b(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const Follower& f = all[used[static_cast<std::size_t>(i)]];
    // A relative error of each: a channel with a factor of 1e6 counts as much as another.
    const double weight = std::sqrt(f.weight) / std::abs(f.fit.factor);
    A.row(i) = weight * f.of_mode.head(modes).transpose();
    b(i) = weight * f.fit.factor;
  }
  Eigen::Vector2d shares = Eigen::Vector2d::Zero();
  shares.head(modes) = A.colPivHouseholderQr().solve(b);
  return shares;
}

std::vector<std::size_t> AgreeingWith(const Eigen::Vector2d& shares,
                                      const std::vector<Follower>& all) {
  std::vector<std::size_t> agreeing;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!IsFarFromOne(all[i].fit.factor / all[i].of_mode.dot(shares))) agreeing.push_back(i);
  }
  return agreeing;
}

double WeightOf(const std::vector<Follower>& all, const std::vector<std::size_t>& of) {
  double sum = 0.0;
  for (const std::size_t i : of) sum += std::log1p(all[i].weight / all[0].weight);
  return sum;
}

// The largest set of channels that one bent shape explains: tried from every channel, or pair.
std::vector<std::size_t> Consensus(const std::vector<Follower>& all, Eigen::Index modes) {
  std::vector<std::size_t> best;
  const auto take = [&](const std::vector<std::size_t>& from) {
    std::vector<std::size_t> agreeing = AgreeingWith(SharesOf(all, from, modes), all);
    const bool more =
        agreeing.size() > best.size() ||
        (agreeing.size() == best.size() && WeightOf(all, agreeing) > WeightOf(all, best));
    if (more) best = std::move(agreeing);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (modes == 1) take({i});
    for (std::size_t j = i + 1; modes == 2 && j < all.size(); ++j) take({i, j});
  }
  return best;
}

// Verdict on a link, and on those of its channels that follow the moment.
ScaleVerdict JudgeLink(const std::vector<Follower>& followers,
                       std::vector<ScaleVerdict>* of_channel) {
  using Kind = ScaleVerdict::Kind;
  if (followers.empty()) return {.kind = Kind::kNoMatch, .fit = {}};
  const Eigen::Index modes = followers.size() >= kChannelsForTwoModes ? 2 : 1;
  const std::vector<std::size_t> agreeing = Consensus(followers, modes);
  if (agreeing.empty()) return {.kind = Kind::kNoMatch, .fit = {}};
  const Eigen::Vector2d shares = SharesOf(followers, agreeing, modes);
  ScaleFit link{.factor = shares.sum(), .sigma = 0.0, .correlation = 0.0};
  for (const std::size_t i : agreeing) {  // the strongest channel has the least error
    const ScaleFit& fit = followers[i].fit;
    if (std::abs(fit.correlation) <= std::abs(link.correlation)) continue;
    link.correlation = fit.correlation;
    link.sigma = std::abs(link.factor * fit.sigma / fit.factor);
  }
  double strongest = 0.0;
  const auto strain = [&shares](const Follower& of) {
    return std::sqrt(of.weight) * std::abs(of.of_mode.dot(shares));
  };
  for (const Follower& follower : followers) strongest = std::max(strongest, strain(follower));
  for (const Follower& follower : followers) {
    // Where the link bends little, near its tip, other modes and the link's own mass count.
    if (strain(follower) < kLeastOfStrongest * strongest) {
      (*of_channel)[follower.channel] = {};
      continue;
    }
    ScaleFit fit = follower.fit;
    const double share = link.factor / follower.of_mode.dot(shares);
    fit.factor *= share;
    fit.sigma *= std::abs(share);
    (*of_channel)[follower.channel] = {.kind = KindOf(fit), .fit = fit};
  }
  return {.kind = KindOf(link), .fit = link};
}

// What all verdicts need.
struct Case {
  const RigConfig& config;
  const Calibration& calibration;
  const CsvRun& run;
  const JointMotion& motion;
  std::array<LinkModes, 2> modes;

  std::vector<std::size_t> ChannelsOf(std::size_t link) const {
    std::vector<std::size_t> channels;
    for (std::size_t i = 0; i < config.sensors.strain.size(); ++i) {
      if (config.sensors.strain[i].link == static_cast<int>(link) + 1) channels.push_back(i);
    }
    return channels;
  }
};

// By the moment at the root.
ScaleVerdict JudgeByMoment(const Case& of, std::size_t link,
                           std::vector<ScaleVerdict>* of_channel) {
  const double period_s = of.config.loop.period_s();
  const RootMoment root = RootMomentOf(link, of.config, of.run, of.motion);
  const Signal moment = Smoothed(
      BehindGaugeFilter(root.moment_nm, of.config.sensors.strain_input, period_s), period_s);
  std::vector<Follower> followers;
  bool observable = false;
  for (const std::size_t i : of.ChannelsOf(link)) {
    const StrainChannelConfig& row = of.config.sensors.strain[i];
    const double of_moment = StrainOfMoment(of.config, row, of.modes[link], 0);
    Prediction prediction{
        .strain = moment, .known = &root.known, .noise = of_moment * root.noise_nm};
    for (double& strain : prediction.strain) strain *= of_moment;
    const StrainPair pair = PairOf(i, of.config, of.calibration, of.run, prediction);
    if (!IsObservable(pair, period_s)) continue;
    observable = true;
    const ScaleFit fit = Regress(pair, period_s);
    (*of_channel)[i] = {.kind = ScaleVerdict::Kind::kNoMatch, .fit = fit};
    if (!(std::abs(fit.correlation) >= kLeastCorrelation)) continue;
    const double second = StrainOfMoment(of.config, row, of.modes[link], 1);
    followers.push_back({.channel = i,
                         .fit = fit,
                         .of_mode = {1.0, second / of_moment},
                         .weight = MeanSquare(pair.predicted)});
  }
  return observable ? JudgeLink(followers, of_channel) : ScaleVerdict{};
}

// By the motion of the joints, with one payload.
ScaleVerdict JudgeChannel(const Case& of, std::size_t channel,
                          const std::vector<Eigen::VectorXd>& modes) {
  const StrainChannelConfig& row = of.config.sensors.strain[channel];
  const auto link = static_cast<std::size_t>(row.link - 1);
  const Eigen::Index count = modes.front().size() / 2;
  Eigen::VectorXd shape(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    shape(j) = of.config.arm.link[link].HalfThicknessAt_m(row.position_m) *
               of.modes[link].mode[static_cast<std::size_t>(j)].Curvature(row.position_m);
  }
  Signal strain;
  for (const Eigen::VectorXd& f : modes) {
    strain.push_back(shape.dot(f.segment(static_cast<Eigen::Index>(link) * count, count)));
  }
  const double period_s = of.config.loop.period_s();
  const StrainPair pair =
      PairOf(channel, of.config, of.calibration, of.run,
             {.strain = Smoothed(
                  BehindGaugeFilter(strain, of.config.sensors.strain_input, period_s), period_s),
              .known = &of.motion.read,
              .noise = 0.0});
  if (!IsObservable(pair, period_s)) return {};
  const ScaleFit fit = Regress(pair, period_s);
  const bool follows = std::abs(fit.correlation) >= kLeastCorrelation;
  return {.kind = follows ? KindOf(fit) : ScaleVerdict::Kind::kNoMatch, .fit = fit};
}

bool IsFarAlike(double a, double b) {
  return IsFarFromOne(a) && IsFarFromOne(b) && (a > 0.0) == (b > 0.0) && (a > 1.0) == (b > 1.0);
}

// The verdict with the payload that fits better; wrong only if the other factor is far off as well.
ScaleVerdict Common(const ScaleVerdict& light, const ScaleVerdict& heavy) {
  using Kind = ScaleVerdict::Kind;
  if (!light.fit) return heavy;
  if (!heavy.fit) return light;
  ScaleVerdict better =
      std::abs(light.fit->correlation) > std::abs(heavy.fit->correlation) ? light : heavy;
  const bool alike = IsFarAlike(light.fit->factor, heavy.fit->factor);
  if (better.kind == Kind::kWrong && !alike) better.kind = Kind::kRight;
  return better;
}

}  // namespace

StrainScaleResult CheckStrainScales(const RigConfig& config, const Calibration& calibration,
                                    const CsvRun& run) {
  using Kind = ScaleVerdict::Kind;
  const JointMotion motion = MotionOf(config, calibration, run);
  const Case of{
      config, calibration, run, motion, {Link1Modes(config.arm, 2), Link2Modes(config.arm, 2)}};
  StrainScaleResult result{.link = {},
                           .channel = std::vector<ScaleVerdict>(config.sensors.strain.size())};
  std::array<std::vector<Eigen::VectorXd>, 2> modes;  // with the least and the greatest payload
  for (std::size_t link = 0; link < 2; ++link) {
    ScaleVerdict& verdict = result.link[link];
    verdict = JudgeByMoment(of, link, &result.channel);
    if (verdict.kind == Kind::kRight || verdict.kind == Kind::kWrong) continue;
    for (std::size_t i = 0; i < 2 && modes[i].empty(); ++i) {
      modes[i] = BaseDrivenModes(config, config.controller.payload_range_kg[i], motion);
    }
    for (const std::size_t i : of.ChannelsOf(link)) {
      result.channel[i] = Common(JudgeChannel(of, i, modes[0]), JudgeChannel(of, i, modes[1]));
      const ScaleVerdict& channel = result.channel[i];
      const bool clearer = channel.fit && (!verdict.fit || std::abs(channel.fit->correlation) >
                                                               std::abs(verdict.fit->correlation));
      if (clearer) verdict = channel;
    }
  }
  return result;
}

bool IsFarFromOne(double factor) {
  return factor < 0.0 || std::abs(std::log(factor)) > std::log(kLargestRight);
}

const char* ToString(ScaleVerdict::Kind kind) {
  switch (kind) {
    case ScaleVerdict::Kind::kRight:
      return "right";
    case ScaleVerdict::Kind::kWrong:
      return "wrong";
    case ScaleVerdict::Kind::kNotObservable:
      return "not-observable";
    case ScaleVerdict::Kind::kNoMatch:
      return "no-match";
  }
  return "?";
}

}  // namespace flexarm
