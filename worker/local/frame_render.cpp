#include "worker/local/frame_render.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

// Films of one call are held in memory.
constexpr uint64_t kMostBytesPerCall = uint64_t{1} << 26;
// Long enough to keep a device busy, short enough to show progress.
constexpr double kSecondsPerCall = 2;

class FrameRender {
public:
    FrameRender(RenderBackend& backend, const JobSpec& spec, int32_t frame, const Clock& clock,
                const std::function<void(const FrameProgress&)>& onProgress)
        : backend_(backend),
          spec_(spec),
          frame_(frame),
          clock_(clock),
          onProgress_(onProgress),
          begin_(clock.now()),
          before_(backend.stats()),
          grid_(spec.image),
          schedule_(passSchedule(spec.stop.samples)),
          bytesPerPixel_(sizeof(PassPixel) + filmLayoutOf(spec).floats() * sizeof(float)) {
        for (uint32_t tile = 0; tile < grid_.count(); ++tile) {
            result_.tiles.emplace_back(grid_.rect(tile), filmLayoutOf(spec));
            errors_.push_back({.pixels = grid_.rect(tile).area()});
        }
        sums_.resize(grid_.count());
        progress_.samplesInAll = uint64_t{spec.image.width} * spec.image.height * spec.stop.samples;
    }

    RenderedFrame run() {
        std::vector<uint32_t> all(grid_.count());
        std::iota(all.begin(), all.end(), 0);
        const uint32_t free = freeLevels(spec_.stop, schedule_);
        for (uint32_t level = 0; level < free; ++level) {
            decides_ = spec_.stop.decidesOnTheWay() && level + 1 == free;
            renderTiles(schedule_[level], all, true);
        }
        while (!promoted_.empty()) renderRound(std::exchange(promoted_, {}));
        result_.stats = stats();
        result_.seconds = seconds();
        return std::move(result_);
    }

private:
    // The next pass of each of the tiles, which may be of different levels.
    void renderRound(const std::vector<uint32_t>& tiles) {
        std::map<uint32_t, std::vector<uint32_t>> bySamples;
        for (const uint32_t tile : tiles) bySamples[errors_[tile].samples].push_back(tile);
        size_t left = bySamples.size();
        for (const auto& [samples, some] : bySamples)
            renderTiles(*nextPass(schedule_, samples), some, --left == 0);
    }

    void renderTiles(SampleRange samples, std::span<const uint32_t> tiles, bool endsRound) {
        while (!tiles.empty()) {
            const size_t count = tilesOfCall(tiles, samples);
            const std::vector<uint32_t> some(tiles.begin(),
                                             tiles.begin() + static_cast<std::ptrdiff_t>(count));
            tiles = tiles.subspan(count);
            merge(backend_.render(frame_, some, samples), some);
            const bool whole = endsRound && tiles.empty();
            if (whole) addPoint();
            if (whole && decides_) decideNext();
            report(whole);
        }
    }

    void decideNext() {
        SampleDecision next = decide(spec_.stop, schedule_, errors_, {stats().deviceSeconds, seconds()});
        progress_.samplesInAll = next.pixelSamples;
        result_.stopReason = next.stop.value_or(result_.stopReason);
        auto promoted = next.tiles.begin();
        for (uint32_t tile = 0; tile < grid_.count(); ++tile)
            if (promoted != next.tiles.end() && *promoted == tile)
                ++promoted;
            else
                errors_[tile].rest();
        promoted_ = std::move(next.tiles);
    }

    // How many tiles go into one call does not change their bits.
    size_t tilesOfCall(std::span<const uint32_t> tiles, SampleRange samples) const {
        const double pace = seconds() > 0 ? static_cast<double>(progress_.samplesDone) / seconds() : 0;
        const double most = pace > 0 ? std::max(pace * kSecondsPerCall, 1.0) : 1e6;
        uint64_t pixels = 0;
        size_t count = 0;
        for (const uint32_t tile : tiles) {
            pixels += grid_.rect(tile).area();
            if (count > 0 && (pixels * bytesPerPixel_ > kMostBytesPerCall ||
                              static_cast<double>(pixels * samples.count) > most))
                break;
            ++count;
        }
        return count;
    }

    void merge(const std::vector<PassFilm>& films, const std::vector<uint32_t>& tiles) {
        if (films.size() != tiles.size())
            throw Error(ErrorCode::internal, "the device gave another number of tiles than it was asked for");
        for (size_t i = 0; i < films.size(); ++i) {
            FilmTile& tile = result_.tiles[tiles[i]];
            tile.merge(films[i]);
            ErrorSums& sums = sums_[tiles[i]] = {};
            sums.add(tile);
            errors_[tiles[i]].reach(tile.mergedSamples, sums.relativeVariance);
            progress_.samplesDone += films[i].rect.area() * films[i].samples.count;
        }
    }

    // The curve has the first point at or after each power of two and the end, as the server's.
    void addPoint() {
        ErrorSums sums;
        for (const ErrorSums& tile : sums_) sums.add(tile);
        const uint32_t samples = meanSamples(errors_);
        const bool newOctave = std::bit_width(samples) > std::bit_width(progress_.last.samples);
        progress_.last = {samples, std::nullopt, stats().deviceSeconds, std::nullopt};
        if (samples > 1) {
            progress_.last.relativeError = sums.relativeError();
            progress_.last.estimate = sums.estimate();
        }
        if (!std::exchange(lastPointStays_, newOctave)) result_.errorCurve.pop_back();
        result_.errorCurve.push_back(progress_.last);
    }

    void report(bool wholeLevel) {
        progress_.wholeLevel = wholeLevel;
        progress_.seconds = seconds();
        const double left = static_cast<double>(progress_.samplesInAll - progress_.samplesDone);
        progress_.secondsLeft = progress_.seconds * left / static_cast<double>(progress_.samplesDone);
        if (onProgress_) onProgress_(progress_);
    }

    // Of this frame alone; the device counts on.
    RenderStats stats() const {
        RenderStats now = backend_.stats();
        now.deviceSeconds -= before_.deviceSeconds;
        now.samples -= before_.samples;
        now.rays -= before_.rays;
        now.droppedSamples -= before_.droppedSamples;
        now.faults.rejectedPaths -= before_.faults.rejectedPaths;
        now.faults.truncatedPaths -= before_.faults.truncatedPaths;
        now.faults.truncatedThroughput -= before_.faults.truncatedThroughput;
        now.faults.clampedSamples -= before_.faults.clampedSamples;
        now.faults.clampedLuminance -= before_.faults.clampedLuminance;
        now.faults.lightsBehindGlass -= before_.faults.lightsBehindGlass;
        auto& dropped = now.faults.dropped;
        dropped.erase(dropped.begin(),
                      dropped.begin() + static_cast<std::ptrdiff_t>(before_.faults.dropped.size()));
        return now;
    }
    double seconds() const { return std::chrono::duration<double>(clock_.now() - begin_).count(); }

    RenderBackend& backend_;
    const JobSpec& spec_;
    const int32_t frame_;
    const Clock& clock_;
    const std::function<void(const FrameProgress&)>& onProgress_;
    const TimePoint begin_;
    const RenderStats before_;
    const TileGrid grid_;
    const std::vector<SampleRange> schedule_;
    const uint64_t bytesPerPixel_;
    std::vector<TileError> errors_;  // of the tiles, as the next two
    std::vector<ErrorSums> sums_;
    std::vector<uint32_t> promoted_;  // ascending: these get a further pass
    bool decides_ = false;            // the levels that every tile gets are done
    bool lastPointStays_ = true;      // of the curve, when there is a further one
    FrameProgress progress_;
    RenderedFrame result_;
};

}  // namespace

RenderedFrame renderFrame(RenderBackend& backend, const JobSpec& spec, int32_t frame, const Clock& clock,
                          const std::function<void(const FrameProgress&)>& onProgress) {
    return FrameRender(backend, spec, frame, clock, onProgress).run();
}

}  // namespace tilefarm
