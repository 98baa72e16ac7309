#include "server/film/film_store.h"

#include <algorithm>
#include <cstring>

#include "shared/error/error.h"
#include "shared/file/durable_file.h"
#include "shared/job/job.h"

namespace tilefarm {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t kPage = 4096;

// In front of each slot's pixels. A database put back from a backup beside newer films is noticed.
struct SlotHead {
    uint32_t magic = 0x544C4631;  // "TLF1"
    uint32_t tile = 0;
    uint32_t mergedSamples = 0;
    uint32_t pixels = 0;
    friend bool operator==(const SlotHead&, const SlotHead&) = default;
};
static_assert(std::is_trivially_copyable_v<FilmPixel> && std::is_trivially_copyable_v<PassPixel>);

uint64_t slotBytesOf(const ImageSpec& image, const FilmLayout& layout) {
    const uint64_t pixels =
        uint64_t{std::min(image.tileSize, image.width)} * std::min(image.tileSize, image.height);
    const uint64_t bytes = sizeof(SlotHead) + pixels * (sizeof(FilmPixel) + layout.floats() * sizeof(double));
    return (bytes + kPage - 1) / kPage * kPage;
}

}  // namespace

FilmFile::FilmFile(const fs::path& path, const JobSpec& spec, File::Mode mode)
    : layout_(filmLayoutOf(spec)), slotBytes_(slotBytesOf(spec.image, layout_)), file_(path, mode) {}

uint64_t FilmFile::offset(uint32_t tile, uint32_t slot) const {
    return (uint64_t{tile} * 2 + slot) * slotBytes_;
}

FilmTile FilmFile::read(const TileRow& row, const Rect& rect) const {
    FilmTile film(rect, layout_);
    film.mergedSamples = row.mergedSamples;
    SlotHead head;
    const uint64_t at = offset(row.tile, row.slot);
    file_.readAt(at, std::as_writable_bytes(std::span(&head, 1)));
    const SlotHead wanted{.tile = row.tile,
                          .mergedSamples = row.mergedSamples,
                          .pixels = static_cast<uint32_t>(film.pixels.size())};
    if (head != wanted) {
        throw Error(ErrorCode::internal, "film '" + file_.path().string() + "', tile " +
                                             std::to_string(row.tile) +
                                             " does not hold what the database says");
    }
    const auto pixels = std::as_writable_bytes(std::span(film.pixels));
    file_.readAt(at + sizeof head, pixels);
    file_.readAt(at + sizeof head + pixels.size(), std::as_writable_bytes(std::span(film.extra)));
    return film;
}

void FilmFile::write(uint32_t tile, uint32_t slot, const FilmTile& film) {
    const SlotHead head{.tile = tile,
                        .mergedSamples = film.mergedSamples,
                        .pixels = static_cast<uint32_t>(film.pixels.size())};
    const uint64_t at = offset(tile, slot);
    file_.writeAt(at, std::as_bytes(std::span(&head, 1)));
    const auto pixels = std::as_bytes(std::span(film.pixels));
    file_.writeAt(at + sizeof head, pixels);
    file_.writeAt(at + sizeof head + pixels.size(), std::as_bytes(std::span(film.extra)));
}

FilmStore::FilmStore(fs::path folder, Probe probe) : folder_(std::move(folder)), probe_(std::move(probe)) {
    makeFolder(folder_ / "films");
    makeFolder(folder_ / "held");
}

fs::path FilmStore::filmPath(const JobInfo& job, int32_t frame) const {
    return folder_ / "films" / job.id / (std::to_string(frame) + ".film");
}

FilmTile FilmStore::read(const JobInfo& job, int32_t frame, const TileRow& row) const {
    const Rect rect = job.grid.rect(row.tile);
    if (row.mergedSamples == 0) return FilmTile(rect, filmLayoutOf(job.spec));
    return FilmFile(filmPath(job, frame), job.spec, File::Mode::read).read(row, rect);
}

FilmFile FilmStore::open(const JobInfo& job, int32_t frame) {
    const fs::path path = filmPath(job, frame);
    const bool isNew = !fs::exists(path);
    makeFolder(path.parent_path());
    FilmFile file(path, job.spec, File::Mode::readWrite);
    if (isNew) syncFolder(path.parent_path());
    return file;
}

void FilmStore::remove(const JobInfo& job, int32_t frame) {
    std::error_code ignored;  // what cannot be removed now goes with a later sweep
    fs::remove(filmPath(job, frame), ignored);
    fs::remove(filmPath(job, frame).parent_path(), ignored);  // only when empty
}

std::pair<std::string, std::vector<uint64_t>> FilmStore::hold(const std::vector<const PassFilm*>& passes) {
    const std::string name = randomHex(24) + ".pixels";
    std::vector<uint64_t> offsets;
    DurableFile file(folder_ / "held" / name);
    for (const PassFilm* pass : passes) {
        offsets.push_back(file.position());
        file.write(std::as_bytes(std::span(pass->pixels)));
        file.write(std::as_bytes(std::span(pass->extra)));
    }
    file.commit();
    return {name, offsets};
}

PassFilm FilmStore::readHeld(const JobInfo& job, const PassRow& row) const {
    PassFilm pass{.tile = row.tile, .rect = job.grid.rect(row.tile), .samples = row.samples, .pixels = {}};
    pass.pixels.resize(pass.rect.area());
    pass.layout = filmLayoutOf(job.spec);
    pass.extra.resize(pass.rect.area() * pass.layout.floats());
    const File file(folder_ / "held" / row.held->file, File::Mode::read);
    const auto pixels = std::as_writable_bytes(std::span(pass.pixels));
    file.readAt(row.held->offset, pixels);
    file.readAt(row.held->offset + pixels.size(), std::as_writable_bytes(std::span(pass.extra)));
    return pass;
}

void FilmStore::removeHeldExcept(const std::vector<std::string>& used) {
    for (const auto& entry : fs::directory_iterator(folder_ / "held")) {
        const std::string name = entry.path().filename().string();
        if (std::find(used.begin(), used.end(), name) == used.end()) fs::remove(entry.path());
    }
}

void FilmStore::removeHeld(const std::string& file) {
    std::error_code ignored;
    fs::remove(folder_ / "held" / file, ignored);
}

}  // namespace tilefarm
