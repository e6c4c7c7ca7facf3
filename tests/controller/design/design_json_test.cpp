#include "controller/design/design_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/design/design_controller.h"
#include "controller/design/run_design.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

bool SameBits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

// Compares everything that the loop and the checks use.
void ExpectSameBits(const Design& a, const Design& b) {
  EXPECT_TRUE(SameBits(a.A, b.A) && SameBits(a.B, b.B));
  EXPECT_TRUE(SameBits(a.Am, b.Am) && SameBits(a.Bm, b.Bm));
  EXPECT_TRUE(SameBits(a.K, b.K) && SameBits(a.K_stop, b.K_stop) && SameBits(a.P, b.P));
  EXPECT_TRUE(SameBits(a.J, b.J) && SameBits(a.G, b.G));
  EXPECT_TRUE(SameBits(a.S11, b.S11) && SameBits(a.S12, b.S12));
  EXPECT_TRUE(SameBits(a.S21, b.S21) && SameBits(a.S22, b.S22));
  EXPECT_TRUE(SameBits(a.Ufx, b.Ufx) && SameBits(a.Ufu, b.Ufu));
  EXPECT_TRUE(SameBits(a.filter_A, b.filter_A) && SameBits(a.filter_B, b.filter_B));
  EXPECT_TRUE(SameBits(a.filter_C, b.filter_C) && SameBits(a.filter_L, b.filter_L));
  EXPECT_TRUE(SameBits(a.filter_W, b.filter_W) && SameBits(a.filter_P, b.filter_P));
  EXPECT_TRUE(SameBits(a.filter_R, b.filter_R));
  EXPECT_TRUE(SameBits(a.rigid_inertia_kgm2, b.rigid_inertia_kgm2));
}

std::string JsonOf(const Design& design, const RigConfig& config) {
  return DesignToJson(design, DesignHash(config));
}

std::string RefusalOf(const std::string& text, const RigConfig& config) {
  return MessageOf<RejectedError>([&] { DesignFromJson(text, config); });
}

std::string RefusalOf(const std::string& text) {
  static const RigConfig shipped = ShippedRig();
  return RefusalOf(text, shipped);
}

nlohmann::json ShippedJson() {
  return nlohmann::json::parse(JsonOf(ShippedDesign(), ShippedRig()));
}

TEST(DesignJson, RoundTripIsBitExact) {
  const Design back = DesignFromJson(ShippedJson().dump(), ShippedRig());
  ExpectSameBits(back, ShippedDesign());
  ASSERT_EQ(back.checks.size(), ShippedDesign().checks.size());
  for (std::size_t i = 0; i < back.checks.size(); ++i) {
    EXPECT_EQ(back.checks[i].name, ShippedDesign().checks[i].name);
    EXPECT_EQ(back.checks[i].value, ShippedDesign().checks[i].value);
    EXPECT_EQ(back.checks[i].limit, ShippedDesign().checks[i].limit);
    EXPECT_EQ(back.checks[i].below, ShippedDesign().checks[i].below);
  }
}

TEST(DesignJson, RoundTripKeepsTheGainsOfTheRecedingHorizonLaw) {
  const RigConfig config = ShippedRig({"controller.name=receding-horizon"});
  const Design design = DesignController(config);
  const Design back = DesignFromJson(JsonOf(design, config), config);
  ASSERT_TRUE(back.scheduled && back.scheduled->start_gains);
  const auto& gains = design.scheduled->gains.knots();
  const auto& start = design.scheduled->start_gains->knots();
  EXPECT_EQ(back.payload_model, design.payload_model);
  EXPECT_EQ(back.scheduled->gains.knots(), gains);
  EXPECT_EQ(back.scheduled->start_gains->knots(), start);
  EXPECT_EQ(back.scheduled->max_kg, design.scheduled->max_kg);
  EXPECT_EQ(back.scheduled->reference_kg, design.scheduled->reference_kg);
  EXPECT_GT((gains[0] - start[0]).norm(), 1.0) << "of another alpha";
}

// Members of 'payload' that a law or its estimator needs.
TEST(DesignJson, AMissingPayloadMemberIsNamed) {
  struct Case {
    const char* law;
    std::vector<std::string> needs;
  };
  const std::vector<std::string> scheduled = {"model", "gain_payload_kg", "gain_theta2_rad",
                                              "gain",  "max_kg",          "reference_kg"};
  std::vector<std::string> planned = scheduled;
  planned.emplace_back("start_gain");
  for (const auto& [law, needs] :
       {Case{"sobel-thesis", {"model"}}, Case{"gain-scheduled", scheduled},
        Case{"receding-horizon", planned}}) {
    const RigConfig config =
        ShippedRig({std::string("controller.name=") + law, "estimator.name=ekf-payload"});
    const nlohmann::json json = nlohmann::json::parse(JsonOf(DesignController(config), config));
    ASSERT_EQ(RefusalOf(json.dump(), config), "") << law;
    for (const std::string& key : needs) {
      const std::string name = std::string("'payload.") + key + "'";
      nlohmann::json without = json;
      ASSERT_EQ(without["payload"].erase(key), 1u) << key;
      EXPECT_THAT(RefusalOf(without.dump(), config),
                  AllOf(HasSubstr(name + " is missing"), HasSubstr("flexarm design")))
          << law;
      nlohmann::json of_another_type = json;
      of_another_type["payload"][key] = "heavy";
      EXPECT_THAT(RefusalOf(of_another_type.dump(), config), HasSubstr("'payload")) << key;
    }
    nlohmann::json without = json;
    without.erase("payload");
    EXPECT_THAT(RefusalOf(without.dump(), config), HasSubstr("'payload.model' is missing")) << law;
  }
}

TEST(DesignJson, ATableWithAMissingKnotIsRefused) {
  const RigConfig config = ShippedRig({"controller.name=receding-horizon"});
  nlohmann::json json = nlohmann::json::parse(JsonOf(DesignController(config), config));
  json["payload"]["start_gain"].erase(0);
  EXPECT_THAT(RefusalOf(json.dump(), config), HasSubstr("'payload'"));
}

// Payload gains in the file of a law that does not use them must not change the law.
TEST(DesignJson, MembersThatTheConfigDoesNotNeedAreIgnored) {
  const RigConfig path = ShippedRig({"controller.name=receding-horizon"});
  const nlohmann::json of_path = nlohmann::json::parse(JsonOf(DesignController(path), path));
  nlohmann::json json = ShippedJson();
  json["payload"] = of_path["payload"];
  const RigConfig thesis = ShippedRig({kThesisLaw});
  json["config_hash"] = DesignHash(thesis);
  const Design plain = DesignFromJson(json.dump(), thesis);
  EXPECT_TRUE(plain.payload_model.empty());
  EXPECT_FALSE(plain.scheduled);
  const RigConfig estimated = ShippedRig({"estimator.name=ekf-payload"});
  json["config_hash"] = DesignHash(estimated);
  const Design read = DesignFromJson(json.dump(), estimated);
  EXPECT_FALSE(read.payload_model.empty());
  EXPECT_FALSE(read.scheduled);
}

TEST(DesignJson, GainsOfAnotherConfigAreRefusedWithBothHashes) {
  EXPECT_THAT(RefusalOf(DesignToJson(ShippedDesign(), "aaaa")),
              AllOf(HasSubstr("another config"), HasSubstr("aaaa"),
                    HasSubstr(DesignHash(ShippedRig())), HasSubstr("flexarm design")));
}

TEST(DesignJson, EachMissingMatrixIsNamed) {
  for (const char* name : {"A", "Am", "K", "K_stop", "P", "G", "S11", "S22", "Ufx", "filter_L",
                           "filter_P", "rigid_inertia_kgm2"}) {
    nlohmann::json json = ShippedJson();
    json.erase(name);
    EXPECT_THAT(RefusalOf(json.dump()), HasSubstr(std::string(name) + "' is missing"));
  }
}

TEST(DesignJson, AWrongShapeIsNamedWithWhatWasExpected) {
  nlohmann::json json = ShippedJson();
  json["B"].erase(json["B"].end() - 1);
  EXPECT_THAT(RefusalOf(json.dump()),
              AllOf(HasSubstr("'B'"), HasSubstr("11 x 2"), HasSubstr("expected 12 x 2")));
  json = ShippedJson();
  json["rigid_inertia_kgm2"] = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("rigid_inertia"), HasSubstr("2 x 2")));
}

TEST(DesignJson, TheNominalModelIsReadAndDeterminesTheShapes) {
  nlohmann::json json = ShippedJson();
  json["nominal"] = "T16";
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("12 x 12"), HasSubstr("expected 16 x 16")));
  json["nominal"] = "R13";
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("'nominal'"), HasSubstr("R13")));
  json.erase("nominal");
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("'nominal'"), HasSubstr("missing")));
}

// A gauge filter of second order has two states per mode: such gains are read back unchanged.
TEST(DesignJson, GainsBehindASecondOrderFilterAreReadBack) {
  const RigConfig config = ShippedRig({"sensors.strain_input.filter_damping=0.9"});
  const Design design = DesignController(config);
  const Design read = DesignFromJson(JsonOf(design, config), config);
  EXPECT_EQ(read.filter_A, design.filter_A);
  EXPECT_EQ(read.layout, design.layout);
}

TEST(DesignJson, ABrokenMatrixIsNamed) {
  nlohmann::json json = ShippedJson();
  json["K"][1].erase(json["K"][1].end() - 1);
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("'K'"), HasSubstr("different length")));
  json = ShippedJson();
  json["S11"][2][3] = "twelve";
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("'S11'"), HasSubstr("not a number")));
  json = ShippedJson();
  json["J"][0][0] = nullptr;  // how JSON writes NaN
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("'J'"), HasSubstr("not a number")));
  json = ShippedJson();
  json["G"] = 5;
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("'G'"), HasSubstr("not a matrix")));
  json = ShippedJson();
  json["P"] = nlohmann::json::array({1.0, 2.0});
  EXPECT_THAT(RefusalOf(json.dump()), AllOf(HasSubstr("'P'"), HasSubstr("not a matrix")));
}

// Each of these files could be passed by mistake: one clear refusal, no other exception.
TEST(DesignJson, AFileThatIsNotAGainsFileIsRefused) {
  for (const char* text : {"", "hello", "[1, 2]", "{}", "{\"format\": \"other\"}",
                           "{\"format\": 5}", "{\"A\": [[1", "null"}) {
    EXPECT_THAT(RefusalOf(text), HasSubstr("not a gains file")) << text;
  }
}

// A log made to hurt: copying brackets within brackets takes stack for each.
TEST(DesignJson, DeepBracketsInAnyMemberAreRefused) {
  const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
  for (const char* member : {"payload", "checks", "config_hash", "unknown"}) {
    nlohmann::json json = ShippedJson();
    json[member] = "here";
    std::string text = json.dump();
    text.replace(text.find("\"here\""), 6, deep);
    EXPECT_THAT(RefusalOf(text), HasSubstr("gains file:1: is nested more than 32")) << member;
  }
}

TEST(DesignJson, FieldsOfTheWrongTypeAreRefused) {
  nlohmann::json json = ShippedJson();
  json["config_hash"] = 12;
  EXPECT_NE(RefusalOf(json.dump()), "");
  json = ShippedJson();
  json["checks"] = 5;
  EXPECT_NE(RefusalOf(json.dump()), "");
  json = ShippedJson();
  json["checks"][0]["value"] = "high";
  EXPECT_NE(RefusalOf(json.dump()), "");
}

class GainsFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  void Write(const std::string& text) const { std::ofstream(path_) << text; }
  RigConfig RigWithGains(const std::vector<std::string>& overrides = {}) const {
    RigConfig config = ShippedRig(overrides);
    config.controller.gains_file = path_;
    return config;
  }

  const std::string path_ = testing::TempDir() + "flexarm_gains_" +
                            testing::UnitTest::GetInstance()->current_test_info()->name() + ".json";
};

TEST_F(GainsFile, IsUsedWhenTheConfigNamesIt) {
  Design marked = ShippedDesign();
  marked.G(0, 0) *= 1.0 + 1e-9;  // as of another processor: it must come from the file
  Write(JsonOf(marked, ShippedRig()));
  ExpectSameBits(DesignFor(RigWithGains()), marked);
}

// Three of these passed all checks of the file, ran, and tripped; K_stop shows in no ordinary run.
TEST_F(GainsFile, WhoseGainsWereChangedIsRefusedByTheirName) {
  const auto refusal = [this](const char* name, double factor) {
    nlohmann::json json = ShippedJson();
    for (auto& row : json[name]) {
      for (auto& number : row) number = factor * number.get<double>();
    }
    Write(json.dump());
    return MessageOf<RejectedError>([&] { DesignFor(RigWithGains()); });
  };
  for (const char* name : {"K", "K_stop"}) {
    EXPECT_THAT(refusal(name, -1.0),
                AllOf(HasSubstr(path_), HasSubstr("'" + std::string(name) + "'[")));
    EXPECT_THAT(refusal(name, 10.0), HasSubstr("but the design of this config gives"));
  }
  EXPECT_THAT(refusal("filter_L", 0.0), HasSubstr("'filter_L'["));
  EXPECT_EQ(refusal("K", 1.0), "");
}

TEST_F(GainsFile, OneChangedNumberOfAnyMatrixIsFound) {
  const nlohmann::json shipped = ShippedJson();
  for (const auto& [name, rows] : shipped.items()) {
    if (!rows.is_array() || name == "checks") continue;
    nlohmann::json json = shipped;
    double& number = json[name].back().back().get_ref<double&>();
    number += 0.01 + 0.01 * std::fabs(number);
    Write(json.dump());
    EXPECT_THAT(MessageOf<RejectedError>([&] { DesignFor(RigWithGains()); }),
                HasSubstr("'" + name + "'["))
        << name;
  }
}

TEST_F(GainsFile, AChangedGainTableIsRefused) {
  const std::vector<std::string> plans = {"controller.name=receding-horizon"};
  const RigConfig rig = ShippedRig(plans);
  const nlohmann::json json = nlohmann::json::parse(JsonOf(DesignController(rig), rig));
  const auto refusal = [&](const char* pointer) {
    nlohmann::json changed = json;
    nlohmann::json& number = changed[nlohmann::json::json_pointer(pointer)];
    number = 1.001 * number.get<double>() + 1e-3;
    Write(changed.dump());
    return MessageOf<RejectedError>([&] { DesignFor(RigWithGains(plans)); });
  };
  EXPECT_THAT(refusal("/payload/model/0"), HasSubstr("'payload.model'[0]"));
  EXPECT_THAT(refusal("/payload/gain/1/0/0"), HasSubstr("'payload.gain[1]'[0][0]"));
  EXPECT_THAT(refusal("/payload/start_gain/2/1/11"), HasSubstr("'payload.start_gain[2]'[1][11]"));
  EXPECT_THAT(refusal("/payload/max_kg"), HasSubstr("'payload.max_kg'"));
  EXPECT_THAT(refusal("/payload/gain_payload_kg/1"), HasSubstr("'payload.gain_payload_kg'[1]"));
}

TEST_F(GainsFile, ItsChecksAreThoseOfTheDesignAndNoOthers) {
  const auto refusal = [this](const auto& change) {
    nlohmann::json json = ShippedJson();
    change(&json["checks"]);
    Write(json.dump());
    return MessageOf<RejectedError>([&] { DesignFor(RigWithGains()); });
  };
  EXPECT_THAT(refusal([](auto* checks) { checks->erase(0); }), HasSubstr("is missing"));
  EXPECT_THAT(refusal([](auto* checks) { (*checks)[0]["limit"] = 1e300; }), HasSubstr("the limit"));
  EXPECT_THAT(refusal([](auto* checks) { (*checks)[0]["below"] = false; }),
              HasSubstr("another result"));
  EXPECT_THAT(refusal([](auto* checks) {
                checks->push_back({{"name", "\x1B"}, {"value", 0}, {"limit", 1}, {"below", true}});
              }),
              HasSubstr("the check '\\x1b' is none of this design"));
}

TEST_F(GainsFile, OfAnotherAlphaIsRefused) {
  const RigConfig other = ShippedRig({"controller.alpha=2.5"});
  Write(JsonOf(DesignController(other), other));
  EXPECT_THROW(DesignFor(RigWithGains()), RejectedError);
}

TEST_F(GainsFile, IfMissingIsRefusedByName) {
  EXPECT_THAT(MessageOf<RejectedError>([&] { DesignFor(RigWithGains()); }),
              AllOf(HasSubstr(path_), HasSubstr("flexarm design")));
}

TEST_F(GainsFile, WithoutAMemberOfItsLawIsRefusedByFileAndKey) {
  const std::vector<std::string> plans = {"controller.name=receding-horizon"};
  Design design = DesignController(ShippedRig(plans));
  design.scheduled->start_gains.reset();
  Write(JsonOf(design, ShippedRig(plans)));
  EXPECT_THAT(MessageOf<RejectedError>([&] { DesignFor(RigWithGains(plans)); }),
              AllOf(HasSubstr(path_), HasSubstr("'payload.start_gain' is missing")));
}

TEST_F(GainsFile, WithAFailedCheckIsRefusedByItsName) {
  Design bad = ShippedDesign();
  bad.checks[0].value = 2.0 * bad.checks[0].limit;
  Write(JsonOf(bad, ShippedRig()));
  EXPECT_THAT(MessageOf<RejectedError>([&] { DesignFor(RigWithGains()); }),
              HasSubstr(bad.checks[0].name));
}

TEST_F(GainsFile, WithAFailedCheckThatWasWaivedIsUsed) {
  Design bad = ShippedDesign();
  bad.checks.push_back({"delay-margin-ms", 1.0, 5.0, false, true});  // a --force of `design`
  Write(JsonOf(bad, ShippedRig()));
  const Design read = DesignFor(RigWithGains());
  EXPECT_TRUE(read.checks.back().waived);
  EXPECT_FALSE(read.checks.back().passed());
  EXPECT_FALSE(read.checks.front().waived);
}

// The hash covers the settings of a design, and no others.
TEST(DesignHash, ChangesExactlyWithTheSettingsOfADesign) {
  const std::string shipped = DesignHash(ShippedRig());
  for (const char* changed : {"controller.alpha=2.9",
                              "controller.torque_weight=2.1",
                              "controller.passivity_margin=4.0",
                              "controller.hub_angle_weight=[100.0, 21.0]",
                              "controller.hub_rate_weight=[5.0, 1.1]",
                              "arm.payload_mass_kg=0.11",
                              "link1.damping_ratio=0.031",
                              "joint2.rotor_inertia_kgm2=0.01",
                              "sensors.strain_input.filter_hz=21.0",
                              "sensors.strain_input.filter_damping=0.9",
                              "joint1.viscous_friction_nm_s_per_rad=0.1",
                              "sensors.encoder[0].counts_per_turn=2000.0",
                              "estimator.process_force=[0.3, 0.05, 5.0, 5.0, 1.5, 1.6]",
                              "controller.nominal=R8",
                              "controller.nominal=T12",
                              "controller.state_weight=[100, 20, 0, 0, 0, 0, 5, 1, 0, 0, 0, 0]",
                              "estimator.modal_sigma_m=[2e-4, 1e-4, 2e-4, 2e-4]",
                              "arm.damping=modal",
                              "arm.link1_tip_inertia=motor",
                              "loop.period_ms=10.0",
                              "controller.name=sobel-original",
                              "controller.name=lqg",
                              "controller.name=pd",
                              "controller.name=pd-zv"}) {
    RigConfig config;
    try {
      config = ShippedRig({changed});
    } catch (const ConfigError&) {
      continue;  // breaks another rule of the config: cannot be run at all
    }
    EXPECT_NE(DesignHash(config), shipped) << changed;
  }
  for (const char* same : {"sim.seed=2", "controller.vartheta=0.5", "safety.rest_time_s=0.6",
                           "controller.adaptation_gain=0.001"}) {
    EXPECT_EQ(DesignHash(ShippedRig({same})), shipped) << same;
  }
  const std::string thesis = DesignHash(ShippedRig({kThesisLaw}));
  EXPECT_NE(thesis, shipped);
  for (const char* same : {"controller.name=lqr-cgt", "controller.name=lqr-um"}) {
    EXPECT_EQ(DesignHash(ShippedRig({same})), thesis) << same;
  }
  EXPECT_EQ(DesignHash(ShippedRig({kThesisLaw, "controller.settling.alpha=5"})), thesis);
  EXPECT_NE(DesignHash(ShippedRig({"controller.settling.alpha=5"})), shipped);
}

}  // namespace
}  // namespace flexarm
