# The library of calibrate/, and its causes; read by src/CMakeLists.txt, from whose folder paths count.

# Causes that `diagnose` can name: a file each.  Where two explain data as well, the earlier one is
# named first.
set(causes
    friction_level
    run_step
    drift
    drag_constant
    drag_viscous
    drag_quadratic
    friction_load
    friction_speed
    friction_temperature
    friction_direction
    bearing_load
    sensor_offset
    sensor_gain
    runout
    mesh_order
    clearance
    compliance
    thermal_expansion)
foreach(cause IN LISTS causes)
  string(APPEND declarations "namespace ${cause} {\nextern const Cause cause;\n}\n")
  list(APPEND pointers "&${cause}::cause")
endforeach()
list(JOIN pointers ", " pointers)
configure_file(calibrate/causes/cause_list.cpp.in cause_list.cpp @ONLY)
list(TRANSFORM causes PREPEND causes/)
list(TRANSFORM causes APPEND .cpp)
gear3k_library(calibrate
  SOURCES
    ${causes}
    causes/angle_order.cpp
    fit/columns.cpp
    fit/final_fit.cpp
    fit/fit.cpp
    fit/holdout.cpp
    fit/linearisation.cpp
    fit/screen.cpp
    fit/wave_amplitude.cpp
    laws/law_fit.cpp
    laws/law_scan.cpp
    loops/branch_zero.cpp
    loops/correlated_noise.cpp
    loops/filtered_record.cpp
    loops/flank_stiffness.cpp
    loops/loop_closing.cpp
    loops/loop_creep.cpp
    loops/torque_angle_loop.cpp
    loops/torque_branch.cpp
    loops/zero_before_jump.cpp
    loops/zero_phase_filter.cpp
    measurement/blank_conditions.cpp
    measurement/commanded_torque.cpp
    measurement/covariate_levels.cpp
    measurement/noise.cpp
    measurement/noise_memory.cpp
    measurement/reading_steps.cpp
    measurement/row_selection.cpp
    model/cause.cpp
    model/extended_model.cpp
    model/hypothesis.cpp
    model/law.cpp
    model/levelled_responses.cpp
    model/row_responses.cpp
    model/simulation.cpp
    search/linear_sets.cpp
    search/memory_from_fit.cpp
    search/noise_from_fit.cpp
    search/order_scan.cpp
    series/joint_fit.cpp
    series/random_effects.cpp
    verdict/posterior.cpp
    dynamic/motion_readings.cpp
    dynamic/motion_windows.cpp
    dynamic/window_fit.cpp
    dynamic/windup.cpp
  SELDOM
    causes/form_catalogue.cpp
    fit/parameter_results.cpp
    fit/row_drag.cpp
    fit/row_gain.cpp
    fit/row_friction.cpp
    fit/rounding.cpp
    laws/law_data.cpp
    laws/law_forms.cpp
    laws/law_result.cpp
    laws/law_search.cpp
    measurement/impossible_rows.cpp
    measurement/left_out_rows.cpp
    measurement/level_groups.cpp
    measurement/loop_observations.cpp
    measurement/loop_friction.cpp
    measurement/loop_reading.cpp
    measurement/marked_together.cpp
    measurement/power_excess.cpp
    measurement/sensor_limit.cpp
    model/law_doubt.cpp
    model/model_range.cpp
    model/parameter_draws.cpp
    search/better_names.cpp
    search/form_doubt.cpp
    search/free_shapes.cpp
    search/judge.cpp
    search/replacements.cpp
    search/rows_together.cpp
    search/search.cpp
    search/search_with_noise.cpp
    search/second_names.cpp
    search/stability.cpp
    series/series.cpp
    series/series_model.cpp
    series/series_search.cpp
    series/unit_differences.cpp
    series/units.cpp
    verdict/correction.cpp
    verdict/diagnosis.cpp
    verdict/experiment.cpp
    verdict/held_out.cpp
    verdict/left_behind.cpp
    verdict/model_update.cpp
    verdict/noise_level.cpp
    verdict/possible_conditions.cpp
    verdict/remainder.cpp
    verdict/rounded_readings.cpp
    verdict/rows_off.cpp
    verdict/simulated_rows.cpp
    verdict/session_conditions.cpp
    verdict/unexplained.cpp
    verdict/wild_rows.cpp
    dynamic/drive_parameters.cpp
    dynamic/motion_diagnosis.cpp
    dynamic/motion_experiment.cpp
    dynamic/motion_holdout.cpp
  LINK gear3k_optimize Ceres::ceres gear3k_random123)
target_sources(gear3k_calibrate PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/cause_list.cpp)
