#pragma once

#include <functional>
#include <string>
#include <vector>

#include "controller/runlog/run_reader.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// One curve of a chart.
struct PanelSignal {
  std::string label;
  std::function<double(const TickRecord& record)> value;  ///< NaN: none
  bool is_reference = false;
};

/// One chart of the signals around a trip.
struct SignalPanel {
  std::string title;
  std::string unit;
  std::vector<PanelSignal> signal;
  std::vector<double> limit;     ///< in `unit`
  std::vector<std::string> row;  ///< of digital inputs: their names (SvgChart::row)
};

/// All charts: hub angles with reference and limits, rates, strains at the root and of each gauge,
/// torques, the estimate, residuals, the payload estimate, the inputs.
std::vector<SignalPanel> SignalPanels(const RunInfo& info, const RigConfig& config);

}  // namespace flexarm
