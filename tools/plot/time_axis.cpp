#include "tools/plot/time_axis.h"

#include <algorithm>
#include <iomanip>

#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"
#include "tools/plot/plot_rows.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostMarks = 18, kMostGaps = 200;
constexpr int kFirstTag = 100;  // of arrows and objects, behind those of the header

}  // namespace

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

TimeAxis::TimeAxis(const std::vector<PlotRun>& runs) : runs_(runs) {
  from_s_ = 0.0;
  until_s_ = 1e-3;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    from_s_ = std::min(from_s_, runs[i].sample.front().time_s);
    until_s_ = std::max(until_s_, runs[i].sample.back().time_s);
    for (PlotRun::Mark mark : runs[i].mark) {
      if (runs.size() > 1 && !mark.trips) continue;
      if (runs.size() > 1) mark.text = "run " + std::to_string(i + 1) + ": " + mark.text;
      marks_.push_back(std::move(mark));
    }
  }
}

void TimeAxis::WriteMarks(std::ostringstream* script) const {
  int tag = kFirstTag;
  for (const PlotRun::Mark& mark : marks_) {
    *script << "set arrow " << tag++ << " from " << mark.at_s << ", graph 0 to " << mark.at_s
            << ", graph 1 nohead back lw " << (mark.trips ? 2 : 1.2) << " dt "
            << (mark.trips ? "1" : "(2,3)") << " lc rgb '"
            << (mark.trips ? kLimitColour : kEventColour) << "'\n";
  }
  if (runs_.size() > 1) return;
  const double least_s = 0.003 * (until_s_ - from_s_);
  tag = kFirstTag;
  for (const PlotRun::Gap& gap : runs_[0].gap) {
    if (tag == kFirstTag + static_cast<int>(kMostGaps)) break;
    *script << "set object " << tag++ << " rectangle from " << gap.from_s << ", graph 0 to "
            << std::max(gap.until_s, gap.from_s + least_s)
            << ", graph 1 behind fs solid noborder fc rgb '#F3D9A4'\n";
  }
}

void TimeAxis::ClearMarks(std::ostringstream* script) const {
  *script << "unset arrow\nunset object\n";
}

void TimeAxis::WriteRange(bool with_numbers, std::ostringstream* script) const {
  *script << "set xrange [" << from_s_ << ':' << until_s_ << "]\nset xtics "
          << NiceStep(until_s_ - from_s_, 10) << '\n'
          << (with_numbers ? "set format x '%g'\nset xlabel 'time, s'\n"
                           : "set format x ''\nunset xlabel\n");
}

void TimeAxis::WriteStates(const Sheet& sheet, const std::array<double, 2>& x, double top_px,
                           std::ostringstream* script) const {
  const double rows = static_cast<double>(runs_.size());
  *script << "unset label\nunset key\nunset logscale\nset lmargin at screen " << x[0]
          << "\nset rmargin at screen " << x[1] << "\nset tmargin at screen "
          << sheet.Y(top_px + 26.0) << "\nset bmargin at screen "
          << sheet.Y(top_px + 26.0 + 22.0 * rows) << "\nset yrange [0:" << rows << "]\n";
  if (runs_.size() == 1) {
    *script << "unset ytics\n";
  } else {
    *script << "set ytics (";
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      *script << (run > 0 ? ", " : "") << "'" << run + 1 << "' "
              << rows - 0.5 - static_cast<double>(run);
    }
    *script << ")\n";
  }
  WriteRange(true, script);
  int object = kFirstTag + static_cast<int>(kMostGaps);
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    const double low = rows - 1.0 - static_cast<double>(run);
    for (const PlotRun::StateSpan& span : runs_[run].span) {
      *script << "set object " << object << " rectangle from " << span.from_s << ',' << low + 0.04
              << " to " << span.until_s << ',' << low + 0.96 << " fs solid noborder fc rgb '"
              << StateColour(span.state) << "' back\n";
      if (span.until_s - span.from_s > 0.09 * (until_s_ - from_s_)) {
        *script << "set label " << object << " '" << ToString(span.state) << "' at "
                << 0.5 * (span.from_s + span.until_s) << ',' << low + 0.5
                << " center font ',11' front\n";
      }
      ++object;
    }
  }
  double last_s = from_s_ - (until_s_ - from_s_);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    const bool close = marks_[i].at_s - last_s < 0.02 * (until_s_ - from_s_);
    if (close) continue;  // its neighbour's number stands for it
    last_s = marks_[i].at_s;
    *script << "set label " << ++object << " '" << i + 1 << "' at " << marks_[i].at_s
            << ", graph 1 offset 0,0.6 center font ',11' textcolor rgb '"
            << (marks_[i].trips ? kLimitColour : kEventColour) << "' front\n";
  }
  *script << "plot 0 with lines lc rgb '#808080' notitle\n";
  ClearMarks(script);
  *script << "unset label\n";
}

std::vector<std::string> TimeAxis::Lines() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < std::min(marks_.size(), kMostMarks); ++i) {
    std::ostringstream line;
    line << i + 1 << "   " << std::fixed << std::setprecision(2) << marks_[i].at_s << " s   "
         << marks_[i].text;
    lines.push_back(line.str());
  }
  if (marks_.size() > kMostMarks) {
    lines.push_back("and " + std::to_string(marks_.size() - kMostMarks) + " more: plot --html");
  }
  if (runs_.size() == 1 && !runs_[0].gap.empty()) {
    std::int64_t missing = 0;
    for (const PlotRun::Gap& gap : runs_[0].gap) missing += gap.samples;
    lines.push_back(std::to_string(missing) + " samples missing from the log: shaded");
  }
  return lines;
}

}  // namespace flexarm
