#include "report/search_report.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "io/text/csv_table.hpp"
#include "io/text/json.hpp"
#include "optimize/cutter_choice.hpp"
#include "optimize/objective_value.hpp"
#include "report/actuator_report.hpp"
#include "report/certificate_report.hpp"
#include "report/display.hpp"
#include "report/fields.hpp"
#include "report/limits_report.hpp"
#include "report/relaxed_limits_report.hpp"
#include "report/text_table.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::report {

namespace {

using optimize::OptimizeResult, optimize::RefinedSet, optimize::Status, optimize::ZeroShiftSet,
    optimize::ToothSearchResult, optimize::Specification;

io::Json rejected_json(const ToothSearchResult& search) {
  io::Json rejected = io::Json::object();
  for (std::size_t k = 0; k < optimize::kToothRejectionCount; ++k) {
    rejected[std::string(optimize::kToothRejectionNames[k])] = search.rejected[k];
  }
  return rejected;
}

io::Json search_counts_json(const Specification& spec, const ToothSearchResult& search) {
  return {{"within_ratio", search.within_ratio},
          {"candidates", search.candidate_count()},
          {"rejected", rejected_json(search)},
          {"nearest_ratio", search.nearest_ratio != 0.0 ? io::Json(search.nearest_ratio) : nullptr},
          {"ratio_target", spec.ratio.target},
          {"ratio_tolerance", spec.ratio.tolerance}};
}

/// The numbers of an optimum, empty for a set without one.
class Optimum {
 public:
  Optimum(Fields& fields, bool any) : fields_(fields), any_(any) {}
  void add(const char* column, const io::Json& value) {
    fields_.add_row(any_ ? value : nullptr, {column});
  }
  template <class Names, class Values>
  void add_each(const Names& columns, const Values& values) {
    for (std::size_t k = 0; k < columns.size(); ++k) add(columns[k], values[k]);
  }

 private:
  Fields& fields_;
  bool any_;
};

constexpr std::array<const char*, train::kGearCount> kTeeth{"zS", "zP1", "zR1", "zP2", "zR2"};
constexpr std::array<const char*, train::kGearCount> kShifts{"xS", "xP1", "xR1", "xP2", "xR2"};
constexpr std::array<const char*, train::kGearCount> kTips{"kS", "kP1", "kR1", "kP2", "kR2"};
constexpr std::array<const char*, train::kMeshCount> kContactRatios{"eps1", "eps2", "eps3"};

/// Capacity over the mass of the gears [N m/kg].
std::optional<double> capacity_per_mass(const RefinedSet& s) {
  return s.torque_capacity_Nm ? std::optional(*s.torque_capacity_Nm / s.mass_kg) : std::nullopt;
}

/// Energy of the cycles with the best motor; empty where none drives the set within its limits.
void add_co_design(const RefinedSet& s, const actuator::CoDesign& co_design, Optimum& optimum) {
  std::optional<double> energy_J;
  std::string motor;
  if (optimize::has_design(s.status) && s.eta_b > 0.0) {
    const optimize::EnergyAt at =
        s.cycle_energy_J ? optimize::EnergyAt{.energy_J = *s.cycle_energy_J,
                                              .motor = s.motor,
                                              .within_limits = std::isfinite(*s.cycle_energy_J)}
                         : co_design.at({.ratio = train::ratio(s.candidate.teeth),
                                         .forward = s.eta_f,
                                         .backward = s.eta_b});
    if (at.within_limits) {
      energy_J = at.energy_J;
      motor = co_design.task().motors[at.motor].name;
    }
  }
  optimum.add(kCoDesignColumns[0], energy_J);
  optimum.add(kCoDesignColumns[1], motor);
}

/// The columns of refined.csv and pareto.csv.
/// @param bound  upper bound of eta_b; empty where there is none
Fields refined_fields(const RefinedSet& s, const std::optional<double>& bound,
                      const RefinedColumns& columns) {
  Fields f;
  const train::ToothSet& teeth = s.candidate.teeth;
  for (std::size_t k = 0; k < kTeeth.size(); ++k) {
    f.add_row(train::teeth_of(teeth)[k], {kTeeth[k]});
  }
  f.add_row(optimize::kStatusNames[static_cast<std::size_t>(s.status)], {"status"});
  f.add_row(reason_of(s), {"reason"});
  f.add_row(train::ratio(teeth), {"ratio"});
  Optimum optimum(f, optimize::has_design(s.status));
  optimum.add("eta_b", s.eta_b);
  optimum.add("eta_f", s.eta_f);
  optimum.add("backlash_arcmin", arcmin(s.lost_motion_rad));
  optimum.add_each(kShifts, s.train.profile_shift);
  optimum.add("m1_mm", mm(s.train.module_m[0]));
  optimum.add("m2_mm", mm(s.train.module_m[1]));
  optimum.add("center_distance_mm", mm(s.train.center_distance_m));
  optimum.add_each(kContactRatios, s.contact_ratio);
  f.add_row(bound, {"eta_b_bound"});
  optimum.add("kkt_residual", std::isfinite(s.kkt_residual) ? io::Json(s.kkt_residual) : nullptr);
  f.add_row(s.candidate.planets, {"planets"});
  optimum.add("ring_root_diameter_mm", mm(s.ring_root_diameter_m));
  const double violation = s.blocked_by.empty() ? 0.0 : s.blocked_by.front().violation;
  f.add_row(violation > 0.0 ? io::Json(violation) : nullptr, {"violation"});
  if (columns.model) {
    optimum.add("eta_b_model", s.eta_b_model);
    optimum.add("eta_f_model", s.eta_f_model);
  }
  if (columns.tips) optimum.add_each(kTips, s.train.tip_shortening);
  if (columns.pressure_angle) {
    optimum.add("pressure_angle_deg", degrees(s.train.pressure_angle_rad));
  }
  if (columns.masses) {
    optimum.add("mass_kg", s.mass_kg);
    optimum.add("inertia_kgm2", s.inertia_kgm2);
  }
  if (columns.strength) {
    optimum.add("b1_mm", mm(s.train.face_width_m[0]));
    optimum.add("b2_mm", mm(s.train.face_width_m[1]));
    optimum.add("torque_capacity_nm", s.torque_capacity_Nm);
    optimum.add("torsional_stiffness_nm_per_rad", s.torsional_stiffness_Nm_rad);
  }
  if (columns.strength && columns.masses) {
    optimum.add("torque_density_nm_per_kg", capacity_per_mass(s));
  }
  if (columns.cutters) {
    optimum.add("cutter_R1_teeth", s.train.cutter_teeth[0]);
    optimum.add("cutter_R2_teeth", s.train.cutter_teeth[1]);
  }
  if (columns.co_design != nullptr) add_co_design(s, *columns.co_design, optimum);
  if (columns.grid) f.add_row(s.grid_cut, {"grid_cut"});
  return f;
}

Fields refined_fields(const OptimizeResult& result, const RefinedSet& s,
                      const RefinedColumns& columns) {
  const bool bounded = s.status != Status::kInfeasible && result.bounds != nullptr &&
                       result.bounds->of(s.index).known;
  return refined_fields(s, bounded ? std::optional(result.bounds->of(s.index).eta_b) : std::nullopt,
                        columns);
}

std::string refined_row(const OptimizeResult& result, const RefinedSet& s,
                        const RefinedColumns& columns) {
  return refined_fields(result, s, columns).csv_values();
}

/// A set to ask for the names of its columns: teeth that have a ratio, and nothing else.
RefinedSet nameless_set() {
  RefinedSet set;
  set.candidate.teeth = {.S = 1, .P1 = 2, .R1 = 1, .P2 = 1, .R2 = 1};
  return set;
}

std::string refined_header(const RefinedColumns& columns) {
  return refined_fields(nameless_set(), std::nullopt, columns).csv_header();
}

}  // namespace

std::string objective_line(const Specification& spec, const RefinedSet& best) {
  using optimize::Objective;
  const Objective first = optimize::first_objective(spec);
  if (first == Objective::kBackwardEfficiency || first == Objective::kForwardEfficiency) return "";
  const optimize::ObjectiveRecord& record = optimize::objective_record(first);
  return fmt::format("\nBest {}: {:.5g}{}{}\n", record.title,
                     optimize::objective_of(spec, best, first) / record.per_unit,
                     record.unit.empty() ? "" : " ", record.unit);
}

std::string search_counts_text(const Specification& spec, const ToothSearchResult& search) {
  std::string text =
      fmt::format("{} tooth sets within {:g} % of {:g}:1; {} candidates", search.within_ratio,
                  100.0 * spec.ratio.tolerance, spec.ratio.target, search.candidate_count());
  for (std::size_t k = 0; k < optimize::kToothRejectionCount; ++k) {
    if (search.rejected[k] == 0) continue;
    text +=
        fmt::format(", {} rejected by {}", search.rejected[k], optimize::kToothRejectionNames[k]);
  }
  if (search.interrupted) text += "; so far: stopped before all tooth numbers were searched";
  return text + "\n";
}

std::string search_table(const Specification& spec, const ToothSearchResult& search,
                         optimize::ZeroShiftRanking& ranking) {
  std::string text = search_counts_text(spec, search);
  // A length thins teeth by an angle that depends on the module.
  text += fmt::format(
      "At zero profile shift, P1-R1 and P2-R2 closed{} (before refinement; * = a mesh interferes "
      "or has a contact ratio below 1 there):\n",
      optimize::thinning_varies(spec) ? ", A_sn_um at the least module" : "");
  TextTable table({"S/P1/R1/P2/R2", "planets", "ratio", "eta backward", "eta forward",
                   "lost motion", "eps S-P1", "eps P1-R1", "eps P2-R2", "m2/m1"});
  std::size_t rows = 0;
  ranking.for_each([&](const ZeroShiftSet& s) {
    ++rows;
    const auto percent = [&](double eta) {
      if (!s.defined) return std::string("-");
      return eta > 0.0 ? fmt::format("{:.2f} %", 100.0 * eta) : std::string("locks");
    };
    const auto contact_ratio = [&](std::size_t mesh) {
      return s.defined ? fixed(s.contact_ratio.at(mesh), 2) : "-";
    };
    table.add({teeth_text(s.candidate.teeth) + (s.meshes ? "" : " *"),
               fmt::format("{}", s.candidate.planets), fmt::format("{:.4f}", s.ratio),
               percent(s.eta_b), percent(s.eta_f),
               s.defined ? fixed(arcmin(s.lost_motion_rad), 2) + " arcmin" : "-", contact_ratio(0),
               contact_ratio(1), contact_ratio(2), fmt::format("{:.4f}", s.module_ratio)});
  });
  text += table.text(2);
  if (ranking.added() > rows) {
    text += fmt::format("  ... and {} more (--top N, or --format csv for all)\n",
                        ranking.added() - rows);
  }
  return text;
}

namespace {

/// A tooth set at zero profile shift: an item of the JSON, a line of the CSV.
Fields zero_shift_fields(const ZeroShiftSet& s) {
  Fields f;
  const auto teeth = train::teeth_of(s.candidate.teeth);
  for (std::size_t k = 0; k < teeth.size(); ++k) f.append("teeth", teeth[k], {kTeeth[k]});
  f.add("planets", s.candidate.planets, {"planets"});
  f.add("ratio", s.ratio, {"ratio"});
  f.add("module_ratio", s.module_ratio, {"module_ratio"});
  f.add("meshes", s.meshes, {"meshes"});
  const auto number = [&](double x) { return s.defined ? io::Json(x) : nullptr; };
  f.add("eta_b", number(s.eta_b), {"eta_b"});
  f.add("eta_f", number(s.eta_f), {"eta_f"});
  f.add("backlash_arcmin", number(arcmin(s.lost_motion_rad)), {"backlash_arcmin"});
  f.add("sun_backlash_modules", number(s.sun_backlash), {"sun_backlash_modules"});
  f.add("contact_ratio", s.defined ? io::Json(s.contact_ratio) : nullptr);
  for (std::size_t k = 0; k < s.contact_ratio.size(); ++k) {
    f.add_row(number(s.contact_ratio[k]), {kContactRatios[k]});
  }
  return f;
}

}  // namespace

void write_search_csv(optimize::ZeroShiftRanking& ranking,
                      const std::function<void(std::string_view)>& out) {
  out(zero_shift_fields({}).csv_header());
  ranking.for_each([&](const ZeroShiftSet& s) { out(zero_shift_fields(s).csv_values()); });
}

void write_search_json(const Specification& spec, const ToothSearchResult& search,
                       optimize::ZeroShiftRanking& ranking,
                       const std::function<void(std::string_view)>& out) {
  const io::Json head{{"tool", tool_json()},
                      {"name", spec.name},
                      {"search", search_counts_json(spec, search)},
                      {"sets", io::Json::array()}};
  // The document as if it were made at once, cut open at its empty list.
  std::string text = head.text();
  text.resize(text.rfind(']'));
  out(text);
  bool first = true;
  ranking.for_each([&](const ZeroShiftSet& s) {
    std::string body = zero_shift_fields(s).json().text();
    body.pop_back();  // the line end of a file
    std::string piece = first ? "\n    " : ",\n    ";
    for (const char c : body) {
      piece += c;
      if (c == '\n') piece += "    ";
    }
    out(piece);
    first = false;
  });
  out(first ? "]\n}\n" : "\n  ]\n}\n");
}

RefinedColumns refined_columns(const Specification& spec) {
  return {.model = spec.model.has_value(),
          .tips = spec.free.tip_shortening.has_value(),
          .pressure_angle = spec.free.pressure_angle_rad.has_value(),
          .masses = optimize::knows_masses(spec),
          .strength = spec.rating.has_value(),
          .grid = spec.shift_step.has_value(),
          .cutters = optimize::cutter_choices(spec).size() > 1,
          .co_design = actuator::co_design_of(spec.cycle_energy.get())};
}

std::vector<std::string> refined_column_names(const RefinedColumns& columns) {
  const std::string header = refined_header(columns);
  io::CsvFields fields;
  fields.split(std::string_view(header).substr(0, header.find('\n')));
  return {fields.values().begin(), fields.values().end()};
}

std::vector<FieldRow> refined_values(const OptimizeResult& result, const RefinedSet& set,
                                     const RefinedColumns& columns) {
  return refined_fields(result, set, columns).rows();
}

void write_refined_csv(const OptimizeResult& result, const RefinedColumns& columns,
                       const std::function<void(std::string_view)>& out) {
  out(refined_header(columns));
  optimize::for_each_set(result, [&](std::size_t, const std::optional<RefinedSet>& set) {
    if (set) out(refined_row(result, *set, columns));
  });
}

std::string pareto_csv(const OptimizeResult& result, const RefinedColumns& columns) {
  std::string text = refined_header(columns);
  for (const std::size_t k : result.pareto) {
    text += refined_row(result, result.refined[k], columns);
  }
  return text;
}

std::string front_file_name(std::size_t row) { return fmt::format("front_{:02}.toml", row + 1); }

std::string pareto_csv(const Specification& spec, const optimize::ParetoFront& front) {
  const RefinedColumns columns = refined_columns(spec);
  const auto point_fields = [&](const optimize::ParetoPoint& point, std::size_t row) {
    Fields f = refined_fields(point.set, std::nullopt, columns);
    for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
      const optimize::ObjectiveRecord& record = optimize::objective_record(spec.objectives[k]);
      f.add_row(point.values[k] / record.per_unit,
                {fmt::format("objective_{}{}{}", record.name, record.unit.empty() ? "" : "_",
                             record.unit)});
    }
    f.add_row(front_file_name(row), {"design_file"});
    return f;
  };
  const optimize::ParetoPoint nameless{.set = nameless_set(),
                                       .values = std::vector<double>(spec.objectives.size())};
  std::string text = point_fields(nameless, 0).csv_header();
  for (std::size_t row = 0; row < front.points.size(); ++row) {
    text += point_fields(front.points[row], row).csv_values();
  }
  return text;
}

namespace {

/// Why the search of a front ended.
std::string ended_text(const Specification& spec, const optimize::ParetoFront& front) {
  using Ended = optimize::ParetoFront::Ended;
  switch (front.ended) {
    case Ended::kDesigns:
      return "as many as were asked for";
    case Ended::kFound:
      return fmt::format("of {} asked for: less than {:g} % is missing", spec.pareto_points,
                         100.0 * optimize::kFrontFound);
    case Ended::kSearches:
      return fmt::format("of {} asked for: {} searches for each made", spec.pareto_points,
                         optimize::kMostSearches);
    case Ended::kBudget:
      return fmt::format("of {} asked for: its time was spent", spec.pareto_points);
    case Ended::kInterrupted:
      return fmt::format("of {} asked for: stopped", spec.pareto_points);
    case Ended::kNoEnds:
      break;
  }
  return "an objective alone has no design";
}

}  // namespace

std::string pareto_table(const Specification& spec, const optimize::ParetoFront& front) {
  std::vector<std::string> head{"S/P1/R1/P2/R2", "planets", "ratio"};
  for (const optimize::Objective objective : spec.objectives) {
    const optimize::ObjectiveRecord& record = optimize::objective_record(objective);
    head.push_back(record.unit.empty() ? std::string(record.title)
                                       : fmt::format("{} [{}]", record.title, record.unit));
  }
  TextTable table(std::move(head));
  for (const optimize::ParetoPoint& point : front.points) {
    const train::ToothSet& z = point.set.candidate.teeth;
    std::vector<std::string> row{teeth_text(z), fmt::format("{}", point.set.candidate.planets),
                                 fmt::format("{:.4f}", train::ratio(z))};
    for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
      row.push_back(fmt::format(
          "{:.5g}", point.values[k] / optimize::objective_record(spec.objectives[k]).per_unit));
    }
    table.add(std::move(row));
  }
  return fmt::format(
      "\nPareto front: {} designs from {} searches of all sets ({})\n"
      "  of the box between the best of each objective alone and the worst of the others' "
      "best designs\n"
      "  they dominate {:.2f} %, others may dominate {:.2f} % more\n{}{}",
      front.points.size(), front.searches, ended_text(spec, front), 100.0 * front.hypervolume,
      100.0 * front.missing, table.text(2), grid_cuts_text(spec, front.grid_cut));
}

namespace {

io::Json front_json(const Specification& spec, const optimize::ParetoFront& front) {
  io::Json objectives = io::Json::array();
  for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
    const optimize::ObjectiveRecord& record = optimize::objective_record(spec.objectives[k]);
    io::Json entry{{"name", record.name}, {"unit", record.unit}, {"maximise", record.maximise}};
    const bool known = !front.ideal.empty();
    entry["ideal"] = known ? io::Json(front.ideal[k] / record.per_unit) : nullptr;
    entry["reference"] = known ? io::Json(front.reference[k] / record.per_unit) : nullptr;
    entry["box_best"] = known ? io::Json(front.box_best[k] / record.per_unit) : nullptr;
    entry["box_worst"] = known ? io::Json(front.box_worst[k] / record.per_unit) : nullptr;
    objectives.push_back(std::move(entry));
  }
  io::Json files = io::Json::array();
  for (std::size_t row = 0; row < front.points.size(); ++row) files.push_back(front_file_name(row));
  return {{"objectives", std::move(objectives)},
          {"designs", front.points.size()},
          {"asked", spec.pareto_points},
          {"ended", optimize::kFrontEndedNames[static_cast<std::size_t>(front.ended)]},
          {"searches", front.searches},
          {"hypervolume", front.hypervolume},
          {"missing", front.missing},
          {"grid_cut", front.grid_cut},
          {"design_files", std::move(files)}};
}

}  // namespace

io::Json summary_json(const Specification& spec, const OptimizeResult& result,
                      const ResultTally& tally, const RunFacts& facts, const ModelUse* model,
                      const optimize::ParetoFront* front, const RobustRun* robust,
                      const ModelComparison* comparison, const design::Limits* stated_limits,
                      const HeldBackReport* held, const optimize::Rounding* rounding,
                      const CoDesignReport* co_design,
                      const std::vector<actuator::LimitCheck>* felt,
                      const optimize::RelaxedLimits* relaxed) {
  io::Json status = io::Json::object();
  io::Json reasons = io::Json::object();
  for (std::size_t k = 0; k < optimize::kStatusCount; ++k) {
    const auto s = static_cast<Status>(k);
    status[std::string(optimize::kStatusNames[k])] = tally.status[k];
    if (optimize::has_design(s) || s == Status::kBounded) continue;
    io::Json by_reason = io::Json::object();
    for (const auto& [reason, count] : tally.reasons[k]) by_reason[reason] = count;
    reasons[std::string(optimize::kStatusNames[k])] = std::move(by_reason);
  }
  io::Json best = nullptr;
  if (result.best) {
    const RefinedSet& s = *result.best;
    best = {{"teeth", train::teeth_of(s.candidate.teeth)},
            {"planets", s.candidate.planets},
            {"ratio", train::ratio(s.candidate.teeth)},
            {"eta_b", s.eta_b},
            {"eta_f", s.eta_f},
            {"backlash_arcmin", arcmin(s.lost_motion_rad)},
            {"kkt_residual", s.kkt_residual}};
    if (spec.rating) {
      best["torque_capacity_nm"] = s.torque_capacity_Nm;
      best["torsional_stiffness_nm_per_rad"] = s.torsional_stiffness_Nm_rad;
      if (optimize::knows_masses(spec)) best["torque_density_nm_per_kg"] = capacity_per_mass(s);
    }
    if (model != nullptr) {
      best["eta_b_model"] = s.eta_b_model;
      best["eta_f_model"] = s.eta_f_model;
    }
  }
  io::Json json{{"tool", tool_json()},
                {"name", spec.name},
                {"objective", optimize::objective_record(optimize::first_objective(spec)).name},
                {"refine", optimize::kRefineNames[static_cast<std::size_t>(spec.solver.refine)]},
                {"starts", spec.solver.starts},
                {"seed", spec.solver.seed},
                {"search", search_counts_json(spec, result.search)},
                {"refined", result.refined.size()},
                {"grid_cut", tally.grid_cut},
                {"refinements", tally.refinements},
                {"relaxations", tally.relaxations},
                {"status", std::move(status)},
                {"reasons", std::move(reasons)},
                {"best", std::move(best)},
                {"certificate", certificate_json(spec, result)},
                {"pareto", front != nullptr ? front->points.size() : result.pareto.size()},
                {"pareto_front", front != nullptr ? front_json(spec, *front) : nullptr},
                {"interrupted", facts.interrupted},
                {"task_fingerprint", facts.task_fingerprint},
                {"wall_time_s", facts.wall_time_s},
                {"threads", facts.threads}};
  json["limits"] =
      limits_json(stated_limits != nullptr ? *stated_limits : spec.limits, limits_subject(spec));
  json["relaxed_limits"] =
      relaxed != nullptr ? relaxed_limits_json(spec, *relaxed) : io::Json(nullptr);
  json["relaxed_limits_missing"] =
      facts.not_relaxed.empty() ? io::Json(nullptr) : io::Json(facts.not_relaxed);
  if (held != nullptr) json.update(held_back_json(spec, *held));
  if (co_design != nullptr) json["co_design"] = co_design_json(*co_design);
  if (felt != nullptr && !felt->empty()) json["felt"] = limit_checks_json(*felt);
  json["notes"] = spec.notes;
  json["rounded"] = nullptr;
  const std::string unread = unread_steps_text(spec);
  json["rounded_missing"] =
      rounding != nullptr || unread.empty() ? io::Json(nullptr) : io::Json(unread);
  if (rounding != nullptr && result.best) {
    const double free_objective =
        optimize::objective_of(spec, *result.best, optimize::first_objective(spec));
    json["rounded"] = rounding_json(spec, free_objective, *rounding);
  }
  if (robust != nullptr) json["robust"] = robust_json(spec, *robust);
  if (spec.rating && spec.rating->factors.held_mesh_load) {
    json["k_gamma"] = *spec.rating->factors.held_mesh_load;
  }
  if (model != nullptr) json["model"] = model_json(*model);
  json["model_change"] = comparison != nullptr ? model_change_json(*comparison) : io::Json(nullptr);
  if (comparison != nullptr && !comparison->change) {
    json["model_change_missing"] = comparison->missing;
  }
  return json;
}

}  // namespace gear3k::report
