#pragma once
// Campaigns of the rig as the library sees them, and simulations of single rows.

#include <optional>
#include <string>
#include <vector>

#include "calibrate/fit/linearisation.hpp"
#include "calibrate/model/simulation.hpp"
#include "calibrate/search/search.hpp"
#include "tests/rig/rig.hpp"

namespace gear3k::calibrate {

design::Design design_of(const rig::Gearbox& gearbox);

/// A black box of the bilateral drive gear's ratio: 85 % forward, 80 % backward, 20 arcmin.
BlackBox some_black_box();

/// An external pair of the design's rack and friction.
design::PairDesign pair_of(const design::Design& design);

/// A campaign of the rig on the bilateral drive gear.  Of torque_angle, whose records are reduced
/// to rows first: lost motion at three torques, in two sessions.
MeasurementSet campaign(Kind kind, std::uint64_t seed = 1,
                        const std::vector<rig::HiddenCause>& causes = {});

/// Every n-th row.
MeasurementSet thinned(MeasurementSet data, std::size_t every);

/// A cause in one of its forms.
/// @throws std::invalid_argument when there is no such cause
Candidate candidate(const std::string& id, Form form, Kind kind = Kind::kTransmission);

/// A hypothesis of one or several causes, with all their parameters.
Hypothesis hypothesis(std::vector<Candidate> effects, std::vector<double> value);

/// Rows as a hypothesis simulates them; empty where some row does not run.
std::optional<Eigen::VectorXd> simulated(const Simulation& simulation, const MeasurementSet& data,
                                         const Hypothesis& h);
/// One row.
/// @throws std::bad_optional_access where it does not run
double simulated(const Simulation& simulation, const Condition& condition,
                 const Hypothesis& h = {});

}  // namespace gear3k::calibrate
