#pragma once

#include <vector>

#include "hal/comedi/comedi_config.h"
#include "hal/comedi/daq_board.h"

namespace flexarm {

/// The channels of a verified board, in the order of the config's rows, with their range.
struct ComediChannels {
  std::vector<DaqChannel> strain;
  std::vector<DaqChannel> drive;
  std::vector<DaqChannel> counter;
  std::vector<int> line_subdevice;  ///< without duplicates
};

/// Verifies that an opened board is the one of the config: driver, name, and for every subdevice
/// that is used its kind, channels, bits and range. Locks the subdevices, sets every output to 0 V,
/// lines to input, and configures the scan, each read back. The scan is not started.
/// @throws HalError naming the device, what was found and what was expected
ComediChannels ProveComediBoard(const ComediBoardConfig& config, const DaqIdentity& identity,
                                DaqBoard* board);

}  // namespace flexarm
