#include "hal/emulation/modbus_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "hal/bus_device.h"
#include "tests/hal/modbus/served_device.h"

// Our server, read by pymodbus: a client independent of our code and of libmodbus.

namespace flexarm {
namespace {

// Debian's own interpreter has Debian's packages; another one in PATH may not.
const std::string kPython =
    std::filesystem::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";

bool PymodbusIsHere() {
  return std::system((kPython + " -c 'import pymodbus.client' 2>/dev/null").c_str()) == 0;
}

struct Ran {
  int status;
  std::string text;
};

Ran RunClient(const std::string& arguments) {
  const std::string command =
      kPython + " '" FLEXARM_SOURCE_DIR "/tests/hal/modbus/pymodbus_client.py' " + arguments;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {.status = -1, .text = "popen"};
  std::string text;
  std::array<char, 512> chunk;
  while (fgets(chunk.data(), chunk.size(), pipe) != nullptr) text += chunk.data();
  return {.status = pclose(pipe), .text = text};
}

void Show(RegisterImage* image) {
  SensorFrame frame{};
  for (std::size_t i = 0; i < 10; ++i) frame.strain[i] = -static_cast<std::int32_t>(i);
  frame.levels = LineBit(Line::kResetButton);
  image->Publish(frame);
}

const char* const kStrain = "[0, 65535, 65534, 65533, 65532, 65531, 65530, 65529, 65528, 65527]";
const char* const kRest =
    R"("identification": [16706, 7], "button": true, "beyond": 2, "write": 1, "after": [16706, 7])";

TEST(ModbusServer, IsUnderstoodByAnIndependentClientOverTcp) {
  if (!PymodbusIsHere())
    GTEST_SKIP() << "NO INDEPENDENT CLIENT: install python3-pymodbus and python3-serial-asyncio";
  ServedDevice served(Amplifier());
  Show(&served.image);
  const Ran ran = RunClient("tcp " + std::to_string(served.server.port()));
  ASSERT_EQ(ran.status, 0) << ran.text;
  const std::string strain = kStrain;
  EXPECT_EQ(ran.text, R"({"strain": [)" + strain + ", " + strain + ", " + strain + "], " + kRest +
                          R"(, "unit": 11})" + "\n");
}

TEST(ModbusServer, IsUnderstoodByAnIndependentClientOverSerial) {
  if (!PymodbusIsHere())
    GTEST_SKIP() << "NO INDEPENDENT CLIENT: install python3-pymodbus and python3-serial-asyncio";
  ServedDevice served(SerialAmplifier(""));
  Show(&served.image);
  const Ran ran = RunClient("rtu " + served.server.path());
  ASSERT_EQ(ran.status, 0) << ran.text;
  EXPECT_EQ(ran.text, std::string(R"({"strain": [)") + kStrain + "], " + kRest + "}\n");
}

TEST(ModbusServer, CreatesTheConfiguredLinkToItsPseudoTerminal) {
  const std::string link = testing::TempDir() + "/flexarm-modbus-link";
  std::filesystem::remove(link);
  for (int i = 0; i < 2; ++i) {  // the first must leave none behind
    const ModbusDeviceConfig config = SerialAmplifier(link);
    const RegisterImage image(config);
    const ModbusServer server(config, image);
    EXPECT_EQ(std::filesystem::read_symlink(link), server.path());
  }
  EXPECT_FALSE(std::filesystem::is_symlink(link));
}

TEST(ModbusServer, ReportsWhereItCannotListen) {
  ServedDevice served(Amplifier());
  const RegisterImage image(served.config());
  try {
    const ModbusServer second(served.config(), image);
    ADD_FAILURE() << "two servers at one port";
  } catch (const HalError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("127.0.0.1:" + std::to_string(served.server.port())));
  }
}

// Every register of a publication has the same number: a mixture is a torn read.
TEST(RegisterImage, AReaderSeesWholePublications) {
  const ModbusDeviceConfig config = Amplifier();
  RegisterImage image(config);
  std::atomic<bool> done{false};
  std::jthread writer([&] {
    SensorFrame frame{};
    for (std::int32_t n = 1; n <= 20000; ++n) {
      frame.strain.fill(n % 30000);
      image.Publish(frame);
      if (n % 64 == 0) std::this_thread::yield();
    }
    done = true;
  });
  int torn = 0;
  std::array<std::uint16_t, 10> cells{};
  while (!done) {
    image.Copy(ModbusTable::kInputRegister, cells.data());
    for (const std::uint16_t cell : cells) torn += cell == cells[0] ? 0 : 1;
  }
  EXPECT_EQ(torn, 0);
  image.Copy(ModbusTable::kInputRegister, cells.data());
  EXPECT_EQ(cells[0], 20000 % 30000);
}

}  // namespace
}  // namespace flexarm
