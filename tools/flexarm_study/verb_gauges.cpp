#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "controller/files/external_json.h"
#include "controller/runlog/errors.h"
#include "tools/analysis/gauge_placing.h"
#include "tools/analysis/gauge_verification.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

struct GaugesOptions {
  ConfigOptions config;
  GaugeChoice choice;
  double noise_microstrain = 0.0, spacing_mm = 20.0;
  bool filtered = false;
  bool json = false;
  OutputOptions output;
};

void PrintLayout(const char* name, const GaugeLayout& layout) {
  std::printf("  %-18s", name);
  for (Eigen::Index j = 0; j < layout.covariance_m2.rows(); ++j) {
    std::printf(" %10.4g", 1e6 * layout.sigma_m(static_cast<int>(j)));
  }
  std::printf(" %10.4g   ", 1e6 * layout.tip_sigma_m);
  for (const double leak : layout.next_mode) std::printf(" %8.3f", leak);
  std::printf("\n    at m");
  for (const double x : layout.position_m) std::printf(" %.3f", x);
  std::printf("\n");
}

void PrintGauges(const std::vector<GaugeComparison>& links) {
  for (const GaugeComparison& link : links) {
    std::printf(
        "link %d, %.3g microstrain of noise: standard deviation of modes 1 to %d and of the tip's\n"
        "deflection, um; what 1 m of mode %d adds to each, m\n",
        link.link, 1e6 * link.task.noise_strain, link.task.modes, link.task.modes + 1);
    PrintLayout("of the config", link.shipped);
    PrintLayout("proposed", link.proposed);
    PrintLayout("five half bridges", link.thesis);
  }
}

nlohmann::ordered_json VerificationJson(const GaugeVerification& run, bool filtered) {
  nlohmann::ordered_json json{{"filtered", filtered}, {"largest_mm", run.largest_mm}};
  for (std::size_t i = 0; i < 2; ++i) {
    json["polynomial_rms_mm"].push_back(run.polynomial[i].rms_mm);
    json["polynomial_largest_error_mm"].push_back(run.polynomial[i].largest_mm);
    json["modal_rms_mm"].push_back(run.modal[i].rms_mm);
    json["modal_largest_error_mm"].push_back(run.modal[i].largest_mm);
  }
  return json;
}

void PrintVerification(const GaugeVerification& run) {
  std::printf("the square wave of chapter 4, deflection of the tips by the gauges: error, mm\n");
  for (std::size_t i = 0; i < 2; ++i) {
    std::printf(
        "  link %d, up to %.4g mm: polynomial of five half bridges %.3g rms, %.3g at most; modal "
        "fit\n  of the config's gauges %.3g rms, %.3g at most\n",
        static_cast<int>(i) + 1, run.largest_mm[i], run.polynomial[i].rms_mm,
        run.polynomial[i].largest_mm, run.modal[i].rms_mm, run.modal[i].largest_mm);
  }
}

void RunGauges(const GaugesOptions& options) {
  GaugeChoice choice = options.choice;
  choice.noise_strain = 1e-6 * options.noise_microstrain;
  choice.spacing_m = 1e-3 * options.spacing_mm;
  const RigConfig config = options.config.Load();
  const OutputRules rules = PictureRules({options.config.file}, options.output.overwrite);
  if (options.output.given()) CheckPicture(options.output.file, rules);
  std::vector<GaugeComparison> links;
  GaugeVerification run;
  try {
    links = CompareGauges(config, choice);
    if (options.output.given()) run = VerifyGauges(config, options.filtered);
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
  if (options.output.given()) {
    DrawVerification(run, options.output.file, rules);
    ReportWritten(options.output.file);
  }
  if (options.json) {
    nlohmann::ordered_json json = GaugesJson(links);
    if (options.output.given()) json["verification"] = VerificationJson(run, options.filtered);
    std::cout << PrintedJson(json) << '\n';
  } else {
    PrintGauges(links);
    if (options.output.given()) PrintVerification(run);
  }
}

}  // namespace

void RegisterGauges(CLI::App& app, Exit&) {
  const auto options = std::make_shared<GaugesOptions>();
  CLI::App* verb = AddOtherVerb(app, "gauges");
  options->config.AddTo(verb, true);
  verb->add_option("--modes", options->choice.modes,
                   "Bending modes of a link that are to be known (default: those of the estimator)")
      ->check(CLI::Range(1, 6));
  verb->add_option("--noise-microstrain,--noise", options->noise_microstrain,
                   "Standard deviation of a gauge's reading (default: that of the config)")
      ->check(NumberWithin(1e-6, 1e6));
  verb->add_option("--per-link", options->choice.per_link,
                   "Gauges proposed for a link (default: as many as the config has)")
      ->check(CLI::Range(1, 100));
  verb->add_option("--spacing-mm", options->spacing_mm,
                   "Least distance between two gauges, middle to middle")
      ->check(NumberWithin(0.0, 1000.0))
      ->capture_default_str();
  verb->add_flag("--filtered", options->filtered,
                 "The picture's readings have passed the config's analogue filter");
  AddJson(verb, &options->json);
  options->output.AddTo(verb,
                        "Picture of the tips' deflections by the gauges and truly, .png or .svg "
                        "(figure B.2)",
                        false);
  verb->footer(
      "Compares the gauges of the config, as many where they know the modes best, and the\n"
      "thesis's five half bridges at the local maxima of strain. The covariance is that of the\n"
      "least-squares fit; modal coordinates are deflections of the tip. Proposed positions have\n"
      "the least volume of errors. A half bridge reads both faces, twice the\n"
      "strain: with the gain of one gauge's amplifier it has half the noise and half the full\n"
      "scale; here it has the same full scale and the same noise.\n"
      "Example: flexarm gauges -c config/thesis-rig.toml --modes 2 --per-link 5");
  verb->callback([options] { RunGauges(*options); });
}

}  // namespace flexarm
