#include "hal/wired/hal_config.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "hal/line_names.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

using Kind = WiredItem::Kind;

// The rows in which each sensor, drive and line is wired.
class Census {
 public:
  using Places = std::vector<std::string>;

  explicit Census(const HalConfig& hal) {
    for (const HalConfig::Bus& bus : hal.bus) {
      for (const WiredItem& item : bus.wiring->Items()) {
        places_[{item.kind, item.index}].push_back(bus.row + "." + item.place);
      }
    }
  }

  Places At(Kind kind, std::size_t index) const {
    const auto found = places_.find({kind, static_cast<int>(index)});
    return found == places_.end() ? Places{} : found->second;
  }

 private:
  std::map<std::pair<Kind, int>, Places> places_;
};

std::string Times(const Census::Places& places) { return std::to_string(places.size()) + " times"; }

// "; it is in canopen[0].node[1], comedi[0].output.drive[0]"
std::string Where(const Census::Places& places) {
  std::string text;
  for (const std::string& place : places) text += (text.empty() ? "; it is in " : ", ") + place;
  return text;
}

void RequireOnce(const Census::Places& places, const std::string& key, const std::string& what,
                 ProblemList* list) {
  list->Require(places.size() == 1, key, Times(places),
                "must be wired exactly once: " + what + Where(places));
}

void CheckWiring(const HalConfig& hal, const SensorConfig& sensors, ProblemList* list) {
  const Census census(hal);
  for (std::size_t i = 0; i < kCounters; ++i) {
    const bool present = (sensors.counters_present() >> i & 1u) != 0;
    const Census::Places places = census.At(Kind::kCounter, i);
    if (!present && places.empty()) continue;
    RequireOnce(places, std::string("role ") + CounterName(static_cast<int>(i)),
                present ? "the encoder of [[sensors.encoder]]"
                        : "and there is no such encoder in [[sensors.encoder]]",
                list);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    RequireOnce(census.At(Kind::kDrive, i), "role drive" + std::to_string(i + 1),
                "the drive of a joint", list);
  }
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    RequireOnce(census.At(Kind::kStrain, i), ProblemList::Element("strain", i),
                "the channel of [[sensors.strain]]", list);
  }
  for (std::size_t i = 0; i < kLines; ++i) {
    const Census::Places places = census.At(Kind::kLine, i);
    list->Require(places.size() <= 1, std::string("line ") + ToString(static_cast<Line>(i)),
                  Times(places), "must be read once at most, besides [hal.gpiod]" + Where(places));
  }
  list->Require(hal.gpiod.has_value(), "gpiod", "missing",
                "must be configured: limit switches, emergency stop, relay and charge pump");
}

// The drives' voltage is a witness only if each drive reports its own.
void CheckVoltage(const HalConfig& hal, ProblemList* list) {
  if (!hal.gpiod || !hal.gpiod->drive_voltage) return;
  for (const HalConfig::Bus& bus : hal.bus) {
    const std::vector<WiredItem> items = bus.wiring->Items();
    const bool drives = std::any_of(items.begin(), items.end(), [](const WiredItem& item) {
      return item.kind == Kind::kDrive;
    });
    list->Require(!drives || bus.wiring->reports_voltage(), "gpiod.drive_voltage", "configured",
                  "needs drives that report their voltage: those of " + bus.row + " do not");
  }
}

void CheckExclusive(const HalConfig& hal, ProblemList* list) {
  std::set<std::tuple<std::string, std::string, std::string>> used;  // kind, key, resource
  for (const HalConfig::Bus& bus : hal.bus) {
    for (const ExclusiveUse& use : bus.wiring->Exclusive()) {
      list->Require(used.insert({bus.wiring->kind(), use.key, use.resource}).second,
                    bus.row + "." + use.key, use.value, use.rule);
    }
  }
}

void Append(std::vector<Problem> more, std::vector<Problem>* all) {
  for (Problem& problem : more) all->push_back(std::move(problem));
}

}  // namespace

void HalConfig::Add(std::shared_ptr<const BusWiring> wiring) {
  const std::string kind = wiring->kind();
  const auto before = std::count_if(bus.begin(), bus.end(),
                                    [&](const Bus& other) { return other.wiring->kind() == kind; });
  bus.push_back({ProblemList::Element(kind, static_cast<std::size_t>(before)), std::move(wiring)});
}

std::vector<Problem> HalConfig::Problems(const BusRequirements& required) const {
  if (empty()) return {};
  std::vector<Problem> all;
  for (const Bus& b : bus) Append(b.wiring->Problems("hal." + b.row + ".", required), &all);
  if (gpiod) Append(gpiod->Problems(), &all);
  ProblemList list("hal.");
  CheckExclusive(*this, &list);
  CheckWiring(*this, required.sensors, &list);
  CheckVoltage(*this, &list);
  Append(list.Take(), &all);
  return all;
}

std::vector<BusCost> AcquisitionCosts(const HalConfig& hal) {
  std::vector<BusCost> costs;
  costs.reserve(hal.bus.size());
  for (const HalConfig::Bus& bus : hal.bus) costs.push_back(bus.wiring->Cost());
  return costs;
}

std::vector<DriveFigures> FiguresOfDrives(const HalConfig& hal) {
  std::vector<DriveFigures> drives;
  for (const HalConfig::Bus& bus : hal.bus) {
    for (DriveFigures& drive : bus.wiring->Drives()) drives.push_back(std::move(drive));
  }
  std::sort(drives.begin(), drives.end(),
            [](const DriveFigures& a, const DriveFigures& b) { return a.joint < b.joint; });
  return drives;
}

}  // namespace flexarm
