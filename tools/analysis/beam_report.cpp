#include "tools/analysis/beam_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "model/beam_methods/lumped_beam.h"
#include "model/beam_methods/mode_shape_fit.h"
#include "model/units.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

constexpr std::array kPartCounts = {10, 20, 31, 50, 86, 100, 200};
constexpr int kPoints = 200;  // points of a drawn shape

std::string NameOf(const LinkBeam& beam) { return "link " + std::to_string(beam.link); }

LumpedBeam Lumped(const LinkBeam& beam, int parts) {
  return {beam.section, beam.tip, beam.root, parts, NameOf(beam)};
}

std::vector<double> ErrorPercent(const LinkBeam& beam, const std::vector<BeamMode>& modes,
                                 int parts) {
  const auto lumped = Lumped(beam, parts).Modes(static_cast<int>(modes.size()));
  std::vector<double> error;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    error.push_back(100.0 * (lumped[i].frequency_rad_s / modes[i].frequency_rad_s() - 1.0));
  }
  return error;
}

void AddShapes(const std::vector<BeamMode>& modes, std::ostream* script) {
  std::vector<double> largest(modes.size(), 0.0);
  const double L = modes.front().length_m();
  for (std::size_t m = 0; m < modes.size(); ++m) {
    for (int i = 0; i <= kPoints; ++i) {
      largest[m] = std::max(largest[m], std::fabs(modes[m].Value(L * i / kPoints)));
    }
  }
  for (int i = 0; i <= kPoints; ++i) {
    *script << L * i / kPoints;
    for (std::size_t m = 0; m < modes.size(); ++m) {
      *script << ' ' << modes[m].Value(L * i / kPoints) / largest[m];
    }
    *script << '\n';
  }
}

void AddErrors(const LinkBeam& beam, const std::vector<BeamMode>& modes, std::ostream* script) {
  for (const int parts : kPartCounts) {
    *script << parts;
    for (const double error : ErrorPercent(beam, modes, parts)) *script << ' ' << std::fabs(error);
    *script << '\n';
  }
}

// The curves of all modes: columns 2.. of a data block, with the frequency or the number as key.
std::string Curves(const std::string& block, const std::vector<BeamMode>& modes, bool by_frequency,
                   const char* style) {
  std::ostringstream text;
  text << "plot " << std::setprecision(4);
  for (std::size_t m = 0; m < modes.size(); ++m) {
    std::ostringstream title;
    title << "mode " << m + 1;
    if (by_frequency) {
      title << std::setprecision(4) << ": " << modes[m].frequency_rad_s() / kTwoPi << " Hz";
    }
    text << (m > 0 ? ", " : "") << block << " using 1:" << m + 2 << " with " << style << ' '
         << CurveStyle(m) << " title " << Quoted(title.str());
  }
  return text.str() + "\n";
}

}  // namespace

nlohmann::ordered_json BeamJson(const LinkBeam& beam, const std::vector<BeamMode>& modes) {
  nlohmann::ordered_json json{{"link", beam.link}, {"base", beam.base}};
  json["beta_l"] = nlohmann::ordered_json::array();
  json["frequency_hz"] = nlohmann::ordered_json::array();
  for (const BeamMode& mode : modes) {
    json["beta_l"].push_back(mode.beta_length());
    json["frequency_hz"].push_back(mode.frequency_rad_s() / kTwoPi);
  }
  return json;
}

nlohmann::ordered_json ConvergenceJson(const LinkBeam& beam, const std::vector<BeamMode>& modes) {
  nlohmann::ordered_json json{{"link", beam.link}};
  json["parts"] = kPartCounts;
  json["error_percent"] = nlohmann::ordered_json::array();
  for (const int parts : kPartCounts)
    json["error_percent"].push_back(ErrorPercent(beam, modes, parts));
  const int finest = kPartCounts.back();
  json["fit_parts"] = finest;
  json["fit_rms_residual"] = nlohmann::ordered_json::array();
  json["fit_coefficients"] = nlohmann::ordered_json::array();
  for (const LumpedMode& mode : Lumped(beam, finest).Modes(static_cast<int>(modes.size()))) {
    const ModeShapeFit fit = FitModeShape(beam.section, mode.frequency_rad_s, mode.x_m, mode.w);
    json["fit_rms_residual"].push_back(fit.rms_residual);
    nlohmann::ordered_json sections = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < beam.section.size(); ++i) sections.push_back(fit.Coefficients(i));
    json["fit_coefficients"].push_back(sections);
  }
  return json;
}

void DrawBeams(const std::vector<LinkBeam>& beams, const std::vector<std::vector<BeamMode>>& modes,
               bool convergence, const std::filesystem::path& output, const OutputRules& rules) {
  std::ostringstream script;
  script << PictureHead(output, convergence ? 1300 : 900, 900) << std::setprecision(8);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    script << "$shape" << i << " << EOD\n";
    AddShapes(modes[i], &script);
    script << "EOD\n";
    if (!convergence) continue;
    script << "$error" << i << " << EOD\n";
    AddErrors(beams[i], modes[i], &script);
    script << "EOD\n";
  }
  script << "set multiplot layout 2," << (convergence ? 2 : 1)
         << " title 'Single links: mode shapes"
         << (convergence ? ", and error of a beam in N parts" : "") << "'\nset tmargin 3.5\n";
  for (std::size_t i = 0; i < beams.size(); ++i) {
    script << "unset logscale\nset format '%g'\nset xrange [*:*]\nset yrange [-1.1:1.1]\n"
              "set xlabel 'position along the link, m'\nset ylabel "
           << Quoted(NameOf(beams[i]) + ", " + beams[i].base + ": shape, largest value 1") << "\n"
           << Curves("$shape" + std::to_string(i), modes[i], true, "lines");
    if (!convergence) continue;
    script << "set logscale xy\nset xrange [" << kPartCounts.front() << ':' << kPartCounts.back()
           << "]\nset yrange [*:*]\nset xlabel 'parts a section'\n"
              "set ylabel 'lumped beam: error of the frequency, %'\n"
           << Curves("$error" + std::to_string(i), modes[i], false, "linespoints pt 7");
  }
  script << "unset multiplot\n";
  DrawPicture(script.str(), output, rules);
}

}  // namespace flexarm
