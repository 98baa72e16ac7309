#pragma once

#include <array>

namespace tilefarm {

using Color = std::array<float, 3>;  // linear Rec. 709

}  // namespace tilefarm
