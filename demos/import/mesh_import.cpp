#include <import/mesh_import.hpp>

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include <grapeshot/core/error.hpp>

#include "detail/header_check.hpp"
#include "detail/helper_process.hpp"
#include "detail/wire.hpp"

namespace grapeshot::import {
namespace {

namespace fs = std::filesystem;

constexpr const char* helperName = "grapeshot-import";

fs::path findHelper(const ImportLimits& limits) {
    if (!limits.helper.empty()) {
        return limits.helper;
    }
    if (const char* named = std::getenv("GRAPESHOT_IMPORT_HELPER"); named != nullptr && *named != '\0') {
        return named;
    }
    std::error_code ignored;
    const fs::path here = fs::read_symlink("/proc/self/exe", ignored).parent_path();
    for (const fs::path& place : {here / helperName, here / "../libexec/grapeshot" / helperName}) {
        if (fs::exists(place, ignored)) {
            return place;
        }
    }
    return GRAPESHOT_IMPORT_HELPER_BUILT;
}

std::uintmax_t requireFile(const fs::path& file, const ImportLimits& limits) {
    std::error_code fault;
    const fs::file_status status = fs::status(file, fault);
    if (fault || !fs::exists(status)) {
        throw Error(Fault::badFile, fault ? fault.message() : "no such file", file.string());
    }
    if (!fs::is_regular_file(status)) {
        throw Error(Fault::badFile, "not a regular file", file.string());
    }
    const std::uintmax_t bytes = fs::file_size(file, fault);
    if (fault || access(file.c_str(), R_OK) != 0) {
        throw Error(Fault::badFile, fault ? fault.message() : std::strerror(errno), file.string());
    }
    if (bytes > limits.maxFileBytes) {
        throw Error(Fault::limitExceeded,
                    std::to_string(bytes) + " bytes, the limit is " + std::to_string(limits.maxFileBytes),
                    file.string());
    }
    return bytes;
}

std::string seconds(std::chrono::milliseconds time) {
    return std::to_string(time.count() / 1000) + "." + std::to_string(time.count() / 100 % 10) + " s";
}

[[noreturn]] void failByEnd(const detail::ProcessResult& run, const ImportLimits& limits, const fs::path& file) {
    switch (run.end) {
        case detail::ProcessEnd::signalled:
            throw Error(
                Fault::badFile,
                "the loader crashed on it: signal " + std::to_string(run.code) + " (" + strsignal(run.code) + ")",
                file.string());
        case detail::ProcessEnd::cpuTimeUp:
            throw Error(Fault::limitExceeded,
                        "loading took more than " + seconds(limits.cpuTime) + " of processor time", file.string());
        case detail::ProcessEnd::wallTimeUp:
            throw Error(Fault::limitExceeded, "loading took longer than " + seconds(limits.wallTime), file.string());
        case detail::ProcessEnd::tooMuchOutput:
            throw Error(Fault::limitExceeded,
                        "more than " + std::to_string(limits.maxVertices) + " vertices or " +
                            std::to_string(limits.maxTriangles) + " triangles",
                        file.string());
        case detail::ProcessEnd::notStarted:
            throw Error(Fault::badSetting, std::string("the loading process did not start: ") + std::strerror(run.code),
                        file.string());
        case detail::ProcessEnd::exited:
            break;
    }
    throw Error(Fault::badFile, "the loader gave up with exit code " + std::to_string(run.code), file.string());
}

}  // namespace

scenes::Mesh importMesh(const fs::path& file, const ImportLimits& limits) {
    detail::checkHeader(file, requireFile(file, limits));
    const fs::path helper = findHelper(limits);
    if (access(helper.c_str(), X_OK) != 0) {
        throw Error(Fault::badSetting, std::string("no loader program: ") + std::strerror(errno), helper.string());
    }
    // An absolute path cannot be taken for anything else by assimp.
    const detail::ProcessResult run = detail::runLimited(
        helper, {std::to_string(limits.maxVertices), std::to_string(limits.maxTriangles), fs::absolute(file).string()},
        {.maxMemory = limits.maxMemory,
         .cpuTime = limits.cpuTime,
         .wallTime = limits.wallTime,
         .maxOutput = detail::wireSize(limits.maxVertices, limits.maxTriangles)});
    if (run.end != detail::ProcessEnd::exited || run.code != 0) {
        failByEnd(run, limits, file);
    }
    auto message = detail::decode(run.output);
    if (const auto* error = std::get_if<detail::WireError>(&message)) {
        throw Error(error->fault, error->text, file.string());
    }
    auto& mesh = std::get<scenes::Mesh>(message);
    if (mesh.triangles.empty()) {
        throw Error(Fault::emptyMesh, "no triangles in the file", file.string());
    }
    return std::move(mesh);
}

}  // namespace grapeshot::import
