#include <grapeshot/plugin/foreign_hierarchy.hpp>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <algorithm>
#include <string>

#include <grapeshot/core/error.hpp>
#include <grapeshot/plugin/detail/shape_mesh.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace {

std::vector<detail::PartSource> sourcesOf(const btCollisionShape& shape) {
    std::vector<detail::PartSource> sources;
    detail::sourcesOf(shape, sources);
    return sources;
}

template <class Shape>
Tree augmentAny(const Shape& shape) {
    const detail::ShapeMesh mesh = detail::readMesh(sourcesOf(shape));
    return augment(mesh.view(), hierarchyOf(shape));
}

/// One of Bullet's nodes. All three kinds of arrays hold them in preorder: a node's left child stands next to it, its
/// right child behind all that is below the left one.
struct PreorderNode {
    bool isLeaf = false;
    int part = 0;      ///< of a leaf
    int triangle = 0;  ///< of a leaf, within the part
    int size = 1;      ///< nodes from here to the end of what is below, this one included
};

/// Numbers the triangles of all parts.
class Numbering {
  public:
    explicit Numbering(const std::vector<detail::PartSource>& sources) {
        std::uint32_t first = 0;
        for (const detail::PartSource& source : sources) {
            m_parts.push_back({first, source.triangles});
            first += static_cast<std::uint32_t>(source.triangles);
        }
    }
    [[nodiscard]] std::uint32_t numberOf(int part, int triangle) const {
        const bool hasPart = part >= 0 && static_cast<std::size_t>(part) < m_parts.size();
        if (!hasPart || triangle < 0 || triangle >= m_parts[static_cast<std::size_t>(part)].triangles) {
            throw Error(Fault::indexOutOfRange,
                        "triangle " + std::to_string(triangle) + " of part " + std::to_string(part),
                        "hierarchy of the shape");
        }
        return m_parts[static_cast<std::size_t>(part)].first + static_cast<std::uint32_t>(triangle);
    }

  private:
    struct Part {
        std::uint32_t first;
        int triangles;
    };
    std::vector<Part> m_parts;
};

/// @param nodeAt gives PreorderNode number i of at most `available`, of which the arrays may use less.
template <class NodeAt>
ForeignHierarchy fromPreorder(int available, const Numbering& numbering, const NodeAt& nodeAt) {
    if (available < 1) {
        throw Error(Fault::emptyMesh, "no nodes", "hierarchy of the shape");
    }
    ForeignHierarchy out;
    const int count = std::min(available, nodeAt(0).size);
    out.nodes.resize(static_cast<std::size_t>(std::max(count, 1)));
    for (int i = 0; i < count; ++i) {
        const PreorderNode node = nodeAt(i);
        ForeignNode& made = out.nodes[static_cast<std::size_t>(i)];
        if (node.isLeaf) {
            made.begin = static_cast<std::uint32_t>(out.triangles.size());
            made.end = made.begin + 1;
            out.triangles.push_back(numbering.numberOf(node.part, node.triangle));
            continue;
        }
        const int left = i + 1;
        if (left >= count) {
            throw Error(Fault::badHierarchy, "ends at node " + std::to_string(i), "hierarchy of the shape");
        }
        // In unsigned: whatever stands there, `augment` will tell.
        made.left = static_cast<std::uint32_t>(left);
        made.right = made.left + static_cast<std::uint32_t>(nodeAt(left).size);
    }
    return out;
}

/// What getEscapeIndex says, but defined for the lowest number too: triangle 0 of part 1024, which has spilt into the
/// sign.
int sizeOf(const btQuantizedBvhNode& inner) {
    return static_cast<int>(0U - static_cast<unsigned>(inner.m_escapeIndexOrTriangleIndex));
}

/// The way to a protected member: a derived class may name it.
struct PlainNodes : btQuantizedBvh {
    static const NodeArray& of(const btQuantizedBvh& bvh) { return bvh.*(&PlainNodes::m_contiguousNodes); }
};

}  // namespace

ForeignHierarchy hierarchyOf(const btBvhTriangleMeshShape& shape) {
    const Numbering numbering(sourcesOf(shape));
    // Bullet forgot the const; nothing is changed.
    auto* bvh = const_cast<btBvhTriangleMeshShape&>(shape).getOptimizedBvh();
    if (bvh == nullptr) {
        throw Error(Fault::emptyMesh, "no hierarchy, see buildOptimizedBvh", "shape");
    }
    if (bvh->isQuantized()) {
        const QuantizedNodeArray& nodes = bvh->getQuantizedNodeArray();
        return fromPreorder(nodes.size(), numbering, [&](int i) {
            const btQuantizedBvhNode& node = nodes[i];
            return node.isLeafNode() ? PreorderNode{true, node.getPartId(), node.getTriangleIndex()}
                                     : PreorderNode{.size = sizeOf(node)};
        });
    }
    const NodeArray& nodes = PlainNodes::of(*bvh);
    return fromPreorder(nodes.size(), numbering, [&](int i) {
        const btOptimizedBvhNode& node = nodes[i];
        return node.m_escapeIndex < 0 ? PreorderNode{true, node.m_subPart, node.m_triangleIndex}
                                      : PreorderNode{.size = node.m_escapeIndex};
    });
}

ForeignHierarchy hierarchyOf(const btGImpactMeshShapePart& shape) {
    const Numbering numbering(sourcesOf(shape));
    const btGImpactBoxSet& boxes = *shape.getBoxSet();
    return fromPreorder(boxes.getNodeCount(), numbering, [&](int i) {
        return boxes.isLeafNode(i) ? PreorderNode{true, 0, boxes.getNodeData(i)}
                                   : PreorderNode{.size = boxes.getEscapeNodeIndex(i)};
    });
}

ForeignHierarchy hierarchyOf(const btGImpactMeshShape& shape) {
    const std::vector<detail::PartSource> sources = sourcesOf(shape);
    // Above the parts a complete tree as in a heap: nodes 0 to parts - 2, children of i at 2 i + 1 and 2 i + 2, where
    // what would be node parts - 1 + k is the root of part k.
    const auto parts = static_cast<std::uint32_t>(sources.size());
    if (parts == 0) {
        throw Error(Fault::emptyMesh, "no parts", "shape");
    }
    ForeignHierarchy out;
    out.nodes.resize(parts - 1);
    std::vector<std::uint32_t> roots;
    std::uint32_t firstTriangle = 0;
    for (std::uint32_t k = 0; k < parts; ++k) {
        ForeignHierarchy part = hierarchyOf(*shape.getMeshPart(static_cast<int>(k)));
        const auto firstNode = static_cast<std::uint32_t>(out.nodes.size());
        const auto firstEntry = static_cast<std::uint32_t>(out.triangles.size());
        roots.push_back(firstNode);
        for (ForeignNode node : part.nodes) {
            if (node.left != 0) {
                node.left += firstNode;
                node.right += firstNode;
            } else {
                node.begin += firstEntry;
                node.end += firstEntry;
            }
            out.nodes.push_back(node);
        }
        for (const std::uint32_t triangle : part.triangles) {
            out.triangles.push_back(firstTriangle + triangle);
        }
        firstTriangle += static_cast<std::uint32_t>(sources[k].triangles);
    }
    const auto nodeAt = [&](std::uint32_t place) { return place < parts - 1 ? place : roots[place - (parts - 1)]; };
    for (std::uint32_t i = 0; i + 1 < parts; ++i) {
        out.nodes[i].left = nodeAt(2 * i + 1);
        out.nodes[i].right = nodeAt(2 * i + 2);
    }
    return out;
}

Tree augment(const btBvhTriangleMeshShape& shape) {
    return augmentAny(shape);
}

Tree augment(const btGImpactMeshShapePart& shape) {
    return augmentAny(shape);
}

Tree augment(const btGImpactMeshShape& shape) {
    return augmentAny(shape);
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
