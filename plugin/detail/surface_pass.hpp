// One call of SurfaceContacts::find, in its parts: what has got through since the last step (surface_look_back.cpp),
// what would get through or near in this one (surface_look_ahead.cpp), and which of that become contacts
// (surface_choice.cpp).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <grapeshot/plugin/detail/feature_crossing.hpp>
#include <grapeshot/plugin/detail/surface_contacts.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

class SurfaceContacts::Pass {
  public:
    Pass(SurfaceContacts& memory, const SurfaceInStep& a, const SurfaceInStep& b, double distance,
         const IndexLists* near, const Faced* faced)
        : m_memory(memory), m_bodies{&a, &b}, m_distance(distance), m_near(near), m_faced(faced) {}

    /// Leaves the pairs whose ways in this step and the last come near each other.
    void sift(std::span<const TrianglePair> pairs, std::vector<TrianglePair>& left) const;
    /// What has got through since the last step?
    void lookBack(std::span<const TrianglePair> pairs);
    void lookAhead(std::span<const TrianglePair> pairs, std::vector<SoftSurfaceContact>& contacts);

  private:
    using Vector3d = Eigen::Vector3d;
    using PositionsView = std::span<const Eigen::Vector3f>;
    using Part = PositionsView SurfaceInStep::*;

    struct Box {
        Vector3d low = Vector3d::Constant(1e300), high = Vector3d::Constant(-1e300);
        void add(const Vector3d& p) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        void add(const Moving& p) {
            add(p.from);
            add(p.to);
        }
        [[nodiscard]] bool meets(const Box& other, double distance) const {
            return ((low - other.high).array() <= distance).all() && ((other.low - high).array() <= distance).all();
        }
    };
    /// A corner beside or through a face.
    struct CornerHit {
        int body = 0;                                 // whose corner
        std::uint32_t corner = 0, face = 0, own = 0;  // own: the corner's triangle
        bool crossing = false;
        double order = 0;          // time of the crossing, or the distance
        Vector3d weights, normal;  // to the corner
        double facing = 0;         // cosine of the normal and the face's
    };
    struct EdgeHit {
        std::array<std::uint32_t, 4> ends{};
        TrianglePair pair;
        bool crossing = false;
        double order = 0;
        double first = 0, second = 0;
        Vector3d normal;
    };
    struct Foot {
        Vector3d weights = Vector3d::Zero(), between = Vector3d::Zero();
    };

    static Vector3d at(PositionsView positions, std::uint32_t v) { return positions[v].cast<double>(); }
    static std::array<Moving, 3> moving(const SurfaceInStep& body, std::uint32_t face, PositionsView from,
                                        PositionsView to);
    static Vector3d normalOf(const SurfaceInStep& body, std::uint32_t face, PositionsView positions);
    std::pair<std::array<Moving, 2>, std::array<Moving, 2>> movingEdges(const EdgePair& ends, Part from, Part to) const;
    [[nodiscard]] Vector3d crossOf(const EdgePair& ends, Part part) const;
    template <class First, class Second>
    [[nodiscard]] bool meet(const First& first, const Second& second, double distance = 0) const {
        const auto boxOf = [](const auto& points) {
            Box box;
            if constexpr (requires { points.size(); }) {
                for (const Moving& point : points) {
                    box.add(point);
                }
            } else {
                box.add(points);
            }
            return box;
        };
        return boxOf(first).meets(boxOf(second), distance + 1e-9);
    }

    template <class Run>
    void forEachCorner(const TrianglePair& pair, const Run& run) const {
        const std::array<std::uint32_t, 2> triangles{pair.triangleA, pair.triangleB};
        for (int body = 0; body < 2; ++body) {
            const SurfaceInStep& own = *m_bodies[body];
            const std::uint32_t t = triangles[static_cast<std::size_t>(body)];
            const std::uint32_t face = triangles[static_cast<std::size_t>(1 - body)];
            if (m_bodies[1 - body]->thread) {
                continue;
            }
            for (std::uint32_t i = 0; i < (own.thread ? 2U : 3U); ++i) {
                const std::uint32_t corner = own.triangles[t][i];
                if (((*own.owners)[t] & (1U << i)) != 0 && !isNear(corner, m_bodies[1 - body]->triangles[face])) {
                    run(body, corner, t, face);
                }
            }
        }
    }
    template <class Run>
    void forEachEdgePair(const TrianglePair& pair, const Run& run) const {
        const auto forEdges = [&](int body, std::uint32_t t, const auto& use) {
            const SurfaceInStep& surface = *m_bodies[body];
            for (std::uint32_t i = 0; i < (surface.thread ? 1U : 3U); ++i) {
                if (((*surface.owners)[t] & (8U << i)) != 0) {
                    use(std::min(surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]),
                        std::max(surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]));
                }
            }
        };
        forEdges(0, pair.triangleA, [&](std::uint32_t a0, std::uint32_t a1) {
            forEdges(1, pair.triangleB, [&](std::uint32_t b0, std::uint32_t b1) {
                const Triangle second{b0, b1, b1};
                if (!isNear(a0, second) && !isNear(a1, second)) {
                    run(EdgePair{a0, a1, b0, b1});
                }
            });
        });
    }
    /// On the surface of one body.
    [[nodiscard]] bool isNear(std::uint32_t vertex, const Triangle& others) const;

    // What is known.
    [[nodiscard]] int memoryOf(int body) const { return m_near != nullptr ? 0 : body; }
    [[nodiscard]] std::map<std::uint32_t, Anchor>& anchors(int body) const {
        return m_memory.m_anchors[static_cast<std::size_t>(memoryOf(body))];
    }
    /// Is a node of the first body's face?
    [[nodiscard]] bool isMisplaced(std::uint32_t face) const;
    [[nodiscard]] bool isMisplaced(const EdgePair& ends) const;

    // Looking back.
    template <class Wanted>
    void rememberCorners(std::span<const TrianglePair> pairs, const Wanted& wanted);
    static Foot footOf(const Vector3d& point, const SurfaceInStep& body, std::uint32_t face);
    /// A corner on the wrong side of a surface slides along below it, so that it comes back where it is and not where
    /// it passed. False if it is back, or beyond the rim.
    [[nodiscard]] bool slide(int body, std::uint32_t corner, Anchor& anchor) const;
    /// Of a rigid mesh's corner and a soft solid, which has no other way to tell once it is deeper than the margins:
    /// O(faces).
    [[nodiscard]] bool isInSoftSolid(int body, std::uint32_t corner) const;
    /// What is inside beside a rigid corner that is: where a node of the solid is in the mesh, nothing is learnt from
    /// what its faces pass.
    void spreadInSoftSolid();
    /// Of edges that have passed; 0 if they are beside each other now.
    [[nodiscard]] double gapOf(const EdgePair& ends, bool along) const;

    // Looking ahead.
    /// Contacts of what is on the wrong side, however far.
    void bringBack();
    void testCorner(int body, std::uint32_t corner, std::uint32_t own, std::uint32_t face);
    [[nodiscard]] bool nearEdges() const { return m_faced == nullptr || m_faced->edges; }
    void testEdges(const TrianglePair& pair, const EdgePair& ends);

    /// Contacts of corners with what they face.
    void takeFaced(std::vector<SoftSurfaceContact>& contacts) const;
    /// Cosine of the direction and the normal of that face at a foot of it which is seen straightest: the sign is the
    /// side.
    double facingOf(const SurfaceInStep& body, std::uint32_t face, const Vector3d& weights, const Vector3d& to) const;

    // Choosing.
    void chooseCorners(std::vector<SoftSurfaceContact>& contacts);
    void chooseOfCorner(std::span<CornerHit> hits, std::vector<CornerHit>& chosen);
    void chooseEdges(std::vector<SoftSurfaceContact>& contacts);
    /// Distance of corner and face at the end of the step, along the normal.
    [[nodiscard]] double endOf(const CornerHit& hit) const;
    void emit(const CornerHit& hit, std::vector<SoftSurfaceContact>& contacts) const;
    void measure(SoftSurfaceContact& contact, std::vector<SoftSurfaceContact>& contacts) const;

    static constexpr double slackened = 0.75;

    SurfaceContacts& m_memory;
    std::array<const SurfaceInStep*, 2> m_bodies;
    double m_distance;
    const IndexLists* m_near;
    const Faced* m_faced;
    std::vector<CornerHit> m_corners;
    std::vector<EdgeHit> m_edges;
    std::vector<std::pair<int, std::uint32_t>> m_passing;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
