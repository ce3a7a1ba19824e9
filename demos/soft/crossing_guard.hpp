// The last word in a step of a carried body: what would pass through something goes only a part of its way.
//
// Contacts are solved in a few rounds, links pull against them, and neighbours that fold have none. Here the nodes of
// whatever crosses at the end of the step go half of their way, then none of it. Nothing crossed when the step began,
// so there is always a way out. Beside a rigid body that moves, to stay means to go along with it.
//
// This work is based on:
// Xavier Provot. Collision and Self-Collision Handling in Cloth Model Dedicated to Design Garments. Graphics Interface
// 1997 (zones of impact)
// Pascal Volino, Nadia Magnenat-Thalmann. Efficient Self-Collision Detection on Smoothly Discretized Surface Animations
// Using Geometrical Shape Regularity. Eurographics 1994 (a piece whose normals are within a cone does not cross itself)
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <grapeshot/core/mesh_view.hpp>

#include "contact_projection.hpp"

namespace grapeshot::soft {

/// A rigid mesh, world frame, m.
struct Obstacle {
    std::vector<Eigen::Vector3d> points;  ///< at the end of the step
    const std::vector<Triangle>* triangles = nullptr;
    /// Where its points at the begin of the step go: turn * x + shift.
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};

struct GuardResult {
    int held = 0;      ///< nodes that did not go all of their way
    int rounds = 0;    ///< of search and holding back
    int crossing = 0;  ///< edges in faces nevertheless: they were so before, or two rigid bodies press
};

class CrossingGuard {
  public:
    /// @param surface must live as long
    CrossingGuard(const CarriedSurface& surface, const CoreNodes& nodes);

    /// Shortens the ways from nodes.before to nodes.now, until no edge of the surface passes through a triangle of it
    /// or of an obstacle. Some us per piece of the surface that one node carries, and more where pieces touch.
    GuardResult hold(CoreNodes& nodes, std::span<const Obstacle> obstacles);
    /// The surface's vertices at the end of the step, as the last call left them.
    [[nodiscard]] const std::vector<Eigen::Vector3d>& points() const { return m_points; }

  private:
    using Vector3d = Eigen::Vector3d;
    struct Box {
        Vector3d low = Vector3d::Constant(1e300), high = Vector3d::Constant(-1e300);
        void add(const Vector3d& p) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
        void add(const Box& other) {
            low = low.cwiseMin(other.low);
            high = high.cwiseMax(other.high);
        }
        [[nodiscard]] bool meets(const Box& other) const {
            return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
        }
    };
    /// The triangles of a component that lie above one node.
    struct Patch {
        std::vector<std::uint32_t> triangles, vertices;
        std::vector<std::uint32_t> neighbours;  // that share a vertex, ascending
        std::uint32_t component = 0;            // connected by edges of two triangles that are seen from one side
        Box box;
        Vector3d normal = Vector3d::Zero();  // mean
        double spread = 1;                   // cosine of the largest angle to it
        bool moved = true;
    };
    struct Branch {
        std::uint32_t left = 0, right = 0;  // branches; of a leaf left is the patch
        bool leaf = false;
        bool moved = true;
        Box box;
    };
    struct Crossing {
        std::array<std::uint32_t, 5> vertices{};
        int count = 0;
        int obstacle = -1;
    };
    /// Of a node: the share of its way, and the obstacle that it goes along with where it does not go.
    struct Held {
        double share = 1;
        int obstacle = -1;
        int round = -1;
    };
    struct Corners {
        const Vector3d* points;
        const Triangle* triangle;
    };

    void makePatches(const CoreNodes& nodes);
    std::uint32_t makeBranch(std::span<std::uint32_t> patches, const std::vector<Vector3d>& middles);
    [[nodiscard]] std::vector<std::uint32_t> components() const;
    void refit(Patch& patch);
    void refit();
    void place(const CoreNodes& nodes);
    void find(std::span<const Obstacle> obstacles);
    void searchItself(std::uint32_t branch);
    void searchPair(std::uint32_t a, std::uint32_t b);
    void searchObstacle(std::uint32_t branch, const Obstacle& obstacle, int index, const Box& box,
                        std::span<const std::uint32_t> triangles);
    [[nodiscard]] bool isFlat(const Patch& a, const Patch& b) const;
    void testPatches(const Patch& a, const Patch& b);
    void test(std::uint32_t first, const Obstacle* obstacle, int index, std::uint32_t second);
    /// Less of the ways of what crosses. False if nothing could be shortened. Sets `stuck` if something could not.
    bool shorten(const CoreNodes& nodes, std::span<const Obstacle> obstacles, int round, bool& stuck);
    bool hold(std::uint32_t node, int obstacle, bool moving, int round);

    const CarriedSurface& m_surface;
    std::vector<Patch> m_patches;
    std::vector<Branch> m_branches;                        // children before parents
    std::vector<std::vector<std::uint32_t>> m_verticesOf;  // that a node carries
    std::vector<std::uint32_t> m_patchesOf;                // of the vertices, one after the other
    std::vector<std::uint32_t> m_patchEnds;
    std::vector<Vector3d> m_points;
    std::vector<Held> m_held;
    std::vector<std::uint32_t> m_changed;  // nodes
    std::vector<Crossing> m_crossings;
    std::vector<std::uint32_t> m_nearA, m_nearB;  // of a test
    std::vector<Vector3d> m_normals;              // of a patch
};

}  // namespace grapeshot::soft
