#include <array>

#include "config/new_rig/arm_description.h"

namespace flexarm {
namespace {

constexpr bool kRequired = true, kOptional = false;

constexpr std::array<ArmKey, 38> kArmKeys = {{
    {"link1.length_m", "length of link 1, from the shoulder's axis to the elbow's, m", kRequired,
     "", 0.05, 5.0},
    {"link1.width_mm", "width of link 1, normal to the plane of motion, mm", kRequired, "", 1.0,
     500.0},
    {"link1.thickness_mm", "thickness of link 1, in the plane of motion, mm", kRequired, "", 0.1,
     100.0},
    {"link2.length_m", "length of link 2, from the elbow's axis to the tip, m", kRequired, "", 0.05,
     5.0},
    {"link2.width_mm", "width of link 2, mm", kRequired, "", 1.0, 500.0},
    {"link2.thickness_mm", "thickness of link 2, mm", kRequired, "", 0.1, 100.0},
    {"elbow_mass_kg", "mass at the elbow: motor, gear, bearing, kg", kRequired, "", 0.0, 100.0},
    {"tip_mass_kg", "mass at the tip: the usual payload, kg", kRequired, "", 0.0, 100.0},
    {"joint1.torque_limit_nm", "largest torque of the shoulder's drive, after its gear, N m",
     kRequired, "", 1e-3, 1e4},
    {"joint2.torque_limit_nm", "largest torque of the elbow's drive, after its gear, N m",
     kRequired, "", 1e-3, 1e4},
    {"joint1.encoder_counts_per_turn",
     "encoder on the shoulder's axis: counts per turn, after quadrature", kRequired, "", 16.0, 1e8},
    {"joint2.encoder_counts_per_turn",
     "encoder on the elbow's axis: counts per turn, after quadrature", kRequired, "", 16.0, 1e8},
    {"gauges_per_link", "strain gauges on each link, 1 to 10", kRequired, "", 1.0, 10.0},
    {"rate_hz", "sampling rate of the loop, Hz, 10 to 500", kRequired, "", 10.0, 500.0},

    {"link1.mass_per_length_kg_m", "mass per length of link 1, kg/m", kOptional,
     "density, width and thickness", 1e-3, 1e3},
    {"link1.bending_stiffness_nm2", "bending stiffness EI of link 1, N m^2", kOptional,
     "modulus, width and thickness", 1e-4, 1e7},
    {"link1.damping_ratio", "damping ratio of link 1's bending", kOptional, "0.01", 0.0, 0.5},
    {"link1.strain_limit", "largest permitted strain of link 1", kOptional,
     "half of the material's yield strain", 1e-6, 0.05},
    {"link2.mass_per_length_kg_m", "mass per length of link 2, kg/m", kOptional,
     "density, width and thickness", 1e-3, 1e3},
    {"link2.bending_stiffness_nm2", "bending stiffness EI of link 2, N m^2", kOptional,
     "modulus, width and thickness", 1e-4, 1e7},
    {"link2.damping_ratio", "damping ratio of link 2's bending", kOptional, "0.01", 0.0, 0.5},
    {"link2.strain_limit", "largest permitted strain of link 2", kOptional,
     "half of the material's yield strain", 1e-6, 0.05},
    {"payload_min_kg", "least payload that the arm may carry, kg", kOptional, "0", 0.0, 100.0},
    {"payload_max_kg", "greatest payload that the arm may carry, kg", kOptional,
     "twice tip_mass_kg", 0.0, 100.0},
    {"joint1.gear", "turns of the shoulder's motor per turn of the joint", kOptional, "1", 1e-3,
     1e5},
    {"joint1.stiffness_nm_per_rad", "stiffness of the shoulder, gear and shaft, N m/rad", kOptional,
     "90 EI / L of link 1: rigid beside it", 1e-3, 1e8},
    {"joint1.motor_inertia_kgm2", "inertia of the shoulder's motor, kg m^2", kOptional,
     "5e-4 kg m^2 per N m of its torque, behind the gear", 1e-12, 1e3},
    {"joint1.rotor_encoder_counts_per_turn",
     "encoder on the shoulder's motor: counts per turn of the motor", kOptional, "no such encoder",
     4.0, 1e8},
    {"joint1.coulomb_friction_nm", "Coulomb friction of the shoulder, N m", kOptional,
     "0.4 % of its torque limit", 0.0, 1e4},
    {"joint2.gear", "turns of the elbow's motor per turn of the joint", kOptional, "1", 1e-3, 1e5},
    {"joint2.stiffness_nm_per_rad", "stiffness of the elbow, gear and shaft, N m/rad", kOptional,
     "90 EI / L of link 2: rigid beside it", 1e-3, 1e8},
    {"joint2.motor_inertia_kgm2", "inertia of the elbow's motor, kg m^2", kOptional,
     "5e-4 kg m^2 per N m of its torque, behind the gear", 1e-12, 1e3},
    {"joint2.rotor_encoder_counts_per_turn",
     "encoder on the elbow's motor: counts per turn of the motor", kOptional, "no such encoder",
     4.0, 1e8},
    {"joint2.coulomb_friction_nm", "Coulomb friction of the elbow, N m", kOptional,
     "0.4 % of its torque limit", 0.0, 1e4},
    {"gauge_filter_hz", "corner of the low-pass filter before the gauges' converter, Hz", kOptional,
     "0.4 of the rate", 0.1, 1e4},
    {"converter_bits", "bits of the gauges' converter", kOptional, "12", 8.0, 24.0},
    {"soft_angle_deg", "largest permitted angle of both joints, degrees", kOptional, "90", 1.0,
     350.0},
    {"plan_fraction", "share of the limits that a move without duration uses", kOptional,
     "0.6, or less if the simulated moves need it", 0.01, 1.0},
}};

constexpr std::array<Material, 4> kMaterials = {{
    {"aluminium", "6061-T6: yields at 276 MPa", 2700.0, 6.9e10, 1.9e-3},
    {"steel", "S355: yields at 355 MPa", 7850.0, 2.07e11, 8.5e-4},
    {"spring-steel", "hardened: yields above 1000 MPa", 7850.0, 2.07e11, 2.4e-3},
    {"titanium", "Ti-6Al-4V: yields at 880 MPa", 4430.0, 1.14e11, 3.8e-3},
}};

}  // namespace

std::span<const ArmKey> ArmKeys() { return kArmKeys; }
std::span<const Material> Materials() { return kMaterials; }

}  // namespace flexarm
