// The EXR that a worker uploads: multi-part, scanlines, fp32, uncompressed. It is written and read here
// rather than by OpenEXR for two reasons. It comes from the network, so every length in it is checked
// against the bytes that are there before anything is allocated; and a lease of small tiles has
// thousands of parts, for which a header parser of the general kind costs more than the pixels.
// Layout: https://openexr.com/en/latest/OpenEXRFileLayout.html
//     magic, version, one header per part, an empty header, a table of chunk offsets per part,
//     chunks: part number, y, byte count, then the line of each channel in the order of their names.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "shared/image/exr_bytes.h"

namespace tilefarm {

namespace {

static_assert(std::endian::native == std::endian::little, "EXR is little endian");

constexpr uint32_t kFormat = 2, kLongNames = 0x400, kMultiPart = 0x1000;
constexpr int32_t kFloat = 2;  // pixel type
constexpr size_t kMostParts = 1 << 18;
constexpr uint64_t kMostLightSamples = uint64_t{1} << 48;  // sums over a job's passes stay below 2^63
constexpr size_t kChunkHeader = 3 * sizeof(int32_t);
constexpr std::string_view kPrefix = "tilefarm.";
constexpr std::string_view kTile = "tilefarm.pass.tile", kFirst = "tilefarm.pass.first",
                           kCount = "tilefarm.pass.count", kRejected = "tilefarm.pass.rejected",
                           kTruncated = "tilefarm.pass.truncated",
                           kThroughput = "tilefarm.pass.truncatedThroughput",
                           kClamped = "tilefarm.pass.clamped",
                           kClampedLuminance = "tilefarm.pass.clampedLuminance",
                           kBehindGlass = "tilefarm.pass.lightsBehindGlass",
                           kDropped = "tilefarm.pass.dropped";

struct Channel {
    std::string_view name;
    size_t offset;  // bytes within PassPixel
};

// Where the line of a channel comes from: a float of PassPixel, or one of the further ones.
struct Line {
    std::string name;
    bool further;
    size_t offset;  // bytes within the pixel's
};

constexpr size_t at(size_t firstFloat, size_t i = 0) {
    return (firstFloat + i) * sizeof(float);
}
constexpr std::array kChannels{
    Channel{"A", at(15)},        Channel{"B", at(2)},         Channel{"G", at(1)},
    Channel{"R", at(0)},         Channel{"Z", at(11)},        Channel{"albedo.B", at(10)},
    Channel{"albedo.G", at(9)},  Channel{"albedo.R", at(8)},  Channel{"m2.B", at(6)},
    Channel{"m2.G", at(5)},      Channel{"m2.R", at(4)},      Channel{"m2.Y", at(7)},
    Channel{"normal.X", at(12)}, Channel{"normal.Y", at(13)}, Channel{"normal.Z", at(14)},
    Channel{"samples", at(3)},
};
static_assert(kChannels.size() * sizeof(float) == sizeof(PassPixel));
static_assert(offsetof(PassPixel, count) == at(3) && offsetof(PassPixel, m2) == at(4) &&
              offsetof(PassPixel, m2Luminance) == at(7) && offsetof(PassPixel, albedo) == at(8) &&
              offsetof(PassPixel, depth) == at(11) && offsetof(PassPixel, normal) == at(12) &&
              offsetof(PassPixel, alpha) == at(15));

struct Box {
    int32_t minX, minY, maxX, maxY;  // both ends are inside
};

Box boxOf(const Rect& r) {
    return {static_cast<int32_t>(r.x), static_cast<int32_t>(r.y), static_cast<int32_t>(r.x + r.width) - 1,
            static_cast<int32_t>(r.y + r.height) - 1};
}

// One way to lay out a part.
struct Layout {
    FilmLayout film;
    std::vector<Line> lines;  // by name, as the lines of a chunk are ordered
    std::string channels;     // the value of the attribute `channels`
};

std::vector<Line> linesOf(const FilmLayout& layout) {
    std::vector<Line> lines;
    for (const Channel& channel : kChannels)
        lines.push_back({std::string(channel.name), false, channel.offset});
    for (const std::string& name : layout.channels())
        lines.push_back({name, true, at(lines.size() - kChannels.size())});
    std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.name < b.name; });
    return lines;
}

std::string channelList(const std::vector<Line>& lines) {
    std::string list;
    const auto put = [&](int32_t value) { list.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const Line& line : lines) {
        list += line.name;
        list += '\0';
        put(kFloat);
        put(0);  // pLinear and three reserved bytes
        put(1);  // sampling in x
        put(1);  // and in y
    }
    list += '\0';
    return list;
}

// All that a job can ask for.
const std::vector<Layout>& layouts() {
    static const std::vector<Layout> all = [] {
        std::vector<Layout> made;
        for (const FilmLayout& film : FilmLayout::all()) {
            std::vector<Line> lines = linesOf(film);
            std::string channels = channelList(lines);
            made.push_back({film, std::move(lines), std::move(channels)});
        }
        return made;
    }();
    return all;
}

// The layout whose member is `value`, or nullptr.
template <typename T>
const Layout* layoutWith(T Layout::*member, const auto& value) {
    const auto at = std::find_if(layouts().begin(), layouts().end(),
                                 [&](const Layout& layout) { return layout.*member == value; });
    return at == layouts().end() ? nullptr : &*at;
}

// ---- Writing

class Writer {
public:
    explicit Writer(size_t expected) { bytes_.reserve(expected); }

    template <typename T>
    void put(const T& value) {
        append(&value, sizeof value);
    }
    void text(std::string_view value) {
        append(value.data(), value.size());
        put('\0');
    }
    void attribute(std::string_view name, std::string_view type, std::string_view value) {
        text(name);
        text(type);
        put(static_cast<int32_t>(value.size()));
        append(value.data(), value.size());
    }
    template <typename T>
    void attribute(std::string_view name, std::string_view type,
                   const T& value) requires std::is_arithmetic_v<T> || std::same_as<T, Box> {
        attribute(name, type, std::string_view(reinterpret_cast<const char*>(&value), sizeof value));
    }
    void append(const void* data, size_t size) {
        const auto* first = static_cast<const std::byte*>(data);
        bytes_.insert(bytes_.end(), first, first + size);
    }
    /// Room for `size` bytes to be filled in.
    std::byte* grow(size_t size) {
        bytes_.resize(bytes_.size() + size);
        return bytes_.data() + bytes_.size() - size;
    }
    size_t size() const { return bytes_.size(); }
    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    std::vector<std::byte> bytes_;
};

// Only what there is: most passes have no fault.
void writeFaults(Writer& out, const PassFaults& faults) {
    if (faults.rejectedPaths > 0) out.attribute(kRejected, "tilefarm", faults.rejectedPaths);
    if (faults.truncatedPaths > 0) {
        out.attribute(kTruncated, "tilefarm", faults.truncatedPaths);
        out.attribute(kThroughput, "tilefarm", faults.truncatedThroughput);
    }
    if (faults.clampedSamples > 0) {
        out.attribute(kClamped, "tilefarm", faults.clampedSamples);
        out.attribute(kClampedLuminance, "tilefarm", faults.clampedLuminance);
    }
    if (faults.lightsBehindGlass > 0) out.attribute(kBehindGlass, "tilefarm", faults.lightsBehindGlass);
    if (faults.dropped.empty()) return;
    const auto* bytes = reinterpret_cast<const char*>(faults.dropped.data());
    out.attribute(kDropped, "tilefarm",
                  std::string_view(bytes, faults.dropped.size() * sizeof(DroppedSample)));
}

void writeHeader(Writer& out, const PassFilm& film, size_t part, const ImageSpec& image,
                 const std::string& channels) {
    out.attribute("channels", "chlist", std::string_view(channels));
    out.attribute("compression", "compression", uint8_t{0});
    out.attribute("dataWindow", "box2i", boxOf(film.rect));
    out.attribute("displayWindow", "box2i", boxOf({0, 0, image.width, image.height}));
    out.attribute("lineOrder", "lineOrder", uint8_t{0});
    out.attribute("pixelAspectRatio", "float", 1.0f);
    out.attribute("screenWindowCenter", "v2f", uint64_t{0});  // two zeros
    out.attribute("screenWindowWidth", "float", 1.0f);
    out.attribute("name", "string",
                  std::string_view(fmt::format("{} tile {} samples {}+{}", part, film.tile,
                                               film.samples.first, film.samples.count)));
    out.attribute("type", "string", std::string_view("scanlineimage"));
    out.attribute("chunkCount", "int", static_cast<int32_t>(film.rect.height));
    out.attribute(kTile, "int", static_cast<int32_t>(film.tile));
    out.attribute(kFirst, "int", static_cast<int32_t>(film.samples.first));
    out.attribute(kCount, "int", static_cast<int32_t>(film.samples.count));
    writeFaults(out, film.faults);
}

size_t lineBytes(const PassFilm& film) {
    return film.rect.width * (sizeof(PassPixel) + film.layout.floats() * sizeof(float));
}
size_t chunkBytes(const PassFilm& film) {
    return kChunkHeader + lineBytes(film);
}

// Calls visit(a float of the film, its place in the chunk) for row `row`, channel after channel.
template <typename Film, typename Visit>
void forEachFloat(Film& film, uint32_t row, const std::vector<Line>& lines, Visit&& visit) {
    const size_t first = size_t{row} * film.rect.width, width = film.rect.width;
    const size_t furtherStride = film.layout.floats() * sizeof(float);
    using Byte = std::conditional_t<std::is_const_v<Film>, const std::byte, std::byte>;
    auto* const own = reinterpret_cast<Byte*>(film.pixels.data() + first);
    auto* const further = reinterpret_cast<Byte*>(film.extra.data()) + first * furtherStride;
    size_t place = 0;
    for (const Line& line : lines) {
        Byte* value = (line.further ? further : own) + line.offset;
        const size_t stride = line.further ? furtherStride : sizeof(PassPixel);
        for (size_t x = 0; x < width; ++x, place += sizeof(float), value += stride) visit(value, place);
    }
}

// Pixels -> a line per channel.
void scatter(const PassFilm& film, uint32_t row, const std::vector<Line>& lines, std::byte* chunk) {
    forEachFloat(film, row, lines, [chunk](const std::byte* value, size_t place) {
        std::memcpy(chunk + place, value, sizeof(float));
    });
}

// And back.
void gather(const std::byte* chunk, const std::vector<Line>& lines, PassFilm& film, uint32_t row) {
    forEachFloat(film, row, lines, [chunk](std::byte* value, size_t place) {
        std::memcpy(value, chunk + place, sizeof(float));
    });
}

void requireWritable(const PassFilm& film, const ImageSpec& image) {
    const Rect& r = film.rect;
    const bool inside =
        r.area() > 0 && uint64_t{r.x} + r.width <= image.width && uint64_t{r.y} + r.height <= image.height;
    if (!inside || film.pixels.size() != r.area() || film.extra.size() != r.area() * film.layout.floats())
        throw Error(ErrorCode::internal, fmt::format("film of tile {} does not fit its image", film.tile));
}

// ---- Reading

// What one header says; nothing where it does not say it.
struct PartHeader {
    std::optional<std::string_view> channels;
    std::optional<uint8_t> compression;
    std::optional<Box> dataWindow, displayWindow;
    std::optional<std::string_view> type;
    std::optional<int32_t> tile, first, count;
    std::optional<uint64_t> rejected, truncated, clamped, behindGlass;
    std::optional<double> throughput, clampedLuminance;
    std::vector<DroppedSample> dropped;
    ImageAttributes attributes;
};

template <typename T>
void setFixed(std::optional<T>& out, std::string_view name, std::string_view value) {
    if (value.size() != sizeof(T))
        throw std::runtime_error(fmt::format("its attribute {} has a wrong size", name));
    T read;
    std::memcpy(&read, value.data(), sizeof read);
    out = read;
}

void setDropped(PartHeader& h, std::string_view value) {
    if (value.size() % sizeof(DroppedSample) != 0 || value.size() > kMostDropped * sizeof(DroppedSample))
        throw std::runtime_error("its list of dropped samples has a wrong size");
    h.dropped.resize(value.size() / sizeof(DroppedSample));
    if (!value.empty()) std::memcpy(h.dropped.data(), value.data(), value.size());
}

void setAttribute(PartHeader& h, std::string_view name, std::string_view type, std::string_view value) {
    if (name == "channels") h.channels = value;
    if (name == "type") h.type = value;
    if (name == "compression") setFixed(h.compression, name, value);
    if (name == "dataWindow") setFixed(h.dataWindow, name, value);
    if (name == "displayWindow") setFixed(h.displayWindow, name, value);
    if (name == kTile) setFixed(h.tile, name, value);
    if (name == kFirst) setFixed(h.first, name, value);
    if (name == kCount) setFixed(h.count, name, value);
    if (name == kRejected) setFixed(h.rejected, name, value);
    if (name == kTruncated) setFixed(h.truncated, name, value);
    if (name == kThroughput) setFixed(h.throughput, name, value);
    if (name == kClamped) setFixed(h.clamped, name, value);
    if (name == kClampedLuminance) setFixed(h.clampedLuminance, name, value);
    if (name == kBehindGlass) setFixed(h.behindGlass, name, value);
    if (name == kDropped) setDropped(h, value);
    if (type == "string" && name.starts_with(kPrefix))
        h.attributes[std::string(name.substr(kPrefix.size()))] = std::string(value);
}

/// Nothing at the empty header that ends the list.
std::optional<PartHeader> readHeader(ExrBytes& in) {
    PartHeader header;
    const bool any =
        forEachAttribute(in, [&](std::string_view name, std::string_view type, std::string_view value) {
            setAttribute(header, name, type, value);
        });
    return any ? std::optional(std::move(header)) : std::nullopt;
}

PassFilm filmOf(const PartHeader& h) {
    const auto require = [](bool good, const char* fault) {
        if (!good) throw std::runtime_error(fault);
    };
    require(h.type == "scanlineimage", "it is no scanline image");
    require(h.compression == uint8_t{0}, "it is compressed");
    const Layout* layout = layoutWith(&Layout::channels, h.channels.value_or(""));
    require(layout != nullptr, "its channels are not those of a pass film");
    require(h.tile && h.first && h.count, "it does not say its tile and samples");
    require(*h.tile >= 0 && *h.first >= 0 && *h.count >= 1 &&
                *h.count <= static_cast<int32_t>(kMaxPassSamples) && *h.first <= (1 << 24),
            "its tile or samples are out of range");
    require(h.dataWindow && h.displayWindow, "it does not say its windows");
    const Box &d = *h.dataWindow, &image = *h.displayWindow;
    require(image.minX == 0 && image.minY == 0 && image.maxX < 65536 && image.maxY < 65536,
            "its display window is out of range");
    require(d.minX >= 0 && d.minY >= 0 && d.minX <= d.maxX && d.minY <= d.maxY && d.maxX <= image.maxX &&
                d.maxY <= image.maxY,
            "its data window is not within the image");
    PassFilm film;
    film.layout = layout->film;
    film.tile = static_cast<uint32_t>(*h.tile);
    film.samples = {static_cast<uint32_t>(*h.first), static_cast<uint32_t>(*h.count)};
    film.rect = {static_cast<uint32_t>(d.minX), static_cast<uint32_t>(d.minY),
                 static_cast<uint32_t>(d.maxX - d.minX + 1), static_cast<uint32_t>(d.maxY - d.minY + 1)};
    film.faults = {h.rejected.value_or(0),
                   h.truncated.value_or(0),
                   h.throughput.value_or(0),
                   h.clamped.value_or(0),
                   h.clampedLuminance.value_or(0),
                   h.behindGlass.value_or(0),
                   h.dropped};
    // More paths than were rendered end in no way.
    const uint64_t paths = film.rect.area() * film.samples.count;
    require(film.faults.truncatedPaths <= paths && film.faults.rejectedPaths <= paths &&
                film.faults.clampedSamples <= paths,
            "it counts more faults than paths");
    require(film.faults.lightsBehindGlass <= kMostLightSamples,
            "it counts more samples of lights than there can be");
    for (const double sum : {film.faults.truncatedThroughput, film.faults.clampedLuminance})
        require(std::isfinite(sum) && sum >= 0, "its sums of light left out are no such sums");
    for (const DroppedSample& sample : film.faults.dropped)
        require(sample.x - film.rect.x < film.rect.width && sample.y - film.rect.y < film.rect.height &&
                    sample.sample - film.samples.first < film.samples.count,
                "a dropped sample is not of this pass");
    return film;
}

// `what` went wrong in part `part`, or before the first.
[[noreturn]] void refuse(std::optional<size_t> part, const std::string& what) {
    throw Error(ErrorCode::unprocessable, part ? fmt::format("the result's part {}: {}", *part, what)
                                               : fmt::format("the result: {}", what));
}

struct Headers {
    std::vector<PassFilm> films;  // without pixels
    ImageAttributes attributes;   // of the first part
};

Headers readHeaders(ExrBytes& in) {
    Headers headers;
    if (in.size() < 8 || in.get<uint32_t>("the magic number") != kExrMagic) refuse({}, "it is no EXR file");
    if (const auto version = in.get<uint32_t>("the version");
        (version & ~kLongNames) != (kFormat | kMultiPart))
        refuse({}, fmt::format("it is no multi-part EXR of scanlines (version field {:#x})", version));
    try {
        while (std::optional<PartHeader> header = readHeader(in)) {
            if (headers.films.size() == kMostParts) throw std::runtime_error("there are too many parts");
            headers.films.push_back(filmOf(*header));
            if (headers.films.size() == 1) headers.attributes = std::move(header->attributes);
        }
    } catch (const std::runtime_error& e) {
        refuse(headers.films.size(), e.what());
    }
    if (headers.films.empty()) refuse({}, "it has no parts");
    return headers;
}

// The bytes must be exactly those of all chunks: only then is memory taken for the pixels.
void requireExactSize(const std::vector<PassFilm>& films, size_t bytesLeft) {
    uint64_t expected = 0;
    for (const PassFilm& film : films) expected += film.rect.height * (sizeof(uint64_t) + chunkBytes(film));
    if (expected != bytesLeft)
        refuse({}, fmt::format("{} bytes follow the headers where {} are due", bytesLeft, expected));
}

// What one part needs while its chunks are read.
struct OpenPart {
    const std::vector<Line>* lines;
    std::vector<bool> seen;
};

void readChunk(ExrBytes& in, std::vector<PassFilm>& films, std::vector<OpenPart>& open) {
    const auto part = in.get<uint32_t>("a chunk"), y = in.get<uint32_t>("a chunk"),
               size = in.get<uint32_t>("a chunk");
    if (part >= films.size()) refuse({}, fmt::format("a chunk of part {} of {}", part, films.size()));
    PassFilm& film = films[part];
    const uint32_t row = y - film.rect.y;  // wraps to a large number above the window
    if (row >= film.rect.height || open[part].seen[row])
        refuse(part, fmt::format("line {} stands twice or outside", y));
    if (size != lineBytes(film)) refuse(part, fmt::format("line {} has {} bytes", y, size));
    open[part].seen[row] = true;
    gather(in.take(size, "a line").data(), *open[part].lines, film, row);
}

}  // namespace

std::vector<std::byte> encodePassFilms(std::span<const PassFilm> films, const ImageSpec& image,
                                       const ImageAttributes& attributes) {
    if (films.empty() || films.size() > kMostParts)
        throw Error(ErrorCode::internal, fmt::format("a result of {} films", films.size()));
    size_t expected = 1024;
    for (const PassFilm& film : films) {
        requireWritable(film, image);
        if (film.layout != films.front().layout)
            throw Error(ErrorCode::internal, "films of one result differ in their channels");
        expected +=
            1024 + film.layout.floats() * 64 + film.rect.height * (sizeof(uint64_t) + chunkBytes(film));
    }

    Writer out(expected);
    out.put(kExrMagic);
    out.put(kFormat | kMultiPart | kLongNames);
    const auto& [layout, lines, channels] = *layoutWith(&Layout::film, films.front().layout);
    for (size_t part = 0; part < films.size(); ++part) {
        writeHeader(out, films[part], part, image, channels);
        if (part == 0)
            for (const auto& [key, value] : attributes)
                out.attribute(std::string(kPrefix) + key, "string", std::string_view(value));
        out.put('\0');
    }
    out.put('\0');

    uint64_t chunk = out.size();
    for (const PassFilm& film : films) chunk += film.rect.height * sizeof(uint64_t);
    for (const PassFilm& film : films)
        for (uint32_t y = 0; y < film.rect.height; ++y, chunk += chunkBytes(film)) out.put(chunk);

    for (size_t part = 0; part < films.size(); ++part) {
        const Rect& r = films[part].rect;
        for (uint32_t y = 0; y < r.height; ++y) {
            out.put(static_cast<int32_t>(part));
            out.put(static_cast<int32_t>(r.y + y));
            out.put(static_cast<int32_t>(lineBytes(films[part])));
            scatter(films[part], y, lines, out.grow(lineBytes(films[part])));
        }
    }
    return out.take();
}

std::vector<PassFilm> decodePassFilms(std::span<const std::byte> bytes) {
    ExrBytes in(bytes);
    std::vector<PassFilm> films = readHeaders(in).films;
    requireExactSize(films, in.size());

    std::vector<OpenPart> open(films.size());
    size_t lines = 0;
    for (size_t part = 0; part < films.size(); ++part) {
        PassFilm& film = films[part];
        film.pixels.resize(film.rect.area());
        film.extra.resize(film.rect.area() * film.layout.floats());
        open[part] = {&layoutWith(&Layout::film, film.layout)->lines, std::vector<bool>(film.rect.height)};
        lines += film.rect.height;
    }
    in.take(lines * sizeof(uint64_t), "the table of offsets");  // chunks are read in the order they stand
    for (size_t i = 0; i < lines; ++i) readChunk(in, films, open);
    return films;
}

ImageAttributes decodePassAttributes(std::span<const std::byte> bytes) {
    ExrBytes in(bytes);
    return readHeaders(in).attributes;
}

}  // namespace tilefarm
