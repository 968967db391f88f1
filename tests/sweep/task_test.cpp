#include "sweep/task.hpp"

#include <linux/magic.h>

#include "io/files/specification_file.hpp"
#include "sweep/file_system.hpp"
#include "tests/sweep/small_sweep.hpp"

namespace gear3k::task_test {
namespace {

sweep::Task task_of(const std::string& text) {
  return sweep::task_of(io::parse_toml(text, "spec.toml"));
}

TEST(Task, HasOneKeyHoweverItIsWritten) {
  const std::string key = task_of(R"(
planets = [3]
[ratio]
target = 96.2
tolerance = 0.005
[teeth]
S = [10, 20]
P1 = [20, 60]
[friction]
coefficient = 0.1
)")
                              .key;
  EXPECT_EQ(key, task_of(R"(# another order, other spellings, a name, defaults stated
friction.coefficient = 1e-1
friction.loss_model = "sliding"
name = "another"
profile_shift.range = [0, 1.0]
teeth = { P1 = [20, 60], S = [10, 20], max_coaxial_offset = 4 }
ratio.target = 96.20
solver.starts = 4
)")
                     .key);
  EXPECT_NE(key, task_of("planets = [3]\nratio.target = 96.2\nteeth.S = [10, 20]\nteeth.P1 = [20, "
                         "61]\nfriction.coefficient = 0.1\n")
                     .key);
  EXPECT_NE(key, task_of("planets = [4]\nratio.target = 96.2\nteeth.S = [10, 20]\nteeth.P1 = [20, "
                         "60]\nfriction.coefficient = 0.1\n")
                     .key);
}

TEST(Task, DefaultsStatedBesideAPresetCountAsTheyOverrideIt) {
  // contact_ratio.range is [1.2, 2.0] or so without a preset; stated it replaces the preset's own.
  const std::string bare = "preset = \"machined\"\nratio.target = 96.2\n";
  EXPECT_NE(task_of(bare).key, task_of(bare + "limits.planet_gap = 0.5\n").key);
}

TEST(Task, ALimitSwitchedOnIsItsDefaultAndOneSwitchedOffIsNoNumber) {
  const std::string bare = "ratio.target = 96.2\n";
  const auto key_of = [&](const std::string& limit) {
    return task_of(bare + "limits.tip_thickness = " + limit + "\n").key;
  };
  EXPECT_EQ(key_of("true"), task_of(bare).key);
  EXPECT_EQ(key_of("0.25"), task_of(bare).key);
  EXPECT_NE(key_of("1.0"), task_of(bare).key);
  EXPECT_NE(key_of("false"), key_of("0.0"));
  // A preset has limits of its own, which `true` leaves and a number replaces.
  const std::string preset = "preset = \"machined\"\n" + bare;
  EXPECT_NE(task_of(preset + "limits.tip_thickness = true\n").key,
            task_of(preset + "limits.tip_thickness = 0.25\n").key);
}

TEST(Task, SurroundingsOfAMotorThatAreStatedAreNoDefault) {
  // Without the key an ACTUATOR's motor has its own.
  const std::string bare = "ratio.target = 96.2\n";
  EXPECT_NE(task_of(bare + "actuator.limits.ambient_c = 25.0\n").key, task_of(bare).key);
}

TEST(Task, ItsTextIsASpecOfTheSameMeaning) {
  for (const char* file : {"rp96.toml", "ratio-96.toml", "ratio-96-pom.toml", "jobs/wrist_150.toml",
                           "jobs/printed_30.toml", "ratio-96-robust.toml"}) {
    const std::string text = test::example(file);
    const sweep::Task task = task_of(text);
    // Read and put into that form once more, nothing changes.
    EXPECT_EQ(task_of(task.spec).spec, task.spec) << file;
    EXPECT_EQ(task_of(task.spec).key, task.key) << file;
    // The whole task, its name aside, as far as its keys have a place.
    io::parse_specification(task.spec, file);
  }
}

TEST(NetworkFileSystem, NumbersAreThoseOfTheKernel) {
  EXPECT_EQ(sweep::network_file_system(NFS_SUPER_MAGIC), "NFS");
  EXPECT_EQ(sweep::network_file_system(SMB_SUPER_MAGIC), "SMB");
  EXPECT_EQ(sweep::network_file_system(CODA_SUPER_MAGIC), "Coda");
  EXPECT_EQ(sweep::network_file_system(AFS_SUPER_MAGIC), "AFS");
  EXPECT_EQ(sweep::network_file_system(AFS_FS_MAGIC), "AFS");
  EXPECT_EQ(sweep::network_file_system(V9FS_MAGIC), "9p");
  EXPECT_EQ(sweep::network_file_system(OCFS2_SUPER_MAGIC), "OCFS2");
  for (const unsigned long local :
       {static_cast<unsigned long>(EXT4_SUPER_MAGIC), static_cast<unsigned long>(TMPFS_MAGIC),
        static_cast<unsigned long>(BTRFS_SUPER_MAGIC), static_cast<unsigned long>(XFS_SUPER_MAGIC),
        static_cast<unsigned long>(OVERLAYFS_SUPER_MAGIC)}) {
    EXPECT_EQ(sweep::network_file_system(local), "");
  }
}

}  // namespace
}  // namespace gear3k::task_test
