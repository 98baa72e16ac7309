#include "shared/film/pixel_error.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tilefarm {
namespace {

// 0.01 keeps black pixels from dominating; it is about the least radiance a display shows.
constexpr double kDark = 0.01;
// The constants below were chosen together on the scenes of docs/accuracy.md, which has what they reach.
constexpr double kNoiseWeight = 20;    // of a pixel's noise against the spread of its neighbours
constexpr double kFewest = 2;          // neighbours, counted by weight, that can stand for a pixel
constexpr double kOwnVote = 0.7;       // of the pixel itself in the mean of its neighbours
constexpr double kLeastVote = 0.04;    // of its luminance that a lone bright pixel keeps there
constexpr double kMeanNoise = 1;       // a noisy mean m overstates 1/E[m]²: Var[m] joins the square
constexpr double kAlike = 0.15;        // weight from which a neighbour tells how bright such pixels get
constexpr double kReliable = 0.04;     // squared relative noise below which a pixel's luminance is known
constexpr double kEdgeSpread = 0.03;   // spread that a reliable pixel beside it gives, of their squared step
constexpr float kAlbedoScale = 0.01f;  // squared distances at which weights have fallen to a good third
constexpr float kNormalScale = 0.25f;
constexpr float kDepthScale = 0.1f;  // of the farther depth
constexpr float kReach = 3.5f;       // distance at which they reach 0

constexpr size_t kBlockPixels = size_t{kErrorBlock} * kErrorBlock;

struct Look {
    std::array<float, 3> albedo, normal;
    float depth;
};

float squaredDistance(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

// 1 for pixels that look the same; close to exp(−distance), without its cost.
float likeness(const Look& a, const Look& b) {
    const float farther = std::max({a.depth, b.depth, 1e-6f});
    const float distance = squaredDistance(a.albedo, b.albedo) / kAlbedoScale +
                           squaredDistance(a.normal, b.normal) / kNormalScale +
                           std::abs(a.depth - b.depth) / (kDepthScale * farther);
    const float left = std::max(0.f, 1 - distance / kReach);
    return left * left;
}

/// The pixels of one block that lie in the tile.
class Block {
public:
    Block(const FilmTile& tile, uint32_t x0, uint32_t y0, uint32_t width, uint32_t height)
        : width_(width), height_(height) {
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x)
                take(tile.pixels[size_t{y0 + y} * tile.rect.width + x0 + x], y * width + x);
        compareAll();
    }

    PixelError error(uint32_t pixel) const {
        const double noise = variance_[pixel], own = luminance_[pixel];
        if (!(noise > 0)) return {};
        const Neighbours near = neighbours(pixel);
        if (!(near.count >= kFewest) || !std::isfinite(noise))
            return {noise / (own * own + kDark * kDark), 0};

        // 1. How far pixels like this one differ in truth: what their spread, its own distance from them or
        //    an edge beside it show beyond noise.
        const double step = own - near.mean, noiseOfMean = near.noise / near.count;
        const double spread = std::max({0.0, near.spread - near.noise, step * step - noise - noiseOfMean,
                                        kEdgeSpread * squaredStepAtEdge(pixel, near.mean)});
        const double borrowed = kNoiseWeight * noise / (kNoiseWeight * noise + spread);
        // 2. The pixel joins the mean as if it were hardly brighter than the brightest of them, unless none
        //    has met light yet. (Light that one pixel of the block met is light that all of them may meet.)
        const double vote =
            near.brightest > kDark ? std::max(std::min(own, near.brightest), kLeastVote * own) : own;
        const double mean = (near.weight * near.mean + kOwnVote * vote) / (near.weight + kOwnVote);
        const double truth = borrowed * mean + (1 - borrowed) * own;
        const double doubt = kMeanNoise * borrowed * borrowed * noiseOfMean;
        return {noise / (truth * truth + doubt + kDark * kDark), borrowed};
    }

private:
    struct Neighbours {
        double weight = 0, count = 0;  // sum of weights; pixels of equal weight that would be as good
        double mean = 0, noise = 0, spread = 0, brightest = 0;
    };

    void take(const FilmPixel& pixel, uint32_t at) {
        luminance_[at] = pixel.luminance();
        variance_[at] = pixel.varianceOfMeanLuminance();
        for (size_t c = 0; c < 3; ++c) {
            look_[at].albedo[c] = static_cast<float>(pixel.albedo[c]);
            look_[at].normal[c] = static_cast<float>(pixel.normal[c]);
        }
        look_[at].depth = static_cast<float>(pixel.depth);
    }

    // Likeness is mutual, and is nothing between a pixel and itself.
    void compareAll() {
        for (uint32_t i = 0; i < width_ * height_; ++i) {
            weights_[i][i] = 0;
            for (uint32_t j = 0; j < i; ++j) weights_[i][j] = weights_[j][i] = likeness(look_[i], look_[j]);
        }
    }

    Neighbours neighbours(uint32_t pixel) const {
        Neighbours near;
        const auto& weights = weights_[pixel];
        double squares = 0;
        const uint32_t pixels = width_ * height_;
        for (uint32_t j = 0; j < pixels; ++j) {
            const double w = weights[j];
            near.weight += w;
            squares += w * w;
            near.mean += w * luminance_[j];
            if (w > 0) near.noise += w * variance_[j];  // which may be infinite
            if (w > kAlike) near.brightest = std::max(near.brightest, luminance_[j]);
        }
        if (!(squares > 0)) return {};
        near.count = near.weight * near.weight / squares;
        near.mean /= near.weight;
        near.noise /= near.weight;
        for (uint32_t j = 0; j < pixels; ++j) {
            const double step = luminance_[j] - near.mean;
            near.spread += double{weights[j]} * step * step;
        }
        near.spread *= near.count / ((near.count - 1) * near.weight);  // as of a sample variance
        return std::isfinite(near.noise) ? near : Neighbours{};
    }

    // A pixel beside one of known brightness may hold part of it: a silhouette, a highlight's rim.
    double squaredStepAtEdge(uint32_t pixel, double mean) const {
        const uint32_t x = pixel % width_, y = pixel / width_;
        double most = 0;
        for (uint32_t v = y - std::min(y, 1u); v < std::min(y + 2, height_); ++v)
            for (uint32_t u = x - std::min(x, 1u); u < std::min(x + 2, width_); ++u) {
                const uint32_t j = v * width_ + u;
                const double l = luminance_[j];
                if (j != pixel && variance_[j] < kReliable * l * l)
                    most = std::max(most, (l - mean) * (l - mean));
            }
        return most;
    }

    const uint32_t width_, height_;
    std::array<double, kBlockPixels> luminance_, variance_;
    std::array<Look, kBlockPixels> look_;
    std::array<std::array<float, kBlockPixels>, kBlockPixels> weights_;
};

// To the next block's begin, or the end.
uint32_t blockLength(uint32_t at, uint32_t origin, uint32_t end) {
    return std::min(kErrorBlock - (origin + at) % kErrorBlock, end - at);
}

}  // namespace

std::vector<PixelError> pixelErrors(const FilmTile& tile) {
    const Rect& rect = tile.rect;
    std::vector<PixelError> errors(tile.pixels.size());
    for (uint32_t y = 0, rows; y < rect.height; y += rows) {
        rows = blockLength(y, rect.y, rect.height);
        for (uint32_t x = 0, columns; x < rect.width; x += columns) {
            columns = blockLength(x, rect.x, rect.width);
            const Block block(tile, x, y, columns, rows);
            for (uint32_t i = 0; i < columns * rows; ++i)
                errors[size_t{y + i / columns} * rect.width + x + i % columns] = block.error(i);
        }
    }
    return errors;
}

}  // namespace tilefarm
