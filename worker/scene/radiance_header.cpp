#include "worker/scene/radiance_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r";
    const size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

template <size_t Count>
std::array<double, Count> numbersOf(std::string_view name, std::string_view value) {
    std::array<double, Count> numbers{};
    std::string_view rest = value;
    for (double& number : numbers) {
        rest = trimmed(rest);
        if (rest.starts_with('+')) rest.remove_prefix(1);
        const char* end = rest.data() + rest.size();
        const auto [after, fault] = std::from_chars(rest.data(), end, number);
        if (fault != std::errc() || !std::isfinite(number))
            throw Error(ErrorCode::invalidArgument,
                        fmt::format("its header's {}={} is not {}", name, value,
                                    Count == 1 ? std::string("a number") : fmt::format("{} numbers", Count)));
        rest = {after, end};
    }
    return numbers;
}

void multiply(double& by, double factor, std::string_view name) {
    by *= factor;
    if (!std::isnormal(by) || by < 0)
        throw Error(ErrorCode::invalidArgument, fmt::format("its header's {} is not above 0", name));
}

}  // namespace

void RadianceHeader::read(std::string_view line) {
    const size_t equals = line.find('=');
    if (equals == std::string_view::npos) return;
    const std::string_view name = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
    if (name == "FORMAT") {
        blanks = blanks || line.size() != name.size() + 1 + value.size();
        xyz = value == "32-bit_rle_xyze";
        if (!xyz && value != "32-bit_rle_rgbe")
            throw Error(
                ErrorCode::invalidArgument,
                fmt::format("is of the FORMAT={}; 32-bit_rle_rgbe and 32-bit_rle_xyze are known", value));
    } else if (name == "EXPOSURE") {
        const double factor = numbersOf<1>(name, value)[0];
        for (double& by : multipliedBy) multiply(by, factor, name);
    } else if (name == "COLORCORR") {
        const auto factors = numbersOf<3>(name, value);
        for (size_t c = 0; c < 3; ++c) multiply(multipliedBy[c], factors[c], name);
    } else if (name == "PIXASPECT") {
        multiply(pixelAspect, numbersOf<1>(name, value)[0], name);
    } else if (name == "PRIMARIES") {
        const auto n = numbersOf<8>(name, value);
        primaries = Primaries{{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}};
        // Published skies have a line of zeros: their writers knew none.
        if (std::all_of(n.begin(), n.end(), [](double v) { return v == 0; })) primaries.reset();
    }
}

std::optional<ColorMatrix> RadianceHeader::toRec709() const {
    const Primaries from = xyz ? kXyzPrimaries : primaries.value_or(Primaries());
    return tilefarm::toRec709(from, from.white);
}

}  // namespace tilefarm
