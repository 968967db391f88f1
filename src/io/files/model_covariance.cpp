#include "io/files/model_covariance.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "io/files/model_file_keys.hpp"
#include "numerics/linear_algebra.hpp"

namespace gear3k::io {

namespace {

/// Relative differences up to this are roundings of what was written.
constexpr double kRounding = 1e-9;

class CovarianceReader {
 public:
  CovarianceReader(const ModelCauses& parameters, TomlReader& reader)
      : parameters_(parameters), reader_(reader) {}

  std::vector<double> read(const TomlValue& table, const std::string& path) {
    const std::size_t count = parameters_.names.size();
    if (!reader_.is_table(table, path)) return {};
    const TomlValue* parameters = nullptr;
    const TomlValue* matrix = nullptr;
    for (const TomlValue& member : table.table) {
      if (member.key == "parameters") {
        parameters = &member;
      } else if (member.key == "matrix") {
        matrix = &member;
      } else {
        reader_.unknown(member, "key", path + "." + member.key, {"parameters", "matrix"});
      }
    }
    if (parameters == nullptr || matrix == nullptr) {
      reader_.error(table.position, fmt::format("{}.{} is missing", path,
                                                parameters == nullptr ? "parameters" : "matrix"));
      return {};
    }
    const auto order = parameter_order(*parameters, path + ".parameters");
    if (!order) return {};
    if (matrix->kind != TomlValue::Kind::kList || matrix->list.size() != count * count) {
      reader_.error(matrix->position,
                    fmt::format("{}.matrix = {}: allowed: {} numbers, {} by {}, row by row", path,
                                matrix->kind == TomlValue::Kind::kList
                                    ? fmt::format("{} elements", matrix->list.size())
                                    : as_text(*matrix),
                                count * count, count, count));
      return {};
    }
    std::vector<double> covariance(count * count, 0.0);
    const std::size_t before = reader_.errors();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        covariance[(*order)[i] * count + (*order)[j]] =
            reader_.number(matrix->list[i * count + j], path + ".matrix");
      }
    }
    if (reader_.errors() == before) check_covariance(*matrix, path + ".matrix", covariance);
    return covariance;
  }

 private:
  /// Places of the named parameters among those of the causes; empty where they are not the same.
  std::optional<std::vector<std::size_t>> parameter_order(const TomlValue& value,
                                                          const std::string& path) {
    const std::size_t before = reader_.errors();
    const std::vector<std::string> written = reader_.texts(value, path);
    if (reader_.errors() != before) return std::nullopt;
    std::vector<std::size_t> order;
    order.reserve(written.size());
    std::vector<bool> seen(parameters_.names.size(), false);
    for (std::size_t k = 0; k < written.size(); ++k) {
      const auto at = std::ranges::find(parameters_.names, written[k]);
      if (at == parameters_.names.end()) {
        const std::string hint = closest_word(written[k], parameters_.names);
        reader_.error(value.list[k].position,
                      fmt::format("{}: unknown parameter \"{}\"{}; allowed: {}", path, written[k],
                                  hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
                                  fmt::join(parameters_.names, ", ")));
        continue;
      }
      const auto place = static_cast<std::size_t>(at - parameters_.names.begin());
      if (seen[place]) {
        reader_.error(value.list[k].position,
                      fmt::format("{}: \"{}\" stands twice", path, written[k]));
      }
      seen[place] = true;
      order.push_back(place);
    }
    for (std::size_t k = 0; k < parameters_.names.size(); ++k) {
      if (!seen[k]) {
        reader_.error(value.position, fmt::format("{}: {} is missing", path, parameters_.names[k]));
      }
    }
    if (reader_.errors() != before) return std::nullopt;
    return order;
  }

  /// Symmetric, positive semidefinite, and with the standard deviations that the causes state.
  void check_covariance(const TomlValue& at, const std::string& path,
                        const std::vector<double>& c) {
    const std::size_t count = parameters_.names.size();
    std::vector<double> sd(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double variance = c[i * (count + 1)];
      if (variance < 0.0) {
        reader_.error(at.position, fmt::format("{}: variance of {} = {}: allowed: at least 0", path,
                                               parameters_.names[i], variance));
        return;
      }
      sd[i] = std::sqrt(variance);
      constexpr double kPrinted = 1e-6;
      if (parameters_.deviations[i].stated && !(std::abs(parameters_.deviations[i].value - sd[i]) <=
                                                kPrinted * std::max(sd[i], 1e-300))) {
        reader_.error(parameters_.deviations[i].position,
                      fmt::format("{}{} = {}: allowed: {}, the square root of its variance in {}",
                                  parameters_.names[i], kDeviation, parameters_.deviations[i].value,
                                  sd[i], path));
      }
    }
    Eigen::MatrixXd correlation(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        const double one = c[i * count + j];
        const double other = c[j * count + i];
        if (i < j && std::abs(one - other) > kRounding * sd[i] * sd[j]) {
          reader_.error(at.position,
                        fmt::format("{}: not symmetric: {} with {} is {}, the reverse {}", path,
                                    parameters_.names[i], parameters_.names[j], one, other));
          return;
        }
        const double scale = sd[i] * sd[j];
        if (scale == 0.0 && one != 0.0) {
          reader_.error(at.position,
                        fmt::format("{}: {} with {} is {}, allowed: 0 (a variance is 0)", path,
                                    parameters_.names[i], parameters_.names[j], one));
          return;
        }
        correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            scale > 0.0 ? one / scale : 0.0;
      }
    }
    if (count == 0) return;
    const double least = numerics::symmetric_eigenvalues(correlation).minCoeff();
    if (least < -kRounding * static_cast<double>(count)) {
      reader_.error(
          at.position,
          fmt::format("{}: not positive semidefinite (least eigenvalue of the correlations "
                      "{:.3g}): allowed: a covariance",
                      path, least));
    }
  }

  const ModelCauses& parameters_;
  TomlReader& reader_;
};

/// Without a covariance the parameters are taken as independent.
std::vector<double> independent(const std::vector<StatedDeviation>& deviations) {
  if (std::ranges::none_of(deviations, &StatedDeviation::stated)) return {};
  const std::size_t count = deviations.size();
  std::vector<double> covariance(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    covariance[i * (count + 1)] = deviations[i].value * deviations[i].value;
  }
  return covariance;
}

}  // namespace

std::vector<double> read_covariance(const TomlValue* table, const std::string& path,
                                    const ModelCauses& parameters, TomlReader& reader) {
  if (table == nullptr) return independent(parameters.deviations);
  return CovarianceReader(parameters, reader).read(*table, path);
}

}  // namespace gear3k::io
