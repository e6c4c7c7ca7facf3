#include "controller/design/check_explanation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "controller/design/design_controller.h"
#include "controller/design/design_verdict.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using Names = std::set<std::string>;

Names ExplainedNames() {
  Names names;
  for (const CheckExplanation& row : CheckExplanations()) names.emplace(row.name);
  return names;
}

std::string FileText(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// The names that the sources give to checks: `checks.push_back({"NAME"` and kCheckNames.
Names NamesInSources() {
  const std::regex pushed(R"re(checks\.push_back\(\s*\{\s*"([^"]+)")re");
  const std::regex listed(R"re(kCheckNames = \{([^}]*)\})re"), quoted(R"re("([^"]+)")re");
  Names names;
  const auto add = [&names](const std::string& text, const std::regex& pattern) {
    for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i) {
      names.insert((*i)[1]);
    }
  };
  const std::filesystem::path root = FLEXARM_SOURCE_DIR "/controller";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = FileText(entry.path());
    add(text, pushed);
    std::smatch list;
    if (std::regex_search(text, list, listed)) add(list[1], quoted);
  }
  return names;
}

void AddNames(const RigConfig& config, Names* names) {
  const DesignVerdict verdict = JudgeDesign(config, DesignController(config), {0.1});
  for (const DesignCheck& check : verdict.checks) names->insert(check.name);
}

TEST(CheckExplanation, EveryCheckOfTheSourcesIsExplained) {
  EXPECT_EQ(NamesInSources(), ExplainedNames());
}

TEST(CheckExplanation, EveryCheckOfADesignIsExplained) {
  Names names;
  AddNames(ShippedRig({"controller.name=pd-zv"}), &names);
  AddNames(ShippedRig({kThesisLaw, "controller.matrices.K_e=[1.0, 1.0]"}), &names);
  EXPECT_EQ(names, ExplainedNames());
}

TEST(CheckExplanation, EachSaysWhatItIsAndNamesAKeyOrAnotherCheck) {
  for (const CheckExplanation& row : CheckExplanations()) {
    EXPECT_GT(row.meaning.size(), 40U) << row.name;
    EXPECT_TRUE(row.remedy.find("controller.") != std::string::npos ||
                row.remedy.find("estimator.") != std::string::npos)
        << row.name;
  }
  EXPECT_EQ(ExplanationOf("no-such-check"), nullptr);
  EXPECT_EQ(ExplanationOf("cgt-condition")->name, "cgt-condition");
}

TEST(CheckExplanation, ThePageHasTheTable) {
  const std::string page = FileText(FLEXARM_SOURCE_DIR "/docs/design-checks.md");
  for (const CheckExplanation& row : CheckExplanations()) {
    const std::string line = "| `" + std::string(row.name) + "` | " + std::string(row.meaning) +
                             " | " + std::string(row.remedy) + " |\n";
    EXPECT_NE(page.find(line), std::string::npos) << "docs/design-checks.md lacks:\n" << line;
  }
}

double ValueOf(const std::string& check, const std::vector<std::string>& overrides) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/quanser-2dsfl.toml", overrides);
  for (const DesignCheck& c : JudgeDesign(config, DesignController(config)).checks) {
    if (c.name == check) return c.value;
  }
  return 0.0;
}

// The advice is not theory: on the second rig each key has the promised effect.
TEST(CheckExplanation, TheKeysChangeTheMarginsAsTheySay) {
  const std::string light = "controller.torque_weight=0.2";  // fails with it
  EXPECT_GT(ValueOf("robustness-spectral-radius", {light}), 1.0);
  EXPECT_LT(ValueOf("robustness-spectral-radius", {"controller.torque_weight=2.0"}),
            ValueOf("robustness-spectral-radius", {light}));
  EXPECT_GT(ValueOf("gain-margin-up", {"controller.torque_weight=2.0"}),
            ValueOf("gain-margin-up", {light}));
  EXPECT_GT(ValueOf("delay-margin-ms", {"controller.torque_weight=2.0"}),
            ValueOf("delay-margin-ms", {light}));
  EXPECT_GT(ValueOf("gain-margin-up", {light, "controller.hub_rate_weight=[0.5, 0.1]"}),
            ValueOf("gain-margin-up", {light}));
}

}  // namespace
}  // namespace flexarm
