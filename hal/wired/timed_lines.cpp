#include "hal/wired/timed_lines.h"

#include <algorithm>
#include <array>

#include "hal/bus_device.h"

namespace flexarm {
namespace {

constexpr std::size_t kCalls = 11;
using CallTimes = std::array<std::int64_t, kCalls>;

void RequireOk(bool ok, const std::string& chip, const char* call) {
  if (ok) return;
  throw HalError("gpiod " + chip + ": a " + call +
                 " of the lines failed. Check that the chip is "
                 "still there (`gpiodetect`)");
}

void RequireQuick(CallTimes times, const std::string& chip, const char* call) {
  std::nth_element(times.begin(), times.begin() + kCalls / 2, times.end());
  const std::int64_t usual_ns = times[kCalls / 2];
  if (usual_ns <= SafetyLines::kBudgetNs) return;
  throw HalError("gpiod " + chip + ": a " + call + " of the lines takes " +
                 std::to_string(usual_ns / 1000) + " us, must be " +
                 std::to_string(SafetyLines::kBudgetNs / 1000) +
                 " us at most: the safety task does it every millisecond. Use lines of the "
                 "processor itself or of a PCI card; see docs/hardware.md");
}

}  // namespace

SafetyLines::Reading TimedLines::Read(std::int64_t now_ns) noexcept {
  const std::int64_t begun_ns = monotonic_ns_();
  Reading reading = lines_->Read(now_ns);
  reading.call.took_ns = monotonic_ns_() - begun_ns;
  return reading;
}

SafetyLines::Call TimedLines::Write(std::int64_t now_ns, const Outputs& outputs) noexcept {
  const std::int64_t begun_ns = monotonic_ns_();
  Call call = lines_->Write(now_ns, outputs);
  call.took_ns = monotonic_ns_() - begun_ns;
  return call;
}

void RequireQuickLines(SafetyLines* lines, const std::string& chip) {
  CallTimes reads{}, writes{};
  for (std::size_t i = 0; i < kCalls; ++i) {
    const SafetyLines::Call read = lines->Read(0).call;
    RequireOk(read.ok, chip, "read");
    const SafetyLines::Call write = lines->Write(0, {.relay_closed = false, .pump_level = false});
    RequireOk(write.ok, chip, "write");
    reads[i] = read.took_ns;
    writes[i] = write.took_ns;
  }
  RequireQuick(reads, chip, "read");
  RequireQuick(writes, chip, "write");
}

}  // namespace flexarm
