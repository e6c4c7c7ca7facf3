#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "controller/runlog/run_reader.h"
#include "controller/runlog/run_writer.h"
#include "tests/support/message_of.h"

namespace flexarm {

/// An empty temporary folder, removed after the test.
class RunLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "runlog-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    std::filesystem::permissions(folder_, std::filesystem::perms{0755});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path File(const std::string& name = "run.flexarm") const {
    return folder_ / name;
  }
  void WriteText(const std::filesystem::path& file, const std::string& text) const {
    std::ofstream(file, std::ios::binary) << text;
  }
  static std::string Bytes(const std::filesystem::path& file) {
    std::ostringstream bytes;
    bytes << std::ifstream(file, std::ios::binary).rdbuf();
    return bytes.str();
  }
  /// The text of the InputError that opening and reading the file whole gives; "" if none.
  static std::string ReadingError(const std::filesystem::path& file) {
    return MessageOf<InputError>([&] { RunReader(file).ReadAll(); });
  }

  std::filesystem::path folder_;
};

inline constexpr std::int64_t kTestPeriodNs = 20'000'000;

/// The status before any request.
inline constexpr SafetyStatus kIdleStatus{SafetyState::kIdle, TripCause::kNone};

/// A tick with distinct values in every field that has a column.
inline TickRecord MakeTick(std::int64_t tick, SafetyState state = SafetyState::kRunning) {
  TickRecord record{};
  std::mt19937 random(static_cast<unsigned>(tick));
  std::uniform_real_distribution<double> real(-1, 1);
  record.input.tick = tick;
  record.input.sampling_instant_ns = tick * kTestPeriodNs;
  record.input.now_ns = tick * kTestPeriodNs;
  record.input.safety_state = state;
  for (auto& count : record.input.frame.counter) count = static_cast<std::uint32_t>(random());
  for (auto& count : record.input.frame.strain) count = static_cast<std::int32_t>(random());
  record.input.frame.counter_valid = 0xf;
  record.input.frame.strain_valid = 0xfffff;
  for (double& torque : record.input.applied_torque_nm) torque = real(random);
  for (double& x : record.input.reference_now.x_m) x = real(random);
  record.output.tick = tick;
  for (double& angle : record.output.angle_rad) angle = real(random);
  for (double& torque : record.output.torque_nm) torque = real(random);
  for (double& x : record.output.x_hat) x = real(random);
  record.truth = {.hub_angle_rad = {real(random), real(random)},
                  .tip_m = {real(random), real(random)},
                  .tip_deflection_m = {real(random), real(random)},
                  .known = true};
  return record;
}

/// A record of the safety task with a transition of NextSafetyState.
inline SafetyRecord MakeSafety(std::int64_t due_ns, SafetyStatus before, RequestKind request,
                               TripCauses present = 0) {
  SafetyRecord record{};
  record.due_ns = due_ns;
  record.before = before;
  record.facts.present = present;
  record.facts.all_reported = 1;
  record.facts.at_rest = 1;
  record.facts.drives_on = 1;
  record.facts.power_follows = 1;
  record.facts.request = request;
  const SafetyDecision next = NextSafetyState(before, record.facts);
  record.after = next.status;
  record.refusal = next.refusal;
  return record;
}

inline RunInfo MakeInfo() {
  return {.start_utc = "2026-11-20T12:00:00Z",
          .start_ns = 0,
          .version = "",
          .build_id = "",
          .rig_name = "thesis rig",
          .clock = "simulated",
          .backend = "sim",
          .seed = 18446744073709551615U,
          .config_text = "[loop]\nperiod_ms = 20\n# \xC3\xA4\n",
          .experiment_name = "",
          .experiment_text = "",
          .gains_json = "{\"K\": [0.1]}",
          .law = "",
          .payload_kg = {},
          .label = {},
          .result_json = ""};
}

}  // namespace flexarm
