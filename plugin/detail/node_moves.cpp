#include <grapeshot/plugin/detail/node_moves.hpp>

#include <algorithm>
#include <cmath>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int passes = 12;

struct End {
    NodeMove* move = nullptr;
    double weight = 0;  ///< with a sign: of b's nodes negative
    double inverseMass = 0;
};

/// Of a point beside nodes that cannot move, as a share of what its lightest node moves: the little that is left of
/// the others' weights would throw those far away.
constexpr double leastResponse = 0.06;

struct Point {
    std::array<End, 6> ends{};
    Eigen::Vector3d normal;
    double missing = 0;
    double scale = 0;  ///< 1 / what a unit of impulse moves
    double impulse = 0;
};

std::size_t cornersA(const SoftSurfaceContact& contact) {
    return contact.features == Features::cornerFace ? 1 : 3;
}
std::size_t cornersB(const SoftSurfaceContact& contact) {
    return contact.features == Features::faceCorner ? 1 : 3;
}

bool concerns(const SoftSurfaceContact& contact, const MovableBodies& bodies) {
    return !(bodies.threadA && contact.features == Features::faceCorner) &&
           !(bodies.threadB && contact.features == Features::cornerFace);
}

}  // namespace

double wayBack(double before, double distance, double hardness) {
    const double inside = distance - before;
    const double deep = before < 0.5 * distance ? 0.5 * distance - before : 0;
    return std::max(hardness * inside, std::max(std::min(deep, 0.5 * distance), 0.2 * deep));
}

const NodeMove* moveOf(std::span<const NodeMove> moves, std::uint32_t node) {
    const auto at = std::ranges::lower_bound(moves, node, {}, &NodeMove::node);
    return at != moves.end() && at->node == node ? &*at : nullptr;
}

NodeMoves nodeMoves(const MovableBodies& bodies, std::span<const SoftSurfaceContact> contacts,
                    std::span<const double> missing) {
    NodeMoves moves;
    const std::size_t ofB = bodies.a == bodies.b ? 0 : 1;
    for (const SoftSurfaceContact& contact : contacts) {
        for (std::size_t i = 0; i < cornersA(contact); ++i) {
            moves[0].push_back({contact.a[i], Eigen::Vector3d::Zero()});
        }
        for (std::size_t i = 0; bodies.b != nullptr && i < cornersB(contact); ++i) {
            moves[ofB].push_back({contact.b[i], Eigen::Vector3d::Zero()});
        }
    }
    for (std::vector<NodeMove>& list : moves) {
        std::ranges::sort(list, {}, &NodeMove::node);
        const auto repeated = std::ranges::unique(list, {}, &NodeMove::node);
        list.erase(repeated.begin(), repeated.end());
    }
    const auto endOf = [&](std::size_t list, const btSoftBody& body, std::uint32_t node, double weight) {
        const btSoftBody::Node& known = body.m_nodes[static_cast<int>(node)];
        return End{const_cast<NodeMove*>(moveOf(moves[list], node)), weight,
                   known.m_battach ? 0.0 : static_cast<double>(known.m_im)};
    };
    std::vector<Point> points;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        const SoftSurfaceContact& contact = contacts[c];
        if (!(missing[c] > 0) || !concerns(contact, bodies)) {
            continue;
        }
        Point point;
        point.normal = contact.normal.cast<double>();
        point.missing = missing[c];
        for (std::size_t i = 0; i < cornersA(contact); ++i) {
            point.ends[i] =
                endOf(0, *bodies.a, contact.a[i], static_cast<double>(contact.weightsA[static_cast<int>(i)]));
        }
        for (std::size_t i = 0; bodies.b != nullptr && i < cornersB(contact); ++i) {
            point.ends[3 + i] =
                endOf(ofB, *bodies.b, contact.b[i], -static_cast<double>(contact.weightsB[static_cast<int>(i)]));
        }
        double response = 0;
        double lightest = 0;
        for (const End& end : point.ends) {
            response += end.weight * end.weight * end.inverseMass;
            lightest = std::max(lightest, end.inverseMass);
        }
        if (response > 0) {
            point.scale = 1 / std::max(response, leastResponse * lightest);
            points.push_back(point);
        }
    }
    for (int pass = 0; pass < passes; ++pass) {
        for (Point& point : points) {
            double left = point.missing;
            for (const End& end : point.ends) {
                left -= end.move != nullptr ? end.weight * end.move->move.dot(point.normal) : 0.0;
            }
            const double impulse = std::max(0.0, point.impulse + left * point.scale);
            for (const End& end : point.ends) {
                if (end.move != nullptr) {
                    end.move->move += (impulse - point.impulse) * end.weight * end.inverseMass * point.normal;
                }
            }
            point.impulse = impulse;
        }
    }
    for (std::vector<NodeMove>& list : moves) {
        std::erase_if(list, [](const NodeMove& move) { return move.move.squaredNorm() < 1e-16; });
    }
    return moves;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
