#include <grapeshot/plugin/detail/node_moves.hpp>

#include <algorithm>
#include <cmath>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

constexpr int passes = 12;

struct Point {
    std::array<std::size_t, 3> slots{};
    std::array<double, 3> weights{};
    std::array<double, 3> inverse{};
    Eigen::Vector3d normal;
    double missing = 0;  // of the way to the target, if nothing moves
    double scale = 0;    // 1 / what a unit of impulse moves
    double impulse = 0;
};

}  // namespace

double wayBack(double before, double distance, double hardness) {
    const double inside = distance - before;
    const double deep = before < 0.5 * distance ? 0.5 * distance - before : 0;
    return std::max(hardness * inside, std::max(std::min(deep, 0.5 * distance), 0.2 * deep));
}

std::vector<NodeMove> nodeMoves(const btSoftBody& body, std::span<const SurfaceContact> contacts,
                                std::span<const double> missing, bool thread) {
    std::vector<NodeMove> moves;
    const auto corners = [](const SurfaceContact& contact) {
        return contact.features == Features::cornerFace ? 1U : 3U;
    };
    for (const SurfaceContact& contact : contacts) {
        for (std::size_t i = 0; i < corners(contact); ++i) {
            moves.push_back({contact.a[i], Eigen::Vector3d::Zero()});
        }
    }
    std::ranges::sort(moves, {}, &NodeMove::node);
    const auto repeated = std::ranges::unique(moves, {}, &NodeMove::node);
    moves.erase(repeated.begin(), repeated.end());
    std::vector<Point> points;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        const SurfaceContact& contact = contacts[c];
        if (!(missing[c] > 0) || (thread && contact.features == Features::faceCorner)) {
            continue;
        }
        Point point;
        point.normal = contact.normal.cast<double>();
        point.missing = missing[c];
        double response = 0;
        for (std::size_t i = 0; i < corners(contact); ++i) {
            const btSoftBody::Node& node = body.m_nodes[static_cast<int>(contact.a[i])];
            const auto at = std::ranges::lower_bound(moves, contact.a[i], {}, &NodeMove::node);
            point.slots[i] = static_cast<std::size_t>(at - moves.begin());
            point.weights[i] = static_cast<double>(contact.weightsA[static_cast<int>(i)]);
            point.inverse[i] = node.m_battach ? 0 : static_cast<double>(node.m_im);
            response += point.weights[i] * point.weights[i] * point.inverse[i];
        }
        if (response > 0) {
            point.scale = 1 / response;
            points.push_back(point);
        }
    }
    for (int pass = 0; pass < passes; ++pass) {
        for (Point& point : points) {
            double left = point.missing;
            for (std::size_t i = 0; i < 3; ++i) {
                left -= point.weights[i] * moves[point.slots[i]].move.dot(point.normal);
            }
            const double impulse = std::max(0.0, point.impulse + left * point.scale);
            for (std::size_t i = 0; i < 3; ++i) {
                moves[point.slots[i]].move +=
                    (impulse - point.impulse) * point.weights[i] * point.inverse[i] * point.normal;
            }
            point.impulse = impulse;
        }
    }
    std::erase_if(moves, [&](const NodeMove& move) { return move.move.squaredNorm() < 1e-16; });
    return moves;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
