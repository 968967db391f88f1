#pragma once

/// Distribution functions and quantiles, by Boost.Math, whose headers take long to compile.
namespace gear3k::numerics {

/// Half of the 95 % interval of a standard normal: x with P(X <= x) = 0.975
inline constexpr double kHalf95 = 1.959963984540054;

/// Lower tail of the standard normal, P(X <= x)
double normal_cdf(double x);

/// x with P(X <= x) = p of the standard normal
/// @param p  in (0, 1)
double normal_quantile(double p);

/// t with P(T <= t) = p of Student's t
/// @param p        in (0, 1)
/// @param degrees  of freedom, > 0
double student_quantile(double p, double degrees);

/// Upper tail P(F > f) of the F distribution
/// @param f  >= 0
/// @param degrees1, degrees2  of freedom of numerator and denominator, > 0
double f_upper_tail(double f, double degrees1, double degrees2);

/// f with P(F > f) = p of the F distribution
/// @param p  in (0, 1)
double f_upper_quantile(double p, double degrees1, double degrees2);

/// Q(a, x) = Γ(a, x) / Γ(a), the upper tail of chi square with 2 a degrees of freedom at 2 x
/// @param a  > 0
/// @param x  >= 0
double gamma_upper(double a, double x);

/// P(X = hit) of the hypergeometric distribution: of `drawn` out of `all`, those that are marked.
/// @param marked, drawn  0 to all
/// @returns 0 where so many cannot be
double hypergeometric_probability(int all, int marked, int drawn, int hit);

/// P(X >= count) of the binomial distribution
/// @param trials, count  0 or more
/// @param p  of each trial, in (0, 1)
double binomial_upper_tail(int trials, double p, int count);

/// Clopper-Pearson bounds of a proportion.
struct ProportionBounds {
  double lower, upper;
};
/// @param count  of `trials`, whole numbers
/// @param tail   probability beyond each bound
ProportionBounds binomial_bounds(double trials, double count, double tail);

}  // namespace gear3k::numerics
