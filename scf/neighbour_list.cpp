#include <grapeshot/scf/neighbour_list.hpp>

#include <algorithm>
#include <cmath>

namespace grapeshot {

using Eigen::Vector3f;
using Eigen::Vector4f;
using Positions = std::span<const Vector3f>;

namespace {

/// Of positions and sums of them.
constexpr float rounding = 1e-5F;

/// Of two boxes, m^2. Nearer than by their sides alone: many that lie aslant are beside each other.
float gapSquare(const PlainBox& a, const PlainBox& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0).squaredNorm();
}

/// Bit per triangle of the leaf whose centroid is farther away at rest.
std::uint32_t farther(const BallLeaf& leaf, const float (&from)[3], float square) {
    std::int32_t far[16];
    for (int k = 0; k < 16; ++k) {
        const float x = leaf.middle[0][k] - from[0];
        const float y = leaf.middle[1][k] - from[1];
        const float z = leaf.middle[2][k] - from[2];
        far[k] = static_cast<std::int32_t>(x * x + y * y + z * z > square);
    }
    std::uint32_t bits = 0;
    for (int k = 0; k < 16; ++k) {
        bits |= static_cast<std::uint32_t>(far[k]) << static_cast<unsigned>(k);
    }
    return bits;
}

bool shareCorner(const BallLeaf& a, int i, const BallLeaf& b, int k) {
    for (const auto& p : a.corner) {
        for (const auto& q : b.corner) {
            if (p[i] == q[k]) {
                return true;
            }
        }
    }
    return false;
}

bool isUsable(const NeighbourSettings& s) {
    return s.distance >= 0 && s.slack > 0 && s.exclusion >= 0 && std::isfinite(s.distance + s.slack + s.exclusion);
}

bool isSame(const NeighbourSettings& a, const NeighbourSettings& b) {
    return a.distance == b.distance && a.slack == b.slack && a.exclusion == b.exclusion;
}

}  // namespace

/// Every leaf that has left its reach, and what everything is compared with.
void NeighbourList::listMoved(Positions last, Positions before, Positions after, const NeighbourSettings& settings) {
    m_now.resize(before.size());
    for (std::size_t v = 0; v < before.size(); ++v) {
        const float past = (last[v] - before[v]).squaredNorm();
        const float next = (after[v] - before[v]).squaredNorm();
        // What is no number stays none, which the larger of two would hide.
        m_now[v] << before[v], std::sqrt(std::max(past, next)) + 0 * (past + next);
    }
    const auto leaves = static_cast<std::uint32_t>(m_tree->leaves.size());
    const bool known = m_looks.size() == leaves && isSame(m_settings, settings);
    if (!known) {
        m_settings = settings;
        m_pictures.resize(m_tree->leafVertices.all.size());
        m_looks.assign(leaves, 0);
        m_boxes.reset(*m_tree);
        m_found.assign(leaves, {});
    }
    m_moved.clear();
    m_isMoved.assign(leaves, 0);
    const IndexLists& corners = m_tree->leafVertices;
    for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) {
        const float reach = m_boxes.reach(leaf);
        bool within = reach >= 0;
        for (std::uint32_t i = corners.begin[leaf]; i < corners.begin[leaf + 1] && within; ++i) {
            const Vector4f& now = m_now[corners.all[i]];
            const float left = reach - now[3];
            within = left >= 0 && (now.head<3>() - m_pictures[i]).squaredNorm() <= left * left;
        }
        if (!within) {
            float stray = 0;
            for (const std::uint32_t v : corners.of(leaf)) {
                stray = std::max(stray, m_now[v][3]);
            }
            m_isMoved[leaf] = 1;
            m_moved.push_back(leaf);
            picture(leaf, 0.5F * settings.slack + stray);
        }
    }
}

void NeighbourList::picture(std::uint32_t leaf, float reach) {
    const IndexLists& corners = m_tree->leafVertices;
    for (std::uint32_t i = corners.begin[leaf]; i < corners.begin[leaf + 1]; ++i) {
        m_pictures[i] = m_now[corners.all[i]].head<3>();
    }
    ++m_looks[leaf];
    const BallLeaf& triangles = m_tree->leaves[leaf];
    Boxes<16> boxes;
    const PlainBox whole = boxTriangles(triangles, boxes, [&](int k) {
        PlainBox box;
        for (const auto& corner : triangles.corner) {
            box.add(m_now[corner[k]].head<3>());
        }
        return box;
    });
    m_boxes.set(leaf, boxes, whole, reach);
}

std::uint64_t NeighbourList::compare(std::uint32_t leaf, std::uint32_t other, const NeighbourSettings& settings) {
    const BallLeaf& a = m_tree->leaves[leaf];
    const BallLeaf& b = m_tree->leaves[other];
    const float reach = settings.distance + m_boxes.reach(leaf) + m_boxes.reach(other) + rounding * m_tree->extent;
    const float square = settings.exclusion * settings.exclusion;
    // Centroids of triangles that share a corner are at most two thirds of both their longest edges apart.
    const float longest = m_tree->surface.longestEdge;
    const bool nearby = square <= 4 * longest * longest;
    Found& found = m_found[leaf];
    const auto begin = static_cast<std::uint32_t>(found.pairs.size());
    std::uint64_t work = 1;
    for (int i = 0; i < static_cast<int>(a.count); ++i) {
        PlainBox box = m_boxes.boxes(leaf).at(i);
        box.grow(reach);
        if (!box.meets(m_boxes.whole(other))) {
            continue;
        }
        ++work;
        std::uint32_t bits = m_boxes.boxes(other).meeting(box) & ((1U << b.count) - 1);
        if (other == leaf) {
            bits &= ~((2U << static_cast<unsigned>(i)) - 1);
        }
        if (bits != 0) {
            bits &= farther(b, {a.middle[0][i], a.middle[1][i], a.middle[2][i]}, square);
        }
        for (; bits != 0; bits &= bits - 1) {
            const int k = __builtin_ctz(bits);
            if (gapSquare(m_boxes.boxes(leaf).at(i), m_boxes.boxes(other).at(k)) <= reach * reach &&
                !(nearby && shareCorner(a, i, b, k))) {
                found.pairs.push_back({std::min(a.triangle[i], b.triangle[k]), std::max(a.triangle[i], b.triangle[k])});
            }
        }
    }
    if (found.pairs.size() > begin) {
        found.groups.push_back({other, m_looks[other], begin, static_cast<std::uint32_t>(found.pairs.size())});
    }
    return work;
}

std::uint64_t NeighbourList::search(std::uint32_t leaf, const NeighbourSettings& settings) {
    m_found[leaf].groups.clear();
    m_found[leaf].pairs.clear();
    PlainBox box = m_boxes.whole(leaf);
    box.grow(settings.distance + m_boxes.reach(leaf) + rounding * m_tree->extent);
    std::uint64_t work = 0;
    const std::uint64_t looks = m_boxes.visitMeeting(box, [&](std::uint32_t other) {
        if (m_isMoved[other] == 0 || other >= leaf) {
            work += compare(leaf, other, settings);
        }
    });
    return work + (looks + 3) / 4;
}

void NeighbourList::find(Positions last, Positions before, Positions after, const NeighbourSettings& settings,
                         NeighbourResult& result) {
    result.pairs.clear();
    result.work = 0;
    result.searched = 0;
    result.fault.reset();
    const std::size_t vertices = m_tree->surface.rest.size();
    if (!isUsable(settings)) {
        result.fault = Fault::badSetting;
        return;
    }
    if (last.size() != vertices || before.size() != vertices || after.size() != vertices) {
        result.fault = Fault::topologyChanged;
        return;
    }
    listMoved(last, before, after, settings);
    result.searched = static_cast<std::uint32_t>(m_moved.size());
    if (!m_moved.empty()) {
        for (const std::uint32_t leaf : m_moved) {
            for (const std::uint32_t v : m_tree->leafVertices.of(leaf)) {
                if (!m_now[v].allFinite()) {
                    m_looks.clear();  // all is searched in the next step
                    result.fault = Fault::notFinite;
                    return;
                }
            }
        }
        m_boxes.refit();
        for (const std::uint32_t leaf : m_moved) {
            result.work += search(leaf, settings);
        }
    }
    for (const Found& found : m_found) {
        for (const Group& group : found.groups) {
            if (m_looks[group.other] == group.look) {
                result.pairs.insert(result.pairs.end(), found.pairs.begin() + group.begin,
                                    found.pairs.begin() + group.end);
            }
        }
    }
    result.work += (result.pairs.size() + 15) / 16;
}

}  // namespace grapeshot
