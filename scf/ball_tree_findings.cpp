#include <grapeshot/scf/ball_tree.hpp>

#include <algorithm>
#include <cmath>

#include <grapeshot/scf/detail/geodesics.hpp>

namespace grapeshot {
namespace {

class Inspector {
  public:
    explicit Inspector(const BallTree& tree)
        : m_tree(tree), m_geodesics(tree.surface), m_seen(tree.surface.triangles.size(), 0) {
        m_geodesics.prepare().run();
    }

    std::vector<std::string> run() {
        if (m_tree.nodes.empty() || m_tree.restBalls.size() != m_tree.nodes.size() ||
            m_tree.plainBalls.size() != m_tree.nodes.size()) {
            say("there is no root, or nodes and balls at rest are not as many");
            return m_found;
        }
        below(0);
        for (std::size_t t = 0; t < m_seen.size(); ++t) {
            if (m_seen[t] != 1) {
                say("triangle " + std::to_string(t) + " stands in " + std::to_string(m_seen[t]) + " leaves");
            }
        }
        return m_found;
    }

  private:
    void say(std::string text) { m_found.push_back(std::move(text)); }

    /// Triangles of everything below a node.
    std::vector<std::uint32_t> below(std::uint32_t index) {
        const BallNode& node = m_tree.nodes[index];
        const std::string name = "node " + std::to_string(index);
        if (node.count < 1 || node.count > 4) {
            say(name + " has " + std::to_string(node.count) + " children");
            return {};
        }
        std::vector<std::uint32_t> all;
        for (std::uint32_t slot = 0; slot < node.count; ++slot) {
            const BallRef child = node.child[slot];
            const bool leaf = isBallLeaf(child);
            if (ballIndex(child) >= (leaf ? m_tree.leaves.size() : m_tree.nodes.size()) ||
                (!leaf && ballIndex(child) <= index)) {
                say(name + ": child " + std::to_string(ballIndex(child)) + " is out of place");
                continue;
            }
            const std::vector<std::uint32_t> part = leaf ? ofLeaf(ballIndex(child)) : below(ballIndex(child));
            checkBall(name + ", slot " + std::to_string(slot), node.center[slot], node.radius[slot], part);
            checkRestBall(name + ", slot " + std::to_string(slot), m_tree.restBalls[index], slot, part);
            checkPlainBall(name + ", slot " + std::to_string(slot), m_tree.plainBalls[index], slot, part);
            const PieceBall& own = m_tree.own(child);
            if (own.center != node.center[slot] || own.radius != node.radius[slot] ||
                own.restRadius != m_tree.restBalls[index].radius[slot]) {
                say(name + ": the child has another ball");
            }
            all.insert(all.end(), part.begin(), part.end());
        }
        return all;
    }

    std::vector<std::uint32_t> ofLeaf(std::uint32_t index) {
        const BallLeaf& leaf = m_tree.leaves[index];
        std::vector<std::uint32_t> part;
        for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
            const std::uint32_t t = leaf.triangle[lane];
            if (t >= m_seen.size()) {
                say("leaf " + std::to_string(index) + ": no triangle in lane " + std::to_string(lane));
                continue;
            }
            ++m_seen[t];
            part.push_back(t);
            if (m_tree.leafOfTriangle[t] != index) {
                say("triangle " + std::to_string(t) + " thinks it is in another leaf");
            }
            const auto vertices = m_tree.leafVertices.of(index);
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const std::uint32_t v = m_tree.surface.triangles[t][corner];
                if (leaf.corner[corner][lane] != v || std::ranges::find(vertices, v) == vertices.end()) {
                    say("leaf " + std::to_string(index) + ": wrong corner in lane " + std::to_string(lane));
                }
            }
        }
        return part;
    }

    void checkBall(const std::string& name, std::uint32_t center, float radius,
                   const std::vector<std::uint32_t>& part) {
        std::vector<std::uint32_t> corners;
        for (const std::uint32_t t : part) {
            corners.insert(corners.end(), m_tree.surface.triangles[t].begin(), m_tree.surface.triangles[t].end());
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        m_geodesics.setGoals(corners).run();
        if (!(m_geodesics.radiusAround(center) <= static_cast<double>(radius))) {
            say(name + ": a corner is farther than the radius");
        }
    }

    void checkRestBall(const std::string& name, const FourBalls& balls, std::uint32_t slot,
                       const std::vector<std::uint32_t>& part) {
        const Eigen::Vector3d center(balls.center[0][slot], balls.center[1][slot], balls.center[2][slot]);
        for (const std::uint32_t t : part) {
            Eigen::Vector3d middle = Eigen::Vector3d::Zero();
            for (const std::uint32_t v : m_tree.surface.triangles[t]) {
                middle += m_tree.surface.rest[v].cast<double>() / 3;
            }
            if ((middle - center).norm() > static_cast<double>(balls.radius[slot]) + 1e-6 * m_tree.extent) {
                say(name + ": a centroid is outside the ball at rest");
                return;
            }
        }
    }

    void checkPlainBall(const std::string& name, const FourBalls& balls, std::uint32_t slot,
                        const std::vector<std::uint32_t>& part) {
        const Eigen::Vector3d center(balls.center[0][slot], balls.center[1][slot], balls.center[2][slot]);
        for (const std::uint32_t t : part) {
            for (const std::uint32_t v : m_tree.surface.triangles[t]) {
                const double distance = (m_tree.surface.rest[v].cast<double>() - center).norm();
                if (distance > static_cast<double>(balls.radius[slot])) {
                    say(name + ": a corner is outside the plain ball, " + std::to_string(distance) + " of " +
                        std::to_string(balls.radius[slot]));
                    return;
                }
            }
        }
    }

    const BallTree& m_tree;
    detail::Geodesics m_geodesics;
    std::vector<int> m_seen;
    std::vector<std::string> m_found;
};

}  // namespace

std::vector<std::string> findings(const BallTree& tree) {
    return Inspector(tree).run();
}

}  // namespace grapeshot
