#include "config/key_units.h"

#include <array>

namespace flexarm {
namespace {

struct Suffix {
  std::string_view end;
  const char* unit;
};

// The longest suffix of a name that is here counts.
constexpr std::array kSuffixes = {
    Suffix{"_nm_s_per_rad", "N m s/rad"},
    Suffix{"_nms_per_rad", "N m s/rad"},
    Suffix{"_nm_per_rad", "N m/rad"},
    Suffix{"_nm_per_s", "N m/s"},
    Suffix{"_nm2", "N m^2"},
    Suffix{"_nm", "N m"},
    Suffix{"_kgm2", "kg m^2"},
    Suffix{"_kg_m3", "kg/m^3"},
    Suffix{"_kg_m", "kg/m"},
    Suffix{"_kg", "kg"},
    Suffix{"_m4", "m^4"},
    Suffix{"_m2", "m^2"},
    Suffix{"_m_s2", "m/s^2"},
    Suffix{"_m", "m"},
    Suffix{"_mm", "mm"},
    Suffix{"_pa", "Pa"},
    Suffix{"_rad_s", "rad/s"},
    Suffix{"_s_per_rad", "s/rad"},
    Suffix{"_rad", "rad"},
    Suffix{"_deg_per_s", "deg/s"},
    Suffix{"_deg", "deg"},
    Suffix{"_hz", "Hz"},
    Suffix{"_us", "us"},
    Suffix{"_ms", "ms"},
    Suffix{"_s", "s"},
    Suffix{"_days", "days"},
    Suffix{"_v", "V"},
    Suffix{"_bps", "bit/s"},
    Suffix{"_counts", "counts"},
    Suffix{"_periods", "periods"},
    Suffix{"_sigmas", "standard deviations"},
    Suffix{"_mb", "MB"},
    Suffix{"_share", "1"},
    Suffix{"_fraction", "1"},
};

}  // namespace

std::string UnitOfName(std::string_view name) {
  const Suffix* longest = nullptr;
  for (const Suffix& suffix : kSuffixes) {
    if (!name.ends_with(suffix.end)) continue;
    if (longest == nullptr || suffix.end.size() > longest->end.size()) longest = &suffix;
  }
  return longest == nullptr ? "" : longest->unit;
}

}  // namespace flexarm
