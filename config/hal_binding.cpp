#include "config/hal_binding.h"

#include <array>
#include <memory>

#include "config/hal_sections.h"
#include "hal/canopen/canopen_wiring.h"
#include "hal/comedi/comedi_wiring.h"
#include "hal/modbus/modbus_wiring.h"

namespace flexarm {
namespace {

void ReadGpiod(TableReader gpiod, GpiodConfig* out) {
  struct Input {
    const char* key;
    Meaning meaning;
  };
  constexpr std::array<Input, kLines> kInputs = {{
      {"limit_1_low", "input of the limit switch of joint 1, low end: 1 while it is closed"},
      {"limit_1_high", "the same, joint 1, high end"},
      {"limit_2_low", "the same, joint 2, low end"},
      {"limit_2_high", "the same, joint 2, high end"},
      {"emergency_stop", "input of the emergency stop: 1 while it is not pressed"},
      {"reset_button", "input of the reset button: 1 while it is pressed"},
  }};
  gpiod.Read("chip", &out->chip, "GPIO chip: its device, name or label");
  for (std::size_t i = 0; i < kInputs.size(); ++i) {
    gpiod.Read(kInputs[i].key, &out->input[i], kInputs[i].meaning);
  }
  gpiod.Read("relay", &out->relay, "output of the relay in the drives' supply: 1 closes it");
  gpiod.Read("pump", &out->pump,
             "output of the charge pump: it enables the drives while it toggles");
  if (gpiod.Has("drive_voltage")) {
    TableReader voltage = gpiod.Table(
        "drive_voltage",
        "the drives hang on relay and pump and report their voltage: it is tested at each arming");
    DriveVoltageTimes& times = out->drive_voltage.emplace();
    voltage.Read("rise_ms", &times.rise_ms,
                 "longest time from power on until every drive has voltage");
    voltage.Read("fall_ms", &times.fall_ms,
                 "longest time from power off until no drive has voltage");
  }
  gpiod.ReadIfGiven("relay_contact", &out->relay_contact,
                    "input of the relay's mirror contact: 1 while all its main contacts are open");
}

// A bus from its row, by a function that reads the keys of its config.
template <typename Wiring, void (*read)(TableReader, double, typename Wiring::Config*)>
std::shared_ptr<const BusWiring> ReadBus(const TableReader& row, double period_ms) {
  typename Wiring::Config config{};
  read(row, period_ms, &config);
  return std::make_shared<Wiring>(std::move(config));
}

struct BusKind {
  const char* key;  // of [hal], and BusWiring::kind
  Meaning meaning;
  std::shared_ptr<const BusWiring> (*read)(const TableReader& row, double period_ms);
};

// Every kind of bus, in the order in which the rig opens them.
constexpr std::array kBusKinds = {
    BusKind{"canopen", "a CAN interface with CANopen drives and encoders",
            ReadBus<CanopenWiring, ReadCanopen>},
    BusKind{"modbus", "a Modbus device: a strain amplifier", ReadBus<ModbusWiring, ReadModbus>},
    BusKind{"comedi", "a DAQ board", ReadBus<ComediWiring, ReadComedi>},
};

}  // namespace

void ReadHal(TableReader hal, double period_ms, std::string* backend, HalConfig* out) {
  hal.Read<std::string>("backend", backend, {{"sim", "sim"}, {"wired", "wired"}},
                        "the simulated arm in the daemon, or the devices of the tables below");
  for (const BusKind& kind : kBusKinds) {
    for (const TableReader& row : hal.OptionalRows(kind.key, kind.meaning))
      out->Add(kind.read(row, period_ms));
  }
  if (hal.Has("gpiod"))
    ReadGpiod(hal.Table("gpiod",
                        "the safety chain on the lines of a GPIO chip, which a wired rig needs; "
                        "offsets of the lines on the chip"),
              &out->gpiod.emplace());
}

}  // namespace flexarm
