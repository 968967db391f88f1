#pragma once
// What `diagnose` found, in words, as JSON and row by row.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/verdict/diagnosis.hpp"
#include "io/text/json.hpp"
#include "report/model_report.hpp"

namespace gear3k::report {

/// What a diagnosis was asked with, beside its data.
struct DiagnosisSetup {
  std::uint64_t seed = 1;
  double false_discovery_rate = 0.05;
  std::optional<ModelUse> model = std::nullopt;  ///< under the simulation
};

/// Of the kinds of data that were given, one by one; results and data go together by their place.
/// In plain words: how far off the simulation is, the causes and what else could explain as well,
/// evidence, residuals along the covariates, gain, what is left, the next experiment.
std::string diagnosis_table(const std::vector<calibrate::Diagnosis>& diagnoses,
                            const std::vector<calibrate::MeasurementSet>& sets,
                            const DiagnosisSetup& setup = {});

/// docs/interface.md, "diagnose".
io::Json diagnosis_json(const std::vector<calibrate::Diagnosis>& diagnoses,
                        const std::vector<calibrate::MeasurementSet>& sets,
                        const DiagnosisSetup& setup = {});

/// A row per measurement: where it stands, its condition, measured and simulated before and after.
std::string residual_csv(const std::vector<calibrate::Diagnosis>& diagnoses,
                         const std::vector<calibrate::MeasurementSet>& sets);

/// The worst of all: unexplained, ambiguous, explained, no_discrepancy.
calibrate::Verdict worst_verdict(const std::vector<calibrate::Diagnosis>& diagnoses);

/// "planet", "stage 1", or "" where a form concerns no body.
std::string place_text(const calibrate::Form& form);

/// What a form says beyond its cause: its name and constants, with the label of a run.
std::string form_text(const calibrate::Form& form, const std::vector<std::string>& runs);

/// Results and data must go together.
/// @throws std::invalid_argument when there are none, or numbers of results, data or rows differ
void require_matching(const std::vector<calibrate::Diagnosis>& diagnoses,
                      const std::vector<calibrate::MeasurementSet>& sets);

}  // namespace gear3k::report
