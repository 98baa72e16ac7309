// Case 45: a frame in parts, merged by the server whatever their order and grouping, is the frame at once.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <random>

#include "shared/image/exr.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/test_scenes.h"
#include "tests/unit/server/support/test_farm.h"
#include "worker/render/renderer.h"

namespace tilefarm {
namespace {

Scene someRoom() {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte({0.7f, 0.6f, 0.5f}, glm::vec3(0.1f)));
    addMesh(scene, sphereMesh(8), Material{}, glm::scale(glm::dmat4(1), glm::dvec3(0.4)));
    return scene;
}

class HardMerge : public DeviceTest {
protected:
    /// 40 × 40 pixels, 24 samples; tiles at the edges are cut.
    static JobSpec job(uint32_t tileSize) {
        JobSpec spec = smallJob(24);
        spec.image = {.width = 40, .height = 40, .tileSize = tileSize};
        return spec;
    }
    std::vector<PassFilm> rendered(const JobSpec& spec, const std::vector<uint32_t>& tiles,
                                   SampleRange samples) {
        if (!renderer_ || tileSize_ != spec.image.tileSize)
            renderer_ = std::make_unique<Renderer>(
                device, someRoom(), cameraAt({0, 0, 0.9}, {0.1, 0.2, -1}, 1.2), spec.image, spec.settings);
        tileSize_ = spec.image.tileSize;
        return renderer_->render(0, tiles, samples);
    }
    /// What a worker uploads for a lease: an EXR of its passes.
    std::vector<PassFilm> uploaded(const Lease& lease) {
        std::vector<PassFilm> films;
        for (const LeasedPass& pass : lease.passes)
            films.push_back(rendered(lease.spec, {pass.tile}, pass.samples).front());
        return decodePassFilms(encodePassFilms(films, lease.spec.image, {}));
    }
    /// One tile, merged where it was rendered.
    std::vector<FilmPixel> atOnce(const std::vector<SampleRange>& ranges) {
        const JobSpec spec = job(128);
        FilmTile tile(TileGrid(spec.image).rect(0));
        for (const SampleRange& range : ranges) tile.merge(rendered(spec, {0}, range).front());
        return tile.pixels;
    }

private:
    std::unique_ptr<Renderer> renderer_;
    uint32_t tileSize_ = 0;
};

void expectSameBits(const std::vector<FilmTile>& tiles, const std::vector<FilmPixel>& whole, uint32_t width) {
    size_t covered = 0;
    for (const FilmTile& tile : tiles)
        for (size_t i = 0; i < tile.pixels.size(); ++i, ++covered) {
            const size_t at = (tile.rect.y + i / tile.rect.width) * width + tile.rect.x + i % tile.rect.width;
            ASSERT_EQ(std::memcmp(&tile.pixels[i], &whole[at], sizeof(FilmPixel)), 0) << "pixel " << at;
        }
    EXPECT_EQ(covered, whole.size());
}

TEST_F(HardMerge, HardCase45_PartsInAnyOrderAndGrouping) {
    const std::vector<FilmPixel> whole = atOnce(passSchedule(24));
    ASSERT_GT(std::count_if(whole.begin(), whole.end(), [](const FilmPixel& p) { return p.m2[0] > 0; }),
              1000);
    std::mt19937 random(45);
    size_t most = 0;
    // Leases of a pass of a tile, of some, of all; tiles of 16, where those at the edges are cut, and of 32.
    for (const auto& [tileSize, pixelsPerLease] :
         {std::pair(16u, 256u), {16u, 5u * 256}, {16u, 1u << 20}, {32u, 2u * 1024}}) {
        for (int order = 0; order < 3; ++order) {
            QueueConfig config;
            config.mostPixelsPerLease = pixelsPerLease;
            TestFarm farm(config);
            const JobSpec spec = job(tileSize);
            const std::string id = farm.scheduler->submit(spec).job.id;
            std::vector<Lease> leases;
            while (const auto lease = farm.tryLease()) leases.push_back(*lease);
            most = std::max(most, leases.size());
            if (order == 1) std::reverse(leases.begin(), leases.end());
            if (order > 1) std::shuffle(leases.begin(), leases.end(), random);
            for (const Lease& lease : leases)
                ASSERT_EQ(farm.deliver(lease, uploaded(lease)).merged, lease.passes.size());
            SCOPED_TRACE(testing::Message() << "tiles of " << tileSize << ", " << leases.size() << " leases");
            expectSameBits(farm.film(id), whole, spec.image.width);
        }
    }
    EXPECT_EQ(most, 9u * passSchedule(24).size());
}

TEST_F(HardMerge, HardCase45_AnyCutOfTheSamples) {
    // The farm cuts samples in one way alone. Any other rounds otherwise, in the last digits of a pass's
    // fp32.
    const std::vector<FilmPixel> whole = atOnce(passSchedule(24));
    for (const std::vector<SampleRange>& cut : {std::vector<SampleRange>{{0, 24}},
                                                {{0, 5}, {5, 1}, {6, 18}},
                                                {{0, 12}, {12, 12}},
                                                {{0, 23}, {23, 1}}}) {
        const std::vector<FilmPixel> pixels = atOnce(cut);
        for (size_t i = 0; i < whole.size(); ++i)
            for (size_t c = 0; c < 3; ++c) {
                ASSERT_NEAR(pixels[i].mean[c], whole[i].mean[c], 1e-6 * whole[i].mean[c]) << i;
                ASSERT_NEAR(pixels[i].m2[c], whole[i].m2[c], 1e-5 * whole[i].m2[c] + 1e-9) << i;
            }
    }
}

}  // namespace
}  // namespace tilefarm
