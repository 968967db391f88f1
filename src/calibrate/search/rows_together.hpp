#pragma once
// Rows far off that fall together: outliers are off singly, rows of one session or level that are
// off in the same sense are structure.

#include <Eigen/Core>
#include <optional>

namespace gear3k::calibrate {

/// Fewer rows than these tell no group from rows that are off singly.
inline constexpr int kFewestTogether = 3;

/// Rows of one group that are far off in the same sense.
struct RowsTogether {
  Eigen::Index group = 0;  ///< the column
  int off = 0;             ///< of them, in the same sense
  int rows = 0;            ///< of the group
  double p_value = 1.0;    ///< that any group has as many by luck
};

/// P that of `off` rows at random places among `rows`, each with a sign at random, at least `hit`
/// fall into a group of `size` rows with the same sign:
///
///   2 Σ_j C(size, j) C(rows − size, off − j)/C(rows, off) · P(Bin(j, 1/2) ≥ hit),  at most 1
///
/// Source: own derivation: hypergeometric places, signs by the coin.
double chance_together(int rows, int off, int size, int hit);

/// The group, of at most half of all rows, that is off as a whole: more than half of its rows are
/// far off in the same sense, three at least, or a third of them while all its rows together are
/// off in that sense by more than their own scatter.  Of several the one that luck makes least
/// often; each group of three rows and more is paid for.  Four fifths of the probability go to
/// chance_together(), the rest to its places alone beside Student's t of how far the group's rows
/// are off: few rows have few patterns of signs, but outliers do not agree in their size either.
/// @param residual  of rows that scatter alike; far off beyond ±kWinsor scale
/// @param groups    a column each: 0 outside, else the sense in which a row of it would be off
/// @returns empty where no group holds so many
std::optional<RowsTogether> rows_together(const Eigen::VectorXd& residual, double scale,
                                          const Eigen::MatrixXd& groups);

}  // namespace gear3k::calibrate
