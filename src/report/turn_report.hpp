#pragma once
// Lost motion and transmission error over a turn, as printed and written.

#include <string>
#include <vector>

#include "backlash/turn_orders.hpp"

namespace gear3k::report {

/// One built gearbox over the output's angle.
struct TurnResult {
  std::string name;  ///< of the design
  backlash::Turn turn;
  std::vector<backlash::OrderFit> fits;  ///< as of backlash::turn_orders()
};

/// An order as tables name it: "sun against the carrier", "sun", "3 x sun against the carrier",
/// "teeth of stage 1".
std::string order_name(const backlash::TurnOrder& order);

/// Range of lost motion and of the transmission errors, least margin, and of each the strongest
/// orders.
std::string turn_table(const TurnResult& result);

/// One row per angle; where it does not assemble, all fields but angle and margin are empty.
std::string turn_csv(const TurnResult& result);

/// One row per quantity and order, the rest and the mean at the end of each quantity.
std::string turn_orders_csv(const TurnResult& result);

}  // namespace gear3k::report
