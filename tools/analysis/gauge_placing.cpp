#include "tools/analysis/gauge_placing.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kGrid = 400;            // places of a link
constexpr int kMostExchanges = 200;   // rounds over all gauges; 3 to 10 are needed
constexpr int kMostStrainModes = 12;  // of the thesis's rule

double HalfThickness(const LinkParameters& link, double x_m) {
  double end = 0.0;
  for (const BeamSection& section : link.section) {
    end += section.length_m;
    if (x_m <= end) return section.half_thickness_m;
  }
  return link.section.back().half_thickness_m;
}

// The candidates and what each adds to the information matrix.
class GaugeSearch {
 public:
  GaugeSearch(const GaugeShapes& shapes, const GaugeTask& task) : task_(task) {
    const double room = shapes.length_m() - 2.0 * task.margin_m;
    if (task.count < task.modes || room < 0.0 || (task.count - 1) * task.spacing_m > room + 1e-12) {
      throw std::invalid_argument(
          "gauges: " + std::to_string(task.count) + " gauges have no room on a link of " +
          std::to_string(shapes.length_m()) + " m, or are fewer than the modes");
    }
    for (int i = 0; i <= kGrid; ++i) {
      place_.push_back(task.margin_m + room * i / kGrid);
      shape_.push_back(shapes.At(place_.back()).head(task.modes));
    }
    // Columns of unit size: the determinant must not underflow.
    VectorXd largest = VectorXd::Zero(task.modes);
    for (const VectorXd& s : shape_) largest = largest.cwiseMax(s.cwiseAbs());
    for (VectorXd& s : shape_) s = s.cwiseQuotient(largest);
  }

  // Gauges in equal steps over the part of the link from its root.
  std::vector<int> Spread(double part) const {
    std::vector<int> at;
    const double least = task_.spacing_m * (task_.count - 1);
    const double room = place_.back() - place_.front(), span = std::max(least, part * room);
    for (int i = 0; i < task_.count; ++i) {
      const double x = task_.count > 1 ? span * i / (task_.count - 1) : 0.0;
      at.push_back(room > 0.0 ? static_cast<int>(std::ceil(x / room * kGrid - 1e-9)) : 0);
    }
    return at;
  }

  // Exchanges gauges until none gains. @returns the determinant
  double Improve(std::vector<int>* at) const {
    double best = Determinant(*at);
    for (int round = 0; round < kMostExchanges; ++round) {
      const double before = best;
      for (int& gauge : *at) {
        const int stayed = gauge;
        int chosen = stayed;
        for (int place = 0; place <= kGrid; ++place) {
          gauge = place;
          if (!Free(*at, &gauge)) continue;
          const double gained = Determinant(*at);
          if (gained > best * (1.0 + 1e-12)) best = gained, chosen = place;
        }
        gauge = chosen;
      }
      if (!(best > before)) break;
    }
    return best;
  }

  std::vector<double> Positions(std::vector<int> at) const {
    std::sort(at.begin(), at.end());
    std::vector<double> position;
    for (const int i : at) position.push_back(place_[static_cast<std::size_t>(i)]);
    return position;
  }

 private:
  bool Free(const std::vector<int>& at, const int* moved) const {
    const double x = place_[static_cast<std::size_t>(*moved)];
    return std::all_of(at.begin(), at.end(), [&](const int& other) {
      return &other == moved ||
             std::abs(place_[static_cast<std::size_t>(other)] - x) >= task_.spacing_m - 1e-12;
    });
  }

  double Determinant(const std::vector<int>& at) const {
    MatrixXd information = MatrixXd::Zero(task_.modes, task_.modes);
    for (const int i : at) {
      const VectorXd& s = shape_[static_cast<std::size_t>(i)];
      information += s * s.transpose();
    }
    return information.determinant();
  }

  GaugeTask task_;
  std::vector<double> place_;
  std::vector<VectorXd> shape_;
};

std::vector<double> ConfigPositions(const SensorConfig& sensors, int link) {
  std::vector<double> position;
  for (const StrainChannelConfig& row : sensors.strain) {
    if (row.link == link) position.push_back(row.position_m);
  }
  return position;
}

std::vector<double> ConfigNoise(const SensorConfig& sensors, int link, double noise_strain) {
  std::vector<double> sigma;
  const StrainInputConfig& input = sensors.strain_input;
  const double counts = std::sqrt(input.noise_counts * input.noise_counts + 1.0 / 12.0);
  for (const StrainChannelConfig& row : sensors.strain) {
    if (row.link != link) continue;
    sigma.push_back(noise_strain > 0.0
                        ? noise_strain
                        : counts * input.volts_per_count() / std::abs(row.gain_v_per_unit));
  }
  return sigma;
}

nlohmann::ordered_json LayoutJson(const GaugeLayout& layout) {
  nlohmann::ordered_json json;
  json["position_m"] = layout.position_m;
  for (Index i = 0; i < layout.covariance_m2.rows(); ++i) {
    const VectorXd row = layout.covariance_m2.row(i);
    json["covariance_m2"].push_back(std::vector<double>(row.begin(), row.end()));
    json["sigma_m"].push_back(layout.sigma_m(static_cast<int>(i)));
  }
  json["tip_sigma_m"] = layout.tip_sigma_m;
  json["next_mode_m_per_m"] = std::vector<double>(layout.next_mode.begin(), layout.next_mode.end());
  return json;
}

}  // namespace

GaugeShapes::GaugeShapes(LinkParameters link, LinkModes modes, int count)
    : link_(std::move(link)), modes_(std::move(modes)), count_(count) {}

VectorXd GaugeShapes::At(double x_m) const {
  VectorXd strain(count_);
  for (int j = 0; j < count_; ++j) {
    strain[j] = HalfThickness(link_, x_m) * modes_.mode[static_cast<std::size_t>(j)].Curvature(x_m);
  }
  return strain;
}

GaugeLayout JudgeGauges(const GaugeShapes& shapes, int modes, const std::vector<double>& position_m,
                        const std::vector<double>& sigma) {
  const Index n = static_cast<Index>(position_m.size());
  MatrixXd S(n, modes);
  VectorXd next(n);
  for (Index i = 0; i < n; ++i) {
    const double weight = 1.0 / sigma[static_cast<std::size_t>(i)];
    const VectorXd strain = weight * shapes.At(position_m[static_cast<std::size_t>(i)]);
    S.row(i) = strain.head(modes);
    next[i] = strain[modes];
  }
  // Columns of unit size: the modes' strains differ by orders of magnitude.
  const VectorXd size = S.colwise().norm();
  if (n < modes || size.minCoeff() <= 0.0) {
    throw std::invalid_argument("gauges: fewer than the modes of the link");
  }
  const MatrixXd scaled = S * size.cwiseInverse().asDiagonal();
  const MatrixXd information = scaled.transpose() * scaled;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information);
  if (eigen.eigenvalues()[0] < 1e-10) {
    throw std::invalid_argument("gauges: they do not determine the modes of the link");
  }
  const MatrixXd inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                           eigen.eigenvectors().transpose();
  GaugeLayout layout{position_m, {}, 0.0, {}};
  const auto back = size.cwiseInverse().asDiagonal();
  layout.covariance_m2 = back * inverse * back;
  layout.tip_sigma_m = std::sqrt(layout.covariance_m2.sum());  // psi_j(L) = 1
  layout.next_mode = back * (inverse * (scaled.transpose() * next));
  return layout;
}

std::vector<double> BestGaugePositions(const GaugeShapes& shapes, const GaugeTask& task) {
  const GaugeSearch search(shapes, task);
  std::vector<int> best;
  double largest = -1.0;
  for (const double part : {1.0, 0.75, 0.5, 0.25, 0.0}) {
    std::vector<int> at = search.Spread(part);
    const double found = search.Improve(&at);
    if (found > largest) largest = found, best = at;
  }
  return search.Positions(best);
}

std::vector<double> LocalMaximaOfStrain(const GaugeShapes& shapes, const GaugeTask& task) {
  std::vector<double> position;
  const double L = shapes.length_m();
  const auto add = [&](double x) {
    const bool apart = std::all_of(position.begin(), position.end(), [&](double other) {
      return std::abs(other - x) >= task.spacing_m;
    });
    if (apart && static_cast<int>(position.size()) < task.count) position.push_back(x);
  };
  add(task.margin_m);
  for (int j = 0; j < shapes.count(); ++j) {
    const auto size = [&](int i) { return std::abs(shapes.At(L * i / kGrid)[j]); };
    for (int i = 1; i < kGrid; ++i) {
      if (size(i) > size(i - 1) && size(i) >= size(i + 1)) add(L * i / kGrid);
    }
  }
  if (static_cast<int>(position.size()) < task.count) {
    throw std::invalid_argument("gauges: the modes have too few local maxima of strain");
  }
  std::sort(position.begin(), position.end());
  return position;
}

std::vector<GaugeComparison> CompareGauges(const RigConfig& config, const GaugeChoice& choice) {
  std::vector<GaugeComparison> all;
  const int modes_wanted = choice.modes > 0 ? choice.modes : config.estimator.modes_per_link;
  for (const int link : {1, 2}) {
    const LinkModes modes = link == 1 ? Link1Modes(config.arm, kMostStrainModes)
                                      : Link2Modes(config.arm, kMostStrainModes);
    const LinkParameters& of = config.arm.link[static_cast<std::size_t>(link) - 1];
    const GaugeShapes shapes(of, modes, kMostStrainModes);
    const std::vector<double> shipped = ConfigPositions(config.sensors, link);
    const std::vector<double> sigma = ConfigNoise(config.sensors, link, choice.noise_strain);
    if (sigma.empty()) throw std::invalid_argument("gauges: the config has none on a link");
    GaugeTask task{.modes = modes_wanted,
                   .count = choice.per_link > 0 ? choice.per_link : static_cast<int>(sigma.size()),
                   .noise_strain = *std::min_element(sigma.begin(), sigma.end()),
                   .spacing_m = choice.spacing_m};
    const std::vector<double> proposed = BestGaugePositions(shapes, task);
    GaugeTask bridges = task;
    bridges.count = static_cast<int>(kThesisHalfBridges);
    const std::vector<double> maxima = LocalMaximaOfStrain(shapes, bridges);
    all.push_back({link, task, JudgeGauges(shapes, modes_wanted, shipped, sigma),
                   JudgeGauges(shapes, modes_wanted, proposed,
                               std::vector<double>(proposed.size(), task.noise_strain)),
                   JudgeGauges(shapes, modes_wanted, maxima,
                               std::vector<double>(maxima.size(), task.noise_strain))});
  }
  return all;
}

nlohmann::ordered_json GaugesJson(const std::vector<GaugeComparison>& links) {
  nlohmann::ordered_json json;
  for (const GaugeComparison& link : links) {
    json["links"].push_back({{"link", link.link},
                             {"modes", link.task.modes},
                             {"noise_strain", link.task.noise_strain},
                             {"spacing_m", link.task.spacing_m},
                             {"shipped", LayoutJson(link.shipped)},
                             {"proposed", LayoutJson(link.proposed)},
                             {"five_half_bridges", LayoutJson(link.thesis)}});
  }
  return json;
}

}  // namespace flexarm
