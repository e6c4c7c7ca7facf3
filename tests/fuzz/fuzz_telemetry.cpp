#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "controller/types/safety_state.h"
#include "model/units.h"
#include "tests/controller/telemetry/telemetry_parts.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

constexpr double kSevenDigits = 1e-6;  // relative: half a unit of the seventh digit, doubled

template <typename T>
void Fill(T* value, FuzzReader* from) {
  static_assert(std::is_trivially_copyable_v<T>);
  const FuzzBytes bytes = from->Take(sizeof(T));
  if (!bytes.empty()) std::memcpy(value, bytes.data(), bytes.size());
}

// The thesis's rig without the encoders and gauges that the bits leave out.
TelemetrySource PartOfARig(std::uint8_t encoders, std::uint8_t gauges) {
  static const TelemetrySource whole = ThesisSource();
  TelemetrySource source = whole;
  std::erase_if(source.sensors.encoder, [&](const EncoderConfig& encoder) {
    return (encoders >> encoder.counter & 1U) != 0;
  });
  source.sensors.strain.resize(source.sensors.strain.size() - gauges % 20U);
  return source;
}

void ExpectNumber(const Json& told, double value) {
  if (told.is_null() && !std::isfinite(value)) return;
  if (told.is_number() &&
      std::fabs(told.get<double>() - value) <= kSevenDigits * std::fabs(value)) {
    return;
  }
  throw std::logic_error(told.dump() + " is not " + std::to_string(value));
}

}  // namespace

// A sample whose bytes may be anything: its line is one JSON object that says what the sample has.
void FuzzTelemetry(FuzzBytes input) {
  FuzzReader from(input);
  const std::uint8_t encoders = from.Byte();
  TelemetrySource source = PartOfARig(encoders, from.Byte());
  source.rig = TextOf(from.Take(from.Byte()));
  const auto lost = from.Number<std::uint64_t>();
  double timestamp_s = 0.0;
  Fill(&timestamp_s, &from);
  TickRecord tick{};
  const std::uint8_t state = from.Byte();
  Fill(&tick.output, &from);
  Fill(&tick.input, &from);
  tick.input.safety_state = static_cast<SafetyState>(state % kSafetyStates);

  const std::string line = TelemetryLine(source, tick, timestamp_s, lost);
  Expect(line.find('\n') == std::string::npos, "a line has a newline");
  const Json told = Json::parse(line);
  Expect(told["lost"] == lost, "lost");
  Expect(told["state"] == ToString(tick.input.safety_state), "state");
  ExpectNumber(told["payload_kg"], tick.output.payload_kg);
  for (std::size_t i = 0; i < 2; ++i) {
    ExpectNumber(told["torque_nm"][i], tick.output.torque_nm[i]);
    if ((encoders >> i & 1U) != 0) {
      Expect(told["hub_angle_deg"][i].is_null(), "an angle without an encoder");
    } else {
      ExpectNumber(told["hub_angle_deg"][i], tick.output.angle_rad[i] * kDegPerRad);
    }
  }
  Expect(told["strain"].size() == source.sensors.strain.size(), "not one strain for each gauge");
  for (std::size_t i = 0; i < source.sensors.strain.size(); ++i) {
    Expect(told["strain_counts"][i] == tick.input.frame.strain[i], "strain_counts");
  }
}

}  // namespace flexarm
