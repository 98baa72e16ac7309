#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "server/film/tile_locks.h"
#include "server/queue/job_catalog.h"
#include "server/store/file.h"
#include "shared/film/film.h"

namespace tilefarm {

struct JobSpec;

/// The film of one frame on disk: two slots per tile, each with a head that names what it holds. A
/// merge writes the slot that is not in force; the tile's row says which one is. So a torn write
/// never touches what counts. Slots start on pages of their own: a page torn by a power cut holds no
/// neighbour's bytes.
class FilmFile {
public:
    FilmFile(const std::filesystem::path& path, const JobSpec& spec, File::Mode mode);
    /// Throws Error(internal) if the slot holds something else than the row says.
    FilmTile read(const TileRow& row, const Rect& rect) const;
    void write(uint32_t tile, uint32_t slot, const FilmTile& film);
    /// Everything written so far survives power loss.
    void sync() { file_.syncData(); }

private:
    uint64_t offset(uint32_t tile, uint32_t slot) const;
    FilmLayout layout_;
    uint64_t slotBytes_;
    File file_;
};

/// Where films and passes that came early lie.
class FilmStore {
public:
    /// Called between the durable steps of a merge with the name of the step just done; tests throw
    /// from it to stop there as a crash would.
    using Probe = std::function<void(std::string_view step)>;

    explicit FilmStore(std::filesystem::path folder, Probe probe = {});

    /// A tile as its row says; without samples it is empty. The caller holds the tile's lock.
    FilmTile read(const JobInfo& job, int32_t frame, const TileRow& row) const;
    /// For writing; makes the file durably when it is the frame's first.
    FilmFile open(const JobInfo& job, int32_t frame);
    void remove(const JobInfo& job, int32_t frame);

    /// Keeps early passes durably in one file; gives its name and each pass's offset.
    std::pair<std::string, std::vector<uint64_t>> hold(const std::vector<const PassFilm*>& passes);
    PassFilm readHeld(const JobInfo& job, const PassRow& row) const;
    /// Removes held files that none of the names uses. No result may be under way.
    void removeHeldExcept(const std::vector<std::string>& used);
    void removeHeld(const std::string& file);

    TileLocks& locks() { return locks_; }
    void reached(std::string_view step) const {
        if (probe_) probe_(step);
    }

private:
    std::filesystem::path filmPath(const JobInfo& job, int32_t frame) const;
    std::filesystem::path folder_;
    Probe probe_;
    TileLocks locks_;
};

}  // namespace tilefarm
