#include "hal/comedi/comedi_plan.h"

#include <cmath>
#include <map>

namespace flexarm {
namespace {

// Ten system calls that copy 40960 samples; more are an overrun.
constexpr std::int64_t kStreamNs = 300'000;
// Waking up late at FIFO 70, and the driver's own work.
constexpr std::int64_t kOverheadNs = 200'000;
// Cancelling or starting a scan: the kernel's driver programs timers and DMA.
constexpr std::int64_t kCommandNs = 1'000'000;

class Planner {
 public:
  explicit Planner(const ComediBoardConfig& config)
      : config_(config), instruction_ns_(std::llround(std::ceil(config.instruction_us * 1e3))) {}

  ComediPlan Run() {
    if (config_.output) AddInstructions(config_.output->drive);
    plan_.reconnect_worst_ns = plan_.exchange_worst_ns + 2 * kCommandNs + kOverheadNs;
    if (config_.input && config_.input->acquisition == ComediAcquisition::kStream) {
      AddStream(*config_.input);
    } else if (config_.input) {
      AddInstructions(config_.input->channel);
    }
    AddInstructions(config_.counter);
    AddLines();
    plan_.exchange_worst_ns += kOverheadNs;
    return plan_;
  }

 private:
  int NewTransaction(std::int64_t cost_ns) {
    plan_.exchange_worst_ns += cost_ns;
    return transactions_++;
  }

  template <typename Row>
  void AddInstructions(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      plan_.channels.push_back({.channel = ChannelName(row),
                                .transaction = NewTransaction(instruction_ns_),
                                .exchange_ns = instruction_ns_,
                                .convert_ns = 0});
    }
  }

  void AddStream(const ComediInputConfig& input) {
    const int transaction = NewTransaction(kStreamNs);
    for (const ComediStrainConfig& row : input.channel) {
      plan_.channels.push_back({.channel = ChannelName(row),
                                .transaction = transaction,
                                .exchange_ns = kStreamNs,
                                .convert_ns = input.convert_interval_ns()});
    }
    plan_.scan_ns =
        input.convert_interval_ns() * (static_cast<std::int64_t>(input.channel.size()) - 1);
    plan_.oldest_ns = plan_.scan_ns + input.scan_interval_ns() + input.transfer_ns();
  }

  void AddLines() {
    std::map<int, int> of_subdevice;
    for (const ComediLineConfig& row : config_.line) {
      if (!of_subdevice.contains(row.subdevice)) {
        of_subdevice[row.subdevice] = NewTransaction(instruction_ns_);
      }
      plan_.channels.push_back({.channel = ChannelName(row),
                                .transaction = of_subdevice[row.subdevice],
                                .exchange_ns = instruction_ns_,
                                .convert_ns = 0});
    }
  }

  const ComediBoardConfig& config_;
  std::int64_t instruction_ns_;
  int transactions_ = 0;
  ComediPlan plan_{};
};

}  // namespace

ComediPlan PlanComedi(const ComediBoardConfig& config) { return Planner(config).Run(); }

}  // namespace flexarm
