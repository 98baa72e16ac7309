#include "server/config.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <fstream>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

// "HOST:PORT", an IPv6 host in brackets.
void setListen(HttpConfig& http, const std::string& listen) {
    const size_t colon = listen.rfind(':');
    const std::string port = colon == std::string::npos ? "" : listen.substr(colon + 1);
    const auto [end, fault] = std::from_chars(port.data(), port.data() + port.size(), http.port);
    if (colon == 0 || port.empty() || fault != std::errc{} || end != port.data() + port.size() ||
        http.port < 0 || http.port > 65535) {
        throw Error(ErrorCode::invalidArgument, "--listen '" + listen + "': HOST:PORT is expected");
    }
    http.host = listen.substr(0, colon);
    if (http.host.starts_with('[') && http.host.ends_with(']'))
        http.host = http.host.substr(1, http.host.size() - 2);
}

bool isLoopback(const std::string& host) {
    return host == "localhost" || host == "::1" || host.starts_with("127.");
}

std::string readToken(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string token;
    if (!in || !std::getline(in, token) || token.empty()) {
        throw Error(ErrorCode::invalidArgument,
                    "--token-file '" + file.string() + "': cannot be read or is empty");
    }
    while (token.ends_with('\r') || token.ends_with(' ')) token.pop_back();
    return token;
}

}  // namespace

ServerConfig parseCommandLine(int argc, char** argv) {
    ServerConfig config;
    std::string listen = "127.0.0.1:8700", tokenFile;
    double leaseSeconds = 30;
    uint64_t floorMiB = config.api.leastFreeBytes >> 20;
    bool insecure = false;

    CLI::App app("Tilefarm's server: accepts jobs, hands out their tiles to workers and merges the results.");
    app.set_version_flag("--version", TILEFARM_VERSION);
    app.add_option("--data", config.data, "Folder of the database, scene files and images")->required();
    app.add_option("--listen", listen, "Address to listen on, HOST:PORT; port 0: any free port")
        ->capture_default_str();
    app.add_option("--token-file", tokenFile,
                   "File whose first line is the bearer token that workers and clients must send");
    app.add_option(
           "--lease-seconds", leaseSeconds,
           "Lease time: seconds after which the work of a worker that does not renew is given to another")
        ->capture_default_str()
        ->check(CLI::Range(0.2, 3600.0));
    app.add_option("--set-aside-after", config.queue.deathsThatSetAside,
                   "Pause a job after this many workers died while rendering the same pass; 0: never")
        ->capture_default_str()
        ->check(CLI::Range(0, 1000));
    app.add_option("--disk-floor-mib", floorMiB,
                   "Refuse uploads and jobs (HTTP 507) below this much free disk space, MiB")
        ->capture_default_str();
    app.add_flag("--insecure", insecure, "Accept requests from other machines without a token");
    app.add_flag("--verbose", config.verbose, "Also log debug messages");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& fault) {
        std::exit(app.exit(fault) == 0 ? 0 : 2);
    }

    setListen(config.http, listen);
    if (!tokenFile.empty()) config.api.token = readToken(tokenFile);
    if (!isLoopback(config.http.host) && config.api.token.empty() && !insecure) {
        throw Error(
            ErrorCode::invalidArgument,
            "--listen " + listen + " accepts other machines: give --token-file, or --insecure to do without");
    }
    config.queue.leaseTime = Milliseconds(static_cast<int64_t>(leaseSeconds * 1000));
    config.api.leastFreeBytes = floorMiB << 20;
    config.api.folder = config.data;
    config.api.uploads = config.data / "cache";
    return config;
}

}  // namespace tilefarm
