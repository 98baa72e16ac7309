#include "tests/unit/server/support/test_farm.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

namespace tilefarm {
namespace {

// A float in [0, 1) from a few integers.
float noise(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    uint32_t h = a * 0x9E3779B1u ^ b * 0x85EBCA77u ^ c * 0xC2B2AE3Du ^ d * 0x27D4EB2Fu;
    h ^= h >> 15;
    h *= 0x2C1B3C6Du;
    h ^= h >> 12;
    return static_cast<float>(h >> 8) / static_cast<float>(1u << 24);
}

PassPixel renderPixel(uint32_t x, uint32_t y, int32_t frame, const SampleRange& samples) {
    PassPixel pixel;
    const auto n = static_cast<float>(samples.count);
    for (uint32_t c = 0; c < 3; ++c) {
        pixel.mean[c] = noise(x, y + 1000 * static_cast<uint32_t>(frame), samples.first, c);
        pixel.m2[c] = samples.count > 1 ? n * noise(x, y, samples.first, 10 + c) : 0;
        pixel.albedo[c] = noise(x, y, 7, c);
        pixel.normal[c] = noise(x, y, 8, c) - 0.5f;
    }
    pixel.m2Luminance = samples.count > 1 ? n * noise(x, y, samples.first, 20) : 0;
    pixel.count = n;
    pixel.depth = 3;
    pixel.alpha = 1;
    return pixel;
}

// Two ids a layer: one that all samples of the first pass see, and one that all later ones do.
void addExtra(PassFilm& film, uint32_t x, uint32_t y) {
    const FilmLayout& layout = film.layout;
    for (uint32_t c = 0; c < layout.means(); ++c)
        film.extra.push_back(noise(x, y, film.samples.first, 30 + c));
    for (uint32_t pair = 0; pair < layout.pairs(); ++pair) {
        const bool used = pair % kMatteRanks == 0;
        film.extra.push_back(!used ? 0 : film.samples.first == 0 ? 0.25f : 1e30f);
        film.extra.push_back(used ? static_cast<float>(film.samples.count) : 0);
    }
}

}  // namespace

PassFilm renderPass(const TileGrid& grid, const LeasedPass& pass, int32_t frame, const FilmLayout& layout) {
    PassFilm film{.tile = pass.tile, .rect = grid.rect(pass.tile), .samples = pass.samples, .pixels = {}};
    film.layout = layout;
    for (uint32_t y = 0; y < film.rect.height; ++y) {
        for (uint32_t x = 0; x < film.rect.width; ++x) {
            film.pixels.push_back(renderPixel(film.rect.x + x, film.rect.y + y, frame, pass.samples));
            addExtra(film, film.rect.x + x, film.rect.y + y);
        }
    }
    return film;
}

std::vector<PassFilm> renderLease(const Lease& lease) {
    std::vector<PassFilm> films;
    for (const LeasedPass& pass : lease.passes)
        films.push_back(renderPass(TileGrid(lease.spec.image), pass, lease.frame, filmLayoutOf(lease.spec)));
    return films;
}

std::vector<FilmTile> renderFrame(const JobSpec& spec, int32_t frame) {
    const TileGrid grid(spec.image);
    std::vector<FilmTile> tiles;
    for (uint32_t i = 0; i < grid.count(); ++i) {
        tiles.emplace_back(grid.rect(i), filmLayoutOf(spec));
        for (const SampleRange& range : passSchedule(spec.stop.samples)) {
            tiles.back().merge(renderPass(grid, {i, range}, frame, filmLayoutOf(spec)));
        }
    }
    return tiles;
}

void TestFarm::open() {
    store = std::make_unique<SqliteJobStore>(folder / "tilefarm.sqlite");
    scheduler = std::make_unique<Scheduler>(*store, clock, config);
    films = std::make_unique<FilmStore>(folder.path(), [this](std::string_view step) {
        if (probe) probe(step);
    });
    images = std::make_unique<FrameImages>(*store, *scheduler, *films, blobs, clock, folder.path());
    merger = std::make_unique<ResultMerger>(*store, *scheduler, *films);
}

void TestFarm::reopen() {
    merger.reset();
    images.reset();
    films.reset();
    scheduler.reset();
    store.reset();
    open();
}

JobRow TestFarm::job(const std::string& id) const {
    JobRow row;
    store->read([&](const ConstTables& t) { row = t.jobs.find(id).value(); });
    return row;
}

std::shared_ptr<const JobInfo> TestFarm::info(const std::string& id) const {
    std::shared_ptr<const JobInfo> info;
    store->read([&](const ConstTables& t) { info = scheduler->catalog().get(t, t.jobs.find(id).value()); });
    return info;
}

FrameRow TestFarm::frame(const std::string& id, int32_t number) const {
    FrameRow row;
    store->read([&](const ConstTables& t) { row = t.frames.find(t.jobs.find(id)->key, number).value(); });
    return row;
}

std::optional<Lease> TestFarm::tryLease(const std::string& worker, double seconds) {
    auto answer = scheduler->lease(hello(worker), seconds);
    if (auto* lease = std::get_if<Lease>(&answer)) return std::move(*lease);
    return std::nullopt;
}

Lease TestFarm::lease(const std::string& worker, double seconds) {
    auto lease = tryLease(worker, seconds);
    if (!lease) throw std::runtime_error("no work");
    return *std::move(lease);
}

ResultReceipt TestFarm::deliver(const Lease& lease, const std::vector<PassFilm>& passes,
                                double deviceSeconds) {
    return merger->accept(scheduler->resultTarget(lease.id, lease.epoch), passes, deviceSeconds);
}

void TestFarm::finish(const std::string& worker) {
    while (const auto lease = tryLease(worker)) deliver(*lease);
    images->finishFrames();
}

std::vector<FilmTile> TestFarm::film(const std::string& id, int32_t number) {
    std::vector<FilmTile> tiles;
    std::vector<TileRow> rows;
    const auto known = info(id);
    store->read([&](const ConstTables& t) { rows = t.frames.tiles(known->key, number); });
    for (const TileRow& tile : rows) tiles.push_back(films->read(*known, number, tile));
    return tiles;
}

bool sameBits(const std::vector<FilmTile>& a, const std::vector<FilmTile>& b) {
    if (a.size() != b.size()) return false;
    for (size_t i = 0; i < a.size(); ++i) {
        const size_t bytes = a[i].pixels.size() * sizeof(FilmPixel);
        const bool same = a[i].rect == b[i].rect && a[i].mergedSamples == b[i].mergedSamples &&
                          a[i].pixels.size() == b[i].pixels.size() &&
                          std::memcmp(a[i].pixels.data(), b[i].pixels.data(), bytes) == 0 &&
                          a[i].layout == b[i].layout && a[i].extra == b[i].extra;
        if (!same) return false;
    }
    return true;
}

}  // namespace tilefarm
