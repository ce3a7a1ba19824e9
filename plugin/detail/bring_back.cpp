#include <grapeshot/plugin/detail/bring_back.hpp>

#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

void moveNodes(btSoftBody& body, const std::vector<NodeMove>& moves, const btMatrix3x3& frame,
               std::vector<Eigen::Vector3f>& before) {
    for (const NodeMove& move : moves) {
        btSoftBody::Node& node = body.m_nodes[static_cast<int>(move.node)];
        const Eigen::Vector3f local = move.move.cast<float>();
        const btVector3 way = frame * toBullet(local);
        node.m_x += way;
        node.m_q += way;
        before[move.node] += local;
    }
}

/// By which a contact grows.
float grown(const std::array<std::uint32_t, 3>& vertices, const Eigen::Vector3f& weights,
            const std::vector<NodeMove>& moves, const Eigen::Vector3f& normal) {
    float sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        if (const NodeMove* move = moveOf(moves, vertices[i])) {
            sum += weights[static_cast<int>(i)] * move->move.cast<float>().dot(normal);
        }
    }
    return sum;
}

}  // namespace

void bringBack(const BringBack& task, btSoftBody& a, btSoftBody* b, std::vector<Eigen::Vector3f>* beforeA,
               std::vector<Eigen::Vector3f>* beforeB, std::vector<SoftSurfaceContact>& contacts) {
    std::vector<double> missing;
    for (const SoftSurfaceContact& contact : contacts) {
        const auto before = static_cast<double>(contact.before);
        missing.push_back(before < task.distance ? wayBack(before, task.distance, task.hardness) : 0.0);
    }
    const NodeMoves moves = nodeMoves(task.bodies, contacts, missing);
    moveNodes(a, moves[0], task.frame, *beforeA);
    const bool itself = task.bodies.a == task.bodies.b;
    if (b != nullptr && !itself) {
        moveNodes(*b, moves[1], task.frame, *beforeB);
    }
    for (SoftSurfaceContact& contact : contacts) {
        const float way = grown(contact.a, contact.weightsA, moves[0], contact.normal) -
                          grown(contact.b, contact.weightsB, itself ? moves[0] : moves[1], contact.normal);
        contact.before += way;
        contact.after += way;
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
