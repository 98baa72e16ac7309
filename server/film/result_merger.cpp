#include "server/film/result_merger.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "shared/error/error.h"
#include "shared/film/error_sums.h"

namespace tilefarm {
namespace {

std::string nameOf(const PassFilm& film) {
    return "the part of tile " + std::to_string(film.tile) + ", samples " +
           std::to_string(film.samples.first) + "+" + std::to_string(film.samples.count);
}

// Every part is one of the lease's passes, once, and covers its tile. Pixels are judged as they are merged,
// or held: a pass over them costs as much as the merge itself.
void requireOfLease(const ResultTarget& target, const std::vector<PassFilm>& films) {
    std::set<std::pair<uint32_t, uint32_t>> wanted;
    for (const LeasedPass& pass : target.lease.passes) wanted.emplace(pass.tile, pass.samples.first);
    const FilmLayout layout = filmLayoutOf(target.job->spec);
    for (const PassFilm& film : films) {
        const bool ofLease = wanted.erase({film.tile, film.samples.first}) == 1 &&
                             *target.job->level(film.samples.first) == film.samples;
        if (!ofLease)
            throw Error(ErrorCode::unprocessable,
                        nameOf(film) + " is not one of this lease's passes, or occurs twice");
        if (film.rect != target.job->grid.rect(film.tile)) {
            throw Error(ErrorCode::unprocessable, nameOf(film) + " does not cover its tile");
        }
        if (film.layout != layout)
            throw Error(ErrorCode::unprocessable, nameOf(film) + " has the additional channels " +
                                                      film.layout.text() + ", but the job's are " +
                                                      layout.text());
    }
    if (films.empty()) throw Error(ErrorCode::unprocessable, "the result holds no pass");
}

bool clamps(const RenderSettings& settings) {
    return settings.clampDirect > 0 || settings.clampIndirect > 0;
}

/// Of all samples, summed up.
double luminanceOf(const PassFilm& film) {
    double sum = 0;
    for (const PassPixel& pixel : film.pixels)
        sum += double{pixel.count} * (0.2126 * double{pixel.mean[0]} + 0.7152 * double{pixel.mean[1]} +
                                      0.0722 * double{pixel.mean[2]});
    return std::isfinite(sum) ? sum : 0;  // as uploaded: its pixels are judged when they are merged
}

LevelRow measured(const ResultTarget& target, const FilmTile& film) {
    ErrorSums sums;
    sums.add(film);
    return {.job = target.job->key,
            .frame = target.lease.frame,
            .samples = film.mergedSamples,
            .tiles = 1,
            .relativeVariance = sums.relativeVariance,
            .errorSquares = sums.squares,
            .borrowedVariance = sums.borrowed,
            .errorTail = sums.tail,
            .droppedSamples = sums.droppedSamples,
            .relativeError = {},
            .deviceSeconds = {}};
}

}  // namespace

struct ResultMerger::Plan {
    struct Tile {
        TileMerge merge;
        std::vector<const PassFilm*> fresh;  // wanted parts of this upload, by first sample
        std::vector<PassRow> held;
    };
    ResultMerge result;
    std::vector<Tile> tiles;
    std::vector<const PassFilm*> early;
    std::set<std::string> spent;  // held files of which a pass was merged
};

// What of the upload is still needed, read while the tiles are locked.
ResultMerger::Plan ResultMerger::plan(const ResultTarget& target, const std::vector<PassFilm>& films) const {
    std::map<uint32_t, std::vector<const PassFilm*>> byTile;
    for (const PassFilm& film : films) byTile[film.tile].push_back(&film);
    const auto& [lease, job] = target;

    Plan plan;
    store_.read([&](const ConstTables& t) {
        const auto frame = t.frames.find(job->key, lease.frame);
        for (auto& [index, parts] : byTile) {
            const auto row = t.frames.tile(job->key, lease.frame, index);
            if (!row || !frame || frame->state != FrameState::active) {
                plan.result.alreadyMerged += static_cast<uint32_t>(parts.size());
                continue;
            }
            Plan::Tile tile{
                .merge =
                    {.before = *row, .after = *row, .merged = {}, .unheld = {}, .held = {}, .levels = {}},
                .fresh = {},
                .held = t.passes.heldOf(job->key, lease.frame, index)};
            for (const PassFilm* part : parts) {
                const auto pass = t.passes.find(job->key, lease.frame, index, part->samples.first);
                const bool wanted = pass && canMove(pass->state, PassState::merged);
                if (!wanted) {
                    ++plan.result.alreadyMerged;
                    continue;
                }
                tile.fresh.push_back(part);
                plan.result.faults.add(part->faults);
                if (clamps(job->spec.settings)) plan.result.keptLuminance += luminanceOf(*part);
            }
            const auto bySample = [](const PassFilm* a, const PassFilm* b) {
                return a->samples.first < b->samples.first;
            };
            std::sort(tile.fresh.begin(), tile.fresh.end(), bySample);
            if (!tile.fresh.empty()) plan.tiles.push_back(std::move(tile));
        }
    });
    return plan;
}

ResultReceipt ResultMerger::accept(const ResultTarget& target, const std::vector<PassFilm>& films,
                                   double deviceSeconds) {
    requireOfLease(target, films);
    std::vector<uint32_t> tiles;
    for (const PassFilm& film : films) tiles.push_back(film.tile);
    const TileLocks::Hold hold(films_.locks(), target.job->key, target.lease.frame, tiles);

    Plan work = plan(target, films);
    work.result.deviceSeconds = std::isfinite(deviceSeconds) ? std::max(0.0, deviceSeconds) : 0;
    for (const PassFilm& film : films) work.result.uploadedSamples += film.rect.area() * film.samples.count;

    // 1. New slots beside those in force, one sync for all of them.
    if (!work.tiles.empty()) {
        FilmFile file = films_.open(*target.job, target.lease.frame);
        for (Plan::Tile& tile : work.tiles)
            mergeTile(target, tile.merge, tile.fresh, tile.held, work.early, file);
        films_.reached("slots written");
        file.sync();
        films_.reached("slots synced");
    }
    // 2. Passes whose predecessors are still out, kept until these come.
    holdEarly(work);
    films_.reached("early passes held");
    // 3. One transaction makes all of it count.
    for (Plan::Tile& tile : work.tiles) {
        for (const PassRow& row : tile.held) {
            const auto& spent = tile.merge.unheld;
            if (std::find(spent.begin(), spent.end(), row.samples.first) != spent.end())
                work.spent.insert(row.held->file);
        }
        work.result.tiles.push_back(std::move(tile.merge));
    }
    const ResultReceipt receipt = scheduler_.commit(target, work.result);
    films_.reached("committed");
    removeSpentFiles(work);
    return receipt;
}

// Merges, in sample order, what follows the tile's film without a gap: parts of this upload and passes
// held from earlier ones. The rest is early.
void ResultMerger::mergeTile(const ResultTarget& target, TileMerge& tile, std::vector<const PassFilm*> fresh,
                             const std::vector<PassRow>& held, std::vector<const PassFilm*>& early,
                             FilmFile& file) const {
    const JobInfo& job = *target.job;
    const auto next = [&](uint32_t first) -> const PassFilm* {
        const auto at = std::find_if(fresh.begin(), fresh.end(),
                                     [&](const auto* p) { return p->samples.first == first; });
        if (at == fresh.end()) return nullptr;
        const PassFilm* pass = *at;
        fresh.erase(at);
        tile.merged.push_back(first);
        return pass;
    };
    const auto nextHeld = [&](uint32_t first) {
        const auto at = std::find_if(held.begin(), held.end(),
                                     [&](const PassRow& p) { return p.samples.first == first; });
        if (at != held.end()) tile.unheld.push_back(first);
        return at;
    };

    std::optional<FilmTile> film;
    if (fresh.front()->samples.first == tile.before.mergedSamples) {
        film = tile.before.mergedSamples == 0
                   ? FilmTile(job.grid.rect(tile.before.tile), filmLayoutOf(job.spec))
                   : file.read(tile.before, job.grid.rect(tile.before.tile));
    }
    while (film) {
        if (const PassFilm* pass = next(film->mergedSamples)) {
            film->merge(*pass);
        } else if (const auto kept = nextHeld(film->mergedSamples); kept != held.end()) {
            film->merge(films_.readHeld(job, *kept));
        } else {
            break;
        }
        tile.levels.push_back(measured(target, *film));
    }
    if (film) {
        tile.after.slot = 1 - tile.before.slot;
        tile.after.mergedSamples = film->mergedSamples;
        file.write(tile.before.tile, tile.after.slot, *film);
    }
    early.insert(early.end(), fresh.begin(), fresh.end());
}

void ResultMerger::holdEarly(Plan& plan) {
    if (plan.early.empty()) return;
    for (const PassFilm* film : plan.early) requireUsable(*film);
    const auto [name, offsets] = films_.hold(plan.early);
    for (size_t i = 0; i < plan.early.size(); ++i) {
        const PassFilm& film = *plan.early[i];
        const auto tile =
            std::lower_bound(plan.tiles.begin(), plan.tiles.end(), film.tile,  // by tile, as planned
                             [](const Plan::Tile& t, uint32_t index) { return t.merge.before.tile < index; });
        PassRow row;
        row.tile = film.tile;
        row.samples = film.samples;
        row.held = HeldPass{name, offsets[i]};
        tile->merge.held.push_back(row);
    }
}

// A held file goes once none of its passes waits any more; one that a crash leaves goes at the next start.
void ResultMerger::removeSpentFiles(const Plan& plan) const {
    if (plan.spent.empty()) return;
    std::set<std::string> unused = plan.spent;
    store_.read([&](const ConstTables& t) {
        std::erase_if(unused, [&](const std::string& file) { return t.passes.isHeld(file); });
    });
    for (const std::string& file : unused) films_.removeHeld(file);
}

}  // namespace tilefarm
