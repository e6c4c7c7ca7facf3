#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>

#include "controller/files/external_json.h"
#include "controller/runlog/blob.h"
#include "model/units.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

struct DiffOptions {
  std::filesystem::path first, second;
  bool json = false;
};

struct Difference {
  std::array<std::size_t, 2> ticks{};
  std::optional<std::int64_t>
      first_tick;  // of the first run: the bytes differ here, or one run ends
  std::array<double, 2> torque_asked_nm{}, torque_applied_nm{}, joint_angle_deg{};
  double estimate = 0;  // largest of any state, SI
};

double Apart(double a, double b) {
  if (std::isnan(a) && std::isnan(b)) return 0;
  const double apart = std::abs(a - b);
  return std::isnan(apart) ? std::numeric_limits<double>::infinity() : apart;
}

// The clocks of two runs start at different values: ticks and times count from the first tick.
TickRecord FromStart(TickRecord record, const TickRecord& first) {
  record.input.tick -= first.input.tick;
  record.output.tick -= first.input.tick;
  for (std::int64_t* time_ns : {&record.input.now_ns, &record.input.sampling_instant_ns,
                                &record.input.frame.sampled_at_ns}) {
    *time_ns -= first.input.sampling_instant_ns;
  }
  return record;
}

void Compare(const TickRecord& a, const TickRecord& b, Difference* difference) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const auto keep = [joint](std::array<double, 2>* largest, double apart) {
      (*largest)[joint] = std::max((*largest)[joint], apart);
    };
    keep(&difference->torque_asked_nm, Apart(a.output.torque_nm[joint], b.output.torque_nm[joint]));
    keep(&difference->torque_applied_nm,
         Apart(a.input.applied_torque_nm[joint], b.input.applied_torque_nm[joint]));
    keep(&difference->joint_angle_deg,
         kDegPerRad * Apart(a.output.angle_rad[joint], b.output.angle_rad[joint]));
  }
  for (std::size_t i = 0; i < kMaxNominalStates; ++i) {
    difference->estimate =
        std::max(difference->estimate, Apart(a.output.x_hat[i], b.output.x_hat[i]));
  }
}

Difference Diff(const std::vector<TickRecord>& a, const std::vector<TickRecord>& b) {
  Difference difference;
  difference.ticks = {a.size(), b.size()};
  const std::size_t both = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < both; ++i) {
    const TickRecord from_a = FromStart(a[i], a[0]), from_b = FromStart(b[i], b[0]);
    Compare(from_a, from_b, &difference);
    const bool same = SameBytes(from_a.input, from_b.input) &&
                      SameBytes(from_a.output, from_b.output) &&
                      from_a.output_checksum == from_b.output_checksum;
    if (!same && !difference.first_tick) difference.first_tick = a[i].input.tick;
  }
  if (a.size() != b.size() && !difference.first_tick) {
    const auto& longer = a.size() > b.size() ? a : b;
    difference.first_tick = longer[both].input.tick;
  }
  return difference;
}

nlohmann::ordered_json PairJson(const std::array<double, 2>& pair) {
  return {NumberOrNull(pair[0]), NumberOrNull(pair[1])};
}

void PrintJson(const Difference& difference) {
  nlohmann::ordered_json json;
  json["identical"] = !difference.first_tick.has_value();
  json["ticks"] = difference.ticks;
  json["first_different_tick"] = difference.first_tick
                                     ? nlohmann::ordered_json(*difference.first_tick)
                                     : nlohmann::ordered_json(nullptr);
  json["max_torque_difference_nm"] = PairJson(difference.torque_asked_nm);
  json["max_applied_torque_difference_nm"] = PairJson(difference.torque_applied_nm);
  json["max_joint_angle_difference_deg"] = PairJson(difference.joint_angle_deg);
  json["max_estimate_difference_si"] = NumberOrNull(difference.estimate);
  std::cout << PrintedJson(json) << '\n';
}

void PrintText(const Difference& difference) {
  std::cout << "ticks                       " << difference.ticks[0] << ", " << difference.ticks[1]
            << "\nfirst different tick        ";
  if (difference.first_tick) {
    std::cout << *difference.first_tick << '\n';
  } else {
    std::cout << "none: the runs are identical bit for bit\n";
  }
  const auto line = [](const char* name, const std::array<double, 2>& pair, const char* unit) {
    std::cout << name << pair[0] << ", " << pair[1] << ' ' << unit << '\n';
  };
  line("largest torque difference   ", difference.torque_asked_nm, "N m asked");
  line("                            ", difference.torque_applied_nm, "N m applied");
  line("largest angle difference    ", difference.joint_angle_deg, "deg");
}

}  // namespace

void RegisterDiff(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<DiffOptions>();
  CLI::App* verb = app.add_subcommand(
      "diff",
      "Compare two run logs: first different tick, largest differences of torque and angle");
  verb->add_option("first", options->first, "Run log")->required()->type_name("RUN");
  verb->add_option("second", options->second, "Run log")->required()->type_name("RUN");
  AddJson(verb, &options->json);
  RefuseConfig(verb, kLogHasItsConfig);
  verb->footer(
      "Compares every recorded byte; ticks and times count from the start of each run. Exit\n"
      "code 1 if the runs differ.\n"
      "Example: flexarm diff real-time.flexarm lock-step.flexarm");
  verb->callback([options, &exit] {
    const Difference difference =
        Diff(RunReader(options->first).ReadAll().tick, RunReader(options->second).ReadAll().tick);
    if (options->json) {
      PrintJson(difference);
    } else {
      PrintText(difference);
    }
    exit.code = difference.first_tick ? Exit::kFailed : Exit::kDone;
  });
}

}  // namespace flexarm
