#include "io/text/gnuplot.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "io/text/diagnostics.hpp"

namespace gear3k::io::gnuplot_test {
namespace {

std::string message_of(const std::string& script) {
  try {
    run_gnuplot(script);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(Gnuplot, ReturnsWhatItPrints) {
  const std::string svg = run_gnuplot("set terminal svg\nset xrange [0:1]\nplot x\n");
  EXPECT_TRUE(svg.starts_with("<?xml")) << svg;
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

TEST(Gnuplot, TakesAScriptThatNoPipeHolds) {
  std::string script = "set terminal svg\n$d << EOD\n";
  for (int k = 0; k < 100000; ++k) script += std::to_string(k) + " 1\n";
  EXPECT_FALSE(run_gnuplot(script + "EOD\nplot $d with dots\n").empty());
}

TEST(Gnuplot, AFailingScriptIsToldInItsWords) {
  const std::string message = message_of("no such command\n");
  EXPECT_NE(message.find("gnuplot: failed with exit code"), std::string::npos) << message;
  EXPECT_NE(message.find("invalid command"), std::string::npos) << message;
}

TEST(Gnuplot, NoFigureIsAFailure) {
  EXPECT_NE(message_of("a = 1\n").find("printed no figure"), std::string::npos);
}

TEST(Gnuplot, MissingIsSaidWithThePackageThatHasIt) {
  const char* path = std::getenv("PATH");
  const std::string before = path != nullptr ? path : "";
  ::setenv("PATH", "/nonexistent", 1);
  const std::string message = message_of("plot x\n");
  ::setenv("PATH", before.c_str(), 1);
  EXPECT_EQ(message, "gnuplot: not found in PATH; figures need it (Debian package gnuplot-nox)");
}

}  // namespace
}  // namespace gear3k::io::gnuplot_test
