#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace tilefarm {

/// Names come from outside: what could drive a terminal is shown as '?'.
std::string printable(std::string text);

using TableRow = std::vector<std::string>;
/// Columns as wide as their longest text.
void printTable(const std::vector<TableRow>& rows, std::ostream& out);

}  // namespace tilefarm
