// LibreCAD as a second reader of the drawings; built where it is installed.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::librecad_test {
namespace {

using test::example, test::read_text, test::Workplace;

const std::vector<std::string> kDrawings{"S", "P1", "R1", "P2", "R2", "train", "assembly"};

/// Runs a command line in a folder with its output in files there.  @returns the exit code
int run_in(const std::filesystem::path& folder, const std::string& command) {
  const std::string line =
      "cd '" + folder.string() + "' && (" + command + ") >stdout.txt 2>stderr.txt </dev/null";
  const int status = std::system(line.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Export, LibreCadOpensEveryDxfAndPrintsIt) {
  const Workplace place;
  place.write("gear.toml", example("designs/bilateral_drive_gear.toml"));
  ASSERT_EQ(place.run({"export", "gear.toml", "--dxf", "dxf", "--chord-error-um", "2"}).exit_code,
            0);
  const std::filesystem::path folder = place.file("dxf");
  std::filesystem::create_directory(folder / "home");
  std::filesystem::permissions(folder / "home", std::filesystem::perms::owner_all);
  // A file that it cannot read makes LibreCAD wait for an answer: the time is limited.
  const int code = run_in(folder,
                          "HOME=\"$PWD/home\" XDG_RUNTIME_DIR=\"$PWD/home\" "
                          "QT_QPA_PLATFORM=offscreen timeout 60 librecad dxf2pdf -a *.dxf");
  const std::string talk = read_text(folder / "stderr.txt") + read_text(folder / "stdout.txt");
  EXPECT_EQ(code, 0) << talk;
  for (const char* sign : {"ERROR", "rror:", "ailed", "arning"}) {
    EXPECT_EQ(talk.find(sign), std::string::npos) << talk;
  }
  for (const std::string& name : kDrawings) {
    const std::filesystem::path pdf = folder / (name + ".pdf");
    ASSERT_TRUE(std::filesystem::exists(pdf)) << name << "\n" << talk;
    EXPECT_TRUE(read_text(pdf).starts_with("%PDF-")) << name;
    // An empty page takes about 1 kB.
    EXPECT_GT(std::filesystem::file_size(pdf), 4000U) << name;
  }
}

}  // namespace
}  // namespace gear3k::librecad_test
