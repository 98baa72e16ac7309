#pragma once

#include <vector>

#include "server/film/film_store.h"
#include "server/queue/scheduler.h"

namespace tilefarm {

/// Takes the passes of an upload into the film: exactly once per (tile, range), in sample order
/// whatever order uploads arrive in, so that the film's bits are those of any other order. Durable
/// when `accept` returns. Any thread may call; memory beyond `films` is one tile.
class ResultMerger {
public:
    ResultMerger(JobStore& store, Scheduler& scheduler, FilmStore& films)
        : store_(store), scheduler_(scheduler), films_(films) {}

    /// Throws Error(unprocessable) if a film is not of the lease, Error(gone | conflict) if the job
    /// wants it no more, Error(outOfSpace); the film is then as before.
    ResultReceipt accept(const ResultTarget& target, const std::vector<PassFilm>& films,
                         double deviceSeconds);

private:
    struct Plan;
    Plan plan(const ResultTarget& target, const std::vector<PassFilm>& films) const;
    void mergeTile(const ResultTarget& target, TileMerge& tile, std::vector<const PassFilm*> fresh,
                   const std::vector<PassRow>& held, std::vector<const PassFilm*>& early,
                   FilmFile& file) const;
    void holdEarly(Plan& plan);
    void removeSpentFiles(const Plan& plan) const;

    JobStore& store_;
    Scheduler& scheduler_;
    FilmStore& films_;
};

}  // namespace tilefarm
