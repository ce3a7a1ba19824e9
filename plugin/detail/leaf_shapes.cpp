#include <grapeshot/plugin/detail/leaf_shapes.hpp>

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int deepest = 64;

void append(const btCollisionShape& shape, const btTransform& inBody, int depth, std::vector<PlacedShape>& leaves) {
    if (!shape.isCompound()) {
        leaves.push_back({&shape, inBody});
        return;
    }
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes() && depth < deepest; ++i) {
        append(*compound.getChildShape(i), inBody * compound.getChildTransform(i), depth + 1, leaves);
    }
}

}  // namespace

void appendLeaves(const btCollisionShape& shape, const btTransform& inBody, std::vector<PlacedShape>& leaves) {
    append(shape, inBody, 0, leaves);
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
