#include "tests/calibrate/rig_campaign.hpp"

#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "io/files/design_file.hpp"
#include "io/files/measurement_file.hpp"

namespace gear3k::calibrate {

design::Design design_of(const rig::Gearbox& gearbox) {
  return io::parse_design(rig::design_toml(gearbox), "design.toml");
}

BlackBox some_black_box() {
  return {.name = "black box",
          .ratio = 5967.0 / 62.0,
          .efficiency_forward = 0.85,
          .efficiency_backward = 0.8,
          .backlash_rad = 20.0 / 60.0 * std::numbers::pi / 180.0};
}

design::PairDesign pair_of(const design::Design& design) {
  design::PairDesign pair;
  pair.pressure_angle_rad = design.train.pressure_angle_rad;
  pair.gear1.rack = pair.gear2.rack = design.train.rack.front();
  pair.friction = design.friction;
  return pair;
}

MeasurementSet campaign(Kind kind, std::uint64_t seed,
                        const std::vector<rig::HiddenCause>& causes) {
  if (kind == Kind::kTorqueAngle) {
    MeasurementSet data;
    data.kind = kind;
    data.runs = {"a", "b"};
    for (int k = 0; k < 12; ++k) {
      Observation row;
      row.condition.test_torque_Nm = 1.0 + 2.0 * (k % 3);
      row.condition.time_s = 40.0 * k;
      row.condition.run = k / 6;
      row.response = 0.006 + 1e-5 * ((7 * k) % 5);
      data.rows.push_back(row);
    }
    return data;
  }
  const rig::Plan plan = kind == Kind::kTransmission ? rig::transmission_plan()
                         : kind == Kind::kLostMotion ? rig::lost_motion_plan()
                                                     : rig::pair_loss_plan();
  const auto measured = rig::measure(rig::bilateral_drive_gear(), plan, causes, seed);
  return io::parse_measurements({{.path = "data.csv", .text = measured.csv}}).sets.at(0);
}

MeasurementSet thinned(MeasurementSet data, std::size_t every) {
  std::vector<Observation> rows;
  rows.reserve(data.rows.size() / every + 1);
  for (std::size_t k = 0; k < data.rows.size(); k += every) rows.push_back(data.rows[k]);
  data.rows = std::move(rows);
  return data;
}

Candidate candidate(const std::string& id, Form form, Kind kind) {
  const Cause* cause = find_cause(id);
  if (cause == nullptr) throw std::invalid_argument("candidate: no cause " + id);
  auto parameters = cause->parameters(form, kind);
  return {.cause = cause, .form = std::move(form), .parameters = std::move(parameters)};
}

Hypothesis hypothesis(std::vector<Candidate> effects, std::vector<double> value) {
  Hypothesis h{.effects = std::move(effects), .value = std::move(value)};
  if (parameters_of(h).size() != h.value.size()) {
    throw std::invalid_argument("hypothesis: not one value for each parameter");
  }
  return h;
}

std::optional<Eigen::VectorXd> simulated(const Simulation& simulation, const MeasurementSet& data,
                                         const Hypothesis& h) {
  const Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
  const Linearisation at = linearise(problem, h, {});
  if (!at.runs) return std::nullopt;
  return at.simulated;
}

double simulated(const Simulation& simulation, const Condition& condition, const Hypothesis& h) {
  MeasurementSet data;
  data.kind = simulation.kind();
  for (int run = 0; run <= condition.run; ++run) data.runs.push_back(std::to_string(run));
  data.rows.push_back({.condition = condition, .response = 0.0});
  return simulated(simulation, data, h).value()[0];
}

}  // namespace gear3k::calibrate
