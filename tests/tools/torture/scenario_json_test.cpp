#include "tools/torture/scenario_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "controller/runlog/errors.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/message_of.h"
#include "tools/support/scratch_folder.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using Json = nlohmann::ordered_json;

class ScenarioFile : public testing::Test {
 protected:
  TortureScenario Read(const std::string& text) {
    const std::filesystem::path file = folder_.path() / "scenario.json";
    std::ofstream(file) << text;
    return ReadScenario(file, 20);
  }
  std::string RefusalOf(const Json& json) {
    return MessageOf<InputError>([&] { Read(json.dump()); });
  }
  static TortureScenario Drawn(std::uint64_t seed) {
    static const RigConfig config = ShippedRig();
    static const TortureSpace space = SpaceOf(config, {"gain-scheduled", "receding-horizon"});
    return ScenarioOf(seed, space, config);
  }

 private:
  ScratchFolder folder_{std::filesystem::temp_directory_path()};
};

// The text has all that is random but the seeds; a fault, a command and a wake-up are among them.
TEST_F(ScenarioFile, HasTheWholeScenario) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const TortureScenario drawn = Drawn(seed);
    const TortureScenario read = Read(ScenarioJson(drawn).dump(2));
    EXPECT_EQ(ScenarioJson(read), ScenarioJson(drawn)) << seed;
    EXPECT_EQ(Text(read), Text(drawn)) << seed;
    EXPECT_EQ(read.after_ns, drawn.after_ns);
    EXPECT_EQ(read.wake_ups.seed, drawn.wake_ups.seed);
    EXPECT_EQ(read.wake_ups.latest_ns, drawn.wake_ups.latest_ns);
    EXPECT_EQ(read.payload_kg, drawn.payload_kg) << "to the bit";
    ASSERT_EQ(read.faults.size(), drawn.faults.size());
    for (std::size_t i = 0; i < read.faults.size(); ++i) {
      EXPECT_EQ(read.faults[i].seed, drawn.faults[i].seed);
      EXPECT_EQ(read.faults[i].to_ns, drawn.faults[i].to_ns);
    }
  }
}

TEST_F(ScenarioFile, SaysWhatIsWrong) {
  TortureScenario scenario = Drawn(1);
  scenario.faults = {{.place = FaultPlace::kRelay,
                      .index = 0,
                      .kind = FaultKind::kOff,
                      .from_ns = 0,
                      .to_ns = INT64_MAX,
                      .seed = 1}};
  const Json good = ScenarioJson(scenario);
  Json bad = good;
  bad["situation"] = "Asleep";
  EXPECT_THAT(RefusalOf(bad), HasSubstr("unknown name \"Asleep\""));
  bad = good;
  bad["faults"][0]["kind"] = "drifting";
  EXPECT_THAT(RefusalOf(bad), HasSubstr("there is no relay drifting"));
  bad = good;
  bad["faults"][0]["index"] = 1;
  EXPECT_THAT(RefusalOf(bad), HasSubstr("relay has no index 1"));
  for (const auto& [key, value] : good.items()) {
    bad = good;
    bad.erase(key);
    EXPECT_THAT(RefusalOf(bad), HasSubstr(key));
    bad[key] = Json::object({{"what", "is this"}});
    EXPECT_THAT(RefusalOf(bad), HasSubstr("scenario.json: " + key)) << key;
  }
  bad = good;
  bad["faults"][0]["seed"] = -1;
  EXPECT_THAT(RefusalOf(bad),
              HasSubstr("faults[0].seed: expected a whole number, 0 or more, found -1"));
  bad = good;
  bad["wake_ups"]["latest_ms"] = "soon";
  EXPECT_THAT(RefusalOf(bad), HasSubstr("wake_ups.latest_ms: expected a number, found \"soon\""));
  EXPECT_THAT(MessageOf<InputError>([&] { Read("[1"); }), HasSubstr("is not JSON"));
}

}  // namespace
}  // namespace flexarm
