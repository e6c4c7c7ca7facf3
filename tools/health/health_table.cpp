#include "tools/health/health_table.h"

#include <array>
#include <cstdio>

#include "controller/files/external_text.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

const char* ToString(DriftVerdict verdict) {
  switch (verdict) {
    case DriftVerdict::kUnknown:
      return "unknown";
    case DriftVerdict::kSteady:
      return "steady";
    case DriftVerdict::kDrifts:
      return "drifts";
  }
  return "";
}

std::string Pair(DriftKind kind, const DriftFigure& figure) {
  const double scale = UnitOf(kind).scale;
  const int digits = kind == DriftKind::kFriction ? 4 : 2;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%9.*f +-%8.*f", digits, scale * figure.value, digits,
                scale * figure.standard_error);
  return text.data();
}

std::string TableRow(const DriftChannel& channel, const DriftTrend& trend) {
  const bool told = trend.runs > 0, compared = trend.runs > 1;
  const std::string blank(20, ' ');
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), "%-28s %-5s %s  %s  %s  %4zu  %s\n",
                channel.Name().c_str(), UnitOf(channel.kind).unit,
                told ? Pair(channel.kind, trend.newest).c_str() : blank.c_str(),
                compared ? Pair(channel.kind, trend.change).c_str() : blank.c_str(),
                compared ? Pair(channel.kind, trend.per_run).c_str() : blank.c_str(), trend.runs,
                trend.verdict == DriftVerdict::kDrifts ? "DRIFTS" : ToString(trend.verdict));
  return text.data();
}

std::string Residuals(const RunFigures& figures) {
  std::string text = "\nresidual of the newest run       mean        rms   expected\n";
  for (std::size_t i = 0; i < figures.residual.size(); ++i) {
    const ResidualFigure& figure = figures.residual[i];
    const bool angle = i < kCounters;
    const double scale = angle ? 1e3 : 1e6;
    const std::string name = angle ? CounterName(static_cast<int>(i))
                                   : "strain channel " + std::to_string(i - kCounters + 1);
    std::array<char, 120> line{};
    std::snprintf(line.data(), line.size(), "%-24s %10.3f %10.3f %10.3f %s\n", name.c_str(),
                  scale * figure.mean, scale * figure.rms, scale * figure.noise,
                  angle ? "mrad" : "um/m");
    text += line.data();
  }
  return text;
}

OrderedJson ToJson(const DriftFigure& figure) {
  return {{"value", figure.value}, {"standard_error", figure.standard_error}};
}

OrderedJson ToJson(const DriftChannel& channel, const DriftTrend& trend) {
  const bool told = trend.runs > 0, compared = trend.runs > 1;
  const OrderedJson none(nullptr);
  return {{"channel", channel.Key()},
          {"name", channel.Name()},
          {"unit", SiUnitOf(channel.kind)},
          {"runs", trend.runs},
          {"newest", told ? ToJson(trend.newest) : none},
          {"reference", compared ? ToJson(trend.reference) : none},
          {"change", compared ? ToJson(trend.change) : none},
          {"per_run", compared ? ToJson(trend.per_run) : none},
          {"sigmas", compared ? OrderedJson(trend.sigmas) : none},
          {"verdict", ToString(trend.verdict)}};
}

OrderedJson ToJson(const HealthRecord& record) {
  return {{"run", record.run},
          {"start_utc", record.start_utc},
          {"unused", record.unused.empty() ? OrderedJson(nullptr) : OrderedJson(record.unused)},
          {"misfit", record.misfit}};
}

}  // namespace

std::string HealthText(const ShownHealth& health) {
  std::string text =
      "channel                      unit   newest run            change to reference   "
      "a run                  runs\n";
  for (std::size_t i = 0; i < health.report.channels.size(); ++i) {
    text += TableRow(health.report.channels[i], health.report.trends[i]);
  }
  if (health.newest) text += Residuals(*health.newest);
  for (const HealthRecord& run : health.history.run) {
    if (run.unused.empty()) continue;
    text += "\nleft out: " + Shown(run.run, kMessageBytes) + ": " + run.unused;
  }
  text += "\n" + std::to_string(health.history.run.size()) + " runs, ";
  const std::vector<std::string> alarms = health.report.AlarmTexts();
  text += (alarms.empty() ? "no" : std::to_string(alarms.size())) + " alarm" +
          (alarms.size() == 1 ? "" : "s") + "\n";
  for (const std::string& alarm : alarms) text += alarm + "\n";
  return text;
}

OrderedJson HealthJson(const ShownHealth& health) {
  OrderedJson channels = OrderedJson::array(), runs = OrderedJson::array();
  for (std::size_t i = 0; i < health.report.channels.size(); ++i) {
    channels.push_back(ToJson(health.report.channels[i], health.report.trends[i]));
  }
  for (const HealthRecord& run : health.history.run) runs.push_back(ToJson(run));
  OrderedJson alarms = OrderedJson::array();
  const std::vector<std::string> keys = health.report.AlarmedKeys(),
                                 texts = health.report.AlarmTexts();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    alarms.push_back({{"channel", keys[i]}, {"text", texts[i]}});
  }
  return {{"alarms", alarms}, {"channels", channels}, {"runs", runs}};
}

}  // namespace flexarm
