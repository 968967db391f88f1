#pragma once

namespace gear3k::rig {

/// A task of some hundred tooth sets, that takes seconds.
inline constexpr const char* kRedesignSpec = R"(name = "redesign"
planets = 3
identical_planets = true
pressure_angle_deg = 20.0
objective = "backward_efficiency"
[ratio]
target = 96.2
tolerance = 0.005
[teeth]
S = [12, 15]
P1 = [30, 60]
R1_max = 140
P2 = [24, 50]
R2_max = 130
max_coaxial_offset = 3
min_internal_difference = 9
[module]
stage1_mm = { min = 0.5, max = 0.8 }
stage2_mm = { min = 0.5, max = 0.8 }
[profile_shift]
range = [0.0, 1.0]
[size]
max_ring_root_diameter_mm = 76.0
[backlash]
model = "kinematic"
max_output_arcmin = 12.0
min_normal_um = 10.0
machining_allowance = 0.02
[contact_ratio]
range = [1.2, 2.5]
[limits]
tip_thickness = 0.3
planet_gap = 0.5
[friction]
coefficient = 0.1
loss_model = "sliding"
[operating_point]
sun_speed_rpm = 600.0
output_torque_nm = 20.0
temperature_c = 35.0
[solver]
refine = "slsqp"
starts = 2
seed = 1
)";

}  // namespace gear3k::rig
