// libFuzzer: EXR pictures, uploads of passes and Radiance pictures are read whole or refused with an Error.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "worker/scene/radiance_hdr.h"

namespace {

using namespace tilefarm;

template <typename Read>
void readOrRefuse(ErrorCode refusal, const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        if (error.code != refusal) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    if (size >= 2 && data[0] == '#' && data[1] == '?') {
        readOrRefuse(ErrorCode::invalidArgument, [&] {
            const Image image = decodeRadianceHdr(bytes);
            if (image.rgbaFloat.size() != size_t{4} * image.width * image.height) std::abort();
        });
        return 0;
    }
    readOrRefuse(ErrorCode::invalidArgument, [&] {
        const FloatImage image = readExr(bytes, "input");
        for (const auto& plane : image.planes)
            if (plane.size() != image.pixelCount()) std::abort();
    });
    readOrRefuse(ErrorCode::unprocessable, [&] {
        for (const PassFilm& film : decodePassFilms(bytes))
            if (film.pixels.size() != film.rect.area()) std::abort();
    });
    return 0;
}
