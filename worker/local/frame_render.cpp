#include "worker/local/frame_render.h"

#include <algorithm>
#include <bit>
#include <numeric>

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
          bytesPerPixel_(sizeof(PassPixel) + filmLayoutOf(spec).floats() * sizeof(float)) {
        for (uint32_t tile = 0; tile < grid_.count(); ++tile)
            result_.tiles.emplace_back(grid_.rect(tile), filmLayoutOf(spec));
        progress_.samplesInAll = uint64_t{spec.image.width} * spec.image.height * spec.stop.samples;
    }

    RenderedFrame run() {
        for (const SampleRange samples : passSchedule(spec_.stop.samples)) renderLevel(samples);
        result_.stats = stats();
        result_.seconds = seconds();
        return std::move(result_);
    }

private:
    void renderLevel(SampleRange samples) {
        for (uint32_t first = 0; first < grid_.count();) {
            std::vector<uint32_t> tiles(tilesOfCall(first, samples));
            std::iota(tiles.begin(), tiles.end(), first);
            first += static_cast<uint32_t>(tiles.size());
            merge(backend_.render(frame_, tiles, samples), tiles);
            if (first == grid_.count()) addPoint(samples.end());
            report(first == grid_.count());
        }
    }

    // How many tiles go into one call does not change their bits.
    size_t tilesOfCall(uint32_t first, SampleRange samples) const {
        const double pace = seconds() > 0 ? static_cast<double>(progress_.samplesDone) / seconds() : 0;
        const double most = pace > 0 ? std::max(pace * kSecondsPerCall, 1.0) : 1e6;
        uint64_t pixels = 0;
        size_t count = 0;
        for (uint32_t tile = first; tile < grid_.count(); ++tile, ++count) {
            pixels += grid_.rect(tile).area();
            if (count > 0 && (pixels * bytesPerPixel_ > kMostBytesPerCall ||
                              static_cast<double>(pixels * samples.count) > most))
                break;
        }
        return count;
    }

    void merge(const std::vector<PassFilm>& films, const std::vector<uint32_t>& tiles) {
        if (films.size() != tiles.size())
            throw Error(ErrorCode::internal, "the device gave another number of tiles than it was asked for");
        for (size_t i = 0; i < films.size(); ++i) {
            result_.tiles[tiles[i]].merge(films[i]);
            progress_.samplesDone += films[i].rect.area() * films[i].samples.count;
        }
    }

    // The curve has the powers of two and the end, as the server's.
    void addPoint(uint32_t samples) {
        ErrorSums sums;
        for (const FilmTile& tile : result_.tiles) sums.add(tile);
        progress_.last = {samples, std::nullopt, stats().deviceSeconds, std::nullopt};
        if (samples > 1) {
            progress_.last.relativeError = sums.relativeError();
            progress_.last.estimate = sums.estimate();
        }
        if (std::has_single_bit(samples) || samples == spec_.stop.samples)
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
    const uint64_t bytesPerPixel_;
    FrameProgress progress_;
    RenderedFrame result_;
};

}  // namespace

RenderedFrame renderFrame(RenderBackend& backend, const JobSpec& spec, int32_t frame, const Clock& clock,
                          const std::function<void(const FrameProgress&)>& onProgress) {
    return FrameRender(backend, spec, frame, clock, onProgress).run();
}

}  // namespace tilefarm
