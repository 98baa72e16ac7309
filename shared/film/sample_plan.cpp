#include "shared/film/sample_plan.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "shared/job/job.h"

namespace tilefarm {
namespace {

constexpr double kRounding = 1e-9;  // of a sum that goes up and down

// A tile's next pass, and how much of the frame's summed squared error it takes away per pixel sample.
struct Promotion {
    double worth = 0;
    uint32_t tile = 0;
    friend bool operator<(const Promotion& a, const Promotion& b) {
        return a.worth != b.worth ? a.worth < b.worth : a.tile > b.tile;
    }
};

// Where the tiles of a frame would end by what is known now: their variances fall as 1/n.
class SamplePlan {
public:
    SamplePlan(const std::vector<SampleRange>& schedule, std::span<const TileError> tiles)
        : schedule_(schedule), tiles_(tiles) {
        for (const TileError& tile : tiles) samples_.push_back(tile.samples);
    }

    void promoteAll() {
        for (uint32_t& samples : samples_) samples = schedule_.back().end();
    }
    /// At least so many passes, if tiles with error can have them. Gives the summed variance expected then.
    double promoteUntil(double allowed, uint64_t least) {
        weigh();
        std::priority_queue<Promotion> promotions;
        double left = 0;
        for (uint32_t t = 0; t < tiles_.size(); ++t) {
            left += weights_[t] / samples_[t];
            offer(promotions, t);
        }
        for (uint64_t made = 0; !promotions.empty() && (made < least || left > allowed); ++made) {
            const uint32_t t = promotions.top().tile;
            promotions.pop();
            const uint32_t before = std::exchange(samples_[t], nextPass(schedule_, samples_[t])->end());
            left -= weights_[t] / before - weights_[t] / samples_[t];
            offer(promotions, t);
        }
        return left;
    }

    SampleDecision decision() const {
        SampleDecision d;
        for (uint32_t t = 0; t < tiles_.size(); ++t) {
            if (samples_[t] > tiles_[t].samples) d.tiles.push_back(t);
            d.pixelSamples += tiles_[t].pixels * samples_[t];
            d.passes += passesUpTo(schedule_, samples_[t]);
        }
        return d;
    }

private:
    // Where the error is, is told by the earlier data; how much there is in all, by the latest. (Where the
    // earlier data know of no error that a pass could lower, the latest tell both.)
    void weigh() {
        double earlier = 0, latest = 0;
        bool known = false;
        for (const TileError& tile : tiles_) {
            earlier += tile.earlier;
            latest += tile.variance;
            known |= tile.earlier > 0 && nextPass(schedule_, tile.samples);
        }
        for (const TileError& tile : tiles_)
            weights_.push_back(tile.samples * (known ? tile.earlier * (latest / earlier) : tile.variance));
    }
    void offer(std::priority_queue<Promotion>& promotions, uint32_t t) const {
        const SampleRange* next = nextPass(schedule_, samples_[t]);
        if (!next || !(weights_[t] > 0)) return;
        const double product = static_cast<double>(samples_[t]) * next->end();
        promotions.push({weights_[t] / (product * static_cast<double>(tiles_[t].pixels)), t});
    }

    const std::vector<SampleRange>& schedule_;
    std::span<const TileError> tiles_;
    std::vector<uint32_t> samples_;  // planned, of each tile
    std::vector<double> weights_;    // variance of each tile times its samples
};

uint64_t pixelSamples(std::span<const TileError> tiles) {
    uint64_t sum = 0;
    for (const TileError& tile : tiles) sum += tile.pixels * tile.samples;
    return sum;
}

SampleDecision complete(StopReason reason, const std::vector<SampleRange>& schedule,
                        std::span<const TileError> tiles) {
    SampleDecision d = SamplePlan(schedule, tiles).decision();
    d.stop = reason;
    return d;
}

// How often what was taken so far fits into the time limits, and which of them is the tighter.
std::pair<double, StopReason> timesInLimits(const StopCondition& stop, const FrameCost& cost) {
    const auto times = [](double limit, double spent) {
        return limit > 0 && spent > 0 ? limit / spent : std::numeric_limits<double>::infinity();
    };
    const double device = times(stop.deviceSeconds, cost.deviceSeconds),
                 wall = times(stop.wallSeconds, cost.wallSeconds);
    return device <= wall ? std::pair{device, StopReason::deviceSeconds}
                          : std::pair{wall, StopReason::wallSeconds};
}

bool reachesTarget(const StopCondition& stop, std::span<const TileError> tiles, double allowed) {
    double sum = 0;
    for (const TileError& tile : tiles) sum += tile.variance;
    return stop.relativeError > 0 && sum <= allowed;
}

}  // namespace

void TileError::reach(uint32_t newSamples, double newVariance) {
    earlier = samples > 1 ? variance * samples / newSamples : newVariance;
    samples = newSamples;
    variance = newVariance;
}

uint32_t freeLevels(const StopCondition& stop, const std::vector<SampleRange>& schedule) {
    const auto all = static_cast<uint32_t>(schedule.size());
    if (!stop.decidesOnTheWay()) return all;
    if (stop.hasTimeLimit()) return 1;
    const auto last = std::find_if(schedule.begin(), schedule.end(),
                                   [&](const SampleRange& range) { return range.end() >= stop.minSamples; });
    return last == schedule.end() ? all : static_cast<uint32_t>(last - schedule.begin()) + 1;
}

const SampleRange* nextPass(const std::vector<SampleRange>& schedule, uint32_t samples) {
    const auto at = std::lower_bound(schedule.begin(), schedule.end(), samples,
                                     [](const SampleRange& range, uint32_t s) { return range.first < s; });
    return at == schedule.end() ? nullptr : &*at;
}

uint32_t passesUpTo(const std::vector<SampleRange>& schedule, uint32_t samples) {
    const auto end = std::upper_bound(schedule.begin(), schedule.end(), samples,
                                      [](uint32_t s, const SampleRange& range) { return s < range.end(); });
    return static_cast<uint32_t>(end - schedule.begin());
}

uint32_t meanSamples(std::span<const TileError> tiles) {
    uint64_t pixels = 0;
    for (const TileError& tile : tiles) pixels += tile.pixels;
    return static_cast<uint32_t>(pixels == 0 ? 0 : pixelSamples(tiles) / pixels);
}

std::optional<uint64_t> samplesUntil(const std::vector<SampleRange>& schedule,
                                     std::span<const TileError> tiles, double allowed) {
    SamplePlan plan(schedule, tiles);
    if (plan.promoteUntil(allowed, 0) > allowed * (1 + kRounding)) return {};
    return plan.decision().pixelSamples;
}

SampleDecision decide(const StopCondition& stop, const std::vector<SampleRange>& schedule,
                      std::span<const TileError> tiles, const FrameCost& cost) {
    uint64_t pixels = 0;
    uint32_t least = std::numeric_limits<uint32_t>::max();
    for (const TileError& tile : tiles) {
        pixels += tile.pixels;
        least = std::min(least, tile.samples);
    }
    const double allowed = stop.relativeError * stop.relativeError * static_cast<double>(pixels);
    const bool believed = stop.relativeError > 0 && least >= std::min(stop.minSamples, stop.samples);
    if (believed && reachesTarget(stop, tiles, allowed))
        return complete(StopReason::relativeError, schedule, tiles);

    SamplePlan plan(schedule, tiles);
    if (believed)
        plan.promoteUntil(allowed, 1);
    else
        plan.promoteAll();
    SampleDecision next = plan.decision();
    if (next.tiles.empty()) return complete(StopReason::samples, schedule, tiles);

    uint64_t round = 0;
    for (const uint32_t t : next.tiles)
        round += tiles[t].pixels * nextPass(schedule, tiles[t].samples)->count;
    const double done = static_cast<double>(pixelSamples(tiles));
    const auto [times, limit] = timesInLimits(stop, cost);
    if (done + static_cast<double>(round) > times * done) return complete(limit, schedule, tiles);
    next.pixelSamples = static_cast<uint64_t>(std::min(static_cast<double>(next.pixelSamples), times * done));
    return next;
}

}  // namespace tilefarm
