#pragma once
// Files of the repository that are part of the program, so that it runs from anywhere.

#include <string_view>

namespace gear3k::papers {

std::string_view published_prototypes_csv();        ///< data/published_3k_prototypes.csv
std::string_view paper_statements_csv();            ///< data/low_backlash_paper_statements.csv
std::string_view pair_losses_csv();                 ///< data/spur_pair_loss_dry_steel.csv
std::string_view thesis_statements_csv();           ///< data/directional_impedance_statements.csv
std::string_view backdrivability_statements_csv();  ///< data/backdrivability_statements.csv
std::string_view motor_catalogue_csv();             ///< data/motor_catalogue.csv
std::string_view planetary_catalogue_csv();         ///< data/planetary_gearbox_catalogue.csv
std::string_view strain_wave_catalogue_csv();       ///< data/strain_wave_catalogue_rt1_i100.csv
std::string_view knee_walking_csv();                ///< data/knee_walking_digitised.csv
std::string_view loaded_design_toml();              ///< examples/designs/loaded.toml
std::string_view rp96_toml();                       ///< examples/rp96.toml
std::string_view paper_figures_toml();              ///< examples/paper-figures.toml

std::string_view bench_actuator_toml();  ///< examples/actuators/directional_bench.toml
std::string_view bench_load_toml();      ///< examples/actuators/directional_bench_load.toml
std::string_view bench_push_toml();      ///< examples/actuators/directional_bench_push.toml
std::string_view bench_braking_toml();   ///< examples/actuators/directional_bench_braking.toml
std::string_view bench_angle_csv();      ///< examples/actuators/directional_bench_angle.csv
std::string_view bench_torque_csv();     ///< examples/actuators/directional_bench_torque.csv

}  // namespace gear3k::papers
