// What a pair remembers, as bytes: to be gone on with later, in another process perhaps.
#pragma once

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/narrowphase/contact_set.hpp>
#include <grapeshot/narrowphase/mesh_model.hpp>
#include <grapeshot/narrowphase/pair_update.hpp>

namespace grapeshot {

void save(const ContactSet& set, ByteWriter& out);
void save(const PairState& state, ByteWriter& out);

/// The two bodies of a loaded pair.
struct LoadedModels {
    const MeshModel* a = nullptr;
    const MeshModel* b = nullptr;  ///< null: a solid, of which there are contacts but no candidates
    /// The trees are those of the saved pair, byte by byte (contentKey). Else the triangles still are, and the contacts
    /// are kept, but the search begins anew.
    bool sameTrees = true;
};

/// @throws Error badFile: cut off, points that are no numbers, indices beyond the models
[[nodiscard]] ContactSet loadContactSet(ByteReader& in, const LoadedModels& models);
/// With the same trees, the following steps give the same bytes as without. @throws Error badFile
[[nodiscard]] PairState loadPairState(ByteReader& in, const LoadedModels& models);

}  // namespace grapeshot
