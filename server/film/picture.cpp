#include "server/film/picture.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

#include <algorithm>

#include "shared/error/error.h"
#include "shared/image/tone.h"

namespace tilefarm {
namespace {
constexpr uint32_t kRowsAtATime = 64;
}

PictureBuilder::PictureBuilder(uint32_t frameWidth, uint32_t frameHeight, uint32_t width,
                               const ToneMapping& mapping)
    : frameWidth_(frameWidth), frameHeight_(frameHeight), mapping_(mapping) {
    image_.width = std::clamp<uint32_t>(width, 1, frameWidth);
    image_.height = std::max<uint32_t>(
        1, static_cast<uint32_t>((uint64_t{frameHeight} * image_.width + frameWidth / 2) / frameWidth));
    image_.pixels.resize(size_t{3} * image_.width * image_.height);
    if (image_.width != frameWidth) sums_.resize(size_t{image_.width} * image_.height);
}

void PictureBuilder::set(size_t pixel, const std::array<float, 3>& radiance) {
    const auto display = toDisplay(radiance, mapping_);
    std::copy(display.begin(), display.end(), image_.pixels.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
}

void PictureBuilder::add(uint32_t x, uint32_t y, const std::array<float, 3>& radiance) {
    if (sums_.empty()) return set(size_t{y} * frameWidth_ + x, radiance);
    const size_t column = uint64_t{x} * image_.width / frameWidth_;
    const size_t row = uint64_t{y} * image_.height / frameHeight_;
    Sum& sum = sums_[row * image_.width + column];
    for (size_t c = 0; c < 3; ++c) sum.radiance[c] += radiance[c];
    ++sum.count;
}

void PictureBuilder::add(const FilmTile& tile) {
    const Rect& r = tile.rect;
    for (uint32_t i = 0; i < tile.pixels.size(); ++i) {
        const auto& mean = tile.pixels[i].mean;
        add(r.x + i % r.width, r.y + i / r.width,
            {static_cast<float>(mean[0]), static_cast<float>(mean[1]), static_cast<float>(mean[2])});
    }
}

void PictureBuilder::addRows(uint32_t y, std::span<const std::array<float, 3>> pixels) {
    for (uint32_t i = 0; i < pixels.size(); ++i) add(i % frameWidth_, y + i / frameWidth_, pixels[i]);
}

RgbImage PictureBuilder::finish() {
    for (size_t i = 0; i < sums_.size(); ++i) {
        auto mean = sums_[i].radiance;
        for (float& value : mean) value /= std::max(1.0f, sums_[i].count);
        set(i, mean);
    }
    return std::move(image_);
}

void forEachRows(
    const std::filesystem::path& path, const std::string& layer,
    const std::function<void(uint32_t y, std::span<const std::array<float, 3>> pixels)>& visit) try {
    Imf::InputFile file(path.c_str());
    const auto& window = file.header().dataWindow();
    const auto width = static_cast<uint32_t>(window.max.x - window.min.x + 1);
    const auto height = static_cast<uint32_t>(window.max.y - window.min.y + 1);
    std::vector<std::array<float, 3>> pixels(size_t{width} * kRowsAtATime);
    for (uint32_t y = 0; y < height; y += kRowsAtATime) {
        const uint32_t rows = std::min(kRowsAtATime, height - y);
        const Imath::V2i origin(window.min.x, window.min.y + static_cast<int>(y));
        Imf::FrameBuffer buffer;
        for (size_t c = 0; c < 3; ++c) {
            buffer.insert((layer.empty() ? "" : layer + ".") + "RGB"[c],
                          Imf::Slice::Make(Imf::FLOAT, &pixels[0][c], origin, width, rows, sizeof pixels[0],
                                           sizeof pixels[0] * width));
        }
        file.setFrameBuffer(buffer);
        file.readPixels(origin.y, origin.y + static_cast<int>(rows) - 1);
        visit(y, std::span(pixels).first(size_t{width} * rows));
    }
} catch (const Error&) {
    throw;
} catch (const std::exception& fault) {
    throw Error(ErrorCode::internal, "cannot read '" + path.string() + "': " + fault.what());
}

}  // namespace tilefarm
