// Any mesh file into a triangle mesh, by a loader that may crash, hang or swallow memory without doing us harm.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include <scenes/shapes.hpp>

namespace grapeshot::import {

/// What one file may cost. A limit that is hit is Fault::limitExceeded, and the message names it.
struct ImportLimits {
    std::uintmax_t maxFileBytes = std::uintmax_t{1} << 30U;
    std::size_t maxVertices = 20'000'000;           ///< after loading; instances of a mesh count each
    std::size_t maxTriangles = 40'000'000;          ///< likewise
    std::size_t maxMemory = std::size_t{4} << 30U;  ///< bytes of address space of the loading process
    std::chrono::seconds cpuTime{60};
    std::chrono::milliseconds wallTime{120'000};
    /// The program that loads. Empty: the environment variable GRAPESHOT_IMPORT_HELPER, else `grapeshot-import` beside
    /// the running program, in ../libexec/grapeshot, or in the build tree.
    std::filesystem::path helper;
};

/// Loads all triangles of all nodes of a file (OBJ, STL, PLY, OFF, glTF, Collada, ...: what assimp reads), polygons
/// triangulated, points and lines left out, nodes moved to their places, in the file's own unit. Vertices may be split
/// (loaders do that); they may be NaN, which `inspect` counts and `build` refuses.
///
/// Assimp runs in a process of its own with limits on memory and time; its answer is checked like any foreign input.
/// @throws Error badFile (missing, unreadable, cut off, a claim that its size contradicts, or the loader crashed),
/// emptyMesh, indexOutOfRange, limitExceeded, badSetting (no helper program); the place is the file.
[[nodiscard]] scenes::Mesh importMesh(const std::filesystem::path& file, const ImportLimits& limits = {});

}  // namespace grapeshot::import
