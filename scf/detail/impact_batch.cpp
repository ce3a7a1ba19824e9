#include <grapeshot/scf/detail/impact_batch.hpp>

#include <algorithm>

#include <grapeshot/scf/detail/lanes.hpp>

namespace grapeshot::detail {

void ImpactBatch::load(const ImpactSpace& space, const LanePair* pairs, int count) {
    m_count = count;
    for (int lane = 0; lane < batchWidth; ++lane) {
        const LanePair& pair = pairs[lane < count ? lane : 0];
        m_pairs[lane] = pair;
        if (space.turns()) {
            const TrianglePair both = triangles(space, lane);
            m_moving.acceleration[lane] =
                static_cast<float>(space.a->accelerationOf(both.triangleA) + space.b->accelerationOf(both.triangleB));
        } else {
            m_moving.acceleration[lane] = 0;
            copyLane(space.a->leafBefore(pair.a >> 4U), pair.a & 15U, m_path.beforeA, lane);
            copyLane(space.a->leafNow(pair.a >> 4U), pair.a & 15U, m_path.nowA, lane);
            copyLane(space.b->leafBefore(pair.b >> 4U), pair.b & 15U, m_path.beforeB, lane);
            copyLane(space.b->leafNow(pair.b >> 4U), pair.b & 15U, m_path.nowB, lane);
        }
    }
}

TrianglePair ImpactBatch::triangles(const ImpactSpace& space, int lane) const {
    const LanePair& pair = m_pairs[lane];
    return {space.a->tree().leaves[pair.a >> 4U].triangle[pair.a & 15U],
            space.b->tree().leaves[pair.b >> 4U].triangle[pair.b & 15U]};
}

void ImpactBatch::placeTurning(const ImpactSpace& space, const float (&time)[16]) {
    for (int lane = 0; lane < m_count; ++lane) {
        const TrianglePair pair = triangles(space, lane);
        const auto at = static_cast<double>(time[lane]);
        const MovingCorners a = space.a->cornersAt(pair.triangleA, at);
        const MovingCorners b = space.b->cornersAt(pair.triangleB, at);
        m_origin[lane] = a.place[0];
        // The common velocity is taken out, and with it what it would cost in rounding.
        for (int corner = 0; corner < 3; ++corner) {
            for (int axis = 0; axis < 3; ++axis) {
                m_moving.a.corner[corner][axis][lane] = static_cast<float>(a.place[corner][axis] - a.place[0][axis]);
                m_moving.b.corner[corner][axis][lane] = static_cast<float>(b.place[corner][axis] - a.place[0][axis]);
                m_moving.velocityA.corner[corner][axis][lane] =
                    static_cast<float>(a.velocity[corner][axis] - a.velocity[0][axis]);
                m_moving.velocityB.corner[corner][axis][lane] =
                    static_cast<float>(b.velocity[corner][axis] - a.velocity[0][axis]);
            }
        }
    }
    for (TriangleBatch* batch : {&m_moving.a, &m_moving.b, &m_moving.velocityA, &m_moving.velocityB}) {
        for (auto& corner : batch->corner) {
            for (auto& axis : corner) {
                std::fill(axis + m_count, axis + batchWidth, axis[0]);
            }
        }
    }
}

std::uint32_t ImpactBatch::run(const ImpactSpace& space, const float (&time)[16], float (&step)[16]) {
    if (space.turns()) {
        placeTurning(space, time);
    } else {
        placeAt(m_path, time, m_moving);
    }
    signedDistances(m_moving.a, m_moving.b, m_out);
    const std::uint32_t used = m_count == 16 ? 0xffffU : (1U << static_cast<unsigned>(m_count)) - 1U;
    return advance(m_moving, m_out, space.reach, space.tolerance, step) & used;
}

Impact ImpactBatch::impactOf(const ImpactSpace& space, int lane, float time) const {
    Impact impact;
    impact.time = time;
    impact.pair = triangles(space, lane);
    Eigen::Vector3d origin = m_origin[lane];
    if (!space.turns()) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto before = static_cast<double>(m_path.beforeA.corner[0][axis][lane]);
            const auto now = static_cast<double>(m_path.nowA.corner[0][axis][lane]);
            origin[axis] = before + static_cast<double>(time) * (now - before);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        impact.onA[axis] = static_cast<float>(origin[axis] + static_cast<double>(m_out.onA[axis][lane]));
        impact.onB[axis] = static_cast<float>(origin[axis] + static_cast<double>(m_out.onB[axis][lane]));
    }
    impact.normal = normalOf(m_out, m_moving.b, lane);
    impact.featureA = static_cast<std::uint8_t>(m_out.featureA[lane]);
    impact.featureB = static_cast<std::uint8_t>(m_out.featureB[lane]);
    return impact;
}

}  // namespace grapeshot::detail
