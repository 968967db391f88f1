#include "strength/material.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace gear3k::strength::material_test {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::vector<std::vector<std::string>> rows_of_the_file() {
  std::ifstream file(GEAR3K_SOURCE_DIR "/data/gear_materials.csv");
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    rows.push_back(split(line));
  }
  return rows;
}

/// Value of an expression of + - * / ^, brackets, numbers and the variables h, T and N.
class Expression {
 public:
  Expression(std::string text, double h, double t, double n)
      : text_(std::move(text)), h_(h), t_(t), n_(n) {}
  double value() {
    const double v = sum();
    EXPECT_EQ(at_, text_.size()) << text_;
    return v;
  }

 private:
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  double sum() {
    double v = product();
    for (;;) {
      if (take('+')) {
        v += product();
      } else if (take('-')) {
        v -= product();
      } else {
        return v;
      }
    }
  }
  double product() {
    double v = power();
    for (;;) {
      if (take('*')) {
        v *= power();
      } else if (take('/')) {
        v /= power();
      } else {
        return v;
      }
    }
  }
  double power() {
    const double base = atom();
    return take('^') ? std::pow(base, power()) : base;
  }
  double atom() {
    if (take('-')) return -atom();
    if (take('(')) {
      const double v = sum();
      EXPECT_TRUE(take(')')) << text_;
      return v;
    }
    if (take('h')) return h_;
    if (take('T')) return t_;
    if (take('N')) return n_;
    std::size_t used = 0;
    const double v = std::stod(text_.substr(at_), &used);
    at_ += used;
    return v;
  }

  std::string text_;
  double h_, t_, n_;
  std::size_t at_ = 0;
};

double stated(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}
/// Equal numbers, or an empty field and an empty value.
void expect_number(const std::string& field, const std::optional<double>& value, double unit,
                   const std::string& where) {
  ASSERT_EQ(field.empty(), !value.has_value()) << where;
  if (field.empty()) return;
  EXPECT_DOUBLE_EQ(std::stod(field) * unit, stated(value)) << where;
}

TEST(MaterialTable, IsTheFileRowByRow) {
  const auto rows = rows_of_the_file();
  const auto table = material_table();
  ASSERT_EQ(rows.size(), table.size() + 1);
  ASSERT_EQ(rows[0].size(), 14u);
  EXPECT_EQ(rows[0][5], "sigma_Hlim_N_mm2");
  EXPECT_EQ(rows[0][6], "sigma_Flim_N_mm2");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto& row = rows[i + 1];
    const Material& material = table[i];
    ASSERT_EQ(row.size(), 14u) << row[0];
    EXPECT_EQ(row[0], material.name);
    EXPECT_EQ(row[1].empty() ? "plastic" : row[1],
              kMaterialGroupNames[static_cast<std::size_t>(material.group)])
        << row[0];
    EXPECT_EQ(row[2], kHardnessScaleNames[static_cast<std::size_t>(material.hardness_scale)]);
    expect_number(row[3], material.hardness_min, 1.0, row[0]);
    expect_number(row[4], material.hardness_max, 1.0, row[0]);
    expect_number(row[7], material.youngs_modulus_Pa, 1e6, row[0]);
    expect_number(row[8], material.poisson_ratio, 1.0, row[0]);
    expect_number(row[9], material.density_kgm3, 1.0, row[0]);
    expect_number(row[10], material.yield_strength_Pa, 1e6, row[0]);
    EXPECT_EQ(row[11], kLifeCurveNames[static_cast<std::size_t>(material.life_curve)]) << row[0];
    EXPECT_EQ(row[12], material.note) << row[0];
    EXPECT_EQ(row[13], material.source) << row[0];
  }
}

TEST(MaterialTable, LimitsAreTheExpressionsOfTheFile) {
  const auto rows = rows_of_the_file();
  const auto table = material_table();
  int compared = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Material& material = table[i];
    const double low = material.hardness_min.value_or(0.0);
    const double high = material.hardness_max.value_or(0.0);
    for (const double share : {0.0, 0.3, 1.0}) {
      for (const double celsius : {20.0, 60.0, 115.0}) {
        for (const double cycles : {1e4, 1e6, 3.7e8}) {
          const double h = low + share * (high - low);
          const ToothCondition<double> condition{
              .hardness = material.hardness_min ? std::optional(h) : std::nullopt,
              .temperature_K = celsius + 273.15,
              .cycles = cycles};
          const auto compare = [&](const std::string& expression, const LimitValue<double>& limit) {
            ASSERT_EQ(expression.empty(), !limit.stated) << material.name;
            if (expression.empty()) return;
            const double expected = Expression(expression, h, celsius, cycles).value();
            EXPECT_NEAR(limit.stress_Pa / 1e6, expected, 1e-11 * (100.0 + std::abs(expected)))
                << material.name;
            EXPECT_TRUE(limit.hardness_in_range && limit.temperature_in_range) << material.name;
            ++compared;
          };
          compare(rows[i + 1][5], flank_limit(material, condition));
          compare(rows[i + 1][6], root_limit(material, condition));
        }
      }
    }
  }
  EXPECT_GE(compared, 27 * 50);
}

TEST(MaterialTable, NamesAreFoundAndDiffer) {
  std::set<std::string_view> names;
  for (const Material& material : material_table()) {
    EXPECT_EQ(find_material(material.name), &material);
    EXPECT_TRUE(names.insert(material.name).second) << material.name;
  }
  EXPECT_EQ(find_material("unobtainium"), nullptr);
}

TEST(Material, OutsideItsRangeIsReportedAndTheValueStands) {
  const Material& steel = *find_material("through hardened alloy steel MQ");
  const auto hard = flank_limit<double>(steel, {.hardness = 400.0});
  EXPECT_FALSE(hard.hardness_in_range);
  EXPECT_DOUBLE_EQ(hard.stress_Pa, (1.313 * 400.0 + 373.0) * 1e6);
  const Material& pom = *find_material("POM");
  const auto hot = root_limit<double>(pom, {.temperature_K = 273.15 + 121.0, .cycles = 1e6});
  EXPECT_FALSE(hot.temperature_in_range);
  EXPECT_TRUE(hot.stated);
  const auto frozen =
      root_limit<double>(*find_material("PA66"), {.temperature_K = 273.15 - 20.0, .cycles = 1e6});
  EXPECT_FALSE(frozen.temperature_in_range);
  EXPECT_DOUBLE_EQ(frozen.stress_Pa, root_limit<double>(*find_material("PA66"),
                                                        {.temperature_K = 273.15, .cycles = 1e6})
                                         .stress_Pa);
}

TEST(Material, RefusesWhatHasNoMeaning) {
  const Material& steel = *find_material("through hardened alloy steel MQ");
  EXPECT_THROW(flank_limit<double>(steel, {}), std::invalid_argument);
  EXPECT_THROW(flank_limit<double>(steel, {.hardness = std::nan("")}), std::invalid_argument);
  const Material& pom = *find_material("POM");
  EXPECT_THROW(root_limit<double>(pom, {.cycles = 0.5}), std::invalid_argument);
  EXPECT_THROW(root_limit<double>(pom, {.temperature_K = std::nan("")}), std::invalid_argument);
  // One value of the row needs no hardness.
  EXPECT_DOUBLE_EQ(flank_limit<double>(*find_material("34CrNiMo6 through hardened"), {}).stress_Pa,
                   700e6);
  EXPECT_FALSE(flank_limit<double>(*find_material("PEEK"), {}).stated);
}

}  // namespace
}  // namespace gear3k::strength::material_test
