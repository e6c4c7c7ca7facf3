#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/comedi/comedi_config.h"

namespace flexarm {

/// What one channel costs.
struct ComediChannelCost {
  std::string channel;       ///< "strain[3]", "drive1", "hub2"
  int transaction;           ///< channels with the same one share its time
  std::int64_t exchange_ns;  ///< of an exchange, the whole transaction
  std::int64_t convert_ns;   ///< of a scan, by the board itself; 0: not streamed, or all at once
};

/// What an exchange with a board consists of, and what it may take.
///
/// An instruction is one system call that reads or writes one channel and waits for the board. A
/// streamed channel costs no instruction: the scan is made by the board beforehand, and reading
/// the buffer is one transaction for all. So are the lines of one subdevice.
struct ComediPlan {
  std::vector<ComediChannelCost> channels;  ///< in the order of the exchange
  std::int64_t exchange_worst_ns;
  std::int64_t reconnect_worst_ns;
  std::int64_t scan_ns;    ///< from the first to the last conversion of a scan
  std::int64_t oldest_ns;  ///< age that a streamed reading can have when it is read; 0: none is
};

/// @param config  without problems. Allocates: start-up only.
ComediPlan PlanComedi(const ComediBoardConfig& config);

}  // namespace flexarm
