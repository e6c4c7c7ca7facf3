#include "controller/reference/sampling_grid.h"

#include <cmath>

#include "controller/types/rejected_error.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kGridTolerance = 1e-6;  // of a period: round-off of sums of decimal times

}  // namespace

int OnGrid(double time_s, double period_s, const std::string& what) {
  const double periods = time_s / period_s;
  if (std::fabs(periods - std::round(periods)) > kGridTolerance) {
    throw RejectedError(what + " = " + NumberText(time_s) +
                        " s does not lie on the sampling grid: it must be a multiple of " +
                        NumberText(period_s) + " s");
  }
  return static_cast<int>(std::lround(periods));
}

double InSeconds(int periods, double period_s) {
  return std::round(periods * period_s * 1e9) / 1e9;
}

}  // namespace flexarm
