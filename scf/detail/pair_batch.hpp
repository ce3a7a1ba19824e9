// Triangle pairs, sixteen to a call.
#pragma once

#include <cstdint>
#include <utility>

#include <grapeshot/core/triangle_batch.hpp>
#include <grapeshot/core/triangle_pair.hpp>
#include <grapeshot/scf/detail/lanes.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>

namespace grapeshot::detail {

class PairBatch {
  public:
    [[nodiscard]] bool isFull() const { return m_count == batchWidth; }
    [[nodiscard]] int size() const { return m_count; }
    void clear() { m_count = 0; }

    /// Lanes of two leaves. Of a body with itself the lower triangle is A's.
    void add(const PairSpace& space, const PosedLeaf& a, unsigned laneA, std::uint32_t triangleA, const PosedLeaf& b,
             unsigned laneB, std::uint32_t triangleB) {
        const bool swap = space.isSelf() && triangleA > triangleB;
        copyLane(a, laneA, swap ? m_b : m_a, m_count);
        copyLane(b, laneB, swap ? m_a : m_b, m_count);
        m_pair[m_count++] = swap ? TrianglePair{triangleB, triangleA} : TrianglePair{triangleA, triangleB};
    }
    /// Straight from the positions. The same roundings.
    void add(const PairSpace& space, TrianglePair pair) {
        if (space.isSelf() && pair.triangleA > pair.triangleB) {
            std::swap(pair.triangleA, pair.triangleB);
        }
        copyTriangle(*space.a, pair.triangleA, m_a);
        copyTriangle(*space.b, pair.triangleB, m_b);
        m_pair[m_count++] = pair;
    }

    /// One unit. Then `pair` and `out` say what was found, distances beyond `maxDistance` being anything beyond it;
    /// what is there is cleared. Returns how many there were.
    int run(float maxDistance) {
        for (int lane = m_count; lane < batchWidth; ++lane) {
            for (int corner = 0; corner < 3; ++corner) {
                for (int axis = 0; axis < 3; ++axis) {
                    m_a.corner[corner][axis][lane] = m_a.corner[corner][axis][0];
                    m_b.corner[corner][axis][lane] = m_b.corner[corner][axis][0];
                }
            }
        }
        signedDistances(m_a, m_b, m_out, maxDistance);
        return std::exchange(m_count, 0);
    }
    /// Were all corners finite that came straight from the positions, since `forget`?
    [[nodiscard]] bool isFinite() const { return m_zero == 0; }
    void forget() { m_zero = 0; }
    [[nodiscard]] const TrianglePair& pair(int lane) const { return m_pair[lane]; }
    [[nodiscard]] const DistanceBatch& out() const { return m_out; }
    /// What the last run says of a lane: a FeaturePair, or more.
    template <class Contact>
    void describe(int lane, Contact& contact) const {
        contact.pair = m_pair[lane];
        contact.onA = {m_out.onA[0][lane], m_out.onA[1][lane], m_out.onA[2][lane]};
        contact.onB = {m_out.onB[0][lane], m_out.onB[1][lane], m_out.onB[2][lane]};
        contact.normal = normalOf(m_out, m_b, lane);
        contact.signedDistance = m_out.signedDistance[lane];
        contact.featureA = static_cast<std::uint8_t>(m_out.featureA[lane]);
        contact.featureB = static_cast<std::uint8_t>(m_out.featureB[lane]);
        contact.overlapping = (m_out.overlapping >> static_cast<unsigned>(lane) & 1U) != 0U;
    }

  private:
    void copyTriangle(const PosedTree& tree, std::uint32_t triangle, TriangleBatch& to) {
        for (int corner = 0; corner < 3; ++corner) {
            const Eigen::Vector3f p =
                tree.point(tree.tree().surface.triangles[triangle][static_cast<std::size_t>(corner)]);
            for (int axis = 0; axis < 3; ++axis) {
                to.corner[corner][axis][m_count] = p[axis];
                m_zero += p[axis] - p[axis];
            }
        }
    }

    TriangleBatch m_a{}, m_b{};
    DistanceBatch m_out{};
    TrianglePair m_pair[batchWidth];
    int m_count = 0;
    float m_zero = 0;
};

}  // namespace grapeshot::detail
