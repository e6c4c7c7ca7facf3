#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "controller/files/input_error.h"
#include "tools/analysis/torsion_report.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

struct TorsionOptions {
  ConfigOptions config;
  TorsionCase of;
  bool json = false;
};

void PrintTorsion(const TorsionEffect& effect) {
  for (std::size_t i = 0; i < effect.link.size(); ++i) {
    const LinkTorsion& link = effect.link[i];
    std::printf(
        "link %d: %.4g x %.4g mm, torsion constant %.4g m4, stiffness %.4g N m/rad; alone %.4g "
        "Hz\n",
        static_cast<int>(i) + 1, link.width_mm, link.thickness_mm, link.torsion_constant_m4,
        link.stiffness_nm_per_rad, link.free_hz);
  }
  std::printf(
      "link 1 carries link 2 and payload, elbow at %.4g deg:\n"
      "  torsion %.4g Hz with %.4g kg m2 about its axis\n"
      "  their weight, %.4g N m, twists it by %.4g deg; the tip drops by %.4g mm\n"
      "  by bending across the plane the elbow drops by %.4g mm\n"
      "  motor 2 at %.4g mm from its axis: %.4g deg for each m/s2 of the elbow\n",
      effect.of.theta2_deg, effect.carried_hz, effect.carried_inertia_kgm2, effect.weight_nm,
      effect.twist_deg, effect.drop_by_twist_mm, effect.drop_by_bending_mm,
      effect.of.motor_offset_mm, effect.twist_deg_per_m_s2);
  std::printf("link 2, payload at %.4g mm from its axis:\n  Hz", effect.of.payload_offset_mm);
  for (const double hz : effect.coupled_hz) std::printf(" %10.6g", hz);
  std::printf("\n  bending alone, payload on the axis: Hz");
  for (const double hz : effect.bending_hz) std::printf(" %10.6g", hz);
  std::printf("\n  lowest frequency %.3g %%; twist %.3g deg for each mm of the tip's deflection\n",
              effect.first_shift_percent, effect.twist_deg_per_mm);
}

}  // namespace

void RegisterAnalyzeTorsion(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<TorsionOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "torsion", "Size of the torsion of the links, which the model leaves out");
  options->config.AddTo(verb, true);
  verb->add_option("--theta2-deg", options->of.theta2_deg, "Elbow angle")
      ->check(NumberWithin(-180.0, 180.0))
      ->capture_default_str();
  verb->add_option("--poisson", options->of.poisson, "Poisson's ratio of the links")
      ->check(NumberWithin(-0.99, 0.49))
      ->capture_default_str();
  verb->add_option("--payload-offset-mm", options->of.payload_offset_mm,
                   "Distance of the payload's centre from the axis of link 2, across the plane")
      ->check(NumberWithin(-1e3, 1e3))
      ->capture_default_str();
  verb->add_option("--motor-offset-mm", options->of.motor_offset_mm,
                   "Distance of motor 2's centre from the axis of link 1, across the plane")
      ->check(NumberWithin(-1e3, 1e3))
      ->capture_default_str();
  verb->add_option("--gravity", options->of.gravity_m_s2, "Gravity across the plane, m/s2")
      ->check(NumberWithin(0.0, 100.0))
      ->capture_default_str();
  AddJson(verb, &options->json);
  verb->footer(
      "Sections must be solid rectangles, whose sides follow from area and second moment. The\n"
      "links are clamped at their roots; link 2 is rigid where link 1 twists under it. Neither "
      "the\n"
      "simulated arm nor the controller's model has torsion.\n"
      "Example: flexarm analyze torsion -c config/thesis-rig.toml --theta2-deg 90");
  verb->callback([options] {
    const ArmParameters arm = options->config.Load().arm;
    if (const std::string lacks = LacksRectangles(arm); !lacks.empty()) {
      throw InputError(options->config.file.string() + ": " + lacks);
    }
    const TorsionEffect effect = TorsionOf(arm, options->of);
    if (options->json) {
      std::cout << PrintedJson(TorsionJson(effect)) << '\n';
    } else {
      PrintTorsion(effect);
    }
  });
}

}  // namespace flexarm
