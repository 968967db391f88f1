#include "io/files/first_file.hpp"

#include <algorithm>
#include <array>

namespace gear3k::io {

namespace {

constexpr std::string_view kTask =
    R"toml(# A task for gear3k:   gear3k optimize FILE --out DIR
# Lines that begin with "#" and no space are choices that are off: take the "#" away.
# Every key with its range and default: gear3k keys
name = "my gearbox"
planets = 3                        # or a list to try, such as [3, 4, 5]
preset = "machined"                # what the workshop can make; or "printed", or "bare" (docs/interface.md)
objective = "backward_efficiency"  # or forward_efficiency, lost_motion, outer_diameter, ratio_error

[ratio]
target = 50.0                      # speed of the sun over that of the output; below 0: it turns back
tolerance = 0.005                  # greatest share that the ratio may be off

[teeth]                            # what the search tries; wider ranges take longer
S = [12, 18]
P1 = [18, 45]
P2 = [18, 45]
R1_max = 120
R2_max = 120
min_internal_difference = 9        # least teeth of a ring over those of its planet

[module]
stage1_mm = { min = 0.5, max = 1.0 }   # or one number, or { series = [0.5, 0.6, 0.8] }
stage2_mm = { min = 0.5, max = 1.0 }

[profile_shift]
range = [-0.5, 1.0]

[size]
ring_rim_mm = 3.0                  # of both rings outside their root circles
max_outer_diameter_mm = 86.0       # with the rims
#sun_bore_mm = 4.0
#planet_bore_mm = 6.0

[backlash]
machining_allowance = 0.02         # each tooth thinner by 0.02 modules: room to turn
max_output_arcmin = 10.0           # greatest lost motion at the output
#min_normal_um = 20.0              # least backlash of every mesh, in place of the preset's

# Limits in place of those of the preset; each check has a key (gear3k keys limits).
#[contact_ratio]
#range = [1.2, 2.5]
#[limits]
#tip_thickness = 0.3               # modules, of S, P1 and P2
#specific_sliding = 3.0            # greatest sliding over rolling at a root
#hunting_tooth = true              # no common factor of the teeth of a mesh
#same_module = true                # one module for both stages

[friction]
coefficient = 0.1                  # of the flanks, as in the papers; gear3k diagnose tells yours

# What it is to carry.  Without these tables no load is checked.
#[stage1]
#face_width_mm = 8.0
#[stage2]
#face_width_mm = 8.0
#[material]
#name = "34CrNiMo6 through hardened"   # the names: docs/materials.md
#[strength]
#output_torque_nm = 10.0           # either direction, reversing, without end
#s_f_min = 1.5                     # least safety of the root
#s_h_min = 1.2                     # least safety of the flank

# What is made will differ from what is drawn: limits that hold for all that is built.
#[tolerances]
#center_distance_um = 10           # +-
#pin_position_um = 10
#planet_phase_arcmin = 0.5         # angle of P2 against P1 on each planet, +-
#[robust]
#hold = "worst_case"               # or "yield", the share robust.yield of those built
)toml";

constexpr std::string_view kDesign =
    R"toml(# One gearbox for gear3k:   gear3k analyze FILE     (also: map, tolerances, export, compare, diagnose)
# Lines that begin with "#" and no space are choices that are off: take the "#" away.
# Every key with its range and default: gear3k keys
name = "my gearbox"
planets = 3
pressure_angle_deg = 20.0
center_distance_mm = 19.25

[stage1]                           # S, P1 and the fixed ring R1
module_mm = 0.6
#face_width_mm = 8.0
[stage2]                           # P2 and the output ring R2; P1 and P2 are one planet
module_mm = 0.6
#face_width_mm = 8.0

[gears.S]
teeth = 13
profile_shift = 0.24               # modules
machining_allowance = 0.02         # modules by which each tooth is thinner; or normal_thinning_um
[gears.P1]
teeth = 50
profile_shift = 0.28
machining_allowance = 0.02
[gears.R1]
teeth = 113
profile_shift = 0.98
machining_allowance = 0.02
[gears.P2]
teeth = 35
profile_shift = 0.35
machining_allowance = 0.02
[gears.R2]
teeth = 98
profile_shift = 0.98
machining_allowance = 0.02

[friction]
coefficient = 0.1                  # of the flanks; gear3k diagnose tells it from measurements

# What the checks hold it to; each has a margin in the result.
[backlash]
min_normal_um = 10.0               # least backlash of every mesh
max_output_arcmin = 15.0           # greatest lost motion at the output
[contact_ratio]
range = [1.2, 2.5]

# What it is to carry.  Take the "#" of face_width_mm above away too.
#[material]
#name = "34CrNiMo6 through hardened"   # the names: docs/materials.md
#[strength]
#output_torque_nm = 10.0           # either direction, reversing, without end
#s_f_min = 1.5                     # least safety of the root
#s_h_min = 1.2                     # least safety of the flank

# What is made will differ from what is drawn: for gear3k tolerances.
#[tolerances]
#center_distance_um = 10           # +-
#pin_position_um = 10
#planet_phase_arcmin = 0.5         # angle of P2 against P1 on each planet, +-
)toml";

constexpr std::string_view kPair =
    R"toml(# One pair of gears for gear3k:   gear3k mesh FILE
# Lines that begin with "#" and no space are choices that are off: take the "#" away.
# Every key with its range and default: gear3k keys
name = "my pair"
kind = "external"                  # or "internal": gear2 is then the ring
module_mm = 1.0
pressure_angle_deg = 20.0
center_distance_mm = 30.4          # without it the distance at which no backlash is left
#face_width_mm = 10.0              # that both gears share

[gear1]
teeth = 20
profile_shift = 0.3                # modules
machining_allowance = 0.02         # modules by which each tooth is thinner

[gear2]
teeth = 40
profile_shift = 0.1
machining_allowance = 0.02

[friction]
coefficient = 0.1                  # of the flanks

# What it is to carry.  Without these tables no load is checked.
#[material]
#name = "34CrNiMo6 through hardened"   # the names: docs/materials.md
#[strength]
#torque_nm = 3.0                   # on gear1, reversing, without end
)toml";

constexpr std::string_view kActuator =
    R"toml(# A motor with gearbox for gear3k:   gear3k actuator FILE     (with a duty cycle: --cycle CYCLE.csv)
# Lines that begin with "#" and no space are choices that are off: take the "#" away.
# Every key with its range and default: gear3k keys
name = "my actuator"

[motor]                            # as its data sheet has it
resistance_ohm = 0.6               # between the terminals, at 25 C
torque_constant_nm_per_a = 0.037
rotor_inertia_kgm2 = 1.8e-5
no_load_current_a = 0.23           # both no-load values tell its friction
no_load_speed_rad_s = 640.0
#coulomb_torque_nm = 0.002         # the part of that friction that no speed changes
#max_current_a = 20.0
#winding_housing_k_per_w = 4.1     # both: the winding's temperature in a repeated cycle
#housing_ambient_k_per_w = 3.6
#max_winding_c = 155.0

[gearbox]                          # or design = "design.toml" and nothing else
ratio = 100.0                      # speed of the motor over that of the output
efficiency_forward = 0.85          # of the loaded meshes, the motor drives
efficiency_backward = 0.82         # the output drives; 0 or less: self-locking
backdriving_torque_nm = 3.0        # drag at the output at rest; while it turns half of it
#viscous_nms_per_rad = 0.05        # at the output
#input_inertia_kgm2 = 1e-6
#stiffness_nm_per_rad = 10000.0    # at the output

[load]
inertia_kgm2 = 0.0                 # on top of the torque of the cycle

# Limits and losses of the drive.
#[drive]
#bus_voltage_v = 48.0
#efficiency_motoring = 0.95
#efficiency_regenerating = 0.9     # 0: what comes back is burnt
#standby_w = 1.0
)toml";

constexpr std::string_view kScenario =
    R"toml(# What happens to an actuator, for gear3k:   gear3k simulate ACTUATOR.toml FILE --out DIR
# Lines that begin with "#" and no space are choices that are off: take the "#" away.
# Every key with its range and default: gear3k keys
name = "my scenario"
duration_s = 4.0

[start]                            # of the output
output_angle_rad = 0.3
output_speed_rad_s = 0.0
#gap_position = 1.0                # with backlash: 1 or -1, the motor's side touches already

[control]
mode = "torque"                    # voltage, shorted, open or position, each with its own keys
torque_nm = 0.0                    # of the motor
torque_amplitude_nm = 0.08         # of a sine
frequency_hz = 0.5
#phase_deg = 90.0
# table = "torque.csv"             # time_s, motor_torque_nm: as gear3k actuator --format csv has them
# For mode = "position", the output follows an angle:
# angle_amplitude_rad = 0.5
# stiffness_nm_per_rad = 50.0
# damping_nms_per_rad = 2.0

[load]                             # all of these add up
pendulum_mass_kg = 1.0             # a mass on an arm that turns with the output
pendulum_length_m = 0.3
#pendulum_angle_rad = 0.5          # output angle at which it hangs
#inertia_kgm2 = 0.01
#torque_nm = 0.5                   # of the load on the output
#stiffness_nm_per_rad = 2.0        # a spring to the frame
# table = "load.csv"               # time_s, torque_nm

# How exactly, and how much of it is written.
#[solver]
#relative_tolerance = 1e-9
#max_step_s = 0.01
#[output]
#sample_s = 0.01
)toml";

constexpr std::array<FirstFile, 5> kFirstFiles{{{.kind = "task", .text = kTask},
                                                {.kind = "design", .text = kDesign},
                                                {.kind = "pair", .text = kPair},
                                                {.kind = "actuator", .text = kActuator},
                                                {.kind = "scenario", .text = kScenario}}};

}  // namespace

std::span<const FirstFile> first_files() { return kFirstFiles; }

const FirstFile* find_first_file(std::string_view kind) {
  const auto* const found = std::ranges::find(kFirstFiles, kind, &FirstFile::kind);
  return found == kFirstFiles.end() ? nullptr : found;
}

}  // namespace gear3k::io
