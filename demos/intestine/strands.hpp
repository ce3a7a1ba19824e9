// Has one strand of the tube passed through another? Told by the tube's middle alone, between one step and the next.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace grapeshot::intestine {

class StrandWatch {
  public:
    /// Of the rings of an Organ's body, which must live as long.
    StrandWatch(const btSoftBody& body, int rings, int around) : m_body(&body), m_rings(rings), m_around(around) {}

    /// Pieces of the middle that went through each other since the last call: the line between their nearest points has
    /// turned about while they were within a tube's radius. O(n^2) in the pieces, each about a radius long; no-number
    /// pieces count as nothing (the nodes are counted as lost).
    std::size_t passed();
    /// The middle of a ring as it lies now. @pre 0 <= ring < rings
    [[nodiscard]] Eigen::Vector3d middleOf(int ring) const;
    [[nodiscard]] double nearest() const { return m_nearest; }  ///< distance of two strands' middles so far, m

  private:
    const btSoftBody* m_body;
    int m_rings;
    int m_around;
    std::map<std::pair<std::size_t, std::size_t>, Eigen::Vector3d> m_last;
    double m_nearest = 1e9;
};

}  // namespace grapeshot::intestine
