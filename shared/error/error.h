#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tilefarm {

/// What kind of fault it is; server/api turns it into an HTTP status in one place, and the farm
/// client turns the status back.
enum class ErrorCode {
    invalidArgument,  // malformed or inconsistent input                          400
    unauthorized,     // no or wrong credentials                                   401
    forbidden,        //                                                           403
    notFound,         //                                                           404
    tooSlow,          // the body of a request did not arrive in time              408
    conflict,         // against the current state or epoch                        409
    gone,             // it existed and is no longer wanted                        410
    tooLarge,         //                                                           413
    unprocessable,    // well formed, but cannot be used (a refused result)        422
    versionRefused,   // the peer speaks another version of the protocol           426
    tooMany,          // asked too often                                           429
    internal,         // a fault of this program                                   500
    unavailable,      // try again later                                           503
    outOfSpace,       // the disk is low                                           507
};

/// One fault of an input and its place: an RFC 6901 JSON pointer, a file path or an option's name.
struct Fault {
    std::string pointer;
    std::string message;
    friend bool operator==(const Fault&, const Fault&) = default;
};

/// The one exception type that crosses the seams between folders. `what()` is a whole sentence that
/// names the fault and its place; `faults` lists every single one where there are several.
class Error : public std::runtime_error {
public:
    Error(ErrorCode kind, const std::string& message) : std::runtime_error(message), code(kind) {}
    Error(ErrorCode kind, const std::string& message, std::vector<Fault> every)
        : std::runtime_error(message), code(kind), faults(std::move(every)) {}

    ErrorCode code;
    std::vector<Fault> faults;
};

}  // namespace tilefarm
