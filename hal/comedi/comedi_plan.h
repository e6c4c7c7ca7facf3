#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/comedi/comedi_config.h"

namespace flexarm {

/// Time of one channel.
struct ComediChannelCost {
  std::string channel;       ///< "strain[3]", "drive1", "hub2"
  int transaction;           ///< channels of the same transaction share its time
  std::int64_t exchange_ns;  ///< time in the exchange, of the whole transaction
  std::int64_t convert_ns;   ///< time in the board's scan; 0: not streamed, or simultaneous
};

/// The transactions of an exchange with a board, and their bounds.
///
/// An instruction is one system call that reads or writes one channel and waits for the board. A
/// streamed channel needs no instruction: the board has made the scan before, and reading the
/// buffer is one transaction for all channels. So is reading the lines of one subdevice.
struct ComediPlan {
  std::vector<ComediChannelCost> channels;  ///< in the order of the exchange
  std::int64_t exchange_worst_ns;
  std::int64_t reconnect_worst_ns;
  std::int64_t scan_ns;    ///< from the first to the last conversion of a scan
  std::int64_t oldest_ns;  ///< largest age of a streamed reading when it is read; 0: none is
};

/// @param config  without problems. Allocates: start-up only.
ComediPlan PlanComedi(const ComediBoardConfig& config);

}  // namespace flexarm
