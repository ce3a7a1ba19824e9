#include <grapeshot/scf/box_pairs.hpp>

#include <algorithm>
#include <cassert>

namespace grapeshot {

BoxPairs::BoxPairs(const BallTree& moving, const BallTree& still) : m_moving(&moving), m_still(&still) {
    m_boxes.reset(still);
    for (std::uint32_t leaf = 0; leaf < still.leaves.size(); ++leaf) {
        const BallLeaf& triangles = still.leaves[leaf];
        Boxes<16> boxes;
        const PlainBox whole = boxTriangles(triangles, boxes, [&](int k) {
            PlainBox box;
            for (const auto& corner : triangles.corner) {
                box.add(still.surface.rest[corner[k]]);
            }
            return box;
        });
        m_boxes.set(leaf, boxes, whole, 0);
        m_whole.add(whole);
    }
    m_boxes.refit();
}

std::uint64_t BoxPairs::find(std::span<const std::span<const Eigen::Vector3f>> moments, float distance,
                             std::vector<TrianglePair>& pairs) {
    pairs.clear();
    PlainBox reached = m_whole;
    reached.grow(distance);
    std::uint64_t work = (m_moving->leaves.size() + 15) / 16;
    for (std::uint32_t leaf = 0; leaf < m_moving->leaves.size(); ++leaf) {
        PlainBox whole;
        for (const auto& moment : moments) {
            assert(moment.size() == m_moving->surface.rest.size());
            for (const std::uint32_t v : m_moving->leafVertices.of(leaf)) {
                whole.add(moment[v]);
            }
        }
        if (!whole.meets(reached)) {
            continue;
        }
        const BallLeaf& triangles = m_moving->leaves[leaf];
        Boxes<16> boxes;
        boxTriangles(triangles, boxes, [&](int k) {
            PlainBox box;
            for (const auto& moment : moments) {
                for (const auto& corner : triangles.corner) {
                    box.add(moment[corner[k]]);
                }
            }
            box.grow(distance);
            return box;
        });
        whole.grow(distance);
        const std::uint64_t looks = m_boxes.visitMeeting(whole, [&](std::uint32_t other) {
            ++work;
            const BallLeaf& others = m_still->leaves[other];
            for (int i = 0; i < static_cast<int>(triangles.count); ++i) {
                const PlainBox box = boxes.at(i);
                if (!box.meets(m_boxes.whole(other))) {
                    continue;
                }
                ++work;
                std::uint32_t bits = m_boxes.boxes(other).meeting(box) & ((1U << others.count) - 1);
                for (; bits != 0; bits &= bits - 1) {
                    pairs.push_back({triangles.triangle[i], others.triangle[__builtin_ctz(bits)]});
                }
            }
        });
        work += (looks + 3) / 4;
    }
    return work;
}

}  // namespace grapeshot
