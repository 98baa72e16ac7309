#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <fmt/format.h>

#include <cstring>

#include "shared/error/error.h"
#include "shared/file/durable_file.h"
#include "shared/image/exr.h"
#include "shared/image/exr_header_check.h"

namespace tilefarm {

namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostDecodedBytes = uint64_t{8} << 30;

class MemoryStream : public Imf::IStream {
public:
    MemoryStream(std::span<const std::byte> bytes, const std::string& name)
        : IStream(name.c_str()), bytes_(bytes) {}
    bool read(char out[], int n) override {
        const auto wanted = static_cast<size_t>(n);
        if (n < 0 || at_ > bytes_.size() || wanted > bytes_.size() - at_)
            throw std::runtime_error("the file ends early");
        std::memcpy(out, bytes_.data() + at_, wanted);
        at_ += wanted;
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t position) override { at_ = position; }

private:
    std::span<const std::byte> bytes_;
    uint64_t at_ = 0;
};

// Sets width and height once they and the number of channels are known to be modest.
void requireModest(const Imf::Header& header, uint64_t encodedBytes, uint32_t& width, uint32_t& height) {
    const Imath::Box2i& window = header.dataWindow();
    const int64_t w = int64_t{window.max.x} - window.min.x + 1, h = int64_t{window.max.y} - window.min.y + 1;
    if (w < 1 || h < 1 || w > kLargestExrSide || h > kLargestExrSide)
        throw std::runtime_error(
            fmt::format("it claims {}x{} pixels; {} a side are the most", w, h, kLargestExrSide));
    uint64_t channels = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++channels)
        if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
            throw std::runtime_error(fmt::format("its channel '{}' is subsampled", c.name()));
    width = static_cast<uint32_t>(w), height = static_cast<uint32_t>(h);
    const uint64_t pixels = uint64_t{width} * height;
    if (channels == 0 || channels > kMostDecodedBytes / sizeof(float) / pixels)
        throw std::runtime_error(fmt::format("it claims {}x{} pixels of {} channels", w, h, channels));
    if (pixels * channels * sizeof(float) / kMostExrExpansion > encodedBytes)
        throw std::runtime_error(fmt::format("{} bytes cannot hold its {}x{} pixels", encodedBytes, w, h));
}

FloatImage readPixels(Imf::InputFile& exr, uint64_t encodedBytes) {
    const Imf::Header& header = exr.header();
    FloatImage image;
    requireModest(header, encodedBytes, image.width, image.height);
    if (!exr.isComplete()) throw std::runtime_error("it is incomplete");

    const Imath::Box2i& window = header.dataWindow();
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        image.channels.emplace_back(c.name());
    image.planes.assign(image.channels.size(), std::vector<float>(image.pixelCount()));
    Imf::FrameBuffer buffer;
    for (size_t c = 0; c < image.channels.size(); ++c)
        buffer.insert(image.channels[c], Imf::Slice::Make(Imf::FLOAT, image.planes[c].data(), window));
    exr.setFrameBuffer(buffer);
    exr.readPixels(window.min.y, window.max.y);
    return image;
}

ImageAttributes attributesOf(const Imf::Header& header) {
    ImageAttributes attributes;
    for (auto a = header.begin(); a != header.end(); ++a) {
        const std::string_view name = a.name();
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute());
        if (text && name.starts_with(kAttributePrefix))
            attributes[std::string(name.substr(kAttributePrefix.size()))] = text->value();
    }
    return joinAttributes(attributes);
}

ImageAttributes metadataOf(const Imf::Header& header) {
    ImageAttributes entries;
    for (auto a = header.begin(); a != header.end(); ++a)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            entries[a.name()] = text->value();
    return entries;
}

ExrWindow windowOf(const Imath::Box2i& box) {
    return {box.min.x, box.min.y, int64_t{box.max.x} - box.min.x + 1, int64_t{box.max.y} - box.min.y + 1};
}

Primaries::Xy xy(const Imath::V2f& v) {
    return {double{v.x}, double{v.y}};
}

Primaries primariesOf(const Imf::Header& header) {
    if (!Imf::hasChromaticities(header)) return {};
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    return {xy(c.red), xy(c.green), xy(c.blue), xy(c.white)};
}

ExrPicture pictureOf(Imf::InputFile& exr, uint64_t encodedBytes) {
    const Imf::Header& header = exr.header();
    ExrPicture picture;
    picture.image = readPixels(exr, encodedBytes);
    picture.primaries = primariesOf(header);
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        picture.half.push_back(c.channel().type == Imf::HALF);
    picture.neutral = picture.primaries.white;
    if (Imf::hasAdoptedNeutral(header)) picture.neutral = xy(Imf::adoptedNeutral(header));
    picture.data = windowOf(header.dataWindow());
    picture.display = windowOf(header.displayWindow());
    picture.pixelAspectRatio = header.pixelAspectRatio();
    picture.cubeMap = Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_CUBE;
    return picture;
}

// Turns whatever goes wrong while reading into one Error that names the file.
template <typename Read>
auto reading(const std::string& name, Read&& read) {
    try {
        return read();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("cannot read '{}': it asks for more memory than there is", name));
    } catch (const std::exception& e) {
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("cannot read '{}' as an EXR image: {}", name, e.what()));
    }
}

template <typename Read>
auto readingFile(const std::string& name, std::span<const std::byte> bytes, Read&& read) {
    return reading(name, [&] {
        requireHonestExrHeaders(bytes);
        MemoryStream stream(bytes, name);
        Imf::InputFile exr(stream, 0);
        return read(exr);
    });
}

std::vector<std::byte> bytesOf(const fs::path& path) {
    try {
        return readWhole(path);
    } catch (const Error& e) {
        throw Error(ErrorCode::invalidArgument, e.what());
    }
}

}  // namespace

FloatImage readExr(const fs::path& path) {
    return readExr(bytesOf(path), path.string());
}

FloatImage readExr(std::span<const std::byte> bytes, const std::string& nameForErrors) {
    return readingFile(nameForErrors, bytes,
                       [&](Imf::InputFile& exr) { return readPixels(exr, bytes.size()); });
}

ExrPicture readExrPicture(const fs::path& path) {
    const std::vector<std::byte> bytes = bytesOf(path);
    ExrPicture picture =
        readingFile(path.string(), bytes, [&](Imf::InputFile& exr) { return pictureOf(exr, bytes.size()); });
    picture.parts = requireHonestExrHeaders(bytes);
    return picture;
}

ImageAttributes readExrAttributes(const fs::path& path) {
    return readingFile(path.string(), bytesOf(path),
                       [](Imf::InputFile& exr) { return attributesOf(exr.header()); });
}

ImageAttributes readExrMetadata(const fs::path& path) {
    return readingFile(path.string(), bytesOf(path),
                       [](Imf::InputFile& exr) { return metadataOf(exr.header()); });
}

}  // namespace tilefarm
