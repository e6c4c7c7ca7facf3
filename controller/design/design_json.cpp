#include "controller/design/design_json.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "controller/design/design_matrices.h"
#include "controller/files/external_file.h"
#include "controller/types/control_config.h"
#include "controller/types/rejected_error.h"
#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {
namespace {

constexpr const char* kFormat = "flexarm-gains-1";

// FNV-1a over the text of every number that a design depends on.
class Digest {
 public:
  Digest& operator<<(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.17g;", value);
    for (const char c : text) {
      if (c == '\0') break;
      hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 1099511628211u;
    }
    return *this;
  }
  template <std::size_t N>
  Digest& operator<<(const std::array<double, N>& values) {
    for (const double value : values) *this << value;
    return *this;
  }
  std::string Hex() const {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash_));
    return text.data();
  }

 private:
  std::uint64_t hash_ = 14695981039346656037u;
};

void AddArm(const ArmParameters& arm, Digest* digest) {
  for (std::size_t i = 0; i < 2; ++i) {
    *digest << arm.link[i].damping_ratio << static_cast<double>(arm.link[i].section.size());
    for (const BeamSection& s : arm.link[i].section) {
      *digest << s.length_m << s.area_m2 << s.second_moment_m4 << s.density_kg_m3
              << s.youngs_modulus_pa << s.half_thickness_m;
      if (!s.has_cross_section) {  // the digests of other arms stay as they are
        *digest << s.given_mass_per_length_kg_m << s.given_bending_stiffness_nm2;
      }
    }
    const JointParameters& joint = arm.joint[i];
    *digest << joint.stiffness_nm_per_rad << joint.rotor_inertia_kgm2 << joint.hub_inertia_kgm2
            << joint.coulomb_friction_nm << joint.viscous_friction_nm_s_per_rad;
  }
  *digest << arm.hub2_mass_kg << arm.motor2_mass_kg << arm.motor2_inertia_kgm2
          << arm.payload_mass_kg << arm.payload_inertia_kgm2 << arm.shape_payload_mass_kg
          << static_cast<double>(arm.damping) << static_cast<double>(arm.link1_tip_inertia);
}

template <typename M>
nlohmann::ordered_json MatrixToJson(const M& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

template <typename M>
void MatrixFromJson(const nlohmann::ordered_json& rows, const std::string& name, M* matrix) {
  if (!rows.is_array() || rows.empty() || !rows[0].is_array()) {
    throw RejectedError("gains file: '" + name + "' is not a matrix (an array of rows)");
  }
  Eigen::MatrixXd read(static_cast<Eigen::Index>(rows.size()),
                       static_cast<Eigen::Index>(rows[0].size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != rows[0].size()) {
      throw RejectedError("gains file: '" + name + "' has rows of different length");
    }
    for (std::size_t j = 0; j < rows[i].size(); ++j) {
      if (!rows[i][j].is_number()) {
        throw RejectedError("gains file: '" + name + "' contains an element that is not a number");
      }
      read(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j].get<double>();
    }
  }
  *matrix = read;
}

template <>
void MatrixFromJson(const nlohmann::ordered_json& rows, const std::string& name,
                    Eigen::RowVectorXd* matrix) {
  Eigen::MatrixXd read;
  MatrixFromJson(rows, name, &read);
  if (read.rows() != 1 || read.cols() == 0) {
    throw RejectedError("gains file: '" + name + "' must be one row");
  }
  *matrix = read;
}

template <>
void MatrixFromJson(const nlohmann::ordered_json& rows, const std::string& name,
                    Eigen::Matrix2d* matrix) {
  Eigen::MatrixXd read;
  MatrixFromJson(rows, name, &read);
  if (read.rows() != 2 || read.cols() != 2) {
    throw RejectedError("gains file: '" + name + "' must be 2 x 2");
  }
  *matrix = read;
}

// A knot is a 2 x 12 matrix, row by row.
nlohmann::ordered_json KnotsToJson(const GainTable& table) {
  auto out = nlohmann::ordered_json::array();
  for (const GainTable::Gain& gain : table.knots()) out.emplace_back(MatrixToJson(gain));
  return out;
}

std::vector<GainTable::Gain> KnotsFromJson(const nlohmann::ordered_json& in,
                                           const std::string& name) {
  std::vector<GainTable::Gain> knots;
  for (const nlohmann::ordered_json& knot : in) {
    Eigen::MatrixXd gain;
    MatrixFromJson(knot, name, &gain);
    if (gain.rows() != 2 || gain.cols() != 12) {
      throw RejectedError("gains file: '" + name + "' contains a matrix that is not 2 x 12");
    }
    knots.emplace_back(gain);
  }
  return knots;
}

// Members of the laws that use the payload.
nlohmann::ordered_json PayloadToJson(const Design& design) {
  nlohmann::ordered_json out{{"model", design.payload_model}};
  if (!design.scheduled && !design.settle_gains) return out;
  const GainTable& table = design.settle_gains ? *design.settle_gains : design.scheduled->gains;
  if (design.scheduled) {
    out["max_kg"] = design.scheduled->max_kg;
    out["reference_kg"] = design.scheduled->reference_kg;
  }
  out["gain_payload_kg"] = table.grid().payload_kg;
  out["gain_theta2_rad"] = table.grid().theta2_rad;
  out["gain"] = KnotsToJson(table);
  if (design.scheduled && design.scheduled->start_gains) {
    out["start_gain"] = KnotsToJson(*design.scheduled->start_gains);
  }
  return out;
}

// The member `key` of the table 'payload'.
const nlohmann::ordered_json& NeededAt(const nlohmann::ordered_json& payload, const char* key) {
  if (payload.contains(key)) return payload.at(key);
  throw RejectedError(
      std::string("gains file: 'payload.") + key +
      "' is missing; the law or the estimator of this config needs it: run `flexarm "
      "design` again");
}

std::vector<double> NumbersAt(const nlohmann::ordered_json& payload, const char* key) {
  return NeededAt(payload, key).get<std::vector<double>>();
}

// Reads only what the config needs: an additional gain table would change the law.
void PayloadFromJson(const nlohmann::ordered_json& in, const ControlConfig& config,
                     Design* design) {
  try {
    design->payload_model = NumbersAt(in, "model");
    static_cast<void>(RigidJointStepper(design->payload_model));
    if (!IsScheduled(config.controller.kind) && !config.settles()) return;
    const GainGrid grid{.payload_kg = NumbersAt(in, "gain_payload_kg"),
                        .theta2_rad = NumbersAt(in, "gain_theta2_rad")};
    const auto table = [&](const char* key) {
      return GainTable(grid, KnotsFromJson(NeededAt(in, key), std::string("payload.") + key));
    };
    if (config.settles()) {
      design->settle_gains = table("gain");
      return;
    }
    design->scheduled = ScheduledDesign{.gains = table("gain"),
                                        .start_gains = {},
                                        .max_kg = NeededAt(in, "max_kg").get<double>(),
                                        .reference_kg = NeededAt(in, "reference_kg").get<double>()};
    if (!PlansAhead(config.controller.kind)) return;
    design->scheduled->start_gains = table("start_gain");
  } catch (const nlohmann::ordered_json::exception&) {
    throw RejectedError("gains file: a member of 'payload' does not consist of numbers");
  } catch (const std::invalid_argument& error) {
    throw RejectedError(std::string("gains file: 'payload': ") + error.what());
  }
}

// The text at `key`, `missing` if there is none; the JSON of a value that is not a string.
std::string TextAt(const nlohmann::ordered_json& in, const char* key, const char* missing) {
  const auto found = in.find(key);
  if (found == in.end()) return missing;
  return found->is_string() ? found->get<std::string>() : found->dump();
}

DesignCheck CheckFromJson(const nlohmann::ordered_json& in) {
  try {
    return {in.at("name").get<std::string>(), in.at("value").get<double>(),
            in.at("limit").get<double>(), in.at("below").get<bool>(), in.value("waived", false)};
  } catch (const nlohmann::ordered_json::exception&) {
    throw RejectedError("gains file: a row of 'checks' lacks its name, value, limit or below");
  }
}

StateLayout LayoutFromJson(const nlohmann::ordered_json& in) {
  const std::string name = TextAt(in, "nominal", "missing");
  const std::optional<StateLayout> layout = LayoutNamed(name);
  if (!layout) throw RejectedError("gains file: 'nominal' is not the name of a model: " + name);
  return *layout;
}

// All products that the loop computes must have matching shapes.
void RequireShapes(const Design& d) {
  const Eigen::Index n = d.layout.states(), outputs = d.layout.outputs();
  const Eigen::Index nf = d.filter_A.rows();  // includes the states of the gauge filters, any order
  const auto require = [](const char* name, const Eigen::MatrixXd& m, Eigen::Index rows,
                          Eigen::Index cols) {
    if (m.rows() == rows && m.cols() == cols) return;
    throw RejectedError(std::string("gains file: '") + name + "' is " + std::to_string(m.rows()) +
                        " x " + std::to_string(m.cols()) + ", expected " + std::to_string(rows) +
                        " x " + std::to_string(cols));
  };
  require("A", d.A, n, n);
  require("B", d.B, n, 2);
  require("A_rate", d.A_rate, n, n);
  require("B_rate", d.B_rate, n, 2);
  require("Am", d.Am, n, n);
  require("Bm", d.Bm, n, 2);
  require("K", d.K, 2, n);
  require("K_stop", d.K_stop, 2, n);
  require("P", d.P, n, n);
  require("J", d.J, 2, 2);
  require("G", d.G, 2, 2);
  require("S11", d.S11, n, n);
  require("S12", d.S12, n, 2);
  require("S21", d.S21, 2, n);
  require("S22", d.S22, 2, 2);
  require("Ufx", d.Ufx, 2, n);
  require("Ufu", d.Ufu, 2, 2);
  require("filter_A", d.filter_A, nf, nf);
  require("filter_B", d.filter_B, nf, 2);
  require("filter_C", d.filter_C, outputs, nf);
  require("filter_L", d.filter_L, nf, outputs);
  require("filter_A_rate", d.filter_A_rate, nf, nf);
  require("filter_B_rate", d.filter_B_rate, nf, 2);
  require("filter_W", d.filter_W, nf, nf);
  require("filter_P", d.filter_P, nf, nf);
  require("filter_R", d.filter_R, outputs, 1);
}

}  // namespace

std::string DesignHash(const ControlConfig& config) {
  Digest digest;
  AddArm(config.arm, &digest);
  for (const EncoderConfig& e : config.sensors.encoder) digest << e.counter << e.counts_per_turn;
  digest << config.sensors.strain_input.filter_hz << config.sensors.strain_input.filter_damping;
  const EstimatorConfig& estimator = config.estimator;
  digest << estimator.modes_per_link << estimator.process_force << estimator.rotor_extra_sigma_rad
         << estimator.hub_extra_sigma_rad << estimator.modal_sigma_m;
  digest << static_cast<double>(config.controller.nominal.torsion)
         << config.controller.nominal.modes_per_link;
  const ControllerConfig& c = config.controller;
  digest << c.design_alpha() << c.hub_angle_weight << c.hub_rate_weight << c.torque_weight
         << c.passivity_margin << config.loop.period_ms;
  for (const double weight : c.state_weight) digest << weight;
  if (c.matrices && IsAdaptive(c.kind)) {
    const GainMatrixConfig& m = *c.matrices;
    for (const auto* entries : {&m.T, &m.Tbar, &m.S, &m.K_e, &m.K_I0}) {
      digest << static_cast<double>(entries->size());
      for (const double entry : *entries) digest << entry;
    }
    digest << static_cast<double>(c.kind) << c.adaptation_gain;
  }
  if (IsPd(c.kind)) {
    digest << static_cast<double>(c.kind) << c.pd_stiffness_nm_per_rad << c.pd_damping_nms_per_rad;
  }
  if (config.uses_payload_estimator()) digest << static_cast<double>(c.kind);
  if (IsScheduled(c.kind)) {
    digest << c.payload->max_kg << c.payload->reference_kg << estimator.payload->process_force
           << estimator.payload->rotor_extra_sigma_rad;
  }
  if (config.settles()) digest << c.settling->alpha;
  if (IsScheduled(c.kind) || config.settles()) {
    for (const double knot : c.payload->gain_payload_kg) digest << knot;
    for (const double knot : c.payload->gain_elbow_deg) digest << knot;
  }
  if (PlansAhead(c.kind)) digest << c.plan->start_alpha;
  return digest.Hex();
}

std::string DesignToJson(const Design& design, const std::string& config_hash) {
  nlohmann::ordered_json out;
  out["format"] = kFormat;
  out["config_hash"] = config_hash;
  out["nominal"] = NameOf(design.layout);
  ForEachMatrix(design, [&out](const char* name, const auto& m) { out[name] = MatrixToJson(m); });
  if (!design.payload_model.empty()) out["payload"] = PayloadToJson(design);
  for (const DesignCheck& check : design.checks) {
    out["checks"].push_back({{"name", check.name},
                             {"value", check.value},
                             {"limit", check.limit},
                             {"below", check.below},
                             {"passed", check.passed()},
                             {"waived", check.waived}});
  }
  return out.dump(1);
}

Design DesignFromJson(const std::string& text, const ControlConfig& config) {
  // The text of a log was not checked when it was read, and copying JSON is recursive.
  if (const std::optional<FileProblem> problem = ProblemOfText(text, kGainsFile)) {
    throw RejectedError(problem->Text("gains file"));
  }
  const nlohmann::ordered_json in = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!in.is_object() || TextAt(in, "format", "") != kFormat) {
    throw RejectedError(std::string("not a gains file: expected JSON with \"format\": \"") +
                        kFormat + "\"; write it with `flexarm design`");
  }
  const std::string expected_hash = DesignHash(config);
  if (TextAt(in, "config_hash", "") != expected_hash) {
    throw RejectedError("gains file: it was designed for another config (hash " +
                        TextAt(in, "config_hash", "missing") + ", this config has " +
                        expected_hash + "); run `flexarm design` again");
  }
  Design design;
  design.layout = LayoutFromJson(in);
  ForEachMatrix(design, [&in](const char* name, auto& m) {
    if (!in.contains(name))
      throw RejectedError(std::string("gains file: '") + name + "' is missing");
    MatrixFromJson(in.at(name), name, &m);
  });
  RequireShapes(design);
  if (config.uses_payload_estimator()) {
    PayloadFromJson(in.value("payload", nlohmann::ordered_json::object()), config, &design);
  }
  if (!in.contains("checks") || !in.at("checks").is_array()) {
    throw RejectedError("gains file: 'checks' is missing or not an array");
  }
  for (const nlohmann::ordered_json& check : in.at("checks"))
    design.checks.push_back(CheckFromJson(check));
  return design;
}

}  // namespace flexarm
