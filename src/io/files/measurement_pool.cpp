#include "io/files/measurement_pool.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "io/files/measurement_repetitions.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

using calibrate::Covariate;
using calibrate::Kind;
using calibrate::MeasurementSet;
using calibrate::Observation;

/// Sessions of files that are pooled.
class Sessions {
 public:
  explicit Sessions(bool several_files) : several_files_(several_files) {}

  /// Index in the pooled set of each session of a file; the last entry is for rows without a label.
  std::vector<int> take(const std::string& path, const MeasurementText& file,
                        MeasurementSet& pooled) {
    std::vector<int> index;
    index.reserve(file.set.runs.size() + 1);
    for (const std::string& label : file.set.runs) {
      const auto known = shared_.find(label);
      if (file.notes.runs_shared && known != shared_.end()) {
        index.push_back(known->second);
        continue;
      }
      const bool taken = labels_.contains(label);
      index.push_back(append(taken ? fmt::format("{} ({})", label, path) : label, pooled));
      if (file.notes.runs_shared) shared_.emplace(label, index.back());
    }
    index.push_back(-1);
    if (several_files_ && !file.has_run) index.back() = append(path, pooled);
    return index;
  }

 private:
  int append(const std::string& label, MeasurementSet& pooled) {
    labels_.insert(label);
    pooled.runs.push_back(label);
    return static_cast<int>(pooled.runs.size()) - 1;
  }

  bool several_files_;
  std::unordered_map<std::string, int> shared_;
  std::unordered_set<std::string> labels_;  ///< of all files so far
};

/// Appends the covariates of a file; rows of files without one have none of its values.
/// @param before  rows of the set before those of the file
void append_covariates(const std::vector<Covariate>& covariates, std::size_t before,
                       MeasurementSet& set) {
  for (const Covariate& covariate : covariates) {
    auto at = std::ranges::find(set.covariates, covariate.name, &Covariate::name);
    if (at == set.covariates.end()) {
      set.covariates.push_back({.name = covariate.name, .value = {}});
      at = set.covariates.end() - 1;
    }
    at->value.resize(before, calibrate::kUnknown);
    at->value.insert(at->value.end(), covariate.value.begin(), covariate.value.end());
  }
  for (Covariate& covariate : set.covariates) {
    covariate.value.resize(set.rows.size(), calibrate::kUnknown);
  }
}

TorqueAngleFile loop_of(const std::string& path, const MeasurementText& file) {
  TorqueAngleFile loop;
  loop.path = path;
  loop.sun_locked = file.notes.sun_locked.value_or(true);
  const std::size_t samples = file.set.rows.size();
  loop.time_s.reserve(samples);
  loop.angle_rad.reserve(samples);
  loop.torque_Nm.reserve(samples);
  if (file.has_run) loop.run.reserve(samples);
  for (const Observation& o : file.set.rows) {
    loop.time_s.push_back(o.condition.time_s);
    loop.angle_rad.push_back(o.condition.output_angle_rad);
    loop.torque_Nm.push_back(o.response);
    if (file.has_run) loop.run.push_back(file.set.runs[static_cast<std::size_t>(o.condition.run)]);
  }
  return loop;
}

}  // namespace

MeasurementSet MeasurementPool::pooled(Kind kind, const std::vector<File*>& files) {
  MeasurementSet set;
  set.kind = kind;
  std::size_t rows = 0;
  for (const File* file : files) rows += file->content.set.rows.size();
  set.rows.reserve(rows);
  Sessions sessions(files.size() > 1);
  for (File* file : files) {
    MeasurementSet& own = file->content.set;
    const std::vector<int> run = sessions.take(file->path, file->content, set);
    const int index = static_cast<int>(set.files.size());
    set.files.push_back(file->path);
    if (!file->content.notes.unit.empty()) set.units.push_back(file->content.notes.unit);
    set.notes.insert(set.notes.end(), own.notes.begin(), own.notes.end());
    const std::size_t before = set.rows.size();
    for (Observation o : own.rows) {
      o.file = index;
      o.condition.run =
          o.condition.run < 0 ? run.back() : run[static_cast<std::size_t>(o.condition.run)];
      set.rows.push_back(o);
    }
    append_covariates(own.covariates, before, set);
    own.rows = {};
    own.covariates = {};
  }
  leave_out_noted(set, copies_of_earlier_files(set), "a copy of a row of an earlier file");
  return set;
}

void MeasurementPool::add(const std::string& path, std::string_view text) {
  File& file = files_.emplace_back(
      File{.path = path, .size = text.size(), .hash = hashed(kHashBasis, text)});
  for (const File& other : files_) {
    if (&other != &file && other.size == file.size && other.hash == file.hash && file.size > 0) {
      file.content.complaints.add(
          {}, fmt::format("holds the same bytes as {}: allowed: each file once", other.path));
      return;
    }
  }
  file.content = read_measurement_text(path, without_mark(text));
  if (!file.content.notes.kind) return;
  // The fingerprint goes on from file to file.
  std::uint64_t& hash = fingerprint_[static_cast<std::size_t>(*file.content.notes.kind)];
  hash = hashed(hash, text);
}

void MeasurementPool::add_unreadable(const std::string& path, const std::string& reason) {
  files_.emplace_back(File{.path = path}).content.complaints.add({}, reason);
}

MeasurementPool::ByKind MeasurementPool::by_kind() {
  ByKind by_kind;
  for (File& file : files_) {
    const auto& kind = file.content.notes.kind;
    if (kind) by_kind[static_cast<std::size_t>(*kind)].push_back(&file);
  }
  return by_kind;
}

std::string MeasurementPool::errors() const {
  std::string errors;
  for (const File& file : files_) {
    if (file.content.complaints.none()) continue;
    if (!errors.empty()) errors += '\n';
    errors += file.content.complaints.text(file.path);
  }
  return errors;
}

void MeasurementPool::require_units(const ByKind& by_kind) {
  // Torque-angle records become rows of lost motion.
  std::array<std::vector<File*>, 3> together{by_kind[static_cast<std::size_t>(Kind::kTransmission)],
                                             by_kind[static_cast<std::size_t>(Kind::kLostMotion)],
                                             by_kind[static_cast<std::size_t>(Kind::kPairLoss)]};
  const auto& records = by_kind[static_cast<std::size_t>(Kind::kTorqueAngle)];
  together[1].insert(together[1].end(), records.begin(), records.end());
  for (const std::vector<File*>& files : together) {
    const auto stated = std::ranges::find_if(
        files, [](const File* file) { return file->content.notes.unit_line > 0; });
    if (stated == files.end()) continue;
    for (File* file : files) {
      if (file->content.notes.unit_line > 0) continue;
      file->content.complaints.add(
          {}, fmt::format("has no note \"# unit: ...\" and {} has (line {}): allowed: in all files "
                          "of a kind or in none",
                          (*stated)->path, (*stated)->content.notes.unit_line));
    }
  }
}

Measurements MeasurementPool::finish() {
  const ByKind by_kind = this->by_kind();
  for (const std::vector<File*>& files : by_kind) {
    const auto stated =
        std::ranges::find_if(files, [](const File* file) { return file->content.has_sigma; });
    if (stated == files.end()) continue;
    for (File* file : files) {
      if (file->content.has_sigma || !file->content.complaints.none()) continue;
      file->content.complaints.add(
          {}, fmt::format("has no column of standard deviations (sigma) and {} "
                          "has: allowed: in all files of a kind or in none",
                          (*stated)->path));
    }
  }
  require_units(by_kind);
  const std::string all_errors = errors();
  if (!all_errors.empty()) throw InvalidInput(all_errors);
  Measurements measurements;
  for (std::size_t k = 0; k < by_kind.size(); ++k) {
    if (by_kind[k].empty()) continue;
    const auto kind = static_cast<Kind>(k);
    if (kind == Kind::kTorqueAngle) {
      for (File* file : by_kind[k]) {
        measurements.loops.push_back(loop_of(file->path, file->content));
        file->content.set.rows = {};
      }
    }
    measurements.sets.push_back(pooled(kind, by_kind[k]));
    measurements.sets.back().fingerprint = fingerprint_[k];
  }
  return measurements;
}

}  // namespace gear3k::io
