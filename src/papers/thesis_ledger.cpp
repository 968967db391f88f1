#include "papers/thesis_ledger.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "efficiency/mesh_loss.hpp"
#include "efficiency/single_pair_loss.hpp"
#include "papers/thesis_model.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

namespace {

using efficiency::SinglePair;
using report::percent;

class ThesisLedger {
 public:
  ThesisLedger(const ThesisSources& sources, const ThesisComparison& comparison)
      : sources_(sources),
        s_(sources.statements),
        comparison_(comparison),
        pairs_(measured_both_ways(sources.measured)) {
    if (pairs_.empty()) throw std::invalid_argument("no pair is measured in both directions");
  }

  std::vector<LedgerEntry> entries() {
    add_distance();
    add_path_limits();
    add_single_pair();
    add_larger_driver();
    add_largest_skew();
    add_corrected_model();
    add_skew_factor();
    add_symmetric_part();
    add_always_greater();
    add_small_skew();
    add_least_loss();
    return std::move(entries_);
  }

 private:
  void add(LedgerEntry entry) {
    entry.number = static_cast<int>(entries_.size()) + 1;
    entries_.push_back(std::move(entry));
  }

  const PairLossModel& model(const std::string& name) const {
    const auto at = std::ranges::find(comparison_.models, name, &PairLossModel::name);
    if (at == comparison_.models.end()) throw std::invalid_argument("no model " + name);
    return *at;
  }

  /// Torque loss at s along the line of action from the moments about both centres.
  static double loss_by_moments(const SinglePair& p, double s) {
    const double sine = std::sin(p.pressure_angle_rad);
    const double cosine = std::cos(p.pressure_angle_rad);
    const double friction = s < 0.0 ? p.friction : -p.friction;
    const double torque1 = p.pitch_radius1_m * (cosine - friction * sine) - friction * s;
    const double torque2 = p.pitch_radius2_m * (cosine - friction * sine) + friction * s;
    return 1.0 - torque2 * p.pitch_radius1_m / (torque1 * p.pitch_radius2_m);
  }

  void add_distance() {
    const MeasuredPairLoss& row = pairs_.front().small_drives;
    const SinglePair pair = pair_of(s_, row, s_.map_friction);
    const efficiency::ContactPath path = efficiency::contact_path(pair);
    const double projection = std::cos(pair.pressure_angle_rad);
    const auto loss = [](const std::string& name, double value) {
      return Figure{.name = name, .unit = "%", .value = percent(value)};
    };
    add({.where = "eqs. 2.1, 2.2: a",
         .paper = "\"distance on the pitch line between the contact point and the center line\"; "
                  "Fig. 2-1a for both equations",
         .finding = fmt::format(
             "both equations hold for any mu (2.1 approach, 2.2 recess) if a is the distance from "
             "the pitch point along the line of action; the distance from the line of centres is a "
             "cos(alpha). Fig. 2-1b belongs to 2.2. Figures: {} driving {} at the ends of contact",
             row.driving_teeth, row.driven_teeth),
         .figures = {loss("first contact by moments", loss_by_moments(pair, -path.approach_m)),
                     loss("by eq. 2.1", efficiency::approach_torque_loss(pair, path.approach_m)),
                     loss("by eq. 2.1 with a from the line of centres",
                          efficiency::approach_torque_loss(pair, projection * path.approach_m)),
                     loss("last contact by moments", loss_by_moments(pair, path.recess_m)),
                     loss("by eq. 2.2", efficiency::recess_torque_loss(pair, path.recess_m)),
                     loss("by eq. 2.2 with a from the line of centres",
                          efficiency::recess_torque_loss(pair, projection * path.recess_m))}});
  }

  void add_path_limits() {
    const auto extreme = std::ranges::max_element(pairs_, {}, &MeasuredBothWays::ratio);
    const SinglePair pair = pair_of(s_, extreme->small_drives, s_.map_friction);
    const efficiency::ContactPath path = efficiency::contact_path(pair);
    // Symbols as in eq. 2.3.
    const double R1 = pair.pitch_radius1_m;
    const double R2 = pair.pitch_radius2_m;
    const double cosine = std::cos(pair.pressure_angle_rad);
    const double sine = std::sin(pair.pressure_angle_rad);
    const double length = std::sqrt(std::pow(pair.tip_radius1_m, 2) - std::pow(R1 * cosine, 2)) +
                          std::sqrt(std::pow(pair.tip_radius2_m, 2) - std::pow(R2 * cosine, 2)) -
                          (R1 + R2) * sine;
    const auto past = [&](const MeasuredPairLoss& m) {
      return !efficiency::path_on_involutes(pair_of(s_, m, s_.map_friction));
    };
    const auto in_modules = [&](const std::string& name, double length_m) {
      return Figure{.name = name, .unit = "module", .value = length_m / s_.module_m};
    };
    add({.where = "ranges of eqs. 2.1, 2.2; eq. 2.3",
         .paper = "a from 0 to the mate's tip circle, whatever the pinion",
         .finding =
             fmt::format("the printed limits are right and add up to eq. 2.3, but they pass the "
                         "tangent point of small pinions' base circles, where no involute is left "
                         "(interference). Figures: {} driving {}",
                         extreme->pinion(), extreme->gear()),
         .figures = {in_modules("limit of 2.1", path.approach_m),
                     in_modules("tangent point", R1 * sine),
                     in_modules("limit of 2.2", path.recess_m),
                     in_modules("eq. 2.3", length),
                     {"rows of Table 3.1 past it", "",
                      static_cast<double>(std::ranges::count_if(sources_.measured, past)), 0},
                     {"of its map's pairs", "%",
                      percent(static_cast<double>(std::ranges::count(
                                  comparison_.map.points, false, &LossMap::Point::on_involutes)) /
                              static_cast<double>(comparison_.map.points.size())),
                      0}}});
  }

  void add_single_pair() {
    const double base_pitch_m = std::numbers::pi * s_.module_m * std::cos(s_.pressure_angle_rad);
    double least_ratio = std::numeric_limits<double>::infinity();
    double most_ratio = 0.0;
    double least_excess = std::numeric_limits<double>::infinity();
    double most_excess = 0.0;
    for (const MeasuredPairLoss& m : sources_.measured) {
      const auto path = efficiency::contact_path(pair_of(s_, m, s_.map_friction));
      const double ea = path.approach_m / base_pitch_m;
      const double er = path.recess_m / base_pitch_m;
      const double alone = (ea * ea + er * er) / (ea + er);
      const double excess = alone / efficiency::sliding_factor(ea, er);
      least_ratio = std::min(least_ratio, ea + er);
      most_ratio = std::max(most_ratio, ea + er);
      least_excess = std::min(least_excess, excess);
      most_excess = std::max(most_excess, excess);
    }
    add({.where = "Sec. 2.1: single contact",
         .paper = fmt::format("below a contact ratio of {:g} mostly one pair is in contact",
                              s_.single_pair_contact_ratio),
         .finding = "every tested pair is above it: mostly two pairs are in contact, and one pair "
                    "that carries all load over the whole path loses more than pairs that share it "
                    "equally",
         .figures = {{"least contact ratio of Table 3.1", "", least_ratio, 3},
                     {"largest", "", most_ratio, 3},
                     {"time with one pair, at most", "%", percent(2.0 - least_ratio), 0},
                     {"loss over that with shared load, least", "", least_excess, 3},
                     {"largest ratio of the two", "", most_excess, 3}}});
  }

  void add_larger_driver() {
    int unequal = 0;
    const LossMap::Point* reversed = nullptr;
    int reversals = 0;
    double both_large = 0.0;
    for (const LossMap::Point& p : comparison_.map.points) {
      if (p.driving_teeth <= p.driven_teeth) continue;
      ++unequal;
      if (p.driven_teeth >= 30) both_large = std::max(both_large, std::abs(p.skew));
      if (p.skew >= 0.0) continue;
      ++reversals;
      if (reversed == nullptr || p.skew < reversed->skew) reversed = &p;
    }
    std::vector<Figure> figures{
        {"pairs of the map", "", static_cast<double>(unequal), 0},
        {"with less loss when the larger drives", "", static_cast<double>(reversals), 0},
        {"largest skew with both gears of 30 teeth or more", "%", percent(both_large), 5}};
    if (reversed != nullptr) {
      figures.push_back(
          {fmt::format("skew of {} driving {}", reversed->driving_teeth, reversed->driven_teeth),
           "%", percent(reversed->skew), 5});
    }
    add({.where = "Sec. 2.1, Fig. 2-2c",
         .paper = "\"there is more loss when the large gear is driving the small one\"",
         .finding = fmt::format(
             "its own equations reverse this between larger gears (mu = {:g}): skew is the small "
             "difference of two terms in mu^2",
             comparison_.map.friction),
         .figures = std::move(figures)});
  }

  double largest_model_skew(double friction) const {
    return parts_of(sources_, friction).skew.cwiseAbs().maxCoeff();
  }

  void add_largest_skew() {
    double of_map = 0.0;
    for (const LossMap::Point& p : comparison_.map.points) of_map = std::max(of_map, p.skew);
    double measured = 0.0;
    for (const MeasuredBothWays& p : pairs_) measured = std::max(measured, p.skew());
    const auto at = [](double friction) { return fmt::format(" at mu = {:g}", friction); };
    add({.where = "Sec. 3.4: largest skew of the model",
         .paper = fmt::format("{:g} %", s_.largest_model_skew_percent),
         .finding = "its own equations, integrated, give more",
         .figures = {{"largest over Table 3.1" + at(s_.corrected_friction), "%",
                      percent(largest_model_skew(s_.corrected_friction)), 3},
                     {"largest over Table 3.1" + at(s_.map_friction), "%",
                      percent(largest_model_skew(s_.map_friction)), 3},
                     {fmt::format("largest of the map from {} to {} teeth", kMapFirst, kMapLast) +
                          at(s_.map_friction),
                      "%", percent(of_map), 3},
                     {"largest measured", "%", percent(measured), 1}}});
  }

  void add_corrected_model() {
    const PairLossModel& scale = model("refit_scale");
    const PairLossModel& friction = model("refit_friction");
    add({.where = "Sec. 3.4: corrected model",
         .paper = fmt::format("mu = {:g}, symmetric part plus {:g}, skew times {:g}: \"matches "
                              "closely\"",
                              s_.corrected_friction, s_.corrected_offset, s_.corrected_skew_factor),
         .finding = "least squares over Table 3.1 with as many parameters leave much less",
         .figures = {
             {"rms error as printed", "", model("corrected").rms_error, 4},
             {"rms error of the single-tooth model", "", model("single_tooth").rms_error, 4},
             {"refit: scale", "", scale.symmetric_scale, 3},
             {"offset", "", scale.offset, 3},
             {"skew factor", "", scale.skew_factor, 0},
             {"rms error", "", scale.rms_error, 4},
             {"refit: mu", "", friction.friction, 3},
             {"its offset", "", friction.offset, 3},
             {"its skew factor", "", friction.skew_factor, 0},
             {"its rms error", "", friction.rms_error, 4}}});
  }

  /// The fit of scale and offset with one skew for all pairs, as wrong torque constants would give.
  LeastSquares fit_with_constant_skew() const {
    const Parts parts = parts_of(sources_, s_.corrected_friction);
    Eigen::VectorXd sense(parts.skew.size());
    for (Eigen::Index k = 0; k < sense.size(); ++k) {
      const MeasuredPairLoss& m = sources_.measured[static_cast<std::size_t>(k)];
      sense[k] = m.driving_teeth > m.driven_teeth ? 1.0 : -1.0;
    }
    return fit_of_scale(parts, sense, measured_losses(sources_));
  }

  void add_skew_factor() {
    std::vector<Figure> figures;
    const auto least = std::ranges::min_element(pairs_, {}, &MeasuredBothWays::ratio);
    const auto most = std::ranges::max_element(pairs_, {}, &MeasuredBothWays::ratio);
    const auto skew_of = [](const MeasuredBothWays& p) {
      return Figure{.name = fmt::format("measured skew {} ({:g}:1)", p.name(), p.ratio()),
                    .unit = "",
                    .value = p.skew(),
                    .decimals = 4};
    };
    figures.push_back(skew_of(*least));
    figures.push_back(skew_of(*most));
    std::vector<int> pinions;
    for (const MeasuredBothWays& p : pairs_) {
      if (std::ranges::find(pinions, p.pinion()) == pinions.end()) {
        pinions.push_back(p.pinion());
      }
    }
    std::ranges::sort(pinions);
    for (const int pinion : pinions) {
      std::vector<MeasuredBothWays> own;
      std::ranges::copy_if(pairs_, std::back_inserter(own),
                           [&](const auto& p) { return p.pinion() == pinion; });
      if (own.size() < 2) continue;
      const auto [small, large] = std::ranges::minmax_element(own, {}, &MeasuredBothWays::gear);
      figures.push_back(
          {fmt::format("pinion {}: at gear {}", pinion, small->gear()), "", small->skew(), 4});
      figures.push_back(
          {fmt::format("pinion {}: at gear {}", pinion, large->gear()), "", large->skew(), 4});
    }
    double least_factor = std::numeric_limits<double>::infinity();
    double most_factor = -least_factor;
    for (const MeasuredBothWays& p : pairs_) {
      const double theory =
          efficiency::skew_loss(pair_of(s_, p.large_drives, s_.corrected_friction));
      least_factor = std::min(least_factor, p.skew() / theory);
      most_factor = std::max(most_factor, p.skew() / theory);
    }
    figures.push_back({"measured over model's skew, least", "", least_factor, 0});
    figures.push_back({"measured over model's skew, largest", "", most_factor, 0});
    figures.push_back({"rms error with scaled skew", "", model("refit_scale").rms_error, 4});
    figures.push_back(
        {"rms error with the same skew for all", "", fit_with_constant_skew().rms_error, 4});
    add({.where = "Sec. 3.4, 3.4.1: skew",
         .paper = fmt::format("{:g} times the model's, by a second tooth or something unmodeled",
                              s_.corrected_skew_factor),
         .finding = "a factor is no cause, and it is not the same for all pairs. On the whole the "
                    "measured skew grows with the ratio at a fixed pinion and falls with pinion "
                    "size; wrong torque constants of the two motors would give one skew for all",
         .figures = std::move(figures)});
  }

  void add_symmetric_part() {
    const auto count = static_cast<Eigen::Index>(pairs_.size());
    Eigen::VectorXd measured(count);
    Eigen::MatrixXd columns(count, 2);
    for (Eigen::Index k = 0; k < count; ++k) {
      const MeasuredBothWays& p = pairs_[static_cast<std::size_t>(k)];
      measured[k] = p.symmetric();
      columns(k, 0) =
          efficiency::symmetric_loss(pair_of(s_, p.large_drives, s_.corrected_friction));
      columns(k, 1) = 1.0;
    }
    const Eigen::Vector2d printed(s_.corrected_symmetric_scale, s_.corrected_offset);
    const LeastSquares fit = least_squares(columns, measured);
    add({.where = "Sec. 3.4: symmetric part",
         .paper = fmt::format("fits with scale {:g} and {:g} added, most likely Coulomb friction "
                              "in the bearings",
                              s_.corrected_symmetric_scale, s_.corrected_offset),
         .finding = "the least squares differ; and eq. 3.3 takes the loss from a slope, which a "
                    "constant friction torque does not change: only friction in proportion to load "
                    "can appear in it",
         .figures = {{"rms error as printed", "", rms(columns * printed - measured), 4},
                     {"refitted", "", fit.rms_error, 4},
                     {"scale", "", fit.coefficients[0], 3},
                     {"offset", "", fit.coefficients[1], 3}}});
  }

  void add_always_greater() {
    std::vector<Figure> figures{
        {"pairs measured both ways", "", static_cast<double>(pairs_.size()), 0}};
    int against = 0;
    std::vector<Figure> cases;
    for (const MeasuredBothWays& p : pairs_) {
      if (p.skew() > 0.0) continue;
      ++against;
      cases.push_back(
          {fmt::format("{} driving {}", p.gear(), p.pinion()), "", p.large_drives.loss, 3});
      cases.push_back(
          {fmt::format("{} driving {}", p.pinion(), p.gear()), "", p.small_drives.loss, 3});
    }
    figures.push_back(
        {"without greater loss when the larger drives", "", static_cast<double>(against), 0});
    figures.insert(figures.end(), cases.begin(), cases.end());
    add({.where = "Sec. 3.4.1",
         .paper = "the loss \"is always greater when the larger gear is driving\"",
         .finding = against > 0 ? "Table 3.1 has it reversed once the gears are nearer in size"
                                : "Table 3.1 agrees",
         .figures = std::move(figures)});
  }

  void add_small_skew() {
    std::vector<Figure> figures;
    for (const MeasuredBothWays& p : pairs_) {
      if (p.pinion() <= s_.small_skew_teeth) continue;
      figures.push_back({"measured skew " + p.name(), "%", percent(p.skew()), 2});
    }
    add({.where = "Sec. 3.4.1: larger gears",
         .paper = fmt::format("both gears above {} teeth: skew {:g} %", s_.small_skew_teeth,
                              s_.small_skew_percent),
         .finding = "all that was measured of such pairs",
         .figures = std::move(figures)});
  }

  /// The friction with which the single-tooth model gives a measured loss; NaN when none does.
  double explaining_friction(const MeasuredPairLoss& m) const {
    const auto excess = [&](double mu) {
      return efficiency::mean_torque_loss(pair_of(s_, m, mu)) - m.loss;
    };
    const double low = 0.0;
    const double high = 0.99 * largest_friction(s_);
    if (!(excess(low) <= 0.0 && excess(high) >= 0.0)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    std::uintmax_t steps = 200;
    return boost::math::tools::toms748_solve(excess, low, high,
                                             boost::math::tools::eps_tolerance<double>(), steps)
        .first;
  }

  void add_least_loss() {
    const auto [least, most] =
        std::ranges::minmax_element(sources_.measured, {}, &MeasuredPairLoss::loss);
    const auto name = [](const MeasuredPairLoss& m) {
      return fmt::format("{} driving {}", m.driving_teeth, m.driven_teeth);
    };
    add({.where = "Table 3.1, Sec. 3.1.2: range",
         .paper = fmt::format("losses of dry steel from {:g} to {:g}; current sensors off by up to "
                              "{:g} % before they were verified",
                              least->loss, most->loss, s_.sensor_sensitivity_error_percent),
         .finding =
             "no one friction comes near both: the least loss is far below the model's at the "
             "thesis's own value for dry steel, the largest far above. That points to an "
             "error of the torque ratio as large as the losses; no uncertainty is stated",
         .figures = {{"mu that gives " + name(*least), "", explaining_friction(*least), 3},
                     {"mu that gives " + name(*most), "", explaining_friction(*most), 3},
                     {fmt::format("model's loss of {} at mu = {:g}", name(*least), s_.map_friction),
                      "", efficiency::mean_torque_loss(pair_of(s_, *least, s_.map_friction)), 3},
                     {fmt::format("of {}", name(*most)), "",
                      efficiency::mean_torque_loss(pair_of(s_, *most, s_.map_friction)), 3}}});
  }

  const ThesisSources& sources_;
  const ThesisStatements& s_;
  const ThesisComparison& comparison_;
  std::vector<MeasuredBothWays> pairs_;
  std::vector<LedgerEntry> entries_;
};

}  // namespace

std::vector<LedgerEntry> thesis_ledger(const ThesisSources& sources,
                                       const ThesisComparison& comparison) {
  return ThesisLedger(sources, comparison).entries();
}

}  // namespace gear3k::papers
