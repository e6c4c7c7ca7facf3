#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace flexarm {

/// A trip or a refusal, with what to do about it.
struct Advice {
  std::string name;             ///< machine name, as in status, journal and answers
  int number;                   ///< of a trip; 0: a refusal
  std::string commands;         ///< that a refusal answers; "" for a trip
  std::string about;            ///< of a trip: its stop category, and what its channel counts
  std::string happened;         ///< and what it means
  std::string check;            ///< how to find which of the causes it was
  std::string remedy;           ///< what to do
  std::string override_option;  ///< option that does without the condition; "": there is none
};

/// Every trip, by number, then every refusal.
std::vector<Advice> AllAdvice();

/// The page docs/trips.md.
std::string AdvicePage(const std::vector<Advice>& all);

/// {"trips": [..], "refusals": [..]}
nlohmann::ordered_json AdviceJson(const std::vector<Advice>& all);

/// One of them for a person, several lines.
std::string AdviceText(const Advice& advice);

}  // namespace flexarm
