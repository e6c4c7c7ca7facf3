#include "controller/host/host_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "hal/canopen/canopen_wiring.h"
#include "hal/comedi/comedi_wiring.h"
#include "hal/modbus/modbus_wiring.h"
#include "tests/controller/host/host_tree.h"

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using State = HostText::State;
using Presence = BusFacts::Presence;

const std::string kCpus = "/sys/devices/system/cpu";

HostFacts Read(const HostTree& tree, const HalConfig& hal = {}) {
  return ReadHostFacts(HostFiles(tree.root()), hal, 90);
}

TEST(NumbersOfList, ReadsRangesAndRefusesOtherTexts) {
  EXPECT_THAT(NumbersOfList("0-2,5").value(), ElementsAre(0, 1, 2, 5));
  EXPECT_THAT(NumbersOfList("").value(), IsEmpty());
  for (const char* text : {"x", "1-", "-1", "3-1", "0-999999999"}) {
    EXPECT_FALSE(NumbersOfList(text)) << text;
  }
}

TEST(HostFiles, TellsAnAbsentFileFromAnUnreadableOne) {
  HostTree tree;
  tree.Write("/proc/number", "950000\n");
  tree.Write("/proc/folder/file", "");
  const HostFiles files(tree.root());
  EXPECT_EQ(files.Read("/proc/number").number(), 950'000);
  EXPECT_EQ(files.Read("/proc/none").state, State::kAbsent);
  EXPECT_EQ(files.Read("/proc/folder").state, State::kUnreadable);
  EXPECT_THAT(files.List("/proc"), ElementsAre("folder", "number"));
}

TEST(HostFacts, AreUnknownInAnEmptyTree) {
  const HostFacts facts = Read(HostTree());
  EXPECT_FALSE(facts.may_lock_all.has_value());
  EXPECT_FALSE(facts.cpu.has_value());
  EXPECT_FALSE(facts.wake_up_limit_us.has_value());
  EXPECT_TRUE(facts.isolated_cpus.absent());
  EXPECT_TRUE(facts.clock_source.absent());
  EXPECT_THAT(facts.interrupt_thread, IsEmpty());
  EXPECT_EQ(facts.time_service, "");
  EXPECT_EQ(facts.realtime.fifo_priority, 90);
}

TEST(HostFacts, KnowTheCapabilityToLockMemory) {
  HostTree tree;
  tree.Write("/proc/self/status", "CapPrm:\t0\nCapEff:\t0000000000004000\n");
  EXPECT_EQ(Read(tree).may_lock_all, true);
  tree.Write("/proc/self/status", "CapEff:\t0000000000001000\n");
  EXPECT_EQ(Read(tree).may_lock_all, false);
}

TEST(HostFacts, DescribeTheProcessorsThatAreOnlineAndAllowed) {
  HostTree tree;
  tree.Write("/proc/self/status", "Cpus_allowed_list:\t0-1,7\n");
  tree.Write(kCpus + "/online", "0-3\n");
  tree.Write(kCpus + "/cpu1/cpufreq/scaling_governor", "powersave\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state0/name", "POLL\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state0/latency", "0\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state0/disable", "0\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state1/name", "C6\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state1/latency", "133\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state1/disable", "0\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state2/latency", "890\n");
  tree.Write(kCpus + "/cpu1/cpuidle/state2/disable", "1\n");
  const HostFacts facts = Read(tree);
  ASSERT_TRUE(facts.cpu);
  ASSERT_THAT(*facts.cpu, SizeIs(2));
  EXPECT_EQ((*facts.cpu)[0].number, 0);
  EXPECT_TRUE((*facts.cpu)[0].governor.absent());
  EXPECT_THAT((*facts.cpu)[0].may_idle, IsEmpty());
  EXPECT_EQ((*facts.cpu)[1].governor.text, "powersave");
  ASSERT_THAT((*facts.cpu)[1].may_idle, SizeIs(2)) << "the disabled state does not count";
  EXPECT_EQ((*facts.cpu)[1].may_idle[1].name, "C6");
  EXPECT_EQ((*facts.cpu)[1].may_idle[1].exit_latency_us, 133);
}

TEST(HostFacts, KnowTheLimitThatAProcessHoldsOnTheWakeUp) {
  HostTree tree;
  tree.Write("/dev/cpu_dma_latency", std::string("\x0a\0\0\0", 4));
  EXPECT_EQ(Read(tree).wake_up_limit_us, 10);
  tree.Write("/dev/cpu_dma_latency", std::string("\x00\x94\x35\x77", 4));  // 2e9: none
  EXPECT_FALSE(Read(tree).wake_up_limit_us.has_value());
}

TEST(HostFacts, NameTheServiceThatSetsTheClock) {
  HostTree tree;
  tree.Write("/proc/12/comm", "bash\n");
  tree.Write("/proc/314/comm", "systemd-timesyn\n");
  EXPECT_EQ(Read(tree).time_service, "systemd-timesyn");
}

TEST(HostFacts, ListTheThreadsOfInterrupts) {
  HostTree tree;
  tree.InterruptThread(90, "irq/33-can0", 80);
  tree.InterruptThread(91, "ksoftirqd/0", 1);
  const HostFacts facts = Read(tree);
  ASSERT_THAT(facts.interrupt_thread, SizeIs(1));
  EXPECT_EQ(facts.interrupt_thread[0].number, 33);
  EXPECT_EQ(facts.interrupt_thread[0].name, "can0");
  EXPECT_EQ(facts.interrupt_thread[0].priority, 80);
}

HalConfig WithCan(const std::string& interface) {
  HalConfig hal;
  CanopenConfig can{};
  can.interface = interface;
  hal.Add(std::make_shared<CanopenWiring>(can));
  return hal;
}

HalConfig WithTcp(const std::string& host) {
  HalConfig hal;
  ModbusDeviceConfig modbus{};
  modbus.name = "amplifier";
  modbus.transport = ModbusTransport::kTcp;
  modbus.host = host;
  hal.Add(std::make_shared<ModbusWiring>(modbus));
  return hal;
}

HalConfig WithSerial(const std::string& device) {
  HalConfig hal;
  ModbusDeviceConfig modbus{};
  modbus.name = "amplifier";
  modbus.transport = ModbusTransport::kRtu;
  modbus.device = device;
  hal.Add(std::make_shared<ModbusWiring>(modbus));
  return hal;
}

BusFacts OnlyBus(const HostTree& tree, const HalConfig& hal) {
  const HostFacts facts = Read(tree, hal);
  EXPECT_THAT(facts.bus, SizeIs(1));
  return facts.bus.at(0);
}

TEST(BusFacts, FindTheInterruptsOfACanCard) {
  HostTree tree;
  const std::string card = "/sys/devices/pci0000:00/0000:03:00.0";
  tree.Link("/sys/class/net/xcan7/device", card);
  tree.Write(card + "/irq", "19\n");
  tree.Write(card + "/msi_irqs/126", "msi\n");
  tree.Write(card + "/msi_irqs/127", "msi\n");
  const BusFacts bus = OnlyBus(tree, WithCan("xcan7"));
  EXPECT_EQ(bus.presence, Presence::kDevice);
  EXPECT_THAT(bus.interrupt, ElementsAre(126, 127)) << "irq is not used with message interrupts";
  EXPECT_FALSE(bus.link.has_value()) << "this machine has no xcan7";
  EXPECT_THAT(ThreadsOf(bus, {{.number = 127, .name = "x", .priority = 50},
                              {.number = 9, .name = "xcan7", .priority = 50},
                              {.number = 9, .name = "xcan77", .priority = 50}}),
              SizeIs(2));
}

TEST(BusFacts, FindTheControllerAboveAUsbAdapter) {
  HostTree tree;
  const std::string controller = "/sys/devices/pci0000:00/0000:00:14.0";
  tree.Link("/sys/class/tty/ttyUSB0/device", controller + "/usb1/1-2/1-2:1.0/ttyUSB0");
  tree.Write(controller + "/irq", "41\n");
  tree.Write("/dev/ttyUSB0", "");
  tree.Write("/sys/bus/usb-serial/devices/ttyUSB0/latency_timer", "16\n");
  std::filesystem::create_directories(tree.root() / "dev/serial/by-id");
  std::filesystem::create_symlink("../../ttyUSB0", tree.root() / "dev/serial/by-id/usb-FTDI");
  const BusFacts bus = OnlyBus(tree, WithSerial("/dev/serial/by-id/usb-FTDI"));
  EXPECT_EQ(bus.device, "/dev/ttyUSB0");
  EXPECT_EQ(bus.presence, Presence::kDevice);
  EXPECT_THAT(bus.interrupt, ElementsAre(41));
  EXPECT_EQ(bus.latency_timer_ms.number(), 16);
}

TEST(BusFacts, TellVirtualDevicesFromMissingOnes) {
  HostTree tree;
  std::filesystem::create_directories(tree.root() / "sys/class/net/vcan9");
  std::filesystem::create_directories(tree.root() / "sys/class/net/lo");
  EXPECT_EQ(OnlyBus(tree, WithCan("vcan9")).presence, Presence::kVirtual);
  EXPECT_EQ(OnlyBus(tree, WithCan("can9")).presence, Presence::kMissing);
  EXPECT_EQ(OnlyBus(tree, WithTcp("127.0.0.1")).presence, Presence::kVirtual);
  EXPECT_EQ(OnlyBus(tree, WithSerial("/dev/ttyUSB9")).presence, Presence::kMissing);
  tree.Write("/dev/pts/3", "");
  EXPECT_EQ(OnlyBus(tree, WithSerial("/dev/pts/3")).presence, Presence::kVirtual);
}

TEST(BusFacts, FollowTheRouteToATcpDevice) {
  HostTree tree;
  tree.Write("/proc/net/route",
             "Iface\tDestination\tGateway\tFlags\tRefCnt\tUse\tMetric\tMask\n"
             "eth0\t00000000\t0101A8C0\t0003\t0\t0\t0\t00000000\n"
             "eth1\t0007A8C0\t00000000\t0001\t0\t0\t0\t00FFFFFF\n"
             "eth2\t0000A8C0\t00000000\t0001\t0\t0\t0\t0000FFFF\n");
  EXPECT_EQ(OnlyBus(tree, WithTcp("192.168.7.21")).device, "eth1");
  EXPECT_EQ(OnlyBus(tree, WithTcp("192.168.8.1")).device, "eth2");
  EXPECT_EQ(OnlyBus(tree, WithTcp("10.0.0.1")).device, "eth0");
  tree.Remove("/proc/net/route");
  const BusFacts lost = OnlyBus(tree, WithTcp("192.168.7.21"));
  EXPECT_EQ(lost.device, "");
  EXPECT_EQ(lost.presence, Presence::kMissing);
}

TEST(BusFacts, FindADaqBoard) {
  HostTree tree;
  tree.Link("/sys/class/comedi/comedi0/device", "/sys/devices/pci0000:00/0000:04:00.0");
  tree.Write("/sys/devices/pci0000:00/0000:04:00.0/irq", "21\n");
  HalConfig hal;
  ComediBoardConfig board{};
  board.device = "/dev/comedi0";
  hal.Add(std::make_shared<ComediWiring>(board));
  EXPECT_THAT(OnlyBus(tree, hal).interrupt, ElementsAre(21));
}

}  // namespace
}  // namespace flexarm
