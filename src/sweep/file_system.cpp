#include "sweep/file_system.hpp"

#include <fmt/format.h>
#include <sys/vfs.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "io/text/diagnostics.hpp"

namespace gear3k::sweep {

std::string_view network_file_system(unsigned long type) {
  constexpr std::array<std::pair<unsigned long, std::string_view>, 14> kNetwork{
      {{0x6969, "NFS"},
       {0xFF534D42, "CIFS"},
       {0xFE534D42, "SMB"},
       {0x517B, "SMB"},
       {0x01021997, "9p"},
       {0x65735546, "FUSE"},
       {0x5346414F, "AFS"},
       {0x6B414653, "AFS"},
       {0x73757245, "Coda"},
       {0x564C, "NCP"},
       {0x00C36400, "Ceph"},
       {0x7461636F, "OCFS2"},
       {0x0BD00BD0, "Lustre"},
       {0x47504653, "GPFS"}}};
  const auto* const found =
      std::ranges::find(kNetwork, type, [](const auto& n) { return n.first; });
  return found == kNetwork.end() ? std::string_view() : found->second;
}

void refuse_network(const std::string& path) {
  struct statfs facts {};
  std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (folder.empty()) folder = ".";
  if (::statfs(path.c_str(), &facts) != 0 && ::statfs(folder.c_str(), &facts) != 0) return;
  const std::string_view name = network_file_system(static_cast<unsigned long>(facts.f_type));
  if (name.empty()) return;
  throw io::InvalidInput(fmt::format(
      "{}: is on a network file system ({}), where writers of several machines would damage the "
      "database: allowed: a file on a local disk, one for each machine (--shard i/n), and gear3k "
      "sweep merge afterwards",
      path, name));
}

}  // namespace gear3k::sweep
