// What the thesis says of dynamics and design, beside what its bench gives.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "papers/directional_bench.hpp"
#include "report/display.hpp"

namespace gear3k::papers {

namespace {

using report::mm, report::percent;

std::string felt_name(const FeltGears& g) { return fmt::format("{}/{}", g.gear, g.pinion); }

double added_loss(const FeltGears& g) { return g.forward - g.backward; }

LedgerEntry power_state(const DirectionalBenchSources& sources, const DirectionalBench& bench) {
  return {.where = "Sec. 2.2: eqs. 2.6, 2.7",
          .paper =
              "\"switched depending on the power transfer state\"; with a motor on side 1 "
              "\"analogous to acceleration and braking of a load\"",
          .finding = fmt::format(
              "both equations agree with the mesh's law once its torque tells the flow, which the "
              "thesis leaves open; the sign of the motor's power does not: its own drag brakes the "
              "load too. Figures: the motor's torque {:g} N m cos(2 pi {:g} Hz t)",
              sources.braking.command.amplitude, sources.braking.command.frequency_Hz),
          .figures = {{"flow backward", "% of the time", percent(bench.braking.backward_share), 1},
                      {"of all time the motor gives power meanwhile", "%",
                       percent(bench.braking.opposite_share), 1}}};
}

LedgerEntry fixed_efficiency(const DirectionalBench& bench) {
  const auto asymmetry = [](const FeltGears& g) { return 1.0 / (g.forward * g.backward); };
  const auto [least, most] = std::ranges::minmax_element(bench.felt, {}, asymmetry);
  return {.where = "Abstract: fixed efficiency",
          .paper = "one efficiency for all conditions \"can result in significant error\"",
          .finding =
              "for the same load sped up and braked, with the mean of both efficiencies in "
              "place of either: the speed differs by a few per cent. What is felt pushed in "
              "over let out, a spring or the motor's inertia, differs by 1/(eta_f eta_b)",
          .figures = {{"rms difference over rms speed", "%", percent(bench.braking.speed_error), 1},
                      {"1/(eta_f eta_b), least " + felt_name(*least), "", asymmetry(*least), 3},
                      {"greatest " + felt_name(*most), "", asymmetry(*most), 3}}};
}

LedgerEntry largest_asymmetry(const ThesisStatements& s, const DirectionalBench& bench) {
  const auto most = std::ranges::max_element(bench.felt, {}, added_loss);
  const FeltGears& named = gears_of(bench.felt, 16, 120);
  const FeltGears& small = gears_of(bench.felt, 30, 120);
  // Two stages of a pair: efficiencies multiply.
  const double two = most->forward * most->forward - most->backward * most->backward;
  return {.where = "Secs. 3.4.1, 4.1; abstract: asymmetry",
          .paper = fmt::format("up to {:g} % (16 and 120 teeth), {:g} % with 30 and 120; with more "
                               "stages \"further amplified\"",
                               s.largest_asymmetry_percent, s.smaller_asymmetry_percent),
          .finding =
              "Table 3.1 agrees; it has as much with 16 and 100. Efficiencies of stages multiply: "
              "the difference of two "
              "equal stages is less than twice that of one, the ratio 1/(eta_f eta_b) of "
              "what is felt its square",
          .figures = {{"greatest, " + felt_name(*most), "%", percent(added_loss(*most)), 1},
                      {felt_name(named), "%", percent(added_loss(named)), 1},
                      {felt_name(small), "%", percent(added_loss(small)), 1},
                      {"two stages of " + felt_name(*most), "%", percent(two), 1},
                      {"felt pushed in over let out", "",
                       1.0 / std::pow(most->forward * most->backward, 2), 3}}};
}

LedgerEntry larger_gears(const DirectionalBench& bench) {
  std::vector<Figure> figures;
  for (const auto& [pinion, gear] : {std::pair{16, 80}, {20, 100}, {24, 120}}) {
    const FeltGears& g = gears_of(bench.felt, pinion, gear);
    figures.push_back({felt_name(g) + ": loss driving", "", 1.0 - g.forward, 3});
    figures.push_back({felt_name(g) + ": driven", "", 1.0 - g.backward, 3});
  }
  return {.where = "Sec. 4.2: larger gears",
          .paper = "\"larger gears can reduce overall friction loss\"",
          .finding =
              "at one ratio, 5:1, Table 3.1 has it so for the largest gears alone: the "
              "middle ones lose most in both directions",
          .figures = std::move(figures)};
}

LedgerEntry closer_sizes(const DirectionalBench& bench) {
  const auto [near, far] = std::ranges::minmax_element(bench.felt, {}, &FeltGears::ratio);
  return {.where = "Sec. 4.2: sizes more closely matched",
          .paper = "they \"reduce the amount of added friction loss in the backdriving direction\"",
          .finding =
              "so they do, but the impedance at the output comes first of all from the "
              "ratio's square, which closer sizes lower with the torque",
          .figures = {{felt_name(*near) + ": added loss", "%", percent(added_loss(*near)), 1},
                      {felt_name(*far) + ": added loss", "%", percent(added_loss(*far)), 1},
                      {felt_name(*near) + ": felt inertia, sped up", "1e-6 kg m2",
                       1e6 * near->speeding_up_kgm2, 1},
                      {felt_name(*far) + ": felt inertia, sped up", "1e-6 kg m2",
                       1e6 * far->speeding_up_kgm2, 1},
                      {"of the latter by the loss", "%",
                       percent(1.0 - far->plain_kgm2 / far->speeding_up_kgm2), 1}}};
}

LedgerEntry trade_off(const DirectionalBench& bench) {
  return {.where = "Sec. 3.4.1: trade-off",
          .paper =
              "\"between the impedance of larger gear inertia and directional loss\"; no "
              "figure, no face width",
          .finding =
              "at 5:1 the inertia felt when sped up is less with 24 and 120 teeth than with "
              "16 and 80 only up to a face width, for the motor of the bench and gears as "
              "solid discs of steel",
          .figures = {{"face width", "mm", mm(bench.even_width_m), 2}}};
}

}  // namespace

std::vector<LedgerEntry> directional_bench_ledger(const ThesisSources& thesis,
                                                  const DirectionalBenchSources& sources,
                                                  const DirectionalBench& bench) {
  std::vector<LedgerEntry> entries{power_state(sources, bench),
                                   fixed_efficiency(bench),
                                   largest_asymmetry(thesis.statements, bench),
                                   larger_gears(bench),
                                   closer_sizes(bench),
                                   trade_off(bench)};
  for (std::size_t k = 0; k < entries.size(); ++k) entries[k].number = static_cast<int>(k) + 1;
  return entries;
}

}  // namespace gear3k::papers
