#include "app/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "app/robust_run.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"
#include "report/result_tally.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::app {

MadeGearboxes make_gearboxes(io::SelectionFiles& files, optimize::Progress& progress) {
  MadeGearboxes made;
  auto& gearboxes = files.task.gearboxes;
  for (const auto& [file, spec] : files.tasks) {
    restart(progress);
    const optimize::OptimizeResult result = optimize::optimize(spec, progress);
    const std::size_t before = gearboxes.size();
    for (const optimize::RefinedSet& set : result.refined) {
      if (!optimize::has_design(set.status)) continue;
      actuator::CatalogueGearbox g;
      g.name = report::teeth_text(set.candidate.teeth);
      g.planets = set.candidate.planets;
      g.file = file;
      g.gearbox.ratio = train::ratio(set.candidate.teeth);
      g.gearbox.efficiency_forward = set.eta_f;
      g.gearbox.efficiency_backward = set.eta_b;
      g.inertia_known = optimize::knows_masses(spec);
      if (g.inertia_known) {
        g.gearbox.output_inertia_kgm2 = set.inertia_kgm2;
        g.gearbox.mass_kg = set.mass_kg;
      }
      g.continuous_Nm = g.intermittent_Nm = set.torque_capacity_Nm;
      made.gearboxes.push_back(
          {.gearbox = gearboxes.size(), .design = optimize::design_of(spec, set)});
      gearboxes.push_back(std::move(g));
    }
    if (progress.stop) break;
    if (gearboxes.size() > before) continue;
    made.blocked.push_back(
        fmt::format("{}: {}", file, report::blocking_text(spec, result, report::tally_of(result))));
  }
  return made;
}

void tell_apart(std::vector<actuator::CatalogueGearbox>& gearboxes) {
  std::map<std::string, std::vector<actuator::CatalogueGearbox*>> by_name;
  std::set<std::string> taken;
  for (actuator::CatalogueGearbox& g : gearboxes) {
    by_name[g.name].push_back(&g);
    taken.insert(g.name);
  }
  for (const auto& [name, group] : by_name) {
    if (group.size() < 2) continue;
    const auto differ = [&, &group = group](const auto& member) {
      return std::ranges::any_of(
          group, [&](const auto* g) { return g->*member != group.front()->*member; });
    };
    const bool files = differ(&actuator::CatalogueGearbox::file);
    const bool planets = differ(&actuator::CatalogueGearbox::planets);
    for (actuator::CatalogueGearbox* g : group) {
      if (files) g->name += '-' + std::filesystem::path(g->file).stem().string();
      if (planets && g->planets > 0) g->name += fmt::format("-{}planets", g->planets);
      const std::string own = g->name;
      for (int n = 2; !taken.insert(g->name).second; ++n) g->name = fmt::format("{}-{}", own, n);
    }
  }
}

}  // namespace gear3k::app
