#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace flexarm {

/// Part of an arm to which a published figure belongs.
enum class PublishedPart : std::uint8_t {
  kLink1,         ///< "link1": with the tip of its mode shapes (Link1Tip)
  kLink1Locked,   ///< "link1_locked": carrying all that turns about joint 2 as one rigid body
  kLink2,         ///< "link2"
  kArm,           ///< "arm": motors free, hubs free
  kShoulderHeld,  ///< "shoulder_held": hub 1 held, hub 2 with its rotor free
};

enum class PublishedQuantity : std::uint8_t {
  kFrequencyHz,     ///< "frequency_hz"
  kFrequencyRadS,   ///< "frequency_rad_s"
  kBetaL,           ///< "beta_l": beta times the length, of a link
  kTip,             ///< "tip": psi(L), by the modal mass
  kTipSlope,        ///< "tip_slope": psi'(L) of a link
  kRootSlope,       ///< "root_slope": psi'(0)
  kMassIntegral,    ///< "mass_integral": int rho A psi of a link
  kMomentIntegral,  ///< "moment_integral": int rho A x psi of a link
  kStripStiffness,  ///< "strip_stiffness_nm_per_rad": 3 EI/L of a link's outermost section
  kInertia11,       ///< "inertia_11_kgm2": the rigid arm about joint 1
  kInertia12,       ///< "inertia_12_kgm2": the coupling of both joints
  kInertia22,       ///< "inertia_22_kgm2": about joint 2
};

/// One figure that a source prints, and what the program compares with it.
struct PublishedFigure {
  std::string symbol;  ///< of the source
  PublishedPart part;
  PublishedQuantity quantity;
  int mode;              ///< elastic mode, from 1; 0 where there is none
  bool pinned;           ///< root of a link: pinned, otherwise clamped
  double elbow_deg;      ///< of "arm" and "shoulder_held"
  double modal_mass_kg;  ///< by which shapes are scaled; the root's curvature or slope is positive
  double published;      ///< in the unit of the quantity
  double tolerance;      ///< largest difference that counts as agreement, same unit
  bool differs;          ///< the source's figure is wrong or of another arm: no agreement
  std::string note;      ///< may be empty, unless `differs`
};

/// An arm or a beam from the literature.
struct PublishedCase {
  std::string name;
  std::filesystem::path config;  ///< of the arm
  int links;                     ///< of the source's arm
  std::string author, title, place;
  int year;
  std::string table;             ///< where in the source the figures stand
  std::string read_in;           ///< what was read, with its address
  std::string obtained;          ///< how the config and the figures follow from that
  std::string tolerance_reason;  ///< why the tolerances are as they are
  std::vector<PublishedFigure> figure;
};

/// Reads the [[case]] rows of a file. @throws ConfigError with every problem found
std::vector<PublishedCase> LoadPublishedCases(const std::filesystem::path& file);

}  // namespace flexarm
