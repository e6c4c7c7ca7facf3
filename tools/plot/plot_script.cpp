#include "tools/plot/plot_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "tools/plot/gnuplot.h"

namespace flexarm {
namespace {

const char* StateColour(SafetyState state) {
  switch (state) {
    case SafetyState::kStarting:
    case SafetyState::kIdle:
      return "#E5E5E5";
    case SafetyState::kArmed:
      return "#F5DFA3";
    case SafetyState::kRunning:
      return "#BFE3CF";
    case SafetyState::kStopping:
      return "#BBD7EE";
    case SafetyState::kDisarming:
    case SafetyState::kTestingPump:
    case SafetyState::kTestingRelay:
    case SafetyState::kTestingPower:
      return "#F5DFA3";
    case SafetyState::kFaultStopping:
    case SafetyState::kTripped:
      return "#E9A49C";
  }
  return "#000000";
}

// Columns 2.. of the data block of a run.
enum Column : int {
  kReference = 2,
  kAngle = 4,
  kAsked = 6,
  kApplied = 8,
  kDeflection = 10,
  kFromRest = 12,
  kTipX = 13,
  kTipY = 14,
  kGated = 15,
};

class Script {
 public:
  Script(const std::vector<PlotRun>& runs, const std::filesystem::path& output) : runs_(runs) {
    FindTimes();
    Terminal(output);
    DataBlocks();
  }

  std::string Text() {
    text_ << "set multiplot\nset style line 100 lc rgb '#D9D9D9' lw 1\n"
             "set grid ls 100\nset border lc rgb '#808080'\nset tics textcolor rgb '#404040'\n"
             "set key opaque samplen 2 spacing 1.1 font ',11'\nset datafile missing 'nan'\n"
             "set label 1 "
          << Quoted(Title()) << " at screen 0.055, screen 0.975 left font ',17' front\n";
    Pair("Joint 1, deg", kAngle, kReference, 0, "reference");
    Pair("Joint 2, deg", kAngle, kReference, 1, "reference");
    Pair("Torque 1, N m", kApplied, kAsked, 0, "asked");
    Pair("Torque 2, N m", kApplied, kAsked, 1, "asked");
    Deflections();
    DistanceFromRest();
    States();
    FromAbove();
    text_ << "unset multiplot\n";
    return text_.str();
  }

 private:
  void FindTimes() {
    from_s_ = 0;
    until_s_ = 1;
    for (const PlotRun& run : runs_) {
      if (run.sample.empty()) continue;
      from_s_ = std::min(from_s_, run.sample.front().time_s);
      until_s_ = std::max(until_s_, run.sample.back().time_s);
    }
  }

  std::string Title() const {
    std::string title = runs_.size() == 1 ? runs_[0].name : std::to_string(runs_.size()) + " runs";
    if (runs_.size() == 1 && !runs_[0].trip.empty()) title += "   TRIPPED: " + runs_[0].trip;
    return title;
  }

  void Terminal(const std::filesystem::path& output) {
    text_ << TerminalFor(output, static_cast<int>(kWidth), static_cast<int>(kHeight));
  }

  void DataBlocks() {
    text_ << "$base << EOD\n0 0\nEOD\n";
    text_ << std::setprecision(9);
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      text_ << "$run" << i << " << EOD\n";
      for (const PlotRun::Sample& s : runs_[i].sample) {
        text_ << s.time_s;
        for (const auto& pair :
             {s.reference_deg, s.angle_deg, s.asked_nm, s.applied_nm, s.deflection_mm}) {
          text_ << ' ' << pair[0] << ' ' << pair[1];
        }
        text_ << ' ' << s.from_rest_mm << ' ' << s.tip_m[0] << ' ' << s.tip_m[1] << ' '
              << s.gated_nm[0] << ' ' << s.gated_nm[1] << '\n';
      }
      text_ << "EOD\n$pose" << i << " << EOD\n";
      for (const PlotRun::Pose& pose : runs_[i].pose) {
        for (const auto& point : pose.point_m) {
          text_ << point[0] << ' ' << point[1] << ' ' << pose.time_s << '\n';
        }
        text_ << "\n\n";
      }
      text_ << "EOD\n";
    }
  }

  // Adds the next panel of the left column; all panels have the same time axis.
  void Panel(const std::string& label, double height, bool last = false) {
    text_ << "unset label 2\nunset logscale\nset autoscale y\nset ytics auto\n"
          << "set lmargin at screen 0.075\nset rmargin at screen 0.60\n"
          << "set tmargin at screen " << top_ << "\nset bmargin at screen " << top_ - height << '\n'
          << "set xrange [" << from_s_ << ':' << until_s_ << "]\n"
          << (last ? "set format x '%g'\nset xlabel 'time, s'\n"
                   : "set format x ''\nunset xlabel\n")
          << "set ylabel " << Quoted(label) << " offset 0.5,0 font ',11'\n";
    top_ -= height + 0.014;
  }

  std::string NameOf(std::size_t run, const char* alone) const {
    return Quoted(runs_.size() == 1 ? alone : runs_[run].name);
  }

  void Plot(const std::vector<std::string>& curves) {
    text_ << "plot ";
    for (std::size_t i = 0; i < curves.size(); ++i) text_ << (i > 0 ? ", \\\n  " : "") << curves[i];
    text_ << '\n';
  }

  std::string Curve(std::size_t run, int column, const std::string& title, const std::string& style,
                    double later_s = 0) const {
    std::ostringstream curve;
    curve << "$run" << run << " using ($1+" << later_s << "):" << column << " with " << style
          << " title " << title;
    return curve.str();
  }

  // A value of one joint as a solid line over its dashed reference.
  void Pair(const char* label, int value, int wanted, int joint, const char* wanted_name) {
    Panel(label, 0.124);
    std::vector<std::string> curves;
    const bool torque = value == kApplied;
    const std::string kind = torque ? "steps lw 2 " : "lines lw 2 ";
    // A torque asked at a tick acts from the next one on; the applied one acted up to its tick.
    const double later_s = torque ? runs_[0].period_s : 0;
    if (!torque || runs_.size() == 1) {  // with several runs only the applied torque is drawn
      curves.push_back(Curve(0, wanted + joint, Quoted(wanted_name),
                             kind + "dt (6,4) lc rgb '#909090'", later_s));
    }
    const char* alone = !torque ? (runs_[0].truth ? "true" : "estimated") : "applied";
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      curves.push_back(Curve(run, value + joint, NameOf(run, alone),
                             (torque ? "f" : "") + kind + "lc rgb '" + Colour(run) + "'"));
    }
    if (torque && runs_.size() == 1 && IsGated(joint)) {
      curves.push_back(Curve(0, kGated + joint, Quoted("changed by the gate"),
                             "points pt 7 ps 0.4 lc rgb '#C03028'"));
    }
    if (joint == 1 || torque) text_ << "set key top right\n";
    if (joint == 1 && runs_.size() > 1) text_ << "set key off\n";
    Plot(curves);
    text_ << "set key on top right\n";
  }

  bool IsGated(int joint) const {
    const auto& samples = runs_[0].sample;
    return std::any_of(samples.begin(), samples.end(), [joint](const PlotRun::Sample& sample) {
      return !std::isnan(sample.gated_nm[static_cast<std::size_t>(joint)]);
    });
  }

  void Deflections() {
    Panel("Tip deflection, mm", 0.124);
    std::vector<std::string> curves;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const std::string colour = Colour(run);
      curves.push_back(Curve(run, kDeflection, runs_.size() == 1 ? "'link 1'" : "''",
                             "lines lw 2 lc rgb '" + colour + "'"));
      const std::string second = runs_.size() == 1 ? Colour(1) : colour;
      curves.push_back(Curve(run, kDeflection + 1, runs_.size() == 1 ? "'link 2'" : "''",
                             "lines lw 2 dt (3,2) lc rgb '" + second + "'"));
    }
    Plot(curves);
  }

  void DistanceFromRest() {
    Panel("Tip to resting place, mm", 0.124);
    text_ << "set logscale y\nset yrange [0.1:3000]\nset ytics (0.1,1,10,100,1000)\n"
             "set label 2 '15 mm' at graph 0.995, first 21 right font ',10' textcolor rgb "
             "'#606060'\n";
    std::vector<std::string> curves = {"15 with lines lw 1.5 dt (6,4) lc rgb '#909090' notitle"};
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      curves.push_back(
          Curve(run, kFromRest, "''", "lines lw 2 lc rgb '" + std::string(Colour(run)) + "'"));
    }
    Plot(curves);
    text_ << "unset yrange\n";
  }

  void States() {
    const double height = 0.022 * static_cast<double>(runs_.size());
    Panel("", height, true);
    const double rows = static_cast<double>(runs_.size());
    text_ << "unset ylabel\nunset ytics\nunset grid\nset yrange [0:" << rows << "]\n";
    int object = 1;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const double low = rows - 1 - static_cast<double>(run);
      for (const PlotRun::StateSpan& span : runs_[run].span) State(span, low, &object);
    }
    text_ << "plot 0 with lines lc rgb '#808080' notitle\n";
    while (--object > 0)
      text_ << "unset object " << object << "\nunset label " << 100 + object << '\n';
    text_ << "set ytics auto\nset grid ls 100\n";
  }

  void State(const PlotRun::StateSpan& span, double low, int* object) {
    text_ << "set object " << *object << " rectangle from " << span.from_s << ',' << low + 0.04
          << " to " << span.until_s << ',' << low + 0.96 << " fs solid noborder fc rgb '"
          << StateColour(span.state) << "' back\n";
    const bool wide = (span.until_s - span.from_s) > 0.09 * (until_s_ - from_s_);
    if (wide) {
      text_ << "set label " << 100 + *object << " '" << ToString(span.state) << "' at "
            << (span.from_s + span.until_s) / 2 << ',' << low + 0.5 << " center font ',11' front\n";
    }
    ++*object;
  }

  // Sets the axes to the range of arm and tips, with a margin.
  void SetReach() {
    std::array<double, 2> low{-0.05, -0.05}, high{0.05, 0.05};
    const auto reach = [&](const std::array<double, 2>& point) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        low[axis] = std::min(low[axis], point[axis]);
        high[axis] = std::max(high[axis], point[axis]);
      }
    };
    for (const PlotRun::Pose& pose : runs_[0].pose) {
      for (const auto& point : pose.point_m) reach(point);
    }
    for (const PlotRun& run : runs_) {
      for (const PlotRun::Sample& sample : run.sample) reach(sample.tip_m);
    }
    const double margin = 0.05 * std::max(high[0] - low[0], high[1] - low[1]);
    text_ << "set xrange [" << low[0] - margin << ':' << high[0] + margin << "]\nset yrange ["
          << low[1] - margin << ':' << high[1] + margin << "]\n";
    height_per_width_ = (high[1] - low[1] + 2 * margin) / (high[0] - low[0] + 2 * margin);
  }

  // Stroboscopic pictures of the first run, one per move; the tip paths of all runs.
  void FromAbove() {
    text_ << "unset logscale\nset size ratio -1\nset format x '%g'\nset ytics auto\n"
             "set xlabel ''\nset ylabel 'y, m' offset 1.5,0\nunset key\nunset label 2\n"
             "set palette defined (0 '#440154', 1 '#3B528B', 2 '#21918C', 3 '#5EC962', 4 "
             "'#E8D21D')\n";
    SetReach();
    const auto& acts = runs_[0].act;
    const std::size_t count = std::min(acts.size(), kMostActs);
    const double natural = (kActsRight - kActsLeft) * kWidth / kHeight * height_per_width_;
    const double height = std::min(natural, 0.66 / static_cast<double>(count) - kActGap);
    double top = 0.935;
    for (std::size_t i = 0; i < count; ++i) {
      FromAbove(acts[i], top, top - height, i + 1 == count);
      top -= height + kActGap;
    }
    Figures(top - 0.01);
  }

  void FromAbove(const PlotRun::Act& act, double top, double bottom, bool last) {
    const double until_s = std::max(act.until_s, act.from_s + 0.1);
    text_ << "set lmargin at screen " << kActsLeft << "\nset rmargin at screen " << kActsRight
          << "\nset tmargin at screen " << top << "\nset bmargin at screen " << bottom
          << "\nset cbrange [" << act.from_s << ':' << until_s
          << "]\nset colorbox user origin screen " << kActsRight + 0.012 << ", screen " << bottom
          << " size screen 0.01, screen " << top - bottom << "\nset label 3 'From above, "
          << act.from_s << " to " << std::round(100 * until_s) / 100
          << " s, every 0.1 s' at graph 0.5, graph 1.045 center font ',12'\n";
    if (last) text_ << "set xlabel 'x, m'\n";
    const auto within = [&](const char* time, const char* value) {
      std::ostringstream text;
      text << "(" << time << " >= " << act.from_s - 1e-9 << " && " << time
           << " <= " << until_s + 1e-9 << " ? " << value << " : NaN)";
      return text.str();
    };
    std::vector<std::string> curves;
    if (!runs_[0].pose.empty()) {
      curves.push_back("$pose0 using 1:" + within("$3", "$2") + ":3 with lines lw 1.7 lc palette");
    }
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      std::ostringstream path;
      path << "$run" << run << " using " << kTipX << ':'
           << within("$1", std::string("$").append(std::to_string(kTipY)).c_str())
           << " with lines lw 1.3 lc rgb '" << Colour(run) << "'";
      curves.push_back(path.str());
    }
    curves.push_back("$base using 1:2 with points pt 7 ps 1.6 lc rgb '#404040'");
    Plot(curves);
  }

  // Writes the metrics as text below the pictures on the right.
  void Figures(double top) {
    int label = 900;
    double y = top;
    const auto line = [&](const std::string& text, const char* font) {
      text_ << "set label " << label++ << ' ' << Quoted(text) << " at screen " << kActsLeft - 0.025
            << ", screen " << y << " left font '" << font << "' front\n";
      y -= 0.0185;
    };
    for (std::size_t run = 0; run < std::min(runs_.size(), kMostActs); ++run) {
      if (!runs_[run].metrics) continue;
      const RunMetrics& metrics = *runs_[run].metrics;
      line(runs_.size() == 1 ? "Figures" : runs_[run].name, ",13");
      line("joint error rms " + Two(metrics.joint_rms_error_deg) + " deg, final " +
               Two(metrics.joint_final_error_deg) + " deg",
           ",11");
      line("tip settles in " +
               (metrics.tip_settling_time_s ? Short(*metrics.tip_settling_time_s) + " s"
                                            : std::string("never")) +
               ", then moves " + Short(metrics.tip_residual_rms_mm) + " mm rms",
           ",11");
      line("peak torque " + Two(metrics.peak_torque_nm) + " N m", ",11");
    }
    // gnuplot draws labels only with a plot: this one is empty.
    text_ << "unset label 3\nunset colorbox\nunset border\nunset tics\nunset xlabel\nunset "
             "ylabel\nset xrange [0:1]\nset yrange [0:1]\nplot NaN\n";
  }

  static std::string Short(double value) {
    std::ostringstream text;
    text << std::setprecision(3) << value;
    return text.str();
  }

  static std::string Two(const std::array<double, 2>& pair) {
    return Short(pair[0]) + ", " + Short(pair[1]);
  }

  static constexpr std::size_t kMostActs = 3;
  static constexpr double kWidth = 1400, kHeight = 1300;
  static constexpr double kActsLeft = 0.655, kActsRight = 0.94, kActGap = 0.06;

  const std::vector<PlotRun>& runs_;
  std::ostringstream text_;
  double from_s_ = 0, until_s_ = 1;
  double top_ = 0.945;
  double height_per_width_ = 1;
};

}  // namespace

std::string PlotScript(const std::vector<PlotRun>& runs, const std::filesystem::path& output) {
  return Script(runs, output).Text();
}

}  // namespace flexarm
