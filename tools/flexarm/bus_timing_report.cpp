#include "tools/flexarm/bus_timing_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "hal/wired/hal_config.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

// Rounded to the microsecond: the bounds are not more accurate.
double Milliseconds(std::int64_t ns) { return std::round(static_cast<double>(ns) / 1e3) / 1e3; }

OrderedJson BusJson(const BusCost& bus, std::int64_t available_ns) {
  OrderedJson json;
  json["kind"] = bus.kind;
  json["name"] = bus.name;
  json["worst_case_ms"] = Milliseconds(bus.worst_ns);
  json["spare_ms"] = Milliseconds(available_ns - bus.worst_ns);
  json["other_ms"] = Milliseconds(bus.other_ns());
  if (bus.oldest_ns > 0) json["oldest_reading_ms"] = Milliseconds(bus.oldest_ns);
  for (const ChannelCost& channel : bus.channel) {
    const auto shares = std::count_if(
        bus.channel.begin(), bus.channel.end(),
        [&](const ChannelCost& other) { return other.transaction == channel.transaction; });
    OrderedJson row = {{"device", channel.device},
                       {"channel", channel.channel},
                       {"transaction", channel.transaction},
                       {"shared_by", shares},
                       {"cost_ms", Milliseconds(channel.cost_ns)}};
    if (channel.convert_ns > 0) row["convert_ms"] = Milliseconds(channel.convert_ns);
    json["channels"].push_back(row);
  }
  return json;
}

OrderedJson AcquisitionJson(const RigConfig& config) {
  const std::int64_t available_ns = std::llround(config.loop.acquire_before_ms * 1e6);
  const std::vector<BusCost> costs = AcquisitionCosts(config.hal);
  OrderedJson json;
  json["available_ms"] = Milliseconds(available_ns);
  const auto slowest =
      std::max_element(costs.begin(), costs.end(),
                       [](const BusCost& a, const BusCost& b) { return a.worst_ns < b.worst_ns; });
  if (slowest != costs.end()) {
    json["slowest_bus"] = slowest->name;
    json["worst_case_ms"] = Milliseconds(slowest->worst_ns);
    json["spare_ms"] = Milliseconds(available_ns - slowest->worst_ns);
  }
  for (const BusCost& bus : costs) json["buses"].push_back(BusJson(bus, available_ns));
  return json;
}

OrderedJson DriveJson(const DriveFigures& drive, const RigConfig& config) {
  const bool volts = std::string(drive.unit) == "V";
  OrderedJson json;
  json["joint"] = drive.joint + 1;
  json["bus"] = drive.bus;
  json[volts ? "torque_per_volt_nm" : "torque_per_mille_nm"] = drive.torque_per_unit_nm;
  json["gear"] = drive.gear;
  json["sign"] = drive.sign;
  json["torque_range_nm"] = drive.range_nm;
  json[volts ? "range_v" : "range_per_mille"] = drive.unit_range;
  json["torque_limit_nm"] = config.safety.torque_limit_nm[static_cast<std::size_t>(drive.joint)];
  return json;
}

void PrintLine(const std::string& name, const std::string& value) {
  std::cout << "  " << std::left << std::setw(26) << name << value << '\n';
}

std::string Ms(const OrderedJson& value) { return NumberText(value.get<double>()) + " ms"; }

void PrintBus(const OrderedJson& bus) {
  PrintLine(bus["kind"].get<std::string>() + " " + bus["name"].get<std::string>(),
            Ms(bus["worst_case_ms"]) + " per exchange in the worst case, " + Ms(bus["spare_ms"]) +
                " spare");
  for (const OrderedJson& channel : bus["channels"]) {
    const int shares = channel["shared_by"].get<int>();
    std::string text = Ms(channel["cost_ms"]);
    if (shares > 1) text += " for " + std::to_string(shares) + " together";
    if (channel.contains("convert_ms")) {
      text += "; converted before the exchange, in " + Ms(channel["convert_ms"]);
    }
    PrintLine(
        "  " + channel["device"].get<std::string>() + " " + channel["channel"].get<std::string>(),
        text);
  }
  PrintLine("  waiting and computing", Ms(bus["other_ms"]));
  if (bus.contains("oldest_reading_ms")) {
    PrintLine("  oldest streamed reading", Ms(bus["oldest_reading_ms"]));
  }
}

void PrintDrive(const OrderedJson& drive) {
  const bool volts = drive.contains("torque_per_volt_nm");
  const auto number = [&](const char* key) { return NumberText(drive[key].get<double>()); };
  const std::string per = volts ? number("torque_per_volt_nm") + " N m per volt"
                                : number("torque_per_mille_nm") + " N m per mille of rated torque";
  const char* unit = volts ? " V" : " per mille";
  const double per_unit = drive[volts ? "torque_per_volt_nm" : "torque_per_mille_nm"].get<double>();
  const double taken = std::round(1e3 * drive["torque_range_nm"].get<double>() / per_unit) / 1e3;
  PrintLine("drive" + std::to_string(drive["joint"].get<int>()) + " on " +
                drive["bus"].get<std::string>(),
            per + ", gear " + number("gear") + ", sign " +
                std::to_string(drive["sign"].get<int>()) + ", range +-" +
                number("torque_range_nm") + " N m: " + NumberText(taken) + " of " +
                number(volts ? "range_v" : "range_per_mille") + unit +
                "; torque limit of the loop " + number("torque_limit_nm") + " N m");
}

}  // namespace

void AddWiring(const RigConfig& config, OrderedJson* json) {
  if (config.hal.empty()) return;
  (*json)["acquisition"] = AcquisitionJson(config);
  for (const DriveFigures& drive : FiguresOfDrives(config.hal)) {
    (*json)["drives"].push_back(DriveJson(drive, config));
  }
}

void PrintWiring(const OrderedJson& json) {
  if (!json.contains("acquisition")) return;
  const OrderedJson& acquisition = json["acquisition"];
  PrintLine("acquisition", Ms(acquisition["worst_case_ms"]) + " on " +
                               acquisition["slowest_bus"].get<std::string>() +
                               ", the slowest bus; available " + Ms(acquisition["available_ms"]) +
                               " until the step is due");
  for (const OrderedJson& bus : acquisition["buses"]) PrintBus(bus);
  for (const OrderedJson& drive : json["drives"]) PrintDrive(drive);
}

}  // namespace flexarm
