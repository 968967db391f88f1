#include "optimize/ipopt.hpp"

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <mutex>

#include "optimize/gradients.hpp"

namespace gear3k::optimize {

namespace {

using Ipopt::Index;
using Ipopt::Number;

/// One refinement problem as Ipopt reads it: dense Jacobian, dense lower triangle of the Hessian.
class RefinementNlp : public Ipopt::TNLP {
 public:
  RefinementNlp(const RefinementProblem& problem, const Point& start)
      : problem_(problem),
        n_(static_cast<std::size_t>(problem.variables)),
        start_(start),
        end_(start),
        g_(problem.rows.size()),
        rows_(all_rows(problem)),
        g2_(problem.rows.size()) {}

  [[nodiscard]] const Point& end() const { return end_; }

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag,
                    IndexStyleEnum& index_style) override {
    n = static_cast<Index>(n_);
    m = static_cast<Index>(g_.size());
    nnz_jac_g = n * m;
    nnz_h_lag = n * (n + 1) / 2;
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l,
                       Number* g_u) override {
    constexpr double kInfinity = 2e19;  // Ipopt's default nlp_upper_bound_inf is 1e19
    std::copy_n(problem_.lower.begin(), n, x_l);
    std::copy_n(problem_.upper.begin(), n, x_u);
    std::fill_n(g_l, m, 0.0);
    std::fill_n(g_u, m, kInfinity);
    return true;
  }

  bool get_starting_point(Index n, bool /*init_x*/, Number* x, bool /*init_z*/, Number* /*z_L*/,
                          Number* /*z_U*/, Index /*m*/, bool /*init_lambda*/,
                          Number* /*lambda*/) override {
    std::copy_n(start_.begin(), n, x);
    return true;
  }

  bool eval_f(Index /*n*/, const Number* x, bool /*new_x*/, Number& value) override {
    const auto f = evaluate<double>(problem_, std::span<const double>(x, n_), g_);
    if (f) value = *f;
    return f.has_value();
  }

  bool eval_grad_f(Index n, const Number* x, bool /*new_x*/, Number* gradient) override {
    if (!evaluate_gradients(problem_, {x, n_}, rows_, first_)) return false;
    std::copy_n(first_.df.begin(), n, gradient);
    return true;
  }

  bool eval_g(Index /*n*/, const Number* x, bool /*new_x*/, Index /*m*/, Number* g) override {
    if (!evaluate<double>(problem_, std::span<const double>(x, n_), g_)) return false;
    std::copy(g_.begin(), g_.end(), g);
    return true;
  }

  bool eval_jac_g(Index n, const Number* x, bool /*new_x*/, Index m, Index /*nnz*/, Index* row,
                  Index* column, Number* values) override {
    if (values == nullptr) {
      for (Index i = 0; i < m; ++i) {
        for (Index j = 0; j < n; ++j) {
          *row++ = i;
          *column++ = j;
        }
      }
      return true;
    }
    if (!evaluate_gradients(problem_, {x, n_}, rows_, first_)) return false;
    std::copy(first_.dg.begin(), first_.dg.end(), values);
    return true;
  }

  bool eval_h(Index n, const Number* x, bool /*new_x*/, Number obj_factor, Index /*m*/,
              const Number* lambda, bool /*new_lambda*/, Index /*nnz*/, Index* row, Index* column,
              Number* values) override {
    if (values == nullptr) {
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j <= i; ++j) {
          *row++ = i;
          *column++ = j;
        }
      }
      return true;
    }
    // Blocks of kMaxVariables by kMaxVariables of the lower triangle.
    for (Index rows = 0; rows < n; rows += kMaxVariables) {
      for (Index columns = 0; columns <= rows; columns += kMaxVariables) {
        if (!add_hessian_block(x, {rows, columns}, obj_factor, lambda, values)) return false;
      }
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn /*status*/, Index n, const Number* x,
                         const Number* /*z_L*/, const Number* /*z_U*/, Index /*m*/,
                         const Number* /*g*/, const Number* /*lambda*/, Number /*obj_value*/,
                         const Ipopt::IpoptData* /*data*/,
                         Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {
    for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
      end_[k] = std::clamp(x[k], problem_.lower[k], problem_.upper[k]);
    }
  }

 private:
  static std::size_t at(Index k) { return static_cast<std::size_t>(k); }
  /// First row and first column of a block.
  struct Block {
    Index row, column;
  };
  bool add_hessian_block(const Number* x, const Block& block, Number obj_factor,
                         const Number* lambda, Number* values) {
    const auto n = static_cast<Index>(n_);
    const Index rows = std::min<Index>(kMaxVariables, n - block.row);
    const Index columns = std::min<Index>(kMaxVariables, n - block.column);
    std::array<Jet2, kMostUnknowns> jets;
    for (Index k = 0; k < n; ++k) {
      Jet2& jet = jets[at(k)];
      jet = Jet2(x[k]);
      if (k >= block.row && k < block.row + rows) jet.by_row[at(k - block.row)] = 1.0;
      if (k >= block.column && k < block.column + columns) {
        jet.by_column[at(k - block.column)] = 1.0;
      }
    }
    const auto f = evaluate<Jet2>(problem_, used(problem_, jets), g2_);
    if (!f) return false;
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < columns && block.column + j <= block.row + i; ++j) {
        double sum = obj_factor * f->mixed[at(i)][at(j)];
        for (std::size_t k = 0; k < g2_.size(); ++k) sum += lambda[k] * g2_[k].mixed[at(i)][at(j)];
        const Index row = block.row + i;
        values[row * (row + 1) / 2 + block.column + j] = sum;
      }
    }
    return true;
  }

  const RefinementProblem& problem_;
  std::size_t n_;
  Point start_, end_;
  std::vector<double> g_;
  std::vector<std::uint16_t> rows_;
  Gradients first_;
  std::vector<Jet2> g2_;
};

}  // namespace

SolveOutcome solve_ipopt(const RefinementProblem& problem, const Point& start) {
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
  application->Options()->SetIntegerValue("print_level", 0);
  application->Options()->SetStringValue("sb", "yes");
  application->Options()->SetNumericValue("tol", 1e-10);
  application->Options()->SetIntegerValue("max_iter", 300);
  // The feasible set is the stated one, not one widened by 1e-8.
  application->Options()->SetNumericValue("bound_relax_factor", 0.0);
  application->Initialize("");
  // The smart pointer takes ownership of the raw one, as Ipopt's interface has it.
  RefinementNlp* nlp = new RefinementNlp(problem, start);
  const Ipopt::SmartPtr<Ipopt::TNLP> owner(nlp);
  application->OptimizeTNLP(owner);  // the end is judged by the problem, not by the status
  return outcome_at(problem, nlp->end());
}

}  // namespace gear3k::optimize
