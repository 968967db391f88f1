#include "numerics/distributions.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace gear3k::numerics {

double normal_cdf(double x) { return boost::math::cdf(boost::math::normal(), x); }

double normal_quantile(double p) { return boost::math::quantile(boost::math::normal(), p); }

double student_quantile(double p, double degrees) {
  return boost::math::quantile(boost::math::students_t(degrees), p);
}

double f_upper_tail(double f, double degrees1, double degrees2) {
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(degrees1, degrees2), f));
}

double f_upper_quantile(double p, double degrees1, double degrees2) {
  return boost::math::quantile(
      boost::math::complement(boost::math::fisher_f(degrees1, degrees2), p));
}

double gamma_upper(double a, double x) { return boost::math::gamma_q(a, x); }

double hypergeometric_probability(int all, int marked, int drawn, int hit) {
  if (hit < 0 || hit > marked || hit > drawn || drawn - hit > all - marked) return 0.0;
  const auto log_choices = [](int n, int k) {
    return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
  };
  return std::exp(log_choices(marked, hit) + log_choices(all - marked, drawn - hit) -
                  log_choices(all, drawn));
}

double binomial_upper_tail(int trials, double p, int count) {
  if (count <= 0) return 1.0;
  if (count > trials) return 0.0;
  return boost::math::ibeta(static_cast<double>(count), trials - count + 1.0, p);
}

ProportionBounds binomial_bounds(double trials, double count, double tail) {
  using boost::math::binomial;
  return {.lower = binomial::find_lower_bound_on_p(trials, count, tail),
          .upper = binomial::find_upper_bound_on_p(trials, count, tail)};
}

}  // namespace gear3k::numerics
