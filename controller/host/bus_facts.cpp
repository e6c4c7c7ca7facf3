#include "controller/host/bus_facts.h"

#include <arpa/inet.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "hal/canopen/canopen_wiring.h"
#include "hal/comedi/comedi_wiring.h"
#include "hal/modbus/modbus_wiring.h"

namespace flexarm {
namespace {

constexpr const char* kLoopback = "lo";

std::string BaseName(const std::string& path) { return path.substr(path.rfind('/') + 1); }

// The interrupts of a device: listed at itself, or at the controller that it hangs on (USB).
std::vector<int> InterruptsAt(const HostFiles& files, std::string device) {
  std::vector<int> numbers;
  for (; numbers.empty() && device.starts_with("/sys/devices/"); device.erase(device.rfind('/'))) {
    for (const std::string& name : files.List(device + "/msi_irqs")) {
      if (const auto list = NumbersOfList(name); list) numbers.push_back(list->front());
    }
    const auto wired = files.Read(device + "/irq").number();
    if (numbers.empty() && wired && *wired > 0) numbers.push_back(static_cast<int>(*wired));
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// `folder` is that of the device's class: "/sys/class/net/can0".
void FindDevice(const HostFiles& files, const std::string& folder, BusFacts* bus) {
  if (bus->device.empty() || files.Resolve(folder).empty()) return;
  const std::string device = files.Resolve(folder + "/device");
  bus->presence = device.empty() ? BusFacts::Presence::kVirtual : BusFacts::Presence::kDevice;
  if (device.empty()) return;
  bus->interrupt = InterruptsAt(files, device);
  bus->names = {BaseName(bus->device), BaseName(device)};
}

BusFacts Make(BusFacts::Kind kind, const std::string& bus, std::string device) {
  return {.kind = kind,
          .bus = bus,
          .device = std::move(device),
          .presence = BusFacts::Presence::kMissing,
          .interrupt = {},
          .names = {},
          .link = std::nullopt,
          .latency_timer_ms = {.state = HostText::State::kAbsent, .text = {}}};
}

BusFacts CanFacts(const HostFiles& files, const CanopenConfig& config) {
  BusFacts bus = Make(BusFacts::Kind::kCan, config.interface, config.interface);
  FindDevice(files, "/sys/class/net/" + config.interface, &bus);
  CanLink link{};
  if (ReadCanLink(config.interface, &link)) bus.link = link;
  return bus;
}

// The interface of the route with the longest mask; "" if there is none.
std::string InterfaceTo(const HostFiles& files, const std::string& host) {
  in_addr address{};
  if (inet_pton(AF_INET, host.c_str(), &address) != 1) return {};
  if ((ntohl(address.s_addr) >> 24) == 127) return kLoopback;
  std::istringstream table(files.Read("/proc/net/route").text);
  std::string line, best;
  std::int64_t best_mask = -1;
  std::getline(table, line);  // titles
  while (std::getline(table, line)) {
    std::istringstream fields(line);
    std::string name, gateway, flags, uses, references, metric;
    std::uint32_t target = 0, mask = 0;
    fields >> name >> std::hex >> target >> gateway >> flags >> uses >> references >> metric >>
        mask;
    if (!fields || (address.s_addr & mask) != target || ntohl(mask) <= best_mask) continue;
    best = name;
    best_mask = ntohl(mask);
  }
  return best;
}

BusFacts ModbusFacts(const HostFiles& files, const ModbusDeviceConfig& config) {
  if (config.transport == ModbusTransport::kTcp) {
    BusFacts bus = Make(BusFacts::Kind::kNetwork, config.name, InterfaceTo(files, config.host));
    FindDevice(files, "/sys/class/net/" + bus.device, &bus);
    return bus;
  }
  BusFacts bus = Make(BusFacts::Kind::kSerial, config.name, files.Resolve(config.device));
  if (bus.device.starts_with("/dev/pts/")) {
    bus.presence = BusFacts::Presence::kVirtual;
    return bus;
  }
  const std::string port = BaseName(bus.device);
  FindDevice(files, "/sys/class/tty/" + port, &bus);
  bus.latency_timer_ms = files.Read("/sys/bus/usb-serial/devices/" + port + "/latency_timer");
  return bus;
}

BusFacts BoardFacts(const HostFiles& files, const ComediBoardConfig& config) {
  BusFacts bus = Make(BusFacts::Kind::kBoard, config.device, config.device);
  FindDevice(files, "/sys/class/comedi/" + BaseName(config.device), &bus);
  return bus;
}

// proc(5): fields 40 and 41 of /proc/PID/stat, counted from the state, which is field 3 and follows
// the name in parentheses.
int FifoPriority(const std::string& stat) {
  constexpr int kPriorityAfterState = 37;
  std::istringstream fields(stat.substr(stat.rfind(')') + 1));
  std::string field;
  int priority = 0;
  for (int i = 0; i < kPriorityAfterState; ++i) fields >> field;
  return fields >> priority ? priority : 0;
}

}  // namespace

std::vector<BusFacts> ReadBusFacts(const HostFiles& files, const HalConfig& hal) {
  std::vector<BusFacts> all;
  for (const HalConfig::Bus& bus : hal.bus) {
    const BusWiring* wiring = bus.wiring.get();
    if (const auto* can = dynamic_cast<const CanopenWiring*>(wiring)) {
      all.push_back(CanFacts(files, can->config()));
    } else if (const auto* modbus = dynamic_cast<const ModbusWiring*>(wiring)) {
      all.push_back(ModbusFacts(files, modbus->config()));
    } else if (const auto* board = dynamic_cast<const ComediWiring*>(wiring)) {
      all.push_back(BoardFacts(files, board->config()));
    }
  }
  return all;
}

std::vector<InterruptThread> ReadInterruptThreads(const HostFiles& files) {
  std::vector<InterruptThread> all;
  for (const std::string& process : files.List("/proc")) {
    if (process.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string name = files.Read("/proc/" + process + "/comm").text;  // "irq/33-can0"
    const std::size_t dash = name.find('-');
    if (!name.starts_with("irq/") || dash == std::string::npos) continue;
    const auto number = NumbersOfList(name.substr(4, dash - 4));
    if (!number || number->size() != 1) continue;
    all.push_back({.number = number->front(),
                   .name = name.substr(dash + 1),
                   .priority = FifoPriority(files.Read("/proc/" + process + "/stat").text)});
  }
  return all;
}

std::vector<InterruptThread> ThreadsOf(const BusFacts& bus,
                                       const std::vector<InterruptThread>& all) {
  const auto serves = [&](const InterruptThread& thread) {
    const auto is_named = [&](const std::string& name) {  // "eth0", "eth0-TxRx-0"
      return thread.name == name || thread.name.starts_with(name + "-");
    };
    return std::find(bus.interrupt.begin(), bus.interrupt.end(), thread.number) !=
               bus.interrupt.end() ||
           std::any_of(bus.names.begin(), bus.names.end(), is_named);
  };
  std::vector<InterruptThread> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found), serves);
  return found;
}

}  // namespace flexarm
