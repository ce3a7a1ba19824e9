#include <grapeshot/scf/detail/posed_tree.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace grapeshot::detail {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float rounding = 1.00002F;  // of distances in single precision, and of stretches
constexpr float posedRounding = 1.002F;

float farthest(const Eigen::Vector3f& point) {
    return point.cwiseAbs().maxCoeff();
}

}  // namespace

PosedTree::PosedTree(const BallTree& tree) : m_tree(&tree), m_made(tree.nodes.size(), tree.leaves.size()) {}

void PosedTree::begin(std::span<const Eigen::Vector3f> positions, const Pose* pose, float stretch) {
    m_positions = positions;
    m_atRest = false;
    m_isPosed = pose != nullptr;
    if (m_isPosed) {
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) {
                m_rotation[3 * row + column] = pose->rotation(row, column);
            }
            m_translation[row] = pose->translation[row];
        }
        m_farthest = farthest(pose->translation);
    }
    m_made.begin();
    m_finite = true;
    m_stretch = stretch;
    if (!(stretch > 0)) {
        for (std::uint32_t node = static_cast<std::uint32_t>(m_tree->nodes.size()); node-- > 0;) {
            static_cast<void>(balls(node));  // children stand after their parents
        }
    }
}

void PosedTree::beginAtRest(const Pose* pose) {
    begin(m_tree->surface.rest, pose, 1);
    m_atRest = true;
}

Eigen::Vector3f PosedTree::moved(const Eigen::Vector3f& p) const {
    Eigen::Vector3f result;
    for (int axis = 0; axis < 3; ++axis) {
        const float* row = m_rotation + 3 * axis;
        result[axis] = ((row[0] * p[0] + row[1] * p[1]) + row[2] * p[2]) + m_translation[axis];
    }
    return result;
}

float PosedTree::radiusFromVertices(std::uint32_t leaf, const Eigen::Vector3f& center) {
    float square = 0;
    for (const std::uint32_t vertex : m_tree->leafVertices.of(leaf)) {
        const Eigen::Vector3f p = point(vertex);
        note(p);
        square = std::max(square, (p - center).squaredNorm());
    }
    return std::sqrt(square);
}

float PosedTree::radiusFromChildren(std::uint32_t node, const Eigen::Vector3f& center) {
    const FourBalls& below = balls(node);
    float radius = 0;
    for (std::uint32_t slot = 0; slot < m_tree->nodes[node].count; ++slot) {
        const Eigen::Vector3f middle(below.center[0][slot], below.center[1][slot], below.center[2][slot]);
        radius = std::max(radius, (middle - center).norm() + below.radius[slot]);
    }
    return radius;
}

void PosedTree::putPlainBall(const float (&center)[3], float radius, FourBalls& balls, std::uint32_t slot) {
    const Eigen::Vector3f rest(center[0], center[1], center[2]);
    const Eigen::Vector3f middle = m_isPosed ? moved(rest) : rest;
    note(middle);
    for (int axis = 0; axis < 3; ++axis) {
        balls.center[axis][slot] = middle[axis];
    }
    balls.radius[slot] =
        m_isPosed ? radius * posedRounding + 1e-6F * (farthest(middle) + m_farthest) : radius * rounding;
}

float PosedTree::radiusOf(BallRef child, std::uint32_t center, float restRadius) {
    float radius = m_stretch > 0 ? restRadius * m_stretch : infinity;
    const Eigen::Vector3f middle = point(center);
    if (radius == infinity) {
        radius = isBallLeaf(child) ? radiusFromVertices(ballIndex(child), middle)
                                   : radiusFromChildren(ballIndex(child), middle);
    }
    // A moved vertex has four roundings of its coordinates, and the rotation may be off by `isRigid`'s tolerance.
    return m_isPosed ? radius * posedRounding + 1e-6F * (farthest(middle) + m_farthest) : radius * rounding;
}

void PosedTree::makeBalls(std::uint32_t index, FourBalls& balls) {
    const BallNode& node = m_tree->nodes[index];
    if (m_atRest) {
        const FourBalls& plain = m_tree->plainBalls[index];
        for (std::uint32_t slot = 0; slot < 4; ++slot) {
            const float center[3] = {plain.center[0][slot], plain.center[1][slot], plain.center[2][slot]};
            putPlainBall(center, plain.radius[slot], balls, slot);
        }
        return;
    }
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
        const bool used = slot < node.count;
        const Eigen::Vector3f middle = point(node.center[used ? slot : 0]);
        note(middle);
        for (int axis = 0; axis < 3; ++axis) {
            balls.center[axis][slot] = middle[axis];
        }
        balls.radius[slot] = used ? radiusOf(node.child[slot], node.center[slot], node.radius[slot]) : 0;
    }
}

void PosedTree::putBall(BallRef ref, const PieceBall& own, FourBalls& balls, int slot) {
    if (m_atRest) {
        putPlainBall(own.plainCenter, own.plainRadius, balls, static_cast<std::uint32_t>(slot));
        return;
    }
    const Eigen::Vector3f middle = point(own.center);
    note(middle);
    for (int axis = 0; axis < 3; ++axis) {
        balls.center[axis][slot] = middle[axis];
    }
    balls.radius[slot] = radiusOf(ref, own.center, own.radius);
}

void PosedTree::makeLeaf(std::uint32_t index, PosedLeaf& posed) {
    const BallLeaf& leaf = m_tree->leaves[index];
    for (int corner = 0; corner < 3; ++corner) {
        for (std::uint32_t lane = 0; lane < 16; ++lane) {
            const Eigen::Vector3f& p = m_positions[leaf.corner[corner][lane]];
            for (int axis = 0; axis < 3; ++axis) {
                posed.corner[corner][axis][lane] = p[axis];
            }
        }
        if (m_isPosed) {
            auto& axes = posed.corner[corner];
            for (std::uint32_t lane = 0; lane < 16; ++lane) {
                const float x = axes[0][lane];
                const float y = axes[1][lane];
                const float z = axes[2][lane];
                for (int axis = 0; axis < 3; ++axis) {
                    const float* row = m_rotation + 3 * axis;
                    axes[axis][lane] = ((row[0] * x + row[1] * y) + row[2] * z) + m_translation[axis];
                }
            }
        }
    }
    float zero = 0;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::uint32_t lane = 0; lane < 16; ++lane) {
            const float a = posed.corner[0][axis][lane];
            const float b = posed.corner[1][axis][lane];
            const float c = posed.corner[2][axis][lane];
            zero += (a - a) + (b - b) + (c - c);
            posed.low[axis][lane] = std::min(std::min(a, b), c);
            posed.high[axis][lane] = std::max(std::max(a, b), c);
            posed.middle[axis][lane] = leaf.middle[axis][lane];
        }
        // Unused lanes repeat lane 0, so that they do not count here.
        posed.boxLow[axis] = *std::min_element(posed.low[axis], posed.low[axis] + 16);
        posed.boxHigh[axis] = *std::max_element(posed.high[axis], posed.high[axis] + 16);
        for (std::uint32_t lane = leaf.count; lane < 16; ++lane) {
            posed.low[axis][lane] = infinity;
            posed.high[axis][lane] = -infinity;
        }
    }
    m_finite = m_finite && zero == 0;
}

}  // namespace grapeshot::detail
