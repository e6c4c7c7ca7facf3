#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "config/config.h"
#include "model/beam/link_modes.h"

namespace flexarm {

/// The wanted gauges of a link.
struct GaugeTask {
  int modes = 2;            ///< modal coordinates that are fitted to the gauges of a link
  int count = 10;           ///< gauges
  double noise_strain = 0;  ///< standard deviation of a reading, unit strain, > 0
  double spacing_m = 0.02;  ///< least distance between two gauges, middle to middle
  double margin_m = 0.01;   ///< least distance of a middle from the ends of the link
};

/// Gauges on a link, and how well the weighted least-squares fit to them knows its modes.
struct GaugeLayout {
  std::vector<double> position_m;
  Eigen::MatrixXd covariance_m2;  ///< of the modal coordinates, which are tip deflections
  double tip_sigma_m;             ///< standard deviation of the fitted deflection of the tip
  /// What one metre of the lowest mode that is not fitted adds to each that is.
  Eigen::VectorXd next_mode;

  double sigma_m(int mode) const { return std::sqrt(covariance_m2(mode, mode)); }
};

/// Surface strain of a link's modes, (h/2) psi_j''(x).
class GaugeShapes {
 public:
  /// @param count  modes, one more than are fitted
  GaugeShapes(LinkParameters link, LinkModes modes, int count);

  Eigen::VectorXd At(double x_m) const;
  double length_m() const { return link_.length_m(); }
  int count() const { return count_; }

 private:
  LinkParameters link_;
  LinkModes modes_;
  int count_;
};

/// The fit of `modes` coordinates to gauges with the given noise.
/// @param sigma  per gauge, unit strain
/// @throws std::invalid_argument if the gauges do not determine the modes
GaugeLayout JudgeGauges(const GaugeShapes& shapes, int modes, const std::vector<double>& position_m,
                        const std::vector<double>& sigma);

/// Positions with the largest determinant of the information matrix, so that the ellipsoid of the
/// modal coordinates' errors has the least volume, however the modes are scaled. Found by
/// exchanging one gauge after the other on a grid of a four-hundredth of the link, from several
/// starts: the best of these, not proved to be the best of all.
/// @throws std::invalid_argument if the gauges have no room, or are fewer than the modes
std::vector<double> BestGaugePositions(const GaugeShapes& shapes, const GaugeTask& task);

/// The thesis's rule (Appendix B1): where the strain of a mode has a local maximum, the root
/// included, of mode 1, then mode 2, .., until there are enough.
std::vector<double> LocalMaximaOfStrain(const GaugeShapes& shapes, const GaugeTask& task);

/// A link's gauges as the config has them, as proposed, and as the thesis wired them.
struct GaugeComparison {
  int link;
  GaugeTask task;       ///< of the proposed ones
  GaugeLayout shipped;  ///< of the config, with its gains and its converter, or with that noise
  GaugeLayout proposed;
  GaugeLayout
      thesis;  ///< five half bridges at local maxima, of the same full scale: noise as above
};

/// What a user may choose instead of the config's.
struct GaugeChoice {
  int modes = 0;              ///< 0: as many as the config's estimator fits
  int per_link = 0;           ///< 0: as many as the config has on the link
  double noise_strain = 0.0;  ///< 0: of the config's converter, quantisation included
  double spacing_m = 0.02;
};

inline constexpr std::size_t kThesisHalfBridges = 5;

/// @throws std::invalid_argument as the functions above
std::vector<GaugeComparison> CompareGauges(const RigConfig& config, const GaugeChoice& choice = {});

nlohmann::ordered_json GaugesJson(const std::vector<GaugeComparison>& links);

}  // namespace flexarm
