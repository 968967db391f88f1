#include "io/text/build_id.hpp"

#include <link.h>

#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <utility>

namespace gear3k::io {

namespace {

/// Notes are aligned to four bytes.
std::size_t aligned(std::size_t size) { return (size + 3) / 4 * 4; }

/// The build id among the notes of a segment.
std::string build_id_in(std::string_view notes) {
  ElfW(Nhdr) head{};
  while (notes.size() >= sizeof head) {
    std::memcpy(&head, notes.data(), sizeof head);
    notes.remove_prefix(sizeof head);
    const std::size_t name = aligned(head.n_namesz);
    const std::size_t size = aligned(head.n_descsz);
    if (notes.size() < name || notes.size() - name < size) break;
    if (head.n_type == NT_GNU_BUILD_ID && notes.substr(0, 4) == std::string_view("GNU\0", 4)) {
      return std::string(notes.substr(name, head.n_descsz));
    }
    notes.remove_prefix(name + size);
  }
  return {};
}

/// Of the first object, which is the program.
int take_build_id(dl_phdr_info* object, std::size_t /*size*/, void* found) {
  for (int k = 0; k < object->dlpi_phnum; ++k) {
    const ElfW(Phdr)& segment = object->dlpi_phdr[k];
    if (segment.p_type != PT_NOTE) continue;
    const auto* bytes = std::bit_cast<const char*>(object->dlpi_addr + segment.p_vaddr);
    std::string id = build_id_in({bytes, segment.p_memsz});
    if (id.empty()) continue;
    *static_cast<std::string*>(found) = std::move(id);
    break;
  }
  return 1;
}

}  // namespace

std::string build_id() {
  std::string id;
  dl_iterate_phdr(take_build_id, &id);
  return id;
}

}  // namespace gear3k::io
