#include "papers/backdrivability_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/files/design_file.hpp"
#include "papers/embedded_data.hpp"
#include "papers/published_fits.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::papers {

namespace {

using report::csv_line, report::exact, report::fixed, report::percent, report::rpm;

/// A design with every length times a factor, carrying the torque of its size.
design::Design resized(design::Design d, double factor) {
  for (double& module : d.train.module_m) module *= factor;
  d.train.center_distance_m *= factor;
  for (auto& extent : d.axial.extent) {
    if (extent) *extent = {.from_m = factor * extent->from_m, .to_m = factor * extent->to_m};
  }
  for (auto& width : d.masses.face_width_m) {
    if (width) *width *= factor;
  }
  strength::RatingTask& rating = d.rating.value();
  for (double& width : rating.face_width_m) width *= factor;
  rating.torque_Nm *= factor * factor * factor;
  rating.supports.reset();
  return d;
}

std::string stiffness_csv(const BackdrivabilityFigures& f) {
  std::string text =
      "# Backdrivability paper, Fig. 8: stiffness at the output over torque; from makers' tables\n"
      "# and from gear3k's own models.  RT1: rated torque, first and last part of the\n"
      "# characteristic.  The 3K design: torque capacity and stiffness of teeth and shafts,\n"
      "# every length times size.\n"
      "series,size,torque_nm,stiffness_nm_per_rad\n";
  for (const StrainWaveGearbox& g : f.strain_waves) {
    for (const auto& [name, stiffness] :
         {std::pair{"RT1 K1", g.first_stiffness_Nm_rad}, {"RT1 K3", g.last_stiffness_Nm_rad}}) {
      text += csv_line({name, exact(g.size), exact(g.rated_Nm), exact(stiffness)});
    }
  }
  for (std::size_t k = 0; k < f.designed.sizes.size(); ++k) {
    const ScalingPoint& p = f.designed.stiffness.points[k];
    text += csv_line({f.designed.name, exact(f.designed.sizes[k]), exact(p.x[0]), exact(p.y)});
  }
  return text;
}

std::string stride_csv(const KneeExample& knee) {
  std::string text =
      "# Backdrivability paper, Fig. 10: a knee over a stride; other curves than the paper's\n"
      "# (data/knee_walking_digitised.csv), 75 kg.  Torque, speed and power that the knee gives.\n"
      "time_s,stride_percent,torque_nm,speed_rpm,power_w\n";
  const actuator::Cycle& c = knee.cycle;
  for (std::size_t k = 0; k < c.time_s.size(); ++k) {
    text += csv_line({exact(c.time_s[k]), exact(percent(c.time_s[k] / c.time_s.back())),
                      exact(-c.load_Nm[k]), exact(rpm(c.motion[k])),
                      exact(-c.load_Nm[k] * c.motion[k])});
  }
  return text;
}

std::string electrical_csv(const KneeExample& knee) {
  std::string text =
      "# Backdrivability paper, Fig. 11: power of the knee and electrical power of its actuator\n"
      "# (SHF-17-120, EC45 flat), without a drive; numbers as printed, of the paper's own\n"
      "# equations, corrected.  Two rows of one time are the limits from both sides.\n"
      "numbers,time_s,stride_percent,mechanical_w,electrical_w,mesh_nm,current_a\n";
  const double stride = knee.cycle.time_s.back();
  for (const KneeRun& run : knee.runs) {
    for (const actuator::MotorInstant& p : run.duty.instants) {
      text += csv_line({run.name, exact(p.time_s), exact(percent(p.time_s / stride)),
                        exact(-p.load_Nm * p.speed_rad_s), exact(p.electrical_W), exact(p.mesh_Nm),
                        exact(p.current_A)});
    }
  }
  return text;
}

std::string scaling_csv(const std::vector<ScalingLaw>& laws) {
  std::string text =
      "# Backdrivability paper: scaling laws fitted to makers' tables by least squares on\n"
      "# logarithms, one intercept per series; y and fitted in SI units.\n"
      "law,series,x1,x2,y,fitted\n";
  for (const ScalingLaw& law : laws) {
    for (const ScalingPoint& p : law.points) {
      text += csv_line({law.name, p.series, exact(p.x[0]), p.x.size() > 1 ? exact(p.x[1]) : "",
                        exact(p.y), exact(fitted_value(law, p))});
    }
  }
  return text;
}

std::string exponent_text(const ScalingFactor& f) {
  return fmt::format("{} +-{}", fixed(f.exponent, 2), fixed(f.band, 2));
}

std::string places_text(const KneeExample& knee, const KneeRun& run) {
  std::string text;
  for (const auto& [from, to] : regenerating_places(run, knee.cycle.time_s.back())) {
    text += fmt::format("{}{} to {}", text.empty() ? "" : ", ", fixed(from, 1), fixed(to, 1));
  }
  return text.empty() ? "nowhere" : text + " %";
}

FigureStatement stiffness_statement(const BackdrivabilityFigures& f) {
  FigureStatement statement{
      .figure = "8", .paper = "stiffness in proportion to torque, an empirical law", .ours = {}};
  for (const ScalingLaw& law : f.comparison.laws) {
    if (law.name != "stiffness_over_torque") continue;
    statement.ours.push_back(fmt::format("{} sizes of RT1: K3 ~ T^{} (rated torque)",
                                         law.points.size(), exponent_text(law.factors[0])));
  }
  const auto [least, most] = std::ranges::minmax(f.designed.sizes);
  statement.ours.push_back(fmt::format("{} in sizes {:g} to {:g}: K ~ T^{} (teeth and shafts)",
                                       f.designed.name, least, most,
                                       exponent_text(f.designed.stiffness.factors[0])));
  return statement;
}

FigureStatement stride_statement(const KneeExample& knee) {
  std::string stretches;
  const double stride = knee.cycle.time_s.back();
  for (const NegativeStretch& n : knee.negative) {
    stretches +=
        fmt::format("{}{} to {}", stretches.empty() ? "" : ", ",
                    fixed(percent(n.from_s / stride), 1), fixed(percent(n.to_s / stride), 1));
  }
  return {.figure = "10",
          .paper = "four stretches of negative power, each from zero torque to zero speed",
          .ours = {fmt::format("{} stretches: {} % of the stride", knee.negative.size(), stretches),
                   fmt::format("{} to {} W, largest torque {} N m", fixed(knee.least_power_W, 1),
                               fixed(knee.peak_power_W, 1), fixed(knee.peak_torque_Nm, 1))}};
}

FigureStatement electrical_statement(const KneeExample& knee) {
  FigureStatement statement{
      .figure = "11",
      .paper = "electrical power an order of magnitude larger; regenerating from 6.5 to 13.9 only",
      .ours = {}};
  for (const KneeRun& run : knee.runs) {
    statement.ours.push_back(fmt::format(
        "{}: {} to {} W, drawn {} J, regenerated {} J, regenerating at {}", run.name,
        fixed(run.least_electrical_W, 0), fixed(run.peak_electrical_W, 0),
        fixed(run.duty.drawn_J, 1), fixed(run.duty.regenerated_J, 1), places_text(knee, run)));
  }
  return statement;
}

}  // namespace

ScaledDesign scaled_design() {
  design::Design whole = io::parse_design(std::string(loaded_design_toml()), "loaded.toml");
  ScaledDesign result{.name = whole.name,
                      .sizes = {0.5, 0.7, 1.0, 1.4, 2.0, 2.8},
                      .stiffness = {.name = "designed_stiffness",
                                    .quantity = "stiffness",
                                    .unit = "N m/rad",
                                    .source = "Fig. 8",
                                    .data = whole.name,
                                    .factors = {{.name = "torque", .symbol = "T", .paper = 1.0}}}};
  for (const double size : result.sizes) {
    const design::Evaluation e = evaluated(resized(whole, size));
    const auto& strength = e.strength.value();
    const auto capacity = strength.least_capacity();
    if (!capacity || !strength.forward.stiffness) {
      throw std::invalid_argument(
          fmt::format("{} in size {:g}: no capacity or no stiffness", whole.name, size));
    }
    result.stiffness.points.push_back({.series = whole.name,
                                       .y = strength.forward.stiffness->output_Nm_rad,
                                       .x = {capacity->capacity.torque_Nm}});
  }
  fit(result.stiffness);
  return result;
}

std::vector<std::pair<double, double>> regenerating_places(const KneeRun& run, double stride_s) {
  std::vector<std::pair<double, double>> places;
  const auto& instants = run.duty.instants;
  bool open = false;
  for (std::size_t k = 0; k + 1 < instants.size(); ++k) {
    const double from = percent(instants[k].time_s / stride_s);
    const double to = percent(instants[k + 1].time_s / stride_s);
    if (to <= from) continue;
    // A part ends where the power changes its sign.
    const double power = instants[k].electrical_W + instants[k + 1].electrical_W;
    if (power >= 0.0) {
      open = false;
    } else if (open) {
      places.back().second = to;
    } else {
      places.emplace_back(from, to);
      open = true;
    }
  }
  return places;
}

std::string backdrivability_figures_table(const BackdrivabilityFigures& figures) {
  const KneeExample& knee = figures.comparison.knee;
  return figures_text(
      "backdrivability-factors paper",
      {stiffness_statement(figures), stride_statement(knee), electrical_statement(knee)});
}

std::vector<FigureData> backdrivability_figure_data(const BackdrivabilityFigures& figures) {
  const KneeExample& knee = figures.comparison.knee;
  return {{.name = kBackdrivabilityFigures[0], .csv = stiffness_csv(figures)},
          {.name = kBackdrivabilityFigures[1], .csv = stride_csv(knee)},
          {.name = kBackdrivabilityFigures[2], .csv = electrical_csv(knee)},
          {.name = kBackdrivabilityFigures[3], .csv = scaling_csv(figures.comparison.laws)}};
}

}  // namespace gear3k::papers
