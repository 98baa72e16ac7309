#include "server/study/pictures.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/image/png.h"
#include "shared/image/primaries.h"

namespace tilefarm {
namespace {

constexpr std::array kColors{"R", "G", "B"};
constexpr double kFullDifference = 0.5;

// Which old pixels a new one covers along an axis, and how much of each.
struct Cover {
    uint32_t first = 0;
    std::vector<double> shares;  // of 1
};

std::vector<Cover> covers(uint32_t from, uint32_t to) {
    std::vector<Cover> found(to);
    const double scale = static_cast<double>(from) / to;
    for (uint32_t i = 0; i < to; ++i) {
        const double begin = i * scale, end = std::min<double>(from, (i + 1) * scale);
        found[i].first = std::min(from - 1, static_cast<uint32_t>(begin));
        for (uint32_t p = found[i].first; p < from && p < end; ++p)
            found[i].shares.push_back((std::min<double>(end, p + 1) - std::max<double>(begin, p)) / scale);
    }
    return found;
}

std::vector<float> resizedPlane(const std::vector<float>& plane, uint32_t width,
                                const std::vector<Cover>& columns, const std::vector<Cover>& rows,
                                bool variance) {
    std::vector<float> made;
    made.reserve(columns.size() * rows.size());
    for (const Cover& row : rows)
        for (const Cover& column : columns) {
            double sum = 0;
            for (size_t y = 0; y < row.shares.size(); ++y)
                for (size_t x = 0; x < column.shares.size(); ++x) {
                    const double share = row.shares[y] * column.shares[x];
                    sum += (variance ? share * share : share) *
                           plane[(row.first + y) * width + column.first + x];
                }
            made.push_back(static_cast<float>(sum));
        }
    return made;
}

double luminance(const FloatImage& image, size_t pixel) {
    static const std::array weights = luminanceWeights({});
    double sum = 0;
    for (size_t c = 0; c < weights.size(); ++c) sum += weights[c] * image.planes[c][pixel];
    return sum;
}

}  // namespace

FloatImage studiedPicture(const FloatImage& exr, bool denoised) {
    FloatImage picture{.width = exr.width, .height = exr.height, .channels = {}, .planes = {}};
    const auto take = [&](const std::string& from, const std::string& name) {
        picture.channels.push_back(name);
        picture.planes.push_back(exr.plane(from));
    };
    for (const std::string color : kColors) take(denoised ? "denoised." + color : color, color);
    for (const std::string color : kColors)
        if (const std::string variance = "variance." + color; !denoised && exr.find(variance) >= 0)
            take(variance, variance);
    return picture;
}

FloatImage resized(const FloatImage& image, uint32_t width, uint32_t height) {
    if (image.width == width && image.height == height) return image;
    const auto columns = covers(image.width, width), rows = covers(image.height, height);
    FloatImage made{.width = width, .height = height, .channels = image.channels, .planes = {}};
    for (size_t i = 0; i < image.planes.size(); ++i)
        made.planes.push_back(resizedPlane(image.planes[i], image.width, columns, rows,
                                           image.channels[i].starts_with("variance.")));
    return made;
}

FloatImage differencePicture(const FloatImage& image, const FloatImage& reference) {
    FloatImage shown{.width = image.width, .height = image.height, .channels = {"R", "G", "B"}, .planes = {}};
    shown.planes.assign(3, std::vector<float>(image.pixelCount()));
    for (size_t i = 0; i < image.pixelCount(); ++i) {
        const double wanted = luminance(reference, i);
        const double off = (luminance(image, i) - wanted) / (std::abs(wanted) + 0.01);
        const auto strength = static_cast<float>(std::min(1.0, std::abs(off) / kFullDifference));
        const std::array<float, 3> full =
            off > 0 ? std::array{0.9f, 0.12f, 0.03f} : std::array{0.03f, 0.2f, 0.9f};
        for (size_t c = 0; c < 3; ++c) shown.planes[c][i] = strength * full[c];
    }
    return shown;
}

std::string pngUrl(const FloatImage& image, uint32_t width) {
    const uint32_t shown = std::min(width, image.width);
    const auto height =
        std::max(1u, static_cast<uint32_t>(std::lround(double{1} * image.height * shown / image.width)));
    const auto png = encodePng(toneMapped(resized(image, shown, height), {}));
    std::string text(4 * ((png.size() + 2) / 3) + 1, '\0');
    const int length =
        EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                        reinterpret_cast<const unsigned char*>(png.data()), static_cast<int>(png.size()));
    text.resize(static_cast<size_t>(length));
    return "data:image/png;base64," + text;
}

}  // namespace tilefarm
