#pragma once
// What the reports of all papers have in common.

#include <optional>
#include <string>
#include <vector>

#include "io/text/json.hpp"
#include "papers/compared_row.hpp"
#include "papers/ledger.hpp"
#include "report/fields.hpp"

namespace gear3k::papers {

/// A number with fixed decimals, "-" for none.
std::string shown(const std::optional<double>& value, int decimals);

/// A quantity of a gearbox: an item of the JSON, a line of the CSV.
report::Fields row_fields(const std::string& gearbox, const ComparedRow& row);

/// A line of the CSV of `reproduce`, shorter ones with blank fields at their end.
std::string reproduce_line(std::vector<std::string> fields);

/// @param source  what the ledger is of: "paper", "thesis"
std::string ledger_text(const std::vector<LedgerEntry>& ledger, const char* source);
io::Json ledger_json(const std::vector<LedgerEntry>& entries);
/// @param name  the lines' first field, before the entry's number
std::string ledger_csv(const std::vector<LedgerEntry>& ledger, const std::string& name);

}  // namespace gear3k::papers
