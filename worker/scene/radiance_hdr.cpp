// Greg Ward's picture format, as its reference describes it. Written here because the copies of stb_image
// that distributions carry do not end on a run that is cut short.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "shared/error/error.h"
#include "worker/scene/environment_picture.h"
#include "worker/scene/limits.h"
#include "worker/scene/radiance_header.h"

namespace tilefarm {
namespace {

constexpr double kLargest = std::numeric_limits<float>::max();

using Rgbe = std::array<uint8_t, 4>;

[[noreturn]] void failPicture(const std::string& fault) {
    throw Error(ErrorCode::invalidArgument, fault);
}

class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    size_t left() const { return bytes_.size() - at_; }

    uint8_t byte() {
        if (at_ == bytes_.size()) {
            failPicture("the picture is cut short");
        }
        return std::to_integer<uint8_t>(bytes_[at_++]);
    }

    Rgbe pixel() { return {byte(), byte(), byte(), byte()}; }

    bool startsRun(uint32_t width) const {
        const auto at = [this](size_t i) { return std::to_integer<uint32_t>(bytes_[at_ + i]); };
        return left() >= 4 && at(0) == 2 && at(1) == 2 && (at(2) << 8 | at(3)) == width;
    }

    std::string_view line() {
        const std::string_view rest(reinterpret_cast<const char*>(bytes_.data()) + at_, left());
        const size_t end = rest.find('\n');
        if (end == std::string_view::npos) {
            failPicture("the picture's header is cut short");
        }
        at_ += end + 1;
        const std::string_view line = rest.substr(0, end);
        return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
    }

private:
    std::span<const std::byte> bytes_;
    size_t at_ = 0;
};

struct Size {
    uint32_t width = 0, height = 0;
};

/// A row of one colour takes 8 bytes where runs are repeated pixels; of rows wider than 4096 all alike nobody
/// has written a file. Runs by channel hold 16 texels a byte. Without a bound a small file takes any memory.
constexpr uint64_t kMostTexelsPerByte = 512;

/// "-Y 512 +X 1024": rows from the top, columns from the left, which is how all of them are written.
Size parseSize(std::string_view line) {
    Size size;
    const auto number = [&](std::string_view axis, uint32_t& out) {
        if (!line.starts_with(axis)) {
            return false;
        }
        const char* end = line.data() + line.size();
        const auto [after, fault] = std::from_chars(line.data() + axis.size(), end, out);
        line = {after, end};
        return fault == std::errc() && out > 0;
    };
    if (!number("-Y ", size.height) || !number(" +X ", size.width) || !line.empty()) {
        failPicture("the picture's size must stand as \"-Y height +X width\"");
    }
    return size;
}

Size readHeader(Reader& reader, RadianceHeader& header) {
    const std::string_view magic = reader.line();
    if (magic != "#?RADIANCE" && magic != "#?RGBE") {
        failPicture("is not a Radiance picture");
    }
    for (std::string_view line = reader.line(); !line.empty(); line = reader.line()) {
        header.read(line);
    }
    const Size size = parseSize(reader.line());
    if (uint64_t{size.width} * size.height > kMaxImageTexels) {
        failPicture(fmt::format("has {} x {} texels, at most {} are allowed", size.width, size.height,
                                kMaxImageTexels));
    }
    return size;
}

/// One channel after the other: a count above 128 repeats a byte, one up to 128 copies bytes.
void readRunRow(Reader& reader, std::span<Rgbe> row) {
    reader.pixel();  // 2, 2, width
    for (size_t channel = 0; channel < 4; ++channel) {
        for (size_t x = 0; x < row.size();) {
            const uint8_t code = reader.byte();
            const size_t count = code > 128 ? code - 128u : code;
            if (count == 0 || count > row.size() - x) {
                failPicture("a run of the picture does not fit its row");
            }
            const uint8_t repeated = code > 128 ? reader.byte() : 0;
            for (const size_t end = x + count; x < end; ++x) {
                row[x][channel] = code > 128 ? repeated : reader.byte();
            }
        }
    }
}

/// Pixel by pixel; (1, 1, 1, n) repeats the last one n times, times 256 for each that came right before.
void readFlatRow(Reader& reader, std::span<Rgbe> row) {
    uint32_t shift = 0;
    for (size_t x = 0; x < row.size();) {
        const Rgbe pixel = reader.pixel();
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            row[x++] = pixel;
            shift = 0;
            continue;
        }
        const uint64_t count = uint64_t{pixel[3]} << shift;
        if (x == 0 || shift > 24 || count > row.size() - x) {
            failPicture("a run of the picture does not fit its row");
        }
        for (uint64_t i = 0; i < count; ++i, ++x) {
            row[x] = row[x - 1];
        }
        shift += 8;
    }
}

void readRow(Reader& reader, std::span<Rgbe> row) {
    const auto width = static_cast<uint32_t>(row.size());
    if (width >= 8 && width < 32768 && reader.startsRun(width)) {
        readRunRow(reader, row);
    } else {
        readFlatRow(reader, row);
    }
}

}  // namespace

EnvironmentPicture decodeRadianceHdr(std::span<const std::byte> bytes) {
    Reader reader(bytes);
    RadianceHeader header;
    const Size size = readHeader(reader, header);
    const uint64_t texels = uint64_t{size.width} * size.height;
    if (texels > kMostTexelsPerByte * bytes.size()) {
        failPicture(fmt::format("has {} x {} texels, more than its {} bytes can hold", size.width,
                                size.height, bytes.size()));
    }
    EnvironmentPicture picture;
    picture.toScene = header.toRec709();
    if (header.blanks) picture.departures.push_back("its header's FORMAT has blanks; read without them");
    picture.aspect = size.width / (size.height * header.pixelAspect);
    Image& image = picture.image;
    image.width = size.width;
    image.height = size.height;
    std::vector<Rgbe> row(size.width);
    image.rgbaFloat.reserve(texels * 4);
    for (uint32_t y = 0; y < size.height; ++y) {
        readRow(reader, row);
        for (const Rgbe& p : row) {
            const double scale = p[3] == 0 ? 0.0 : std::ldexp(1.0, p[3] - (128 + 8));
            for (size_t c = 0; c < 3; ++c)
                image.rgbaFloat.push_back(
                    static_cast<float>(std::min(p[c] * scale / header.multipliedBy[c], kLargest)));
            image.rgbaFloat.push_back(1.0f);
        }
    }
    return picture;
}

}  // namespace tilefarm
