// The triangle pairs of two meshes by brute force over the wide kernel, and small helpers on contacts.
#pragma once

#include <algorithm>
#include <ostream>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include <grapeshot/core/triangle_batch.hpp>
#include <grapeshot/narrowphase/local_contacts.hpp>

namespace grapeshot::test {

inline void setLane(TriangleBatch& batch, int lane, const Tree& tree, std::uint32_t triangle, const Pose& pose) {
    for (unsigned c = 0; c < 3; ++c) {
        const Eigen::Vector3f corner = apply(pose, tree.vertices[tree.triangles[triangle][c]]);
        for (int axis = 0; axis < 3; ++axis) {
            batch.corner[c][axis][lane] = corner[axis];
        }
    }
}

/// All pairs within the distance, ascending (a, b); what Query::contacts lists, without its trees.
inline std::vector<TriangleContact> trianglePairs(const Tree& a, const Tree& b, const Pose& bInA, float maxDistance) {
    std::vector<TriangleContact> out;
    std::vector<TrianglePair> pending;
    TriangleBatch batchA{};
    TriangleBatch batchB{};
    DistanceBatch distances{};
    const auto flush = [&] {
        for (std::size_t lane = pending.size(); lane < batchWidth; ++lane) {
            setLane(batchA, static_cast<int>(lane), a, pending[0].triangleA, {});
            setLane(batchB, static_cast<int>(lane), b, pending[0].triangleB, bInA);
        }
        signedDistances(batchA, batchB, distances);
        for (std::size_t lane = 0; lane < pending.size(); ++lane) {
            if (distances.signedDistance[lane] <= maxDistance) {
                TriangleContact contact;
                contact.pair = pending[lane];
                contact.onA = {distances.onA[0][lane], distances.onA[1][lane], distances.onA[2][lane]};
                contact.onB = {distances.onB[0][lane], distances.onB[1][lane], distances.onB[2][lane]};
                contact.signedDistance = distances.signedDistance[lane];
                contact.featureA = static_cast<std::uint8_t>(distances.featureA[lane]);
                contact.featureB = static_cast<std::uint8_t>(distances.featureB[lane]);
                contact.overlapping = (distances.overlapping >> lane & 1U) != 0;
                out.push_back(contact);
            }
        }
        pending.clear();
    };
    for (std::uint32_t ta = 0; ta < a.triangles.size(); ++ta) {
        Eigen::AlignedBox3f boxA;
        for (const std::uint32_t v : a.triangles[ta]) {
            boxA.extend(a.vertices[v]);
        }
        for (std::uint32_t tb = 0; tb < b.triangles.size(); ++tb) {
            Eigen::AlignedBox3f boxB;
            for (const std::uint32_t v : b.triangles[tb]) {
                boxB.extend(apply(bInA, b.vertices[v]));
            }
            if (boxA.squaredExteriorDistance(boxB) > maxDistance * maxDistance) {
                continue;
            }
            setLane(batchA, static_cast<int>(pending.size()), a, ta, {});
            setLane(batchB, static_cast<int>(pending.size()), b, tb, bInA);
            pending.push_back({ta, tb});
            if (pending.size() == batchWidth) {
                flush();
            }
        }
    }
    if (!pending.empty()) {
        flush();
    }
    return out;
}

/// By the trees and the wide filter, as every step does it.
inline std::vector<SurfaceContact> localContactsOf(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                                                   float maxDistance, float lean = LocalContactSettings{}.lean) {
    LeafPairs leaves;
    Query(a.tree, b.tree).leafPairs(bInA, {maxDistance, Order::depthFirst}, {}, leaves);
    std::vector<SurfaceContact> out;
    LocalContactSearch search;
    search.start(a, b, bInA, {lean, maxDistance});
    search.add(leaves.pairs);
    search.finish(out);
    return out;
}

/// By brute force over all triangle pairs and all their features.
inline std::vector<SurfaceContact> exhaustiveContactsOf(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                                                        float maxDistance, float lean = LocalContactSettings{}.lean) {
    std::vector<TrianglePair> pairs;
    for (const TriangleContact& contact : trianglePairs(a.tree, b.tree, bInA, maxDistance)) {
        pairs.push_back(contact.pair);
    }
    std::vector<SurfaceContact> out;
    localContactsExhaustive(a, b, bInA, pairs, {lean, maxDistance}, out);
    return out;
}

/// The same contact seen by the other side: in B's frame, with the roles exchanged.
inline SurfaceContact mirrored(const SurfaceContact& contact, const Pose& bInA) {
    const Pose aInB = inverse(bInA);
    return {apply(aInB, contact.onB), apply(aInB, contact.onA), -(aInB.rotation * contact.normal),
            contact.signedDistance,   contact.triangleB,        contact.triangleA};
}

inline bool near(const SurfaceContact& left, const SurfaceContact& right, float tolerance) {
    return (left.onA - right.onA).norm() <= tolerance && (left.onB - right.onB).norm() <= tolerance &&
           (left.normal - right.normal).norm() <= 10 * tolerance &&
           std::abs(left.signedDistance - right.signedDistance) <= tolerance;
}

inline const SurfaceContact* deepest(const std::vector<SurfaceContact>& contacts) {
    const auto found = std::min_element(contacts.begin(), contacts.end(), [](const auto& l, const auto& r) {
        return l.signedDistance < r.signedDistance;
    });
    return found == contacts.end() ? nullptr : &*found;
}

}  // namespace grapeshot::test

namespace grapeshot {

/// For the messages of failing tests.
inline void PrintTo(const SurfaceContact& c, std::ostream* out) {
    const Eigen::IOFormat row(6, Eigen::DontAlignCols, ", ", ", ", "", "", "(", ")");
    *out << "onA " << c.onA.transpose().format(row) << " onB " << c.onB.transpose().format(row) << " normal "
         << c.normal.transpose().format(row) << " distance " << c.signedDistance << " triangles " << c.triangleA << ' '
         << c.triangleB;
}

}  // namespace grapeshot
