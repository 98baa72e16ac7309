// libFuzzer: the films that a worker uploads are read whole, and then survive being written, or are refused.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "shared/error/error.h"
#include "shared/image/exr.h"

namespace {

using namespace tilefarm;

void require(bool sound) {
    if (!sound) std::abort();
}

// A NaN is as good as any other pixel.
template <typename T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// A picture that holds every part, if an image may be that large.
ImageSpec around(const std::vector<PassFilm>& films) {
    ImageSpec image{1, 1, 1};
    for (const PassFilm& film : films) {
        image.width = std::max(image.width, film.rect.x + film.rect.width);
        image.height = std::max(image.height, film.rect.y + film.rect.height);
    }
    return image;
}

void requireRoundTrip(const std::vector<PassFilm>& films) {
    std::vector<std::byte> written;
    try {
        written = encodePassFilms(films, around(films), {});
    } catch (const Error&) {
        return;  // larger than pictures are, or of different channels
    }
    const std::vector<PassFilm> again = decodePassFilms(written);
    require(again.size() == films.size());
    for (size_t i = 0; i < films.size(); ++i) {
        require(again[i].rect == films[i].rect && again[i].samples == films[i].samples &&
                again[i].tile == films[i].tile);
        require(sameBits(again[i].pixels, films[i].pixels) && sameBits(again[i].extra, films[i].extra));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    try {
        decodePassAttributes(bytes);
        const std::vector<PassFilm> films = decodePassFilms(bytes);
        for (const PassFilm& film : films) {
            require(film.pixels.size() == film.rect.area());
            require(film.extra.size() == film.rect.area() * film.layout.floats());
        }
        requireRoundTrip(films);
    } catch (const Error& error) {
        require(error.code == ErrorCode::unprocessable);
    }
    return 0;
}
