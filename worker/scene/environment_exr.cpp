#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "worker/scene/cube_map.h"
#include "worker/scene/environment_picture.h"
#include "worker/scene/limits.h"

namespace tilefarm {
namespace {

constexpr float kLargestHalf = 65504;
/// Texels of a display window that no bytes need bear out: data may be small in a large window.
constexpr int64_t kFreeTexels = int64_t{1} << 24;
constexpr int64_t kExrTexelsPerByte = 128;

using Planes = std::array<std::vector<float>, 3>;

/// G from what Y holds beside R and B; RY is (R − Y) / Y, BY likewise.
Planes fromLuminance(const FloatImage& image, const Primaries& primaries) {
    const auto weights = luminanceWeights(primaries);
    const std::vector<float>&y = image.plane("Y"), &ry = image.plane("RY"), &by = image.plane("BY");
    Planes rgb;
    for (auto& plane : rgb) plane.resize(y.size());
    for (size_t i = 0; i < y.size(); ++i) {
        const double r = (double{ry[i]} + 1) * y[i], b = (double{by[i]} + 1) * y[i];
        rgb[0][i] = static_cast<float>(r);
        rgb[1][i] = static_cast<float>((y[i] - weights[0] * r - weights[2] * b) / weights[1]);
        rgb[2][i] = static_cast<float>(b);
    }
    return rgb;
}

bool isGray(const FloatImage& image) {
    return image.find("R") < 0 && image.find("Y") >= 0 && image.find("RY") < 0 && image.find("BY") < 0;
}

Planes planesOf(const ExrPicture& exr) {
    const FloatImage& image = exr.image;
    if (isGray(image)) return {image.plane("Y"), image.plane("Y"), image.plane("Y")};
    if (image.find("R") < 0 && image.find("Y") >= 0) return fromLuminance(image, exr.primaries);
    return {image.plane("R"), image.plane("G"), image.plane("B")};
}

float infinityOf(const ExrPicture& exr, const char* channel) {
    const int index = exr.image.find(channel);
    return index >= 0 && exr.half[static_cast<size_t>(index)] ? kLargestHalf : 0;
}

void requireModest(const ExrPicture& exr) {
    const auto [x, y, width, height] = exr.display;
    const int64_t borne = static_cast<int64_t>(exr.image.pixelCount()) * kExrTexelsPerByte;
    const int64_t most = std::min<int64_t>(kMaxImageTexels, std::max(kFreeTexels, borne));
    if (width < 1 || height < 1 || width > most || height > most / width)
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("its display window has {} x {} texels around {} x {} of data", width, height,
                                exr.data.width, exr.data.height));
}

/// The window `to` of planes that fill `from`; what lies outside is black.
Image placed(const Planes& planes, const ExrWindow& from, const ExrWindow& to) {
    Image image;
    image.width = static_cast<uint32_t>(to.width);
    image.height = static_cast<uint32_t>(to.height);
    image.rgbaFloat.resize(size_t{4} * image.width * image.height);
    const int64_t first = std::max(from.x, to.x), last = std::min(from.x + from.width, to.x + to.width);
    for (int64_t y = 0; y < to.height; ++y) {
        float* row = image.rgbaFloat.data() + 4 * y * to.width;
        for (int64_t x = 0; x < to.width; ++x) row[4 * x + 3] = 1;
        const int64_t dataRow = y + to.y - from.y;
        if (dataRow < 0 || dataRow >= from.height) continue;
        for (int64_t x = first; x < last; ++x)
            for (size_t c = 0; c < 3; ++c)
                row[4 * (x - to.x) + static_cast<int64_t>(c)] =
                    planes[c][static_cast<size_t>(dataRow * from.width + x - from.x)];
    }
    return image;
}

bool overlap(const ExrWindow& a, const ExrWindow& b) {
    return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

std::vector<std::string> notesOf(const ExrPicture& exr) {
    std::vector<std::string> notes;
    if (exr.parts > 1) notes.push_back(fmt::format("only the first of its {} parts is used", exr.parts));
    if (!exr.cubeMap && !overlap(exr.data, exr.display))
        notes.push_back("black: its data window lies outside its display window");
    return notes;
}

}  // namespace

EnvironmentPicture readExrEnvironment(const std::filesystem::path& path) {
    const ExrPicture exr = readExrPicture(path);
    EnvironmentPicture picture;
    if (exr.cubeMap) {
        // Its layout is that of the data window.
        picture.image = equirectangularOf(placed(planesOf(exr), exr.data, exr.data));
    } else {
        requireModest(exr);
        picture.image = placed(planesOf(exr), exr.data, exr.display);
        picture.aspect = exr.pixelAspectRatio * double(exr.display.width) / double(exr.display.height);
    }
    if (!isGray(exr.image)) picture.toScene = toRec709(exr.primaries, exr.neutral);
    const char* const rgb[] = {"R", "G", "B"};
    for (size_t c = 0; c < 3; ++c)
        picture.infinity[c] = std::max(infinityOf(exr, rgb[c]), infinityOf(exr, "Y"));
    picture.notes = notesOf(exr);
    return picture;
}

}  // namespace tilefarm
