#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace flexarm {

/// The control law, `controller.name`. The gains file depends on the value: never renumber.
enum class ControllerKind : std::uint8_t {
  kSobel,
  kSobelOriginal,
  kLqrCgt,
  kLqrUm,
  kLqg,
  kPd,
  kPdZv,
  kPdZvd,
  kGainScheduled,
  kRecedingHorizon,
  kSobelThesis,
};

/// What config, programs, benchmark, documents and tests say of a control law.
struct LawRow {
  ControllerKind kind;
  const char* name;      ///< value of controller.name
  const char* about;     ///< a noun phrase for --help
  bool is_adaptive;      ///< corrects its gains while it runs
  bool is_pd;            ///< feeds each hub back alone
  bool is_scheduled;     ///< follows moves with gains for the payload that `ekf-payload` estimates
  bool plans_ahead;      ///< follows a plan that is made while it runs
  bool settles = false;  ///< can bring the arm to rest: ControlConfig::settles
};

/// All laws. A new one has its row here, its class behind MakeLaw (controller/law/law_factory.h).
inline constexpr std::array<LawRow, 11> kLaws = {{
    {ControllerKind::kSobel, "sobel",
     "modified Sobel model-reference adaptive control that brings the tip to rest", true, false,
     false, false, true},
    {ControllerKind::kSobelThesis, "sobel-thesis", "the same without what it does at rest", true,
     false, false, false},
    {ControllerKind::kSobelOriginal, "sobel-original",
     "sobel-thesis as Sobel published it: alpha = 0, vartheta = 0", true, false, false, false},
    {ControllerKind::kLqrCgt, "lqr-cgt", "LQR around the command generator's trajectory", false,
     false, false, false},
    {ControllerKind::kLqrUm, "lqr-um", "LQR towards the reference model, its command fed forward",
     false, false, false, false},
    {ControllerKind::kLqg, "lqg", "LQR with alpha = 0 towards the reference's joints", false, false,
     false, false},
    {ControllerKind::kPd, "pd", "proportional and derivative feedback of each hub", false, true,
     false, false},
    {ControllerKind::kPdZv, "pd-zv", "the same behind a zero-vibration input shaper", false, true,
     false, false},
    {ControllerKind::kPdZvd, "pd-zvd", "the same with a zero derivative as well", false, true,
     false, false},
    {ControllerKind::kGainScheduled, "gain-scheduled", "LQR gains for the estimated payload", false,
     false, true, false},
    {ControllerKind::kRecedingHorizon, "receding-horizon",
     "the same along a plan that is made while the arm moves", false, false, true, true},
}};

constexpr const LawRow& LawOf(ControllerKind kind) {
  return *std::find_if(kLaws.begin(), kLaws.end(),
                       [kind](const LawRow& law) { return law.kind == kind; });
}

constexpr bool IsScheduled(ControllerKind kind) { return LawOf(kind).is_scheduled; }
constexpr bool PlansAhead(ControllerKind kind) { return LawOf(kind).plans_ahead; }
constexpr bool IsAdaptive(ControllerKind kind) { return LawOf(kind).is_adaptive; }
constexpr bool IsPd(ControllerKind kind) { return LawOf(kind).is_pd; }

/// Names of the laws, in the order of the table.
/// @param wanted  of a LawRow
template <typename Predicate>
std::vector<std::string> LawNames(Predicate wanted) {
  std::vector<std::string> names;
  for (const LawRow& law : kLaws) {
    if (wanted(law)) names.emplace_back(law.name);
  }
  return names;
}

}  // namespace flexarm
