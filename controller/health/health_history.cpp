#include "controller/health/health_history.h"

#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/health/drift_trend.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kKind = "health";
constexpr int kVersion = 1;

// FNV-1a of the bytes of a text.
std::uint64_t Hash(const std::string& text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  }
  return hash;
}

OrderedJson ToJson(const HealthRecord& record) {
  OrderedJson values = OrderedJson::array(), errors = OrderedJson::array();
  for (const DriftFigure& figure : record.drift) {
    values.push_back(figure.value);
    errors.push_back(figure.standard_error);
  }
  return {{"run", record.run},
          {"start_utc", record.start_utc},
          {"unused", record.unused},
          {"plant", record.plant},
          {"zero_counts", record.zero_counts},
          {"gain_error", record.gain_error},
          {"misfit", record.misfit},
          {"value", values},
          {"standard_error", errors}};
}

std::vector<double> Numbers(const OrderedJson& json, const char* key, std::size_t count,
                            const std::string& where) {
  const OrderedJson& list = JsonArray(json, key, where);
  std::vector<double> numbers;
  for (const OrderedJson& entry : list) {
    if (!entry.is_number()) break;
    numbers.push_back(entry.get<double>());
  }
  if (numbers.size() == count && list.size() == count) return numbers;
  throw InputError(where + ": '" + key + "': expected " + std::to_string(count) + " numbers");
}

std::vector<float> Floats(const std::vector<double>& numbers) {
  std::vector<float> floats;
  for (const double number : numbers) floats.push_back(static_cast<float>(number));
  return floats;
}

HealthRecord RecordOfJson(const OrderedJson& json, const std::vector<DriftChannel>& channels,
                          std::size_t gauges, const std::string& where) {
  HealthRecord record;
  record.run = JsonText(json, "run", where);
  record.start_utc = JsonText(json, "start_utc", where);
  record.unused = JsonText(json, "unused", where);
  if (!json.contains("plant") || !json["plant"].is_number_unsigned()) {
    throw InputError(where + ": 'plant': expected a whole number");
  }
  record.plant = json["plant"].get<std::uint64_t>();
  record.zero_counts = Floats(Numbers(json, "zero_counts", gauges, where));
  record.gain_error = Floats(Numbers(json, "gain_error", gauges, where));
  record.misfit = JsonNumber(json, "misfit", where);
  const std::vector<double> values = Numbers(json, "value", channels.size(), where);
  const std::vector<double> errors = Numbers(json, "standard_error", channels.size(), where);
  for (std::size_t i = 0; i < values.size(); ++i) {
    record.drift.push_back({.value = values[i], .standard_error = errors[i]});
  }
  return record;
}

OrderedJson Keys(const std::vector<DriftChannel>& channels) {
  OrderedJson keys = OrderedJson::array();
  for (const DriftChannel& channel : channels) keys.push_back(channel.Key());
  return keys;
}

void Print(std::ostream& text, const BeamSection& s) {
  text << s.length_m << ' ' << s.mass_per_length_kg_m() << ' ' << s.bending_stiffness_nm2() << ' '
       << s.half_thickness_m << ';';
}

}  // namespace

void HealthHistory::Add(HealthRecord record) {
  run.push_back(std::move(record));
  if (run.size() <= kMost) return;
  // What precedes a change of the plant is not compared any more.
  const bool old_plant = run.front().plant != run.back().plant;
  run.erase(run.begin() + (old_plant ? 0 : static_cast<std::ptrdiff_t>(kReferenceRuns)));
}

std::uint64_t PlantMark(const ControlConfig& config) {
  std::ostringstream text;
  text.precision(9);
  for (std::size_t i = 0; i < 2; ++i) {
    const LinkParameters& link = config.arm.link[i];
    for (const BeamSection& section : link.section) Print(text, section);
    const JointParameters& joint = config.arm.joint[i];
    text << link.damping_ratio << ' ' << joint.stiffness_nm_per_rad << ' '
         << joint.rotor_inertia_kgm2 << ' ' << joint.hub_inertia_kgm2 << ' '
         << joint.coulomb_friction_nm << ' ' << joint.viscous_friction_nm_s_per_rad << ';';
  }
  const ArmParameters& arm = config.arm;
  text << arm.hub2_mass_kg << ' ' << arm.motor2_mass_kg << ' ' << arm.motor2_inertia_kgm2 << ' '
       << arm.payload_inertia_kgm2 << ' ' << arm.shape_payload_mass_kg << ' '
       << static_cast<int>(arm.damping) << ' ' << static_cast<int>(arm.link1_tip_inertia) << ' '
       << arm.foreshortening << ' ' << arm.joint2_backlash.clearance_rad << ';';
  for (const EncoderConfig& encoder : config.sensors.encoder) {
    text << encoder.counter << ' ' << encoder.counts_per_turn << ' ' << encoder.sign << ';';
  }
  for (const StrainChannelConfig& gauge : config.sensors.strain) {
    text << gauge.link << ' ' << gauge.position_m << ' ' << gauge.face << ' '
         << gauge.gain_v_per_unit << ' ' << gauge.offset_counts << ';';
  }
  const StrainInputConfig& input = config.sensors.strain_input;
  text << input.converter_bits << ' ' << input.range_v << ' ' << input.filter_hz << ' '
       << input.filter_damping << ' ' << config.loop.period_ms;
  return Hash(text.str());
}

HealthRecord RecordOf(const ControlConfig& config, const Calibration& calibration,
                      const RunFigures& figures) {
  const std::size_t gauges = config.sensors.strain.size();
  const auto first = [gauges](const auto& values) {
    return std::vector<float>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(gauges));
  };
  return {.run = {},
          .start_utc = {},
          .unused = figures.unused,
          .plant = PlantMark(config),
          .zero_counts = first(calibration.strain_zero_counts),
          .gain_error = first(calibration.strain_gain_error),
          .misfit = figures.misfit,
          .drift = figures.drift};
}

std::string HistoryText(const std::vector<DriftChannel>& channels, const HealthHistory& history) {
  std::string text = OrderedJson{{"flexarm", kKind}, {"version", kVersion}}.dump();
  text.back() = ',';
  text += "\n\"channels\": " + Keys(channels).dump() + ",\n\"runs\": [";
  for (std::size_t i = 0; i < history.run.size(); ++i) {
    text += (i == 0 ? "\n" : ",\n") +
            ToJson(history.run[i]).dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  }
  return text + "\n]}\n";
}

HealthHistory ParseHistory(const std::string& text, const std::string& name,
                           const std::vector<DriftChannel>& channels) {
  const std::string file = Shown(name, kMessageBytes);
  const OrderedJson json = ParseJson(text, name, kHealthFile.name);
  if (!json.is_object() || JsonText(json, "flexarm", file) != kKind ||
      JsonWhole(json, "version", file) != kVersion) {
    throw InputError(file + ": found another JSON file, expected " + kHealthFile.name);
  }
  if (JsonArray(json, "channels", file) != Keys(channels)) {
    throw InputError(file + ": is of a rig with other gauges or joints than this config's");
  }
  std::size_t gauges = 0;
  for (const DriftChannel& channel : channels) {
    if (channel.kind == DriftKind::kGaugeGain) ++gauges;
  }
  HealthHistory history;
  const OrderedJson& runs = JsonArray(json, "runs", file);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    history.run.push_back(
        RecordOfJson(runs[i], channels, gauges, file + ": runs[" + std::to_string(i) + "]"));
  }
  return history;
}

}  // namespace flexarm
