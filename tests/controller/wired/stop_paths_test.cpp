// How long torque lasts at the simulated drives after each event that ends it, over the phase of
// the event in the period of the buses, with a healthy power circuit, a welded relay, and a charge
// pump that is stuck. docs/safety.md has the table that this test measures.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "tests/controller/wired/hostile_rig.h"
#include "tests/support/campaign.h"

namespace flexarm {
namespace {

struct StopPath {
  std::string name;
  std::function<void(Rig&)> begin;
  std::array<int, 3> longest_ms;  // by power fault, over every phase
};

void Open(Rig& rig, Line line) { rig.world->lines.levels &= ~LineBit(line); }

void StallAll(Rig& rig) {
  for (const Task* task : rig.stack->tasks()) rig.executor.Stall(*task);
}

const std::array<StopPath, 6> kPaths = {{
    {"limit switch", [](Rig& rig) { Open(rig, Line::kLimit1High); }, {2, 4, 2}},
    {"emergency stop", [](Rig& rig) { Open(rig, Line::kEmergencyStop); }, {2, 4, 2}},
    {"safety thread stands still",
     [](Rig& rig) { rig.executor.Stall(rig.stack->safety()); },
     {5, 5, 25}},
    {"control thread stands still",
     [](Rig& rig) { rig.executor.Stall(rig.stack->control()); },
     {40, 42, 40}},
    {"nothing passes on the drives' bus",
     [](Rig& rig) { rig.world->wire.SetStalled(true); },
     {40, 44, 40}},
    {"daemon killed", [](Rig& rig) { StallAll(rig); }, {5, 5, 102}},
}};

struct PowerFault {
  bool welded, pump_stuck;
};
constexpr std::array<PowerFault, 3> kPowerFaults = {{{false, false}, {true, false}, {false, true}}};

class StopPaths : public HostileBus {
 protected:
  // Longest torque over the phases, ms: at a shaft, which needs a command in the drive and power.
  double TorqueLasts_ms(const StopPath& path, const PowerFault& fault,
                        const std::vector<int>& phases_ms) {
    double longest_ms = 0.0;
    for (const int phase_ms : phases_ms) {
      SCOPED_TRACE(path.name + " at " + std::to_string(phase_ms) + " ms");
      rig_.reset();  // one rig at a time: its drivers share a clock
      StartRun();
      if (HasFatalFailure()) return longest_ms;
      WiredWorld& world = *rig_->world;
      EXPECT_TRUE(rig_->RunUntil(500 * kMs, [&] {
        return rig_->executor.now_ns() % kPeriodNs == phase_ms % 20 * kMs &&
               world.drives_make_torque();
      }));
      world.lines.welded = fault.welded;
      world.lines.pump_stuck = fault.pump_stuck;
      const std::int64_t begin_ns = rig_->executor.now_ns();
      path.begin(*rig_);
      EXPECT_TRUE(rig_->RunUntil(500 * kMs, [&] {
        return !world.drives_make_torque() || !world.lines.PowerOn(rig_->executor.now_ns());
      }));
      longest_ms = std::max(longest_ms,
                            static_cast<double>(rig_->executor.now_ns() - begin_ns) / double{kMs});
    }
    return longest_ms;
  }

  // The rig ends with stalled tasks: the base's checks of their deadlines do not hold.
  void TearDown() override { rig_.reset(); }
};

std::string Document() {
  std::ifstream file(FLEXARM_SOURCE_DIR "/docs/safety.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(StopPaths, CampaignTheTableOfTheDocumentIsWhatIsMeasured) {
  const bool whole = CampaignCases(0, 1) > 0;
  std::vector<int> phases_ms;
  for (int phase_ms = 1; phase_ms <= 20; phase_ms += whole ? 1 : 9) phases_ms.push_back(phase_ms);
  const std::string document = Document();
  for (const StopPath& path : kPaths) {
    std::string row = "| " + path.name + " |";
    for (std::size_t i = 0; i < kPowerFaults.size(); ++i) {
      const double measured_ms = TorqueLasts_ms(path, kPowerFaults[i], phases_ms);
      std::printf("%s, power fault %zu: %g ms\n", path.name.c_str(), i, measured_ms);
      EXPECT_LE(measured_ms, path.longest_ms[i]) << path.name;
      if (whole) {
        EXPECT_EQ(measured_ms, path.longest_ms[i]) << path.name;
      }
      row.append(" ").append(std::to_string(path.longest_ms[i])).append(" ms |");
    }
    EXPECT_NE(document.find(row + "\n"), std::string::npos) << "docs/safety.md needs: " << row;
  }
}

}  // namespace
}  // namespace flexarm
