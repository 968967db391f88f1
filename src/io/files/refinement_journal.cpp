#include "io/files/refinement_journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>

#include "io/text/build_id.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/fnv_hash.hpp"
#include "io/text/version.hpp"

namespace gear3k::io {

namespace {

constexpr std::string_view kFormat = "gear3k refinement journal 4\n";
constexpr std::uint32_t kMostBytes = 4096;  ///< of a record
constexpr std::uint8_t kNoCheck = 255, kStage1Module = 254, kStage2Module = 253;

template <class T>
void put(std::string& record, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const char*>(&value);
  record.append(bytes, sizeof value);
}

/// Reads what put() wrote.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : rest_(bytes) {}
  template <class T>
  bool get(T& value) {
    if (rest_.size() < sizeof value) return false;
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return true;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }
  bool take(std::size_t bytes, std::string_view& part) {
    if (rest_.size() < bytes) return false;
    part = rest_.substr(0, bytes);
    rest_.remove_prefix(bytes);
    return true;
  }

 private:
  std::string_view rest_;
};

constexpr std::uint8_t kFirstObjective = 200, kFirstFelt = 240;

std::uint8_t code_of(std::string_view name) {
  if (name == "stage1_module") return kStage1Module;
  if (name == "stage2_module") return kStage2Module;
  const auto objectives = optimize::objective_records();
  const auto objective = std::ranges::find(objectives, name, &optimize::ObjectiveRecord::name);
  if (objective != objectives.end()) {
    return static_cast<std::uint8_t>(kFirstObjective + (objective - objectives.begin()));
  }
  const auto felt = std::ranges::find(optimize::kFeltRecords, name, &optimize::FeltRecord::name);
  if (felt != optimize::kFeltRecords.end()) {
    return static_cast<std::uint8_t>(kFirstFelt + (felt - optimize::kFeltRecords.begin()));
  }
  const auto records = design::check_records();
  const auto record = std::ranges::find(records, name, &design::CheckRecord::name);
  return record == records.end() ? kNoCheck : static_cast<std::uint8_t>(record - records.begin());
}

optimize::Miss miss_of(std::uint8_t code, double violation, double amount) {
  optimize::Miss miss{.name = {}, .violation = violation, .amount = amount, .unit = {}};
  const auto records = design::check_records();
  if (code < records.size()) {
    miss.name = records[code].name;
    miss.unit = units::unit_name(records[code].unit);
  } else if (code >= kFirstObjective && code < kFirstObjective + optimize::kObjectiveCount) {
    const auto& record = optimize::objective_records()[code - std::size_t{kFirstObjective}];
    miss.name = record.name;
    miss.unit = record.unit;
  } else if (code >= kFirstFelt && code < kFirstFelt + optimize::kFeltRecords.size()) {
    const optimize::FeltRecord& felt = optimize::kFeltRecords.at(code - std::size_t{kFirstFelt});
    miss.name = felt.name;
    miss.unit = units::unit_name(felt.unit);
  } else if (code != kNoCheck) {
    miss.name = code == kStage1Module ? "stage1_module" : "stage2_module";
    miss.unit = units::unit_name(units::Unit::kMillimetre);
  }
  return miss;
}

double number_of(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}
std::optional<double> optional_of(double value) {
  return value == value ? std::optional(value) : std::nullopt;
}

std::string record_of(const optimize::RefinedSet& s) {
  std::string record;
  put(record, s.index);
  put(record, s.candidate);
  put(record, s.status);
  put(record, s.grid_cut);
  put(record, s.refinements);
  put(record, s.relaxations);
  put(record, s.blocked_together);
  put(record, static_cast<std::uint32_t>(s.blocked_by.size()));
  for (const optimize::Miss& miss : s.blocked_by) {
    put(record, code_of(miss.name));
    put(record, miss.violation);
    put(record, miss.amount);
  }
  put(record, s.train);
  put(record, s.eta_b);
  put(record, s.eta_f);
  put(record, number_of(s.eta_b_model));
  put(record, number_of(s.eta_f_model));
  put(record, s.lost_motion_rad);
  put(record, s.contact_ratio);
  put(record, s.ring_root_diameter_m);
  put(record, s.mass_kg);
  put(record, s.inertia_kgm2);
  put(record, number_of(s.torque_capacity_Nm));
  put(record, number_of(s.torsional_stiffness_Nm_rad));
  put(record, s.kkt_residual);
  put(record, number_of(s.cycle_energy_J));
  put(record, static_cast<std::uint64_t>(s.motor));
  return record;
}

bool read_record(std::string_view bytes, optimize::RefinedSet& s) {
  Fields fields(bytes);
  std::uint32_t misses = 0;
  if (!(fields.get(s.index) && fields.get(s.candidate) && fields.get(s.status) &&
        fields.get(s.grid_cut) && fields.get(s.refinements) && fields.get(s.relaxations) &&
        fields.get(s.blocked_together) && fields.get(misses))) {
    return false;
  }
  for (std::uint32_t k = 0; k < misses; ++k) {
    std::uint8_t code = kNoCheck;
    double violation = 0.0, amount = 0.0;
    if (!(fields.get(code) && fields.get(violation) && fields.get(amount))) return false;
    s.blocked_by.push_back(miss_of(code, violation, amount));
  }
  double eta_b_model = 0.0, eta_f_model = 0.0;
  double torque_capacity_Nm = 0.0, torsional_stiffness_Nm_rad = 0.0, cycle_energy_J = 0.0;
  std::uint64_t motor = 0;
  if (!(fields.get(s.train) && fields.get(s.eta_b) && fields.get(s.eta_f) &&
        fields.get(eta_b_model) && fields.get(eta_f_model) && fields.get(s.lost_motion_rad) &&
        fields.get(s.contact_ratio) && fields.get(s.ring_root_diameter_m) &&
        fields.get(s.mass_kg) && fields.get(s.inertia_kgm2) && fields.get(torque_capacity_Nm) &&
        fields.get(torsional_stiffness_Nm_rad) && fields.get(s.kkt_residual) &&
        fields.get(cycle_energy_J) && fields.get(motor))) {
    return false;
  }
  s.eta_b_model = optional_of(eta_b_model);
  s.eta_f_model = optional_of(eta_f_model);
  s.torque_capacity_Nm = optional_of(torque_capacity_Nm);
  s.torsional_stiffness_Nm_rad = optional_of(torsional_stiffness_Nm_rad);
  s.cycle_energy_J = optional_of(cycle_energy_J);
  s.motor = static_cast<std::size_t>(motor);
  return fields.rest().empty() && static_cast<std::size_t>(s.status) < optimize::kStatusCount;
}

}  // namespace

std::uint64_t task_fingerprint(const std::vector<std::string>& contents) {
  std::uint64_t hash = hashed(hashed(kHashBasis, version()), git_commit());
  // No commit tells builds of changed sources apart.
  if (git_commit() == "unknown" || git_commit().ends_with("-dirty"))
    hash = hashed(hash, build_id());
  for (const std::string& content : contents) {
    hash = hashed_bytes(hashed(hash, content), content.size());
  }
  return hash;
}

Journal read_journal(const std::string& path, std::uint64_t fingerprint) {
  Journal journal;
  std::error_code status;
  journal.exists = std::filesystem::exists(path, status);
  if (!journal.exists) return journal;
  if (!std::filesystem::is_regular_file(path, status)) {
    throw InvalidInput(fmt::format("{}: cannot be read: is no regular file", path));
  }
  const std::string bytes = read_text(path, "a journal", std::numeric_limits<std::size_t>::max());
  std::string header(kFormat);
  put(header, fingerprint);
  if (bytes.size() < header.size() && header.starts_with(bytes)) {
    // Killed before its header was written.
    journal.exists = false;
    return journal;
  }
  Fields fields(bytes);
  std::string_view format;
  std::uint64_t task = 0;
  if (!(fields.take(kFormat.size(), format) && format == kFormat && fields.get(task)) ||
      task != fingerprint) {
    throw InvalidInput(
        fmt::format("{}: is of another task: the specification, the model or the program has "
                    "changed since; allowed: the same ones, or a run without --resume",
                    path));
  }
  journal.valid_bytes = bytes.size() - fields.rest().size();
  while (true) {
    std::uint32_t length = 0;
    std::string_view record;
    std::uint64_t hash = 0;
    optimize::RefinedSet set;
    if (!(fields.get(length) && length <= kMostBytes && fields.take(length, record) &&
          fields.get(hash) && hash == hashed(kHashBasis, record) && read_record(record, set))) {
      break;
    }
    journal.sets.push_back(std::move(set));
    journal.valid_bytes = bytes.size() - fields.rest().size();
  }
  std::ranges::stable_sort(journal.sets, {}, &optimize::RefinedSet::index);
  return journal;
}

JournalWriter::Descriptor::~Descriptor() {
  if (value >= 0) ::close(value);
}

JournalWriter::JournalWriter(std::string path, std::uint64_t fingerprint, const Journal& journal)
    : path_(std::move(path)), lock_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (lock_.value < 0 || ::flock(lock_.value, LOCK_EX | LOCK_NB) != 0) {
    const bool used = lock_.value >= 0 && errno == EWOULDBLOCK;
    throw InvalidInput(fmt::format("{}: cannot be written: {}", path_,
                                   used ? "another run is writing it" : std::strerror(errno)));
  }
  if (journal.exists) {
    std::error_code status;
    std::filesystem::resize_file(path_, journal.valid_bytes, status);
    if (status) {
      throw InvalidInput(fmt::format("{}: cannot be written: {}", path_, status.message()));
    }
    file_.open(path_, std::ios::binary | std::ios::app);
  } else {
    file_.open(path_, std::ios::binary | std::ios::trunc);
    std::string header(kFormat);
    put(header, fingerprint);
    file_ << header;
  }
  append({});
}

void JournalWriter::append(std::span<const optimize::RefinedSet> sets) {
  std::string bytes;
  for (const optimize::RefinedSet& set : sets) {
    const std::string record = record_of(set);
    put(bytes, static_cast<std::uint32_t>(record.size()));
    bytes += record;
    put(bytes, hashed(kHashBasis, record));
  }
  file_ << bytes;
  file_.flush();
  if (!file_) {
    throw InvalidInput(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
  }
}

}  // namespace gear3k::io
