#pragma once
// Which limits a result was made for: those of a preset, those stated, those left bare.

#include <span>
#include <string>
#include <string_view>

#include "design/design.hpp"
#include "io/text/json.hpp"
#include "optimize/specification.hpp"

namespace gear3k::report {

/// What checks apply to, besides what every design has.
struct LimitsSubject {
  bool pair = false;
  bool ring = true;          ///< of a pair: gear 2 is one
  bool thermal = false;      ///< temperatures are stated
  bool rated = false;        ///< a load is
  bool ring_cutter = false;  ///< of some ring
};
LimitsSubject limits_subject(const design::Design& design);
LimitsSubject limits_subject(const design::PairDesign& design);
LimitsSubject limits_subject(const optimize::Specification& spec);

/// One line: the preset with its limits and those that were stated instead; without a preset, or of
/// preset bare, the limits of a workshop that nobody stated.  Then the other limits that leave no
/// reserve, and the checks that apply and are off.
std::string limits_line(const design::Limits& limits, const LimitsSubject& subject);

/// The limits of a preset among checks that block a design, with the keys that state others:
/// "; of preset printed: limits.tip_thickness_mm = 0.8"; "" where there is none.
/// @param checks  names; others than those of a check with a limit of the preset say nothing
std::string preset_note(const design::Limits& limits, std::span<const std::string_view> checks);

/// Whether the limit of a check is the preset's.
bool is_of_preset(const design::Limits& limits, design::CheckId check);

/// of_preset (names of the checks whose limits are the preset's), preset (null without), bare,
/// at_zero and off (names), in_force (by name, in the unit of the check; those of a load are in its
/// own tables).
io::Json limits_json(const design::Limits& limits, const LimitsSubject& subject);

}  // namespace gear3k::report
