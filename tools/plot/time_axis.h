#pragma once

#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "tools/plot/plot_data.h"
#include "tools/plot/sheet.h"

namespace flexarm {

/// Colour of a safety state, as #RRGGBB.
const char* StateColour(SafetyState state);

/// The time axis that all panels of a picture have in common, with what is marked on it.
class TimeAxis {
 public:
  /// @param runs  outlive it; of several runs only the trips are marked
  explicit TimeAxis(const std::vector<PlotRun>& runs);

  /// Lines at the marks and shades where samples are missing, for all plots that follow.
  void WriteMarks(std::ostringstream* script) const;
  /// Ends them.
  void ClearMarks(std::ostringstream* script) const;
  void WriteRange(bool with_numbers, std::ostringstream* script) const;
  /// The strip of safety states, a row a run, with the numbers of the marks.
  void WriteStates(const Sheet& sheet, const std::array<double, 2>& x, double top_px,
                   std::ostringstream* script) const;

  /// What the numbers of the marks stand for: a line a mark.
  std::vector<std::string> Lines() const;

 private:
  const std::vector<PlotRun>& runs_;
  double from_s_ = 0.0, until_s_ = 1.0;
  std::vector<PlotRun::Mark> marks_;
};

}  // namespace flexarm
