// What a search to its end finds on a surface with itself, and how much of it somebody else has found.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <vector>

#include <grapeshot/plugin/soft_contacts.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot::soft {

struct ExactComparison {
    /// Of this thread's processor time: of the traversal alone, for all that may touch within the step.
    double seconds = 0;
    std::size_t contacts = 0;  ///< pairs of triangles within the thickness at its end
    std::size_t covered = 0;   ///< of these, with a reported contact within the radius
};

class ExactPeer {
  public:
    /// What is within one and a half times the thickness along the surface is a neighbour, and no contact.
    /// @param surface as it stands now, at rest @param how as the surface collides with itself: thickness and exclusion
    ExactPeer(const btSoftBody& surface, const SelfCollision& how);

    /// Of the positions that nodes have now. @param radius m
    ExactComparison compare(const btSoftBody& surface, const std::vector<SoftContact>& reported, double radius);

  private:
    [[nodiscard]] bool areNeighbours(const TrianglePair& pair) const;

    std::unique_ptr<BallTree> m_tree;
    std::unique_ptr<Tracker> m_tracker;
    TrackSettings m_settings;
    float m_thickness = 0;  // m
    TrackResult m_found;
    IndexLists m_near;
};

}  // namespace grapeshot::soft
