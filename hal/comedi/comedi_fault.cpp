#include "hal/comedi/comedi_fault.h"

namespace flexarm {

const char* ToString(ComediFault fault) noexcept {
  switch (fault) {
    case ComediFault::kNone:
      return "no fault";
    case ComediFault::kStarting:
      return "the scan restarts";
    case ComediFault::kLateScan:
      return "scan late";
    case ComediFault::kEarlyScan:
      return "scans arrive too fast";
    case ComediFault::kSlow:
      return "instruction takes longer than instruction_us";
    case ComediFault::kReadRefused:
      return "reading is refused";
    case ComediFault::kOverrun:
      return "input buffer overrun, or an error of the board";
    case ComediFault::kScanStopped:
      return "the board has stopped scanning";
    case ComediFault::kStartRefused:
      return "the board does not start to scan";
    case ComediFault::kOutputRefused:
      return "writing an output is refused";
    case ComediFault::kGone:
      return "the board is gone";
    case ComediFault::kBeyondRange:
      return "reads a number beyond the bits of the converter";
  }
  return "?";
}

bool Lasts(ComediFault fault) noexcept { return fault >= ComediFault::kLateScan; }

BusStatus StatusOf(ComediFault fault) noexcept {
  switch (fault) {
    case ComediFault::kNone:
      return BusStatus::kOk;
    case ComediFault::kStarting:
    case ComediFault::kLateScan:
    case ComediFault::kSlow:
      return BusStatus::kTimeout;
    case ComediFault::kEarlyScan:
    case ComediFault::kReadRefused:
    case ComediFault::kOverrun:
    case ComediFault::kBeyondRange:
      return BusStatus::kMalformed;
    case ComediFault::kScanStopped:
    case ComediFault::kStartRefused:
    case ComediFault::kGone:
      return BusStatus::kDisconnected;
    case ComediFault::kOutputRefused:
      return BusStatus::kDriveFault;
  }
  return BusStatus::kDisconnected;
}

}  // namespace flexarm
