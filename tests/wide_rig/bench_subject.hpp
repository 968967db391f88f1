#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "tests/rig/deterministic_random.hpp"
#include "tests/rig/rig_train.hpp"
#include "tests/wide_rig/bench_row.hpp"

namespace gear3k::wide_rig {

/// Where an effect enters the bench. Units of the value: friction and gains relative, drags and
/// offset Nm, lost motion arcmin.
enum class Channel {
  friction,        ///< coefficient of a mesh times 1 + value
  skew,            ///< coefficient times 1 + value in approach, 1 - value in recess
  drag,            ///< torque against the rotation of a body
  pin,             ///< coefficient of friction of the planets on their pins
  output_bearing,  ///< share of the output torque lost there
  gain,            ///< reading times 1 + value
  offset,          ///< added to the sensor's signed reading
  lost_motion,     ///< added
  expansion,       ///< of all centre distances, relative
  loss             ///< added to the loss factor of a pair
};

enum class Body { sun, planet, carrier, output, none };
inline constexpr std::array<const char*, 4> kBodyNames{"sun", "planet", "carrier", "R2"};

/// What a law of friction may depend on at one mesh. Of a black box: torque at the output and speed
/// of the fast shaft in place of tooth force and sliding speed.
struct MeshPoint {
  std::size_t mesh = 0;
  double force_N = 0.0;  ///< on the flanks of one planet's mesh
  double sliding_m_s = 0.0;
  bool a_drives = true;
};

/// One effect: its value at amplitude a in a row.
struct HiddenEffect {
  std::string cause{}, law{}, acts_on{};
  Channel channel = Channel::friction;
  Body body = Body::sun;
  std::function<double(double, const BenchRow&, const MeshPoint&)> value{};
  double largest = 1e9, smallest = -1e9;  ///< of the amplitude
  double start = 0.01;                    ///< an amplitude to begin the search with
  std::vector<std::string> companions{};
  /// Name, unit and value per amplitude of what the contract defines; value = base + slope a.
  struct Parameter {
    std::string name, unit;
    double base = 0.0, slope = 1.0;
  };
  std::vector<Parameter> parameters{};
};

struct AppliedEffect {
  const HiddenEffect* effect = nullptr;
  double amplitude = 0.0;
};

/// What stands on the bench.
struct BenchSubject {
  bool black_box = false;
  rig::Train train{};  ///< unless black_box
  double ratio = 1.0, efficiency_forward = 1.0, efficiency_backward = 1.0, backlash_arcmin = 0.0;
  double friction = 0.1, module_mm = 1.0;
  std::string toml{};

  /// Load at which a law of friction sees this force, and the same of speed: of the mesh P2-R2, or
  /// of the black box itself.
  double force_at(double output_torque_Nm) const;
  double sliding_at(double sun_speed_rpm) const;
};

BenchSubject random_gearbox(rig::DeterministicRandom& random, bool may_be_black_box);
/// A pair of steel gears without shift, for pair_loss.
BenchSubject random_pair(rig::DeterministicRandom& random);

/// A mean of the losses that leaves the physical: the reading's clean value and whether the
/// state behind it can exist.
struct BenchReading {
  double value = 0.0;
  bool physical = true;
};

/// Sun torque that the sensor reads, Nm.
///
/// Forces: balance of sun, planets, carrier and R2 with Coulomb friction in the meshes and drags on
/// the bodies. Source: own derivation (free bodies), as tests/rig/rig_train.hpp.
BenchReading sun_torque(const BenchSubject& subject, const BenchRow& row,
                        const std::vector<AppliedEffect>& effects);
/// Lost motion at the output, arcmin.
BenchReading lost_motion(const BenchSubject& subject, const BenchRow& row,
                         const std::vector<AppliedEffect>& effects);
/// Loss factor of a pair without profile shift at the standard centre distance.
BenchReading pair_loss(const BenchSubject& subject, const BenchRow& row,
                       const std::vector<AppliedEffect>& effects);

}  // namespace gear3k::wide_rig
