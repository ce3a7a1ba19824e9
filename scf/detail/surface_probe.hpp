// Questions of a point to a surface where it is now: how far, from what, and on which side?
//
// This work is based on:
// Andreas Baerentzen, Henrik Aanaes. Signed Distance Computation Using the Angle Weighted Pseudonormal. TVCG 11(3),
// 2005
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include <grapeshot/core/topology.hpp>
#include <grapeshot/scf/detail/posed_tree.hpp>

namespace grapeshot::detail {

/// The closest point of a surface, or of a part of it, to some point.
struct Foot {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< m
    double distance = 0;                              ///< m, >= 0
    std::uint32_t triangle = noTriangle;
    int feature = 6;  ///< 0..2 corner, 3..5 edge, 6 face
};

/// Both must stay where they are, and the tree must have begun its step.
class SurfaceProbe {
  public:
    SurfaceProbe(PosedTree& tree, const Topology& topology) : m_tree(&tree), m_topology(&topology) {}

    [[nodiscard]] PosedTree& tree() const { return *m_tree; }
    [[nodiscard]] const Topology& topology() const { return *m_topology; }

    /// Of one triangle.
    [[nodiscard]] Foot footOn(std::uint32_t triangle, const Eigen::Vector3d& point) const;
    /// From triangle to triangle while it gets nearer: a local minimum, so never nearer than the surface is.
    [[nodiscard]] Foot walk(std::uint32_t from, const Eigen::Vector3d& point, std::uint64_t& work) const;
    /// Of all of it, if nearer than `known`, which else is returned. @param known triangle may be noTriangle
    [[nodiscard]] Foot nearest(const Eigen::Vector3d& point, const Foot& known, std::uint64_t& work);

    /// The distance, negative behind the surface, by the angle-weighted normal of what the foot lies on; 0 if that is
    /// not known, or if the foot is on the border of an open surface.
    [[nodiscard]] double heightOver(const Foot& foot, const Eigen::Vector3d& point) const {
        return normalAt(foot).isOnBorder ? 0 : sideOf(foot, point) * foot.distance;
    }
    /// 1 in front of the surface, -1 behind it, 0 if that is not known, or if the point is rather past a border.
    [[nodiscard]] int sideOf(const Foot& foot, const Eigen::Vector3d& point) const;
    /// Can the point not be inside? By the box around all balls. One unit.
    [[nodiscard]] bool isBeyond(const Eigen::Vector3d& point, std::uint64_t& work) const;

  private:
    [[nodiscard]] Eigen::Vector3d corner(std::uint32_t triangle, unsigned i) const {
        return m_tree->point(m_tree->tree().surface.triangles[triangle][i % 3]).cast<double>();
    }
    [[nodiscard]] Eigen::Vector3d normalOf(std::uint32_t triangle) const;
    struct Normal {
        Eigen::Vector3d direction = Eigen::Vector3d::Zero();
        bool isOnBorder = false;
    };
    /// Of what the foot lies on, as far as there are triangles.
    [[nodiscard]] Normal normalAt(const Foot& foot) const;
    /// use(triangle, its corner) for all triangles around a corner, as far as they are joined. True: there is a border.
    template <class Use>
    bool around(std::uint32_t triangle, unsigned corner, Use&& use) const;

    struct Waiting {
        double distance;
        BallRef piece;
    };
    PosedTree* m_tree;
    const Topology* m_topology;
    std::vector<Waiting> m_stack;
};

}  // namespace grapeshot::detail
