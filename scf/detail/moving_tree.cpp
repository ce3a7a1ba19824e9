#include <grapeshot/scf/detail/moving_tree.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <grapeshot/scf/detail/turning.hpp>

namespace grapeshot::detail {
namespace {

constexpr float rounding = 1.00002F;
constexpr double rigidRounding = 1.003;  // a rotation may be off by isRigid's tolerance

void mix(std::span<const Eigen::Vector3f> before, std::span<const Eigen::Vector3f> now, double time,
         std::vector<Eigen::Vector3f>& out) {
    out.resize(before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
        out[i] = (before[i].cast<double>() + time * (now[i].cast<double>() - before[i].cast<double>())).cast<float>();
    }
}

}  // namespace

MovingTree::MovingTree(const BallTree& tree)
    : m_before(tree), m_now(tree), m_made(tree.nodes.size(), tree.leaves.size()) {}

void MovingTree::begin(const SurfaceMotion& motion, float stretch, const StepPart& part) {
    assert(part.index == 0 || (part.index == m_part.index + 1 && part.count == m_part.count));
    m_made.begin();
    m_frame = motion.frame;
    m_part = part;
    m_turns = !motion.frame.turn.isZero(0);
    m_angle = static_cast<double>(motion.frame.turn.norm()) / part.count;
    const std::span<const Eigen::Vector3f> before =
        motion.before.empty() ? std::span(tree().surface.rest) : motion.before;
    const std::span<const Eigen::Vector3f> now = motion.now.empty() ? before : motion.now;
    const bool isMixed = part.count > 1 && now.data() != before.data();
    const bool stays = !m_turns && motion.frame.path.isZero(0) && motion.frame.from.rotation.isIdentity(0) &&
                       motion.frame.from.translation.isZero(0);
    const auto beginEnd = [&](double time, std::span<const Eigen::Vector3f> whole, std::vector<Eigen::Vector3f>& mixed,
                              PosedTree& end) {
        if (isMixed) {
            mix(before, now, time, mixed);
        }
        const std::span<const Eigen::Vector3f> local = isMixed ? mixed : whole;
        const Pose pose = poseAt(motion.frame, time);
        end.begin(local, stays ? nullptr : &pose, stretch);
        return local;
    };
    if (part.index == 0) {
        m_localBefore = beginEnd(0, before, m_partBefore, m_before);
    } else {
        // It begins where the one before ended, with what was made there.
        std::swap(m_before, m_now);
        m_partBefore.swap(m_partNow);
        m_localBefore = m_localNow;
    }
    m_localNow = beginEnd(static_cast<double>(part.index + 1) / part.count, now, m_partNow, m_now);
}

double MovingTree::acceleration(std::uint32_t vertex) const {
    if (!m_turns) {
        return 0;
    }
    const Eigen::Vector3f& before = localBefore(vertex);
    const Eigen::Vector3f& now = localNow(vertex);
    const double arm = std::sqrt(static_cast<double>(std::max(before.squaredNorm(), now.squaredNorm())));
    const auto own = static_cast<double>((now - before).norm());
    return rigidRounding * m_angle * (m_angle * arm + 2 * own);
}

float MovingTree::bulge(std::uint32_t vertex) const {
    return static_cast<float>(acceleration(vertex) * 0.125);
}

void MovingTree::makeBalls(std::uint32_t index, SweptBalls& balls) {
    const BallNode& node = tree().nodes[index];
    const FourBalls& before = m_before.balls(index);
    const FourBalls& now = m_now.balls(index);
    for (std::uint32_t slot = 0; slot < 4; ++slot) {
        for (int axis = 0; axis < 3; ++axis) {
            balls.center[axis][slot] = before.center[axis][slot];
            balls.path[axis][slot] = now.center[axis][slot] - before.center[axis][slot];
        }
        balls.radius[slot] =
            std::max(before.radius[slot], now.radius[slot]) + (slot < node.count ? bulge(node.center[slot]) : 0);
    }
}

void MovingTree::putBall(BallRef ref, SweptBalls& balls, int slot) {
    FourBalls before;
    FourBalls now;
    m_before.putBall(ref, before, 0);
    m_now.putBall(ref, now, 0);
    for (int axis = 0; axis < 3; ++axis) {
        balls.center[axis][slot] = before.center[axis][0];
        balls.path[axis][slot] = now.center[axis][0] - before.center[axis][0];
    }
    balls.radius[slot] = std::max(before.radius[0], now.radius[0]) + bulge(tree().own(ref).center);
}

void MovingTree::makeLeaf(std::uint32_t index, SweptLeaf& leaf) {
    const BallLeaf& own = tree().leaves[index];
    const PosedLeaf& before = m_before.leaf(index);
    const PosedLeaf& now = m_now.leaf(index);
    SweptBalls around;
    putBall(index | ballLeafBit, around, 0);
    leaf.whole = {{around.center[0][0], around.center[1][0], around.center[2][0]},
                  {around.path[0][0], around.path[1][0], around.path[2][0]},
                  around.radius[0]};
    constexpr float third = 1.0F / 3;
    for (int lane = 0; lane < 16; ++lane) {
        float square = 0;
        for (const PosedLeaf* end : {&before, &now}) {
            float middle[3];
            for (int axis = 0; axis < 3; ++axis) {
                middle[axis] =
                    (end->corner[0][axis][lane] + end->corner[1][axis][lane] + end->corner[2][axis][lane]) * third;
                if (end == &before) {
                    leaf.center[axis][lane] = middle[axis];
                } else {
                    leaf.path[axis][lane] = middle[axis] - leaf.center[axis][lane];
                }
            }
            for (int corner = 0; corner < 3; ++corner) {
                float sum = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    const float d = end->corner[corner][axis][lane] - middle[axis];
                    sum += d * d;
                }
                square = std::max(square, sum);
            }
        }
        float most = 0;
        if (m_turns) {
            for (int corner = 0; corner < 3; ++corner) {
                most = std::max(most, bulge(own.corner[corner][lane]));
            }
        }
        // The middle is rounded like its corners.
        const float far =
            std::max({std::abs(leaf.center[0][lane]), std::abs(leaf.center[1][lane]), std::abs(leaf.center[2][lane])});
        leaf.radius[lane] = std::sqrt(square) * rounding + most + 1e-6F * far;
    }
}

MovingCorners MovingTree::cornersAt(std::uint32_t triangle, double time) const {
    const double whole = (static_cast<double>(m_part.index) + time) / m_part.count;
    const Eigen::Vector3d turnInAll = m_frame.turn.cast<double>();
    const Eigen::Matrix3d rotation = rotationBy(whole * turnInAll) * m_frame.from.rotation.cast<double>();
    const Eigen::Vector3d path = m_frame.path.cast<double>();
    const Eigen::Vector3d origin = m_frame.from.translation.cast<double>() + whole * path;
    const Eigen::Vector3d turn = turnInAll / m_part.count;
    const Triangle& corners = tree().surface.triangles[triangle];
    MovingCorners result;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d before = localBefore(corners[i]).cast<double>();
        const Eigen::Vector3d own = localNow(corners[i]).cast<double>() - before;
        const Eigen::Vector3d arm = rotation * (before + time * own);
        result.place[i] = origin + arm;
        result.velocity[i] = path / m_part.count + turn.cross(arm) + rotation * own;
    }
    return result;
}

double MovingTree::accelerationOf(std::uint32_t triangle) const {
    double largest = 0;
    for (const std::uint32_t corner : tree().surface.triangles[triangle]) {
        largest = std::max(largest, acceleration(corner));
    }
    return largest;
}

}  // namespace grapeshot::detail
