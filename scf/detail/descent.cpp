#include <grapeshot/scf/detail/descent.hpp>

#include <limits>

namespace grapeshot::detail {
namespace {

/// Moves `vertex` of one side nearer to `other` of the other side. False: there is nothing nearer.
bool improve(const PosedTree& side, const Eigen::Vector3f& target, const Eigen::Vector3f* restTarget, float exclusion,
             std::uint32_t& vertex, float& square, std::uint64_t& work) {
    const auto ring = side.tree().surface.ring.of(vertex);
    work += 1 + ring.size() / 16;
    bool moved = false;
    for (const std::uint32_t next : ring) {
        const float distance = (side.point(next) - target).squaredNorm();
        if (distance < square &&
            (restTarget == nullptr ||
             (side.tree().surface.rest[next] - *restTarget).squaredNorm() > exclusion * exclusion)) {
            square = distance;
            vertex = next;
            moved = true;
        }
    }
    return moved;
}

}  // namespace

VertexPair descend(const PairSpace& space, std::uint32_t a, std::uint32_t b, int units, std::uint64_t& work) {
    const std::uint64_t first = work;
    VertexPair pair{a, b, (space.a->point(a) - space.b->point(b)).squaredNorm()};
    const float enough = space.reach * space.reach;
    int stuck = 0;  // sides in a row that had nothing nearer
    for (bool turnOfB = true; stuck < 2 && pair.square > enough && work - first < static_cast<std::uint64_t>(units);
         turnOfB = !turnOfB) {
        const PosedTree& side = turnOfB ? *space.b : *space.a;
        const PosedTree& other = turnOfB ? *space.a : *space.b;
        std::uint32_t& vertex = turnOfB ? pair.b : pair.a;
        const std::uint32_t fixed = turnOfB ? pair.a : pair.b;
        const Eigen::Vector3f* rest = space.isSelf() ? &other.tree().surface.rest[fixed] : nullptr;
        stuck = improve(side, other.point(fixed), rest, space.exclusion, vertex, pair.square, work) ? 0 : stuck + 1;
    }
    return pair;
}

VertexPair nearestCorners(const PairSpace& space, const TrianglePair& pair) {
    VertexPair nearest{0, 0, std::numeric_limits<float>::infinity()};
    for (const std::uint32_t a : space.a->tree().surface.triangles[pair.triangleA]) {
        const Eigen::Vector3f point = space.a->point(a);
        for (const std::uint32_t b : space.b->tree().surface.triangles[pair.triangleB]) {
            const float square = (space.b->point(b) - point).squaredNorm();
            if (square < nearest.square) {
                nearest = {a, b, square};
            }
        }
    }
    if (nearest.square == std::numeric_limits<float>::infinity()) {  // not a number
        nearest = {space.a->tree().surface.triangles[pair.triangleA][0],
                   space.b->tree().surface.triangles[pair.triangleB][0], nearest.square};
    }
    return nearest;
}

}  // namespace grapeshot::detail
