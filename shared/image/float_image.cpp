#include "shared/image/float_image.h"

#include <algorithm>

#include "shared/error/error.h"

namespace tilefarm {

int FloatImage::find(const std::string& channel) const {
    const auto found = std::find(channels.begin(), channels.end(), channel);
    return found == channels.end() ? -1 : static_cast<int>(found - channels.begin());
}

const std::vector<float>& FloatImage::plane(const std::string& channel) const {
    const int index = find(channel);
    if (index >= 0) return planes[static_cast<size_t>(index)];
    std::string known;
    for (const std::string& name : channels) known += (known.empty() ? "" : ", ") + name;
    throw Error(ErrorCode::invalidArgument, "the image has no channel '" + channel + "'; it has " + known);
}

}  // namespace tilefarm
