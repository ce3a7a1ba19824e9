#include "crossing_guard.hpp"

#include <LinearMath/btScalar.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "crossings.hpp"

namespace grapeshot::soft {

namespace {

constexpr double widest = 1.2;  // rad, half the cone of pieces that count as flat
constexpr int mostRounds = 40;
constexpr std::size_t obstacleChunk = 12;  // triangles

/// As Bullet keeps it, so that what is tested is what stays.
Eigen::Vector3d kept(const Eigen::Vector3d& v) {
    return v.cast<btScalar>().cast<double>();
}

}  // namespace

CrossingGuard::CrossingGuard(const CarriedSurface& surface, const CoreNodes& nodes)
    : m_surface(surface), m_verticesOf(nodes.now.size()), m_points(surface.vertices()) {
    for (std::uint32_t v = 0; v < surface.vertices(); ++v) {
        for (std::uint32_t k = surface.begin(v); k < surface.ends[v]; ++k) {
            m_verticesOf[surface.shares[k].node].push_back(v);
        }
    }
    makePatches(nodes);
}

void CrossingGuard::makePatches(const CoreNodes& nodes) {
    const std::vector<std::uint32_t> component = components();
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> patchOfNode;
    std::vector<std::vector<std::uint32_t>> patchesOf(m_surface.vertices());
    for (std::uint32_t t = 0; t < m_surface.triangles.size(); ++t) {
        const std::uint32_t v = m_surface.triangles[t][0];
        const auto heaviest = std::max_element(m_surface.shares.begin() + m_surface.begin(v),
                                               m_surface.shares.begin() + m_surface.ends[v],
                                               [](const auto& a, const auto& b) { return a.weight < b.weight; });
        const auto known =
            patchOfNode.try_emplace({heaviest->node, component[t]}, static_cast<std::uint32_t>(m_patches.size())).first;
        if (known->second == m_patches.size()) {
            m_patches.emplace_back().component = component[t];
        }
        m_patches[known->second].triangles.push_back(t);
        for (const std::uint32_t corner : m_surface.triangles[t]) {
            patchesOf[corner].push_back(known->second);
        }
    }
    const auto sortOut = [](std::vector<std::uint32_t>& list) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    for (std::uint32_t v = 0; v < m_surface.vertices(); ++v) {
        sortOut(patchesOf[v]);
        for (const std::uint32_t p : patchesOf[v]) {
            m_patches[p].vertices.push_back(v);
            m_patches[p].neighbours.insert(m_patches[p].neighbours.end(), patchesOf[v].begin(), patchesOf[v].end());
        }
        m_patchesOf.insert(m_patchesOf.end(), patchesOf[v].begin(), patchesOf[v].end());
        m_patchEnds.push_back(static_cast<std::uint32_t>(m_patchesOf.size()));
    }
    place(nodes);
    std::vector<Vector3d> middles;
    for (Patch& patch : m_patches) {
        sortOut(patch.neighbours);
        refit(patch);
        middles.emplace_back(0.5 * (patch.box.low + patch.box.high));
    }
    std::vector<std::uint32_t> order(m_patches.size());
    std::iota(order.begin(), order.end(), 0U);
    if (!order.empty()) {
        makeBranch(order, middles);
    }
}

std::uint32_t CrossingGuard::makeBranch(std::span<std::uint32_t> patches, const std::vector<Vector3d>& middles) {
    Branch branch;
    if (patches.size() == 1) {
        branch.leaf = true;
        branch.left = patches[0];
    } else {
        Box box;
        for (const std::uint32_t p : patches) {
            box.add(middles[p]);
        }
        int axis = 0;
        (box.high - box.low).maxCoeff(&axis);
        const std::size_t half = patches.size() / 2;
        std::nth_element(patches.begin(), patches.begin() + static_cast<std::ptrdiff_t>(half), patches.end(),
                         [&](std::uint32_t a, std::uint32_t b) {
                             return std::pair(middles[a][axis], a) < std::pair(middles[b][axis], b);
                         });
        branch.left = makeBranch(patches.first(half), middles);
        branch.right = makeBranch(patches.subspan(half), middles);
    }
    m_branches.push_back(branch);
    return static_cast<std::uint32_t>(m_branches.size()) - 1;
}

/// Of each triangle. A sheet that is sewn to a tube is not of the tube's.
std::vector<std::uint32_t> CrossingGuard::components() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> beside;  // by directed edge
    for (std::uint32_t t = 0; t < m_surface.triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            beside[{m_surface.triangles[t][i], m_surface.triangles[t][(i + 1) % 3]}].push_back(t);
        }
    }
    std::vector<std::uint32_t> component(m_surface.triangles.size(), 0xffffffffU);
    std::vector<std::uint32_t> open;
    std::uint32_t count = 0;
    for (std::uint32_t first = 0; first < component.size(); ++first) {
        if (component[first] != 0xffffffffU) {
            continue;
        }
        component[first] = count;
        open.assign(1, first);
        while (!open.empty()) {
            const Triangle& t = m_surface.triangles[open.back()];
            open.pop_back();
            for (std::size_t i = 0; i < 3; ++i) {
                const auto mine = beside.find({t[i], t[(i + 1) % 3]});
                const auto other = beside.find({t[(i + 1) % 3], t[i]});
                if (mine->second.size() == 1 && other != beside.end() && other->second.size() == 1 &&
                    component[other->second.front()] == 0xffffffffU) {
                    component[other->second.front()] = count;
                    open.push_back(other->second.front());
                }
            }
        }
        ++count;
    }
    return component;
}

void CrossingGuard::refit(Patch& patch) {
    patch.box = {};
    for (const std::uint32_t v : patch.vertices) {
        patch.box.add(m_points[v]);
    }
    m_normals.clear();
    Vector3d sum = Vector3d::Zero();
    for (const std::uint32_t t : patch.triangles) {
        const Triangle& corners = m_surface.triangles[t];
        const Vector3d& origin = m_points[corners[0]];
        m_normals.emplace_back((m_points[corners[1]] - origin).cross(m_points[corners[2]] - origin));
        sum += m_normals.back();
    }
    patch.normal = sum.normalized();
    patch.spread = 1;
    for (const Vector3d& normal : m_normals) {
        const double along = patch.normal.dot(normal);
        if (along < patch.spread * normal.norm()) {
            patch.spread = along / normal.norm();
        }
    }
}

void CrossingGuard::refit() {
    for (Branch& branch : m_branches) {
        if (branch.leaf) {
            branch.box = m_patches[branch.left].box;
            branch.moved = m_patches[branch.left].moved;
        } else {
            branch.box = m_branches[branch.left].box;
            branch.box.add(m_branches[branch.right].box);
            branch.moved = m_branches[branch.left].moved || m_branches[branch.right].moved;
        }
    }
}

void CrossingGuard::place(const CoreNodes& nodes) {
    for (std::uint32_t v = 0; v < m_surface.vertices(); ++v) {
        m_points[v] = kept(placeOf(m_surface, v, nodes.now));
    }
}

bool CrossingGuard::isFlat(const Patch& a, const Patch& b) const {
    double between = a.normal.dot(b.normal);
    if (a.component != b.component) {
        between = -std::abs(between);  // nobody knows how their sides belong together
    }
    // Most are: within .35 rad of their means each, and these within a right angle and a bit.
    constexpr double nearlyFlat = 0.94, little = -0.1;
    if (a.spread > nearlyFlat && b.spread > nearlyFlat && between > little) {
        return true;
    }
    const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
    return 0.5 * (angle(between) + angle(a.spread) + angle(b.spread)) < widest && angle(a.spread) < widest &&
           angle(b.spread) < widest;
}

void CrossingGuard::test(std::uint32_t first, const Obstacle* obstacle, int index, std::uint32_t second) {
    const Triangle& a = m_surface.triangles[first];
    const Triangle& b = obstacle != nullptr ? (*obstacle->triangles)[second] : m_surface.triangles[second];
    const Vector3d* pointsB = obstacle != nullptr ? obstacle->points.data() : m_points.data();
    const bool apart = obstacle != nullptr;
    const auto crosses = [&](const Triangle& edges, const Vector3d* from, const Triangle& face, const Vector3d* to) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t p = edges[i];
            const std::uint32_t q = edges[(i + 1) % 3];
            const bool shared =
                !apart && std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return v == p || v == q; });
            if (!shared && passesThrough(from[p], from[q], to[face[0]], to[face[1]], to[face[2]])) {
                Crossing crossing;
                const auto add = [&](std::uint32_t v) {
                    crossing.vertices[static_cast<std::size_t>(crossing.count++)] = v;
                };
                if (!apart || from == m_points.data()) {
                    add(p);
                    add(q);
                }
                if (!apart || to == m_points.data()) {
                    std::for_each(face.begin(), face.end(), add);
                }
                crossing.obstacle = index;
                m_crossings.push_back(crossing);
            }
        }
    };
    crosses(a, m_points.data(), b, pointsB);
    crosses(b, pointsB, a, m_points.data());
}

void CrossingGuard::testPatches(const Patch& a, const Patch& b) {
    const auto boxOf = [&](std::uint32_t t) {
        Box box;
        for (const std::uint32_t v : m_surface.triangles[t]) {
            box.add(m_points[v]);
        }
        return box;
    };
    const auto near = [&](const Patch& patch, const Box& other, std::vector<std::uint32_t>& out) {
        out.clear();
        std::copy_if(patch.triangles.begin(), patch.triangles.end(), std::back_inserter(out),
                     [&](std::uint32_t t) { return boxOf(t).meets(other); });
    };
    near(a, b.box, m_nearA);
    if (m_nearA.empty()) {
        return;
    }
    near(b, a.box, m_nearB);
    for (const std::uint32_t first : m_nearA) {
        const Box box = boxOf(first);
        for (const std::uint32_t second : m_nearB) {
            if ((&a != &b || first < second) && box.meets(boxOf(second))) {
                test(first, nullptr, -1, second);
            }
        }
    }
}

void CrossingGuard::searchPair(std::uint32_t a, std::uint32_t b) {
    const Branch& first = m_branches[a];
    const Branch& second = m_branches[b];
    if (!(first.moved || second.moved) || !first.box.meets(second.box)) {
        return;
    }
    if (first.leaf && second.leaf) {
        const Patch& one = m_patches[first.left];
        const Patch& other = m_patches[second.left];
        if (!std::binary_search(one.neighbours.begin(), one.neighbours.end(), second.left) || !isFlat(one, other)) {
            testPatches(one, other);
        }
        return;
    }
    const bool openFirst = !first.leaf && (second.leaf || (first.box.high - first.box.low).sum() >
                                                              (second.box.high - second.box.low).sum());
    if (openFirst) {
        searchPair(first.left, b);
        searchPair(first.right, b);
    } else {
        searchPair(a, second.left);
        searchPair(a, second.right);
    }
}

void CrossingGuard::searchItself(std::uint32_t branch) {
    const Branch& at = m_branches[branch];
    if (!at.moved) {
        return;
    }
    if (at.leaf) {
        const Patch& patch = m_patches[at.left];
        if (!isFlat(patch, patch)) {
            testPatches(patch, patch);
        }
        return;
    }
    searchItself(at.left);
    searchItself(at.right);
    searchPair(at.left, at.right);
}

void CrossingGuard::searchObstacle(std::uint32_t branch, const Obstacle& obstacle, int index, const Box& box,
                                   std::span<const std::uint32_t> triangles) {
    const Branch& at = m_branches[branch];
    if (!at.moved || !at.box.meets(box)) {
        return;
    }
    if (!at.leaf) {
        searchObstacle(at.left, obstacle, index, box, triangles);
        searchObstacle(at.right, obstacle, index, box, triangles);
        return;
    }
    for (const std::uint32_t second : triangles) {
        Box other;
        for (const std::uint32_t v : (*obstacle.triangles)[second]) {
            other.add(obstacle.points[v]);
        }
        if (!other.meets(at.box)) {
            continue;
        }
        for (const std::uint32_t first : m_patches[at.left].triangles) {
            Box mine;
            for (const std::uint32_t v : m_surface.triangles[first]) {
                mine.add(m_points[v]);
            }
            if (mine.meets(other)) {
                test(first, &obstacle, index, second);
            }
        }
    }
}

void CrossingGuard::find(std::span<const Obstacle> obstacles) {
    m_crossings.clear();
    if (m_branches.empty()) {
        return;
    }
    refit();
    const auto root = static_cast<std::uint32_t>(m_branches.size()) - 1;
    searchItself(root);
    std::vector<std::uint32_t> chunk;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
        const Obstacle& obstacle = obstacles[i];
        for (std::uint32_t t = 0; t < obstacle.triangles->size();) {
            Box box;
            chunk.clear();
            for (; t < obstacle.triangles->size() && chunk.size() < obstacleChunk; ++t) {
                chunk.push_back(t);
                for (const std::uint32_t v : (*obstacle.triangles)[t]) {
                    box.add(obstacle.points[v]);
                }
            }
            searchObstacle(root, obstacle, static_cast<int>(i), box, chunk);
        }
    }
}

bool CrossingGuard::hold(std::uint32_t node, int obstacle, bool moving, int round) {
    Held& held = m_held[node];
    if (held.round == round) {
        return true;
    }
    const bool takenAlong = moving && held.obstacle != obstacle;
    if (!takenAlong && held.share == 0) {
        return false;
    }
    held.round = round;
    held.share = held.share == 1 ? 0.5 : 0;
    held.obstacle = takenAlong ? obstacle : held.obstacle;
    m_changed.push_back(node);
    return true;
}

bool CrossingGuard::shorten(const CoreNodes& nodes, std::span<const Obstacle> obstacles, int round, bool& stuck) {
    m_changed.clear();
    std::vector<std::uint32_t> below;
    for (const Crossing& found : m_crossings) {
        below.clear();
        for (int i = 0; i < found.count; ++i) {
            const std::uint32_t v = found.vertices[static_cast<std::size_t>(i)];
            for (std::uint32_t k = m_surface.begin(v); k < m_surface.ends[v]; ++k) {
                if (nodes.inverseMass[m_surface.shares[k].node] > 0) {
                    below.push_back(m_surface.shares[k].node);
                }
            }
        }
        const auto isMoving = [&](int index) {
            return index >= 0 && !(obstacles[static_cast<std::size_t>(index)].turn.isIdentity(0) &&
                                   obstacles[static_cast<std::size_t>(index)].shift.isZero(0));
        };
        const bool moving = isMoving(found.obstacle);
        bool any = false;
        for (const std::uint32_t node : below) {
            any = hold(node, found.obstacle, moving, round) || any;
        }
        // All stay already: some where they were, others beside what moves. Then all go along with that.
        if (!any && found.obstacle < 0) {
            const auto along = std::max_element(below.begin(), below.end(), [&](std::uint32_t a, std::uint32_t b) {
                return m_held[a].obstacle < m_held[b].obstacle;
            });
            const int obstacle = along == below.end() ? -1 : m_held[*along].obstacle;
            for (const std::uint32_t node : below) {
                any = (obstacle >= 0 && hold(node, obstacle, true, round)) || any;
            }
        }
        stuck = stuck || !any;
    }
    return !m_changed.empty();
}

GuardResult CrossingGuard::hold(CoreNodes& nodes, std::span<const Obstacle> obstacles) {
    GuardResult result;
    const std::vector<Vector3d> wanted = nodes.now;
    m_held.assign(nodes.now.size(), {});
    place(nodes);
    for (Patch& patch : m_patches) {
        patch.moved = true;
        refit(patch);
    }
    bool stuck = false;
    for (int round = 0; round < mostRounds; ++round) {
        find(obstacles);
        if (!shorten(nodes, obstacles, round, stuck)) {
            break;
        }
        result.rounds = round + 1;
        for (Patch& patch : m_patches) {
            patch.moved = false;
        }
        std::vector<std::uint32_t> vertices;
        for (const std::uint32_t node : m_changed) {
            const Held& held = m_held[node];
            Vector3d stay = nodes.before[node];
            if (held.obstacle >= 0) {
                const Obstacle& along = obstacles[static_cast<std::size_t>(held.obstacle)];
                stay = along.turn * stay + along.shift;
            }
            nodes.now[node] = kept(stay + held.share * (wanted[node] - stay));
            vertices.insert(vertices.end(), m_verticesOf[node].begin(), m_verticesOf[node].end());
        }
        for (const std::uint32_t v : vertices) {
            m_points[v] = kept(placeOf(m_surface, v, nodes.now));
            for (std::uint32_t i = v == 0 ? 0 : m_patchEnds[v - 1]; i < m_patchEnds[v]; ++i) {
                m_patches[m_patchesOf[i]].moved = true;
            }
        }
        for (Patch& patch : m_patches) {
            if (patch.moved) {
                refit(patch);
            }
        }
    }
    // A search looks at what has moved since the last one alone.
    if (stuck || result.rounds == mostRounds) {
        for (Patch& patch : m_patches) {
            patch.moved = true;
        }
        find(obstacles);
        result.crossing = static_cast<int>(m_crossings.size());
    }
    result.held =
        static_cast<int>(std::count_if(m_held.begin(), m_held.end(), [](const Held& held) { return held.round >= 0; }));
    return result;
}

}  // namespace grapeshot::soft
