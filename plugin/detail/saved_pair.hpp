// One of our pairs as it is saved and restored.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <grapeshot/core/content_key.hpp>
#include <grapeshot/narrowphase/pair_bytes.hpp>
#include <grapeshot/plugin/detail/manifold_state.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// What tells one mesh from another, and one tree over it from another.
struct ModelKeys {
    ContentKey mesh, tree;
};
[[nodiscard]] ModelKeys keysOf(const MeshModel& model);

struct SavedPair {
    PairKind kind = PairKind::meshMesh;
    std::array<ModelKeys, 2> keys;  ///< of the bodies that are meshes, in the pair's order
    PairState state;
    ContactSet ahead;
    std::vector<ManifoldState> manifolds;
    std::uint64_t lastNeed = 0;
    std::uint32_t age = 0, staleness = 0;
    bool cutShort = false, unwanted = false;
};

[[nodiscard]] constexpr bool isMeshOf(PairKind kind, std::size_t body) {
    return kind == PairKind::meshMesh || (kind == PairKind::meshSolid) == (body == 0);
}

void save(const SavedPair& pair, ByteWriter& out);

/// The bodies' models now, null for solids; `keys` of them.
struct PresentPair {
    PairKind kind = PairKind::foreign;
    std::array<const MeshModel*, 2> models{};
    std::array<ModelKeys, 2> keys;
};
/// `otherWorld` is set, and the rest not read, if the meshes are others. @throws Error badFile
[[nodiscard]] SavedPair loadPair(ByteReader& in, const PresentPair& present, bool& otherWorld);

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
