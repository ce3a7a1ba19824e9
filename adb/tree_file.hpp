// Trees on disk: built once, read again in a fraction of the time.
//
// A file holds the arrays of a tree as they are in memory, behind a header that says what they are: magic, version,
// bits of a coordinate, sizes of the structures, counts, a hash of the mesh and settings it was built from, and hashes
// of the header and of all that follows. So it is read by machines of the same byte order only (all that this library
// runs on), and a file of another version is refused rather than guessed at.
#pragma once

#include <filesystem>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/content_key.hpp>

namespace grapeshot {

/// Of all arrays of the tree: with the same key, indices of nodes and leaves mean the same. O(n)
[[nodiscard]] ContentKey contentKey(const Tree& tree);

/// Writes to a name of its own beside `file` and renames it when all is there, so that whoever reads `file` sees the
/// old one or the new one, from other processes too. Leaves nothing behind when it fails.
/// @param settings that the tree was built with
/// @throws Error badFile: cannot be written, with the system's reason
void saveTree(const Tree& tree, const BuildSettings& settings, const std::filesystem::path& file);

/// The tree of this mesh, byte for byte as `build` makes it. Whatever the file holds, nothing outside of it is touched:
/// indices are checked, and every node and leaf is reached once. O(n).
/// @throws Error badFile: cannot be read, is of another version or kind, truncated, changed since it was written, of
/// another mesh or other settings, or its indices are wild; with what and where
[[nodiscard]] Tree loadTree(const std::filesystem::path& file, MeshView mesh, const BuildSettings& settings);

}  // namespace grapeshot
