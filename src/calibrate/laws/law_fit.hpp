#pragma once
// Values of a form's parameters: Gauss-Newton steps of all of them beside the hypothesis' own.

#include <Eigen/Core>
#include <vector>

#include "calibrate/laws/law_data.hpp"

namespace gear3k::calibrate {

/// Where the parameters of a factor begin among a trial's values, which hold the own ones.
std::size_t first_value(const LawTrial& t, std::size_t factor);

/// Fits trials to some of the rows with Huber's bound at `scale`.
class LawFit {
 public:
  /// @param scale  standard deviation of the whitened rows; 0: squares, without a bound
  LawFit(const LawData& data, double scale) : d_(data), scale_(scale) {}

  /// Whitened residual of all rows under a trial, and its derivatives by own parameters, amplitude,
  /// offset and the rest.
  struct At {
    Eigen::VectorXd residual;
    Eigen::MatrixXd jacobian;
  };
  [[nodiscard]] At at(const LawTrial& t) const;

  /// Σ ρ(r/s) over rows; Σ r² without a scale.
  [[nodiscard]] double sum_of(const Eigen::VectorXd& residual,
                              const std::vector<Eigen::Index>& in) const;

  /// Own parameters, amplitude and offset by least squares over rows, the others as they are; what
  /// the rows do not determine is 0.
  void start(LawTrial& t, const std::vector<Eigen::Index>& in) const;

  /// Gauss-Newton steps over rows; the sum goes into the trial.
  /// @returns the residual of all rows
  Eigen::VectorXd refine(LawTrial& t, const std::vector<Eigen::Index>& in) const;

  /// Other constants of a refined trial as long as one does better: widths by preferred numbers one
  /// by one, thresholds between any two values of the rows where the law acts, and pulses twice as
  /// often, up to twice the highest order that was looked through.
  void polish(LawTrial& t, const std::vector<Eigen::Index>& in) const;

  /// The residual of all rows with the own parameters alone, fitted over rows by the same loss.
  [[nodiscard]] Eigen::VectorXd without_law(const std::vector<Eigen::Index>& in) const;

 private:
  /// Refines another trial, which becomes this one where its sum is less.
  bool take_better(LawTrial& t, LawTrial other, const std::vector<Eigen::Index>& in) const;
  bool polish_step(LawTrial& t, std::size_t factor, const std::vector<Eigen::Index>& in) const;
  bool polish_width(LawTrial& t, std::size_t factor, const std::vector<Eigen::Index>& in) const;

  const LawData& d_;
  double scale_;
};

}  // namespace gear3k::calibrate
