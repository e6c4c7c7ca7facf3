#include "controller/latch/latch_record.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKind = "safety-latch";
constexpr int kVersion = 1;

// JSON has no NaN and no infinity: null, which is read as NaN.
Json NumberJson(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

const Json& Field(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) throw InputError(std::string("expected the key '") + key + "'");
  return *found;
}

std::string Text(const Json& json, const char* key) {
  const Json& value = Field(json, key);
  if (!value.is_string()) throw InputError(std::string("expected a text in '") + key + "'");
  return value.get<std::string>();
}

double Number(const Json& json, const char* key) {
  const Json& value = Field(json, key);
  if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!value.is_number()) throw InputError(std::string("expected a number in '") + key + "'");
  return value.get<double>();
}

std::uint32_t Whole(const Json& json, const char* key) {
  const Json& value = Field(json, key);
  if (!value.is_number_unsigned() ||
      value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(std::string("expected a whole number in '") + key + "'");
  }
  return value.get<std::uint32_t>();
}

TripCause Cause(const std::string& name) {
  for (int number = 1; number < kTripCauses; ++number) {
    const auto cause = static_cast<TripCause>(number);
    if (name == ToString(cause)) return cause;
  }
  throw InputError("'" + name + "' is no trip cause of this version");
}

}  // namespace

std::string LatchText(const LatchRecord& record) {
  const bool tripped = record.cause != TripCause::kNone;
  Json json{{"flexarm", kKind},
            {"version", kVersion},
            {"state", tripped ? "tripped" : "armed"},
            {"time_utc", record.time_utc}};
  if (tripped) {
    json["cause"] = ToString(record.cause);
    json["value"] = NumberJson(record.evidence.value);
    json["limit"] = NumberJson(record.evidence.limit);
    json["channel"] = record.evidence.channel;
    json["detail"] = record.evidence.detail;
    json["text"] = OperatorText(record.cause);
  }
  json["log_directory"] = record.log_directory;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

LatchRecord ParseLatch(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw InputError("expected one JSON object");
  if (const std::string kind = Text(json, "flexarm"); kind != kKind) {
    throw InputError("expected 'flexarm': '" + std::string(kKind) + "', not '" + kind + "'");
  }
  if (Whole(json, "version") != kVersion) {
    throw InputError("expected version " + std::to_string(kVersion) + ", not " +
                     json["version"].dump());
  }
  LatchRecord record{.time_utc = Text(json, "time_utc"),
                     .log_directory = Text(json, "log_directory")};
  const std::string state = Text(json, "state");
  if (state == "armed") return record;
  if (state != "tripped") throw InputError("expected 'state': 'armed' or 'tripped'");
  record.cause = Cause(Text(json, "cause"));
  record.evidence = {.value = Number(json, "value"),
                     .limit = Number(json, "limit"),
                     .channel = Whole(json, "channel"),
                     .detail = Whole(json, "detail")};
  return record;
}

}  // namespace flexarm
