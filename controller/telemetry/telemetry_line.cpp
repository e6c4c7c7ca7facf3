#include "controller/telemetry/telemetry_line.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "controller/types/shown_reference.h"
#include "estimator/strain_scale.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

// A float has seven digits: more than any sensor, and half the bytes.
Json Short(double value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 7);
  double rounded = 0.0;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

template <typename Values>
Json List(const Values& values, double factor = 1.0) {
  Json list = Json::array();
  for (const double value : values) list.push_back(Short(value * factor));
  return list;
}

Json Angles(const TelemetrySource& source, const StepOutput& out, std::size_t first) {
  Json angles = Json::array();
  for (std::size_t i = first; i < first + 2; ++i) {
    const bool there = (source.sensors.counters_present() >> i & 1U) != 0;
    angles.push_back(there ? Short(out.angle_rad[i] * kDegPerRad) : Json(nullptr));
  }
  return angles;
}

Json Reference(const StepInput& in) {
  const auto reference_rad = ShownReference(in);
  return reference_rad ? List(*reference_rad, kDegPerRad) : Json{nullptr, nullptr};
}

void PutMotion(const TelemetrySource& source, const TickRecord& tick, Json* line) {
  const StepOutput& out = tick.output;
  const auto rate = [&](int joint) {
    return Short(out.x_hat[static_cast<std::size_t>(source.layout.rate(source.layout.hub(joint)))]);
  };
  (*line)["hub_angle_deg"] = Angles(source, out, 0);
  (*line)["rotor_angle_deg"] = Angles(source, out, 2);
  (*line)["hub_rate_rad_s"] = {rate(0), rate(1)};
  (*line)["reference_deg"] = Reference(tick.input);
  (*line)["modal_m"] = List(out.modal_m);
  (*line)["torque_nm"] = List(out.torque_nm);
  (*line)["applied_torque_nm"] = List(tick.input.applied_torque_nm);
}

void PutSensors(const TelemetrySource& source, const TickRecord& tick, Json* line) {
  const StepInput& in = tick.input;
  Json counts = Json::array(), strain = Json::array();
  for (std::size_t i = 0; i < source.sensors.strain.size(); ++i) {
    const StrainScale scale = Calibrated(StrainScaleOf(source.sensors, i), in.calibration, i);
    counts.push_back(in.frame.strain[i]);
    strain.push_back(Short(StrainOf(scale, in.frame.strain[i])));
  }
  (*line)["root_strain"] = List(tick.output.root_strain);
  (*line)["strain"] = std::move(strain);
  (*line)["strain_counts"] = std::move(counts);
  (*line)["encoder_counts"] = tick.output.counts;
  (*line)["strain_used"] = tick.output.strain_used;
  (*line)["counters_used"] = tick.output.counters_used;
  (*line)["levels"] = in.frame.levels;
}

}  // namespace

std::string TelemetryLine(const TelemetrySource& source, const TickRecord& tick, double timestamp_s,
                          std::uint64_t lost) {
  const StepInput& in = tick.input;
  const StepOutput& out = tick.output;
  Json line{{"telemetry", kTelemetryVersion},
            {"rig", source.rig},
            {"timestamp_s", timestamp_s},
            {"time_s", static_cast<double>(in.sampling_instant_ns) * 1e-9},
            {"tick", in.tick},
            {"state", ToString(in.safety_state)},
            {"state_number", static_cast<int>(in.safety_state)},
            {"run", tick.run_number}};
  PutMotion(source, tick, &line);
  PutSensors(source, tick, &line);
  line["payload_kg"] = Short(out.payload_kg);
  line["payload_sigma_kg"] = Short(out.payload_sigma_kg);
  line["at_rest"] = out.at_rest != 0;
  line["limits"] = out.limits;
  line["faults"] = out.faults;
  line["lost"] = lost;
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace flexarm
