#include "tools/csv/scale_warnings.h"

#include <algorithm>
#include <cmath>

#include "controller/files/external_text.h"
#include "controller/runlog/csv.h"
#include "controller/runlog/csv_rows.h"
#include "controller/types/rounded_text.h"

namespace flexarm {
namespace {

// What to look at for a wrong scale of a channel.
std::string KeyOf(std::size_t channel, const RigConfig& config, const CsvFacts& facts) {
  if (facts.own || !config.csv) {
    return "sensors.strain[" + std::to_string(channel) + "].gain_v_per_unit";
  }
  const std::size_t row = ColumnOf(*config.csv, StrainColumns(config.sensors)[channel]);
  return "csv.column[" + std::to_string(row) + "] (" + Shown(config.csv->column[row].column) +
         "): scale and unit, and gain_v_per_unit of the channel";
}

std::string TimesText(const ScaleFit& fit) {
  const double size = std::abs(fit.factor);
  const std::string spread =
      " (fit " + RoundedText(fit.factor, 4) + " +- " + RoundedText(fit.sigma, 2) + ")";
  if (fit.factor < 0.0 && !IsFarFromOne(size)) return "the wrong sign" + spread;
  const std::string sign = fit.factor < 0.0 ? " and of the wrong sign" : "";
  return size >= 1.0 ? RoundedText(size, 2) + " times too large" + sign + spread
                     : RoundedText(1.0 / size, 2) + " times too small" + sign + spread;
}

}  // namespace

std::vector<std::string> ScaleWarnings(const StrainScaleResult& result, const RigConfig& config,
                                       const CsvFacts& facts) {
  using Kind = ScaleVerdict::Kind;
  std::vector<std::string> warnings;
  for (int link = 1; link <= 2; ++link) {
    const ScaleVerdict& of_link = result.link[static_cast<std::size_t>(link - 1)];
    const std::string about = "strain scale of link " + std::to_string(link);
    if (of_link.kind == Kind::kWrong) {
      const auto is_of_link = [link](const StrainChannelConfig& row) { return row.link == link; };
      const auto& rows = config.sensors.strain;
      const auto first = std::find_if(rows.begin(), rows.end(), is_of_link) - rows.begin();
      const bool has_others = std::count_if(rows.begin(), rows.end(), is_of_link) > 1;
      warnings.push_back(about + " looks " + TimesText(*of_link.fit) + ": check " +
                         KeyOf(static_cast<std::size_t>(first), config, facts) +
                         (has_others ? "; likewise the link's other channels" : ""));
    }
    for (std::size_t i = 0; i < result.channel.size(); ++i) {
      const ScaleVerdict& of = result.channel[i];
      if (config.sensors.strain[i].link != link || of.kind != Kind::kWrong) continue;
      const bool as_link =
          of_link.kind == Kind::kWrong && !IsFarFromOne(of.fit->factor / of_link.fit->factor);
      if (as_link) continue;
      warnings.push_back("strain scale of channel " + StrainColumns(config.sensors)[i] + " looks " +
                         TimesText(*of.fit) + ": check " + KeyOf(i, config, facts));
    }
  }
  return warnings;
}

}  // namespace flexarm
