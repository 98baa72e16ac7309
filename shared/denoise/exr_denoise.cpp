#include "shared/denoise/exr_denoise.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "shared/error/error.h"
#include "shared/file/durable_file.h"
#include "shared/image/durable_stream.h"
#include "shared/image/exr_attributes.h"

namespace tilefarm {

namespace {

namespace fs = std::filesystem;

constexpr std::array kResult{"denoised.R", "denoised.G", "denoised.B"};
// A header of a few bytes must not ask for all memory.
constexpr int64_t kLargestSide = 65536;
constexpr size_t kMostChannels = 256;
constexpr int kZipLevel = 1;  // as exr.cpp's; a file does not say its own

struct Guide {
    std::string name;
    std::vector<float>* plane;
};

// Older files of ours have a channel `samples`.
std::string samplesChannel(const Imf::ChannelList& channels) {
    return channels.findChannel("samples") ? "samples" : "samples.X";
}

std::vector<Guide> guidesOf(GuidedRows& rows, const Imf::ChannelList& channels) {
    std::vector<Guide> guides{
        {"Z", &rows.depth}, {"A", &rows.alpha}, {samplesChannel(channels), &rows.samples}};
    for (size_t c = 0; c < 3; ++c) {
        const std::string colour(1, "RGB"[c]), axis(1, "XYZ"[c]);
        guides.push_back({colour, &rows.radiance[c]});
        guides.push_back({"variance." + colour, &rows.variance[c]});
        guides.push_back({"albedo." + colour, &rows.albedo[c]});
        guides.push_back({"normal." + axis, &rows.normal[c]});
    }
    return guides;
}

// Rows of channels as they lie in a file, whatever their types.
class StoredRows {
public:
    StoredRows(const Imf::ChannelList& channels, const Imath::Box2i& window)
        : window_(window), width_(static_cast<size_t>(window.max.x - window.min.x) + 1) {
        for (auto c = channels.begin(); c != channels.end(); ++c)
            if (std::find_if(kResult.begin(), kResult.end(), [&](const char* name) {
                    return std::strcmp(name, c.name()) == 0;
                }) == kResult.end())
                planes_.push_back({c.name(), c.channel().type, {}});
    }
    /// Where `rows` rows from `first` on are read to and written from.
    Imf::FrameBuffer buffer(uint32_t first, uint32_t rows) {
        Imf::FrameBuffer buffer;
        for (Stored& plane : planes_) {
            const size_t bytes = plane.type == Imf::HALF ? 2 : 4;
            plane.bytes.resize(bytes * width_ * rows);
            buffer.insert(plane.name,
                          Imf::Slice::Make(plane.type, plane.bytes.data(),
                                           Imath::V2i(window_.min.x, window_.min.y + static_cast<int>(first)),
                                           static_cast<int64_t>(width_), rows, bytes));
        }
        return buffer;
    }

private:
    struct Stored {
        std::string name;
        Imf::PixelType type;
        std::vector<char> bytes;
    };
    Imath::Box2i window_;
    size_t width_;
    std::vector<Stored> planes_;
};

class Frame {
public:
    explicit Frame(const fs::path& path) : file_(path.c_str()), window_(file_.header().dataWindow()) {
        const int64_t w = int64_t{window_.max.x} - window_.min.x + 1,
                      h = int64_t{window_.max.y} - window_.min.y + 1;
        if (w < 1 || h < 1 || w > kLargestSide || h > kLargestSide)
            throw std::runtime_error(
                fmt::format("it claims {}x{} pixels; {} a side are the most", w, h, kLargestSide));
        width_ = static_cast<uint32_t>(w), height_ = static_cast<uint32_t>(h);
        if (file_.header().hasTileDescription()) throw std::runtime_error("it is not made of scanlines");
        requireChannels();
        if (!file_.isComplete()) throw std::runtime_error("it is incomplete");
    }

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    const Imf::Header& header() const { return file_.header(); }

    void read(uint32_t first, uint32_t rows, GuidedRows& into) {
        Imf::FrameBuffer buffer;
        for (const Guide& guide : guidesOf(into, header().channels()))
            buffer.insert(guide.name, slice(guide.plane->data(), first, rows));
        read(buffer, first, rows);
    }
    void read(const Imf::FrameBuffer& buffer, uint32_t first, uint32_t rows) {
        file_.setFrameBuffer(buffer);
        file_.readPixels(window_.min.y + static_cast<int>(first),
                         window_.min.y + static_cast<int>(first + rows) - 1);
    }
    Imf::Slice slice(const float* plane, uint32_t first, uint32_t rows) const {
        return Imf::Slice::Make(Imf::FLOAT, plane,
                                Imath::V2i(window_.min.x, window_.min.y + static_cast<int>(first)), width_,
                                rows);
    }

private:
    void requireChannels() const {
        const Imf::ChannelList& channels = header().channels();
        GuidedRows none;
        std::string missing;
        for (const Guide& guide : guidesOf(none, channels))
            if (!channels.findChannel(guide.name)) missing += (missing.empty() ? "" : ", ") + guide.name;
        if (!missing.empty()) throw std::runtime_error("it has no channels " + missing);
        size_t count = 0;
        for (auto c = channels.begin(); c != channels.end(); ++c, ++count)
            if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
                throw std::runtime_error(fmt::format("its channel '{}' is subsampled", c.name()));
        if (count > kMostChannels)
            throw std::runtime_error(fmt::format("it has {} channels, more than {}", count, kMostChannels));
    }

    Imf::InputFile file_;
    Imath::Box2i window_;
    uint32_t width_ = 0, height_ = 0;
};

Imf::Header headerFor(const Frame& frame, const DenoiseSettings& settings) {
    Imf::Header header = frame.header();
    for (const char* name : kResult) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    for (const auto& [name, part] : splitAttribute("tilefarm.denoiser", denoiserText(settings)))
        header.insert(name, Imf::StringAttribute(part));
    header.zipCompressionLevel() = kZipLevel;
    return header;
}

// Calls `work` so that what OpenEXR throws names the file at fault.
template <typename Work>
auto named(const fs::path& path, ErrorCode code, const char* fault, const Work& work) {
    try {
        return work();
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        throw Error(code, fmt::format("{} '{}': {}", fault, path.string(), e.what()));
    }
}

}  // namespace

void denoiseExr(const fs::path& in, const fs::path& out, const DenoiseSettings& settings) {
    const auto reading = [&](const auto& work) {
        return named(in, ErrorCode::invalidArgument, "cannot denoise", work);
    };
    const auto writing = [&](const auto& work) { named(out, ErrorCode::internal, "cannot write", work); };

    const auto frame = reading([&] { return std::make_unique<Frame>(in); });
    DurableFile file(out);
    writing([&] {
        DurableStream stream(file, out.string());
        Imf::OutputFile exr(stream, headerFor(*frame, settings), 0);
        StoredRows stored(frame->header().channels(), frame->header().dataWindow());
        denoise(
            frame->width(), frame->height(), settings,
            [&](uint32_t first, uint32_t rows, GuidedRows& into) {
                reading([&] { frame->read(first, rows, into); });
            },
            [&](uint32_t first, uint32_t rows, const std::array<std::vector<float>, 3>& radiance) {
                Imf::FrameBuffer buffer = stored.buffer(first, rows);
                reading([&] { frame->read(buffer, first, rows); });
                for (size_t c = 0; c < 3; ++c)
                    buffer.insert(kResult[c], frame->slice(radiance[c].data(), first, rows));
                exr.setFrameBuffer(buffer);
                exr.writePixels(static_cast<int>(rows));
            });
        // The destructor writes the table of offsets and swallows faults; DurableFile remembers them.
    });
    file.commit();
}

}  // namespace tilefarm
