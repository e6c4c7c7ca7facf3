#include "tools/analysis/parametric_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <sstream>

#include "controller/files/write_file.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr double kDrawn_hz = 15.0;

struct SignalName {
  const char* title;
  const char* column;
};

constexpr std::array<SignalName, kSignals> kSignalNames = {
    {{"bending of link 1, mm", "bending_1_mm"},
     {"bending of link 2, mm", "bending_2_mm"},
     {"twist of joint 1, mrad", "twist_1_mrad"},
     {"twist of joint 2, mrad", "twist_2_mrad"}}};

constexpr std::array<const char*, kSweeps> kFigureOf = {"5.1", "5.2", "5.2", "5.3",
                                                        "5.4", "5.4", "5.5", "5.5"};

OrderedJson PointJson(const ParametricPoint& point) {
  OrderedJson json{{"value", point.value}};
  for (std::size_t i = 0; i < kSignals; ++i) {
    const std::string name = kSignalNames[i].column;
    const std::string plain = name.substr(0, name.rfind('_'));
    json["peak_" + name] = NumberOrNull(point.signal[i].peak);
    json["spectral_peak_" + name] = NumberOrNull(point.signal[i].spectral_peak);
    json["free_rms_" + name] = NumberOrNull(point.signal[i].free_rms);
    json["free_frequency_" + plain + "_hz"] = NumberOrNull(point.signal[i].free_frequency_hz);
  }
  json["motors_free_frequency_hz"] = point.free_hz;
  json["motors_held_frequency_hz"] = point.held_hz;
  return json;
}

// Spectra as a map with logarithmic colours.
void DrawSpectrum(const ParametricSweep& sweep, std::size_t signal, std::ostringstream* script) {
  double most = 0.0;
  for (const ParametricPoint& point : sweep.point) {
    for (const double amplitude : point.signal[signal].spectrum.amplitude) {
      most = std::max(most, amplitude);
    }
  }
  *script << "set title " << Quoted(kSignalNames[signal].title) << "\nset cbrange [" << 1e-3 * most
          << ':' << most << "]\nsplot $signal" << signal << " using 1:2:3 with pm3d notitle\n";
}

void WriteSpectrum(const ParametricSweep& sweep, std::size_t signal, std::ostringstream* script) {
  *script << "$signal" << signal << " << EOD\n";
  for (const ParametricPoint& point : sweep.point) {
    const Spectrum& spectrum = point.signal[signal].spectrum;
    for (std::size_t i = 0; i < spectrum.amplitude.size(); ++i) {
      if (spectrum.FrequencyHz(i) > kDrawn_hz) break;
      // A logarithmic colour scale cannot show zero.
      *script << spectrum.FrequencyHz(i) << ' ' << point.value << ' '
              << std::max(spectrum.amplitude[i], 1e-12) << '\n';
    }
    *script << '\n';
  }
  *script << "EOD\n";
}

void DrawPeaks(std::size_t first, const char* of, const char* unit, std::ostringstream* script) {
  *script << "set ylabel 'largest magnitude, " << unit << "'\nunset title\nplot";
  for (const std::size_t which : {0U, 1U}) {
    *script << (which > 0 ? ", " : " ") << "$peaks using 1:" << first + which + 2
            << " with linespoints pt 7 " << CurveStyle(which) << " title '" << of << ' '
            << which + 1 << "'";
  }
  *script << '\n';
}

// The axes of the spectrum maps and of the curves beside them.
std::string MapAxes(const ParametricSweep& sweep) {
  std::ostringstream axes;
  axes << std::setprecision(8) << "set xlabel 'frequency, Hz'\nset xrange [0:" << kDrawn_hz
       << "]\nset yrange [" << sweep.point.front().value << ':' << sweep.point.back().value
       << "]\nset ylabel " << Quoted(sweep.label) << '\n';
  return axes.str();
}

std::string CurveAxes(const ParametricSweep& sweep) {
  return "set xlabel " + Quoted(sweep.label) + "\nset autoscale x\nset yrange [0:*]\n";
}

void WritePeaks(const ParametricSweep& sweep, std::ostringstream* script) {
  *script << "$peaks << EOD\n";
  for (const ParametricPoint& point : sweep.point) {
    *script << point.value;
    for (const SignalMeasures& signal : point.signal) *script << ' ' << signal.peak;
    *script << '\n';
  }
  *script << "EOD\n";
}

void DrawSweep(const ParametricStudy& study, const ParametricSweep& sweep,
               const std::filesystem::path& output) {
  std::ostringstream script;
  script << PictureHead(output, 1600, 850) << std::setprecision(8);
  for (std::size_t signal = 0; signal < kSignals; ++signal) WriteSpectrum(sweep, signal, &script);
  WritePeaks(sweep, &script);
  std::ostringstream title;
  title << "Effect of the " << sweep.label << ": amplitude spectra, and largest magnitudes, after "
        << study.excitation.torque_nm[0] << " and " << study.excitation.torque_nm[1] << " N m";
  script << "set multiplot layout 2,3 title " << Quoted(title.str())
         << "\nset palette defined (0 '#FFFFFF', 1 '#9ECAE1', 2 '#08519C', 3 '#000000')\n"
            "set view map\nset lmargin 9\nset rmargin 4\nset tmargin 3\nset bmargin 4\nset "
            "logscale cb\nset format cb '10^{%T}'\n"
         << MapAxes(sweep);
  for (const std::size_t signal : {kBending1, kBending2}) DrawSpectrum(sweep, signal, &script);
  script << CurveAxes(sweep);
  DrawPeaks(kBending1, "link", "mm", &script);
  script << MapAxes(sweep);
  for (const std::size_t signal : {kTwist1, kTwist2}) DrawSpectrum(sweep, signal, &script);
  script << CurveAxes(sweep);
  DrawPeaks(kTwist1, "joint", "mrad", &script);
  DrawPicture(script.str() + "unset multiplot\n", output);
}

std::string Csv(const ParametricStudy& study) {
  std::ostringstream out;
  out << "parameter,value";
  for (const char* measure : {"peak_", "spectral_peak_", "free_rms_"}) {
    for (const SignalName& name : kSignalNames) out << ',' << measure << name.column;
  }
  out << ",motors_free_1_hz,motors_free_2_hz,motors_held_hz\n" << std::setprecision(8);
  for (const ParametricSweep& sweep : study.sweep) {
    for (const ParametricPoint& point : sweep.point) {
      out << sweep.name << ',' << point.value;
      for (const SignalMeasures& signal : point.signal) out << ',' << signal.peak;
      for (const SignalMeasures& signal : point.signal) out << ',' << signal.spectral_peak;
      for (const SignalMeasures& signal : point.signal) out << ',' << signal.free_rms;
      out << ',' << point.free_hz[0] << ',' << point.free_hz[1] << ',' << point.held_hz << '\n';
    }
  }
  return out.str();
}

}  // namespace

OrderedJson ParametricJson(const ParametricStudy& study, const std::vector<Statement>& statements) {
  OrderedJson json{{"torque_nm", study.excitation.torque_nm},
                   {"motor_lag_ms", study.excitation.motor_lag_ms},
                   {"excitation_s", Excitation::kPeriod_s},
                   {"sweeps", OrderedJson::array()}};
  json.update(StatementsJson(statements));
  for (const ParametricSweep& sweep : study.sweep) {
    OrderedJson points = OrderedJson::array();
    for (const ParametricPoint& point : sweep.point) points.push_back(PointJson(point));
    json["sweeps"].push_back(
        {{"parameter", sweep.name}, {"nominal", sweep.nominal}, {"points", std::move(points)}});
  }
  return json;
}

void PrintSweeps(const ParametricStudy& study) {
  std::printf("square wave of torque, 1 s: %.3g and %.3g N m\n", study.excitation.torque_nm[0],
              study.excitation.torque_nm[1]);
  for (const ParametricSweep& sweep : study.sweep) {
    std::printf("%s\n  value    lowest Hz, motors free, held    largest bending 1, 2, mm\n",
                sweep.label.c_str());
    for (const ParametricPoint& p : sweep.point) {
      std::printf("  %-8.4g %8.4g %8.4g %8.4g    %8.3g %8.3g\n", p.value, p.free_hz[0],
                  p.free_hz[1], p.held_hz, p.signal[kBending1].peak, p.signal[kBending2].peak);
    }
  }
}

void PrintStatements(const std::vector<Statement>& statements) {
  for (const Statement& s : statements) {
    std::printf("%s  %s\n     model: %s\n     %s\n", s.section.c_str(), s.thesis.c_str(),
                s.model.c_str(), ToString(s.verdict));
  }
}

std::vector<std::filesystem::path> WriteParametricFolder(const ParametricStudy& study,
                                                         const std::vector<Statement>& statements,
                                                         const std::filesystem::path& folder) {
  MakeFolder(folder);
  std::vector<std::filesystem::path> files;
  for (std::size_t i = 0; i < study.sweep.size(); ++i) {
    const std::string figure =
        study.sweep.size() == kSweeps ? "figure-" + std::string(kFigureOf[i]) + "-" : "";
    files.push_back(folder / (figure + study.sweep[i].name + ".png"));
    DrawSweep(study, study.sweep[i], files.back());
  }
  files.push_back(folder / "parametric.csv");
  WriteFile(files.back(), Csv(study), ReplaceAny("a table"));
  if (statements.empty()) return files;
  files.push_back(folder / "statements.md");
  WriteFile(files.back(), StatementTable(statements), ReplaceAny("a page"));
  return files;
}

}  // namespace flexarm
