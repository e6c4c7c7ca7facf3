#include "config/published_cases.h"

#include "config/config.h"
#include "config/document.h"
#include "config/problem_log.h"
#include "config/table_reader.h"

namespace flexarm {
namespace {

void ReadQuantity(TableReader row, PublishedFigure* out) {
  using Quantity = PublishedQuantity;
  row.Read("quantity", &out->quantity,
           {{"frequency_hz", Quantity::kFrequencyHz},
            {"frequency_rad_s", Quantity::kFrequencyRadS},
            {"beta_l", Quantity::kBetaL},
            {"tip", Quantity::kTip},
            {"tip_slope", Quantity::kTipSlope},
            {"root_slope", Quantity::kRootSlope},
            {"mass_integral", Quantity::kMassIntegral},
            {"moment_integral", Quantity::kMomentIntegral},
            {"strip_stiffness_nm_per_rad", Quantity::kStripStiffness},
            {"inertia_11_kgm2", Quantity::kInertia11},
            {"inertia_12_kgm2", Quantity::kInertia12},
            {"inertia_22_kgm2", Quantity::kInertia22}},
           kListedElsewhere);
}

bool IsShape(PublishedQuantity quantity) {
  return quantity >= PublishedQuantity::kTip && quantity <= PublishedQuantity::kMomentIntegral;
}

bool IsOfALink(PublishedPart part) {
  return part == PublishedPart::kLink1 || part == PublishedPart::kLink1Locked ||
         part == PublishedPart::kLink2;
}

bool IsOfTheRigidArm(PublishedQuantity quantity) {
  return quantity >= PublishedQuantity::kInertia11;
}

// Quantities that only a link has, or only the arm.
void CheckPart(TableReader row, const PublishedFigure& figure) {
  using Quantity = PublishedQuantity;
  const Quantity quantity = figure.quantity;
  const bool by_link = quantity == Quantity::kBetaL || quantity == Quantity::kTipSlope ||
                       quantity == Quantity::kMassIntegral ||
                       quantity == Quantity::kMomentIntegral ||
                       quantity == Quantity::kStripStiffness;
  if (by_link && !IsOfALink(figure.part)) {
    row.Refuse("quantity", "must be of \"link1\", \"link1_locked\" or \"link2\"");
  }
  if (IsOfTheRigidArm(quantity) && figure.part != PublishedPart::kArm) {
    row.Refuse("quantity", "must be of \"arm\"");
  }
  if (figure.part == PublishedPart::kArm && IsShape(quantity)) {
    row.Refuse("quantity", "must be a frequency or an inertia: the arm's shapes are not compared");
  }
}

PublishedFigure ReadFigure(TableReader row) {
  PublishedFigure figure{};
  row.Read("symbol", &figure.symbol, kListedElsewhere);
  row.Read("of", &figure.part,
           {{"link1", PublishedPart::kLink1},
            {"link1_locked", PublishedPart::kLink1Locked},
            {"link2", PublishedPart::kLink2},
            {"arm", PublishedPart::kArm},
            {"shoulder_held", PublishedPart::kShoulderHeld}},
           kListedElsewhere);
  ReadQuantity(row, &figure);
  CheckPart(row, figure);
  const bool has_mode =
      !IsOfTheRigidArm(figure.quantity) && figure.quantity != PublishedQuantity::kStripStiffness;
  if (has_mode) {
    row.Read("mode", &figure.mode, kListedElsewhere);
    if (row.Has("mode") && (figure.mode < 1 || figure.mode > 6)) {
      row.Refuse("mode", "must be 1 to 6");
    }
  }
  if (row.Has("root"))
    row.Read("root", &figure.pinned, {{"clamped", false}, {"pinned", true}}, kListedElsewhere);
  if (row.Has("elbow_deg")) row.Read("elbow_deg", &figure.elbow_deg, kListedElsewhere);
  if (IsShape(figure.quantity)) {
    row.Read("modal_mass_kg", &figure.modal_mass_kg, kListedElsewhere);
    if (row.Has("modal_mass_kg") && !(figure.modal_mass_kg > 0.0)) {
      row.Refuse("modal_mass_kg", "must be positive");
    }
  }
  row.Read("published", &figure.published, kListedElsewhere);
  row.Read("tolerance", &figure.tolerance, kListedElsewhere);
  if (row.Has("tolerance") && !(figure.tolerance > 0.0)) {
    row.Refuse("tolerance", "must be positive");
  }
  if (row.Has("differs")) row.Read("differs", &figure.differs, kListedElsewhere);
  if (row.Has("note") || figure.differs) row.Read("note", &figure.note, kListedElsewhere);
  return figure;
}

PublishedCase ReadCase(TableReader row, const std::filesystem::path& folder) {
  PublishedCase one{};
  std::string config;
  row.Read("name", &one.name, kListedElsewhere);
  row.Read("config", &config, kListedElsewhere);
  one.config = folder / config;
  row.Read("links", &one.links, kListedElsewhere);
  row.Read("author", &one.author, kListedElsewhere);
  row.Read("title", &one.title, kListedElsewhere);
  row.Read("year", &one.year, kListedElsewhere);
  row.Read("place", &one.place, kListedElsewhere);
  row.Read("table", &one.table, kListedElsewhere);
  row.Read("read_in", &one.read_in, kListedElsewhere);
  row.Read("obtained", &one.obtained, kListedElsewhere);
  row.Read("tolerance_reason", &one.tolerance_reason, kListedElsewhere);
  for (const TableReader& figure : row.Rows("figure", kListedElsewhere))
    one.figure.push_back(ReadFigure(figure));
  return one;
}

}  // namespace

std::vector<PublishedCase> LoadPublishedCases(const std::filesystem::path& file) {
  const toml::table document = ParseToml(ReadConfigFile(file), file.string());
  ProblemLog log(file.string(), &document);
  TableReader root(&document, "", &log);
  std::vector<PublishedCase> cases;
  for (const TableReader& row : root.Rows("case", kListedElsewhere)) {
    cases.push_back(ReadCase(row, file.parent_path()));
  }
  log.AddUnknown();
  log.ThrowIfAny();
  return cases;
}

}  // namespace flexarm
