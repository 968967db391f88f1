#include "app/selection.hpp"

#include "app/robust_run.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::app {

std::vector<report::MadeGearbox> make_gearboxes(io::SelectionFiles& files,
                                                optimize::Progress& progress) {
  std::vector<report::MadeGearbox> made;
  auto& gearboxes = files.task.gearboxes;
  for (const optimize::Specification& spec : files.tasks) {
    restart(progress);
    const optimize::OptimizeResult result = optimize::optimize(spec, progress);
    for (const optimize::RefinedSet& set : result.refined) {
      if (!optimize::has_design(set.status)) continue;
      actuator::CatalogueGearbox g;
      g.name = report::teeth_text(set.candidate.teeth);
      g.gearbox.ratio = train::ratio(set.candidate.teeth);
      g.gearbox.efficiency_forward = set.eta_f;
      g.gearbox.efficiency_backward = set.eta_b;
      if (optimize::knows_masses(spec)) {
        g.gearbox.output_inertia_kgm2 = set.inertia_kgm2;
        g.gearbox.mass_kg = set.mass_kg;
      }
      g.continuous_Nm = g.intermittent_Nm = set.torque_capacity_Nm;
      made.push_back({.gearbox = gearboxes.size(), .design = optimize::design_of(spec, set)});
      gearboxes.push_back(std::move(g));
    }
    if (progress.stop) break;
  }
  return made;
}

}  // namespace gear3k::app
