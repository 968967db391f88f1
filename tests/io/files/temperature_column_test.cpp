// Temperatures of measurements: beyond what the temperature of a lubricant may be they are refused,
// and a column that looks like kelvin is doubted.
#include "io/files/temperature_column.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/files/measurement_file.hpp"
#include "io/files/motion_log_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::temperature_column_test {
namespace {

struct Kind {
  std::string head, row;  ///< a row without its temperature
};
const std::vector<Kind> kKinds{
    {"# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,cell",
     "forward,100,5,0.1"},
    {"# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin,cell", "0,1,20"},
    {"# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,cell", "16,80,0.1"}};

std::string data(const Kind& kind, const std::vector<std::string>& temperatures) {
  std::string text = kind.head + ",temperature_c\n";
  int cell = 0;
  for (const std::string& t : temperatures) {
    text += fmt::format("{},{},{}\n", kind.row, cell++, t);
  }
  return text;
}

/// Sixty rows, the temperatures one after the other again and again.
std::string log_of(const std::vector<std::string>& temperatures) {
  std::string text = "# kind: dynamic\ntime_s,speed_rad_s,motor_torque_nm,temperature_c\n";
  for (std::size_t k = 0; k < 60; ++k) {
    text += fmt::format("{:.2f},{},{},{}\n", 0.01 * static_cast<double>(k), k, k + 1,
                        temperatures[k % temperatures.size()]);
  }
  return text;
}

struct Read {
  std::string errors;
  std::vector<std::string> notes;
};
Read read_data(const std::string& text) {
  try {
    return {.errors = "", .notes = io::parse_measurements({{"f.csv", text}}).sets.at(0).notes};
  } catch (const io::InvalidInput& error) {
    return {.errors = error.what(), .notes = {}};
  }
}
Read read_log(const std::string& text) {
  try {
    return {.errors = "",
            .notes = io::parse_motion_log("f.csv", text, {.ratio = 10.0, .load_kgm2 = 0.3}).notes};
  } catch (const io::InvalidInput& error) {
    return {.errors = error.what(), .notes = {}};
  }
}

TEST(TemperatureColumn, BeyondThatOfALubricantIsRefusedInEveryKind) {
  for (const Kind& kind : kKinds) {
    const int column = static_cast<int>(kind.row.size()) + 4;
    for (const char* value : {"400.1", "2000", "1e9", "-273.16"}) {
      EXPECT_EQ(read_data(data(kind, {"20", value})).errors,
                fmt::format("f.csv:4:{}: temperature_c = {}: allowed: a finite number, -273.15 to "
                            "400 (degrees Celsius)",
                            column, value));
    }
    EXPECT_EQ(read_data(data(kind, {"20", "400", "-273.15", ""})).errors, "");
  }
  std::vector<std::string> once(60, "20");
  once[1] = "2000";
  EXPECT_EQ(read_log(log_of(once)).errors,
            "f.csv:4:10: temperature_c = \"2000\": allowed: a number, -273.15 to 400 (degrees "
            "Celsius)");
  // It is not used, so what is no number is no harm.
  EXPECT_EQ(read_log(log_of({"20", "", "nan", "off", "400"})).errors, "");
}

TEST(TemperatureColumn, ThatLooksLikeKelvinIsDoubted) {
  const std::string doubt =
      "f.csv: temperature_c is 298.15 to 333.15 throughout: it is read as degrees Celsius, is this "
      "file's in kelvin?";
  for (const Kind& kind : kKinds) {
    EXPECT_EQ(read_data(data(kind, {"298.15", "", "333.15"})).notes,
              (std::vector<std::string>{doubt}));
    EXPECT_EQ(read_data(data(kind, {"298.15", "249", "333.15"})).notes, std::vector<std::string>{});
    EXPECT_EQ(read_data(data(kind, {"25", "60"})).notes, std::vector<std::string>{});
    EXPECT_EQ(read_data(data(kind, {"25"})).notes, std::vector<std::string>{});
  }
  EXPECT_EQ(read_log(log_of({"298.15", "333.15"})).notes, (std::vector<std::string>{doubt}));
  EXPECT_EQ(read_log(log_of({"25", "60"})).notes, std::vector<std::string>{});
  EXPECT_EQ(read_log(log_of({"", "off"})).notes, std::vector<std::string>{});
}

}  // namespace
}  // namespace gear3k::temperature_column_test
