#pragma once

#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "shared/error/error.h"
#include "worker/scene/json_node.h"

namespace tilefarm {

/// Reads what nothing may need: a fault becomes a warning at `node` and comes back, for whoever needs it
/// after all. In a strict file it is thrown.
template <typename Read>
std::optional<Error> readIfSound(const JsonNode& node, Read read) {
    try {
        read();
        return std::nullopt;
    } catch (const Error& fault) {
        node.forgive(fault);
        return fault;
    }
}

/// The elements of an array of the file, in its order. A broken one is a warning until something asks for
/// it, and then its fault.
template <typename T>
class PartList {
public:
    template <typename Read>
    void add(const JsonNode& node, Read read) {
        std::optional<T> part;
        std::optional<Error> fault = readIfSound(node, [&] { part.emplace(read()); });
        fault ? parts_.emplace_back(std::move(*fault)) : parts_.emplace_back(std::move(*part));
    }

    size_t size() const { return parts_.size(); }
    /// Throws what add() met if the element is broken.
    const T& operator[](size_t index) const {
        if (const auto* fault = std::get_if<Error>(&parts_[index])) throw *fault;
        return std::get<T>(parts_[index]);
    }
    T& operator[](size_t index) { return const_cast<T&>(std::as_const(*this)[index]); }

private:
    std::vector<std::variant<T, Error>> parts_;
};

}  // namespace tilefarm
