#include "io/text/file_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "io/text/diagnostics.hpp"

namespace gear3k::io::file_writer_test {
namespace {

namespace fs = std::filesystem;

class FileWriter : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "gear3k_test_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  static std::string read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file.is_open()) << path;
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      found.push_back(entry.path().filename().string());
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  static std::string failure_of(const std::string& path, const std::string& content) {
    try {
      write_file(path, content);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  }

 private:
  fs::path folder_;
};

using Names = std::vector<std::string>;

TEST_F(FileWriter, WritesTheBytesAndNothingElse) {
  const std::string content("line\r\n\0end \xc3\xa9", 13);
  write_file(path("result"), content);
  EXPECT_EQ(read(path("result")), content);
  EXPECT_EQ(names(), Names{"result"});
}

TEST_F(FileWriter, WritesAnEmptyFile) {
  write_file(path("result"), "");
  EXPECT_EQ(read(path("result")), "");
}

TEST_F(FileWriter, ReplacesTheFileRatherThanItsBytes) {
  write_file(path("result"), "the old, longer text");
  fs::create_hard_link(path("result"), path("kept"));
  write_file(path("result"), "new");
  EXPECT_EQ(read(path("result")), "new");
  EXPECT_EQ(read(path("kept")), "the old, longer text");
  EXPECT_EQ(names(), (Names{"kept", "result"}));
}

TEST_F(FileWriter, ReadersNeverSeeHalfAFile) {
  const std::string a(200'000, 'a');
  const std::string b(300'000, 'b');
  write_file(path("result"), a);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int k = 0; k < 100; ++k) write_file(path("result"), k % 2 == 0 ? b : a);
    done = true;
  });
  std::size_t torn = 0;
  while (!done) {
    const std::string seen = read(path("result"));
    if (seen != a && seen != b) ++torn;
  }
  writer.join();
  EXPECT_EQ(torn, 0U);
}

TEST_F(FileWriter, MissingFolderIsAnErrorThatNamesPathAndCause) {
  const std::string message = failure_of(path("absent/result"), "text");
  EXPECT_NE(message.find(path("absent/result") + ": cannot be written: No such file"),
            std::string::npos)
      << message;
  EXPECT_EQ(names(), Names{});
}

TEST_F(FileWriter, FolderInTheWayIsAnErrorAndStays) {
  fs::create_directory(path("result"));
  std::ofstream(path("result/inner")) << "kept";
  const std::string message = failure_of(path("result"), "text");
  EXPECT_NE(message.find(path("result") + ": cannot be written"), std::string::npos) << message;
  EXPECT_EQ(read(path("result/inner")), "kept");
  EXPECT_EQ(names(), Names{"result"}) << "a temporary file is left";
}

TEST_F(FileWriter, FailureWhileWritingLeavesTheOldFileAndNoTemporary) {
  write_file(path("result"), "old");
  // A limit on file sizes stands in for a full disk.
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = failure_of(path("result"), std::string(100'000, 'x'));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(message.find(path("result") + ": cannot be written: File too large"), std::string::npos)
      << message;
  EXPECT_EQ(read(path("result")), "old");
  EXPECT_EQ(names(), Names{"result"});
}

TEST_F(FileWriter, ALinkThatWaitsForATemporaryNameIsNotFollowed) {
  write_file(path("victim"), "kept");
  const std::string guess = path(fmt::format("result.{}.tmp", ::getpid()));
  fs::create_symlink(path("victim"), guess);
  write_file(path("result"), "new");
  EXPECT_EQ(read(path("victim")), "kept");
  EXPECT_TRUE(fs::is_symlink(guess));
  EXPECT_EQ(read(path("result")), "new");
}

TEST_F(FileWriter, ALinkAtItsOwnNameIsReplacedAndWhatItNamesIsKept) {
  write_file(path("other"), "kept");
  fs::create_symlink(path("other"), path("result"));
  write_file(path("result"), "new");
  EXPECT_FALSE(fs::is_symlink(path("result")));
  EXPECT_EQ(read(path("result")), "new");
  EXPECT_EQ(read(path("other")), "kept");
  EXPECT_EQ(names(), (Names{"other", "result"}));
}

TEST_F(FileWriter, HasThePermissionsThatTheUsersMaskLeaves) {
  const mode_t before = ::umask(027);
  write_file(path("result"), "text");
  ::umask(before);
  EXPECT_EQ(fs::status(path("result")).permissions(), static_cast<fs::perms>(0640));
}

TEST_F(FileWriter, LongNamesLeaveRoomForATemporaryOne) {
  const std::string name(255, 'n');
  write_file(path(name), "text");
  EXPECT_EQ(names(), Names{name});
}

/// Writes in two pieces, with a signal between them.
void write_and_raise(const std::string& path, int signal) {
  write_file_in_pieces(path, [&](const auto& out) {
    out(std::string(100'000, 'a'));
    ::raise(signal);
    out("end");
  });
}

TEST_F(FileWriter, SignalsWaitForTheWholeFile) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    write_file(path("result"), "old");
    EXPECT_EXIT(write_and_raise(path("result"), signal), testing::KilledBySignal(signal), "");
    EXPECT_EQ(read(path("result")), std::string(100'000, 'a') + "end");
    EXPECT_EQ(names(), Names{"result"});
  }
}

TEST_F(FileWriter, AProgramThatIgnoresASignalGoesOnIgnoringIt) {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  write_and_raise(path("result"), SIGHUP);
  EXPECT_EQ(std::signal(SIGHUP, before), SIG_IGN);
  EXPECT_EQ(read(path("result")), std::string(100'000, 'a') + "end");
}

/// Whether files of a folder can do without a name (O_TMPFILE).
bool has_nameless_files(const std::string& folder) {
  const int nameless = ::open(folder.c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (nameless >= 0) ::close(nameless);
  return nameless >= 0;
}

TEST_F(FileWriter, OneThatIsKilledLeavesTheOldFileAndNothingButAnUnguessableName) {
  write_file(path("result"), "old");
  EXPECT_EXIT(write_and_raise(path("result"), SIGKILL), testing::KilledBySignal(SIGKILL), "");
  EXPECT_EQ(read(path("result")), "old");
  Names left = names();
  if (!has_nameless_files(path(""))) {
    const auto temporary = std::ranges::find_if(
        left, [](const std::string& name) { return name.starts_with(".gear3k-"); });
    ASSERT_NE(temporary, left.end());
    left.erase(temporary);
  }
  EXPECT_EQ(left, Names{"result"});
}

TEST_F(FileWriter, APipeIsNotReplacedByAFile) {
  // As --out /dev/stdout and --out /dev/null: what is no regular file belongs to others.
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const std::string message = failure_of(path("pipe"), "text");
  std::string received(16, '\0');
  const ssize_t count = ::read(reader, received.data(), received.size());
  received.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  EXPECT_TRUE(message.empty() ? received == "text" : message.starts_with(path("pipe") + ": "))
      << message;
  EXPECT_EQ(names(), Names{"pipe"});
}

TEST_F(FileWriter, ALinkToADescriptorIsWrittenThrough) {
  // As /dev/stdout is, which may refer to a regular file.
  const int file = ::open(path("file").c_str(), O_CREAT | O_WRONLY, 0600);
  ASSERT_GE(file, 0);
  fs::create_symlink("/proc/self/fd/" + std::to_string(file), path("stdout"));
  write_file(path("stdout"), "text");
  ::close(file);
  EXPECT_TRUE(fs::is_symlink(path("stdout")));
  EXPECT_EQ(read(path("file")), "text");
}

TEST_F(FileWriter, PrepareFolderMakesItWithItsParentsAndKeepsWhatIsThere) {
  prepare_folder(path("a/b/c"));
  EXPECT_TRUE(fs::is_directory(path("a/b/c")));
  std::ofstream(path("a/b/c/file")) << "kept";
  prepare_folder(path("a/b/c"));
  EXPECT_EQ(read(path("a/b/c/file")), "kept");
}

TEST_F(FileWriter, AFolderNamesTheFileInTheWay) {
  std::ofstream(path("file")) << "kept";
  fs::create_symlink("nowhere", path("link"));
  for (const auto& refused : {prepare_folder, expect_folder}) {
    for (const std::string& folder :
         {path("file"), path("file/inner"), path("file/in/ner"), path("link"), path("link/in")}) {
      try {
        refused(folder);
        ADD_FAILURE() << "no exception for " << folder;
      } catch (const InvalidInput& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(folder + ": cannot be made a folder"))
            << error.what();
      }
    }
  }
  EXPECT_EQ(read(path("file")), "kept");
}

TEST_F(FileWriter, WhatIsExpectedIsNotMade) {
  EXPECT_NO_THROW(expect_folder(path("a/b/c")));
  EXPECT_NO_THROW(expect_file(path("new")));
  EXPECT_NO_THROW(expect_file("/dev/null"));
  EXPECT_TRUE(std::filesystem::is_empty(path(".")));
}

TEST_F(FileWriter, AFileIsExpectedWhereItCanBe) {
  std::filesystem::create_directory(path("folder"));
  std::ofstream(path("file")) << "kept";
  EXPECT_NO_THROW(expect_file(path("file")));
  const auto refusal = [](const std::string& name) -> std::string {
    try {
      expect_file(name);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(path("folder")),
            path("folder") + ": cannot be written: a folder has this name");
  EXPECT_EQ(refusal(path("absent/file")),
            path("absent/file") + ": cannot be written: No such file or directory");
  EXPECT_EQ(refusal(path("file/inner")),
            path("file/inner") + ": cannot be written: Not a directory");
}

}  // namespace
}  // namespace gear3k::io::file_writer_test
