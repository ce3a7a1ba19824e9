// What a search to its end finds on a surface with itself, and how much of it somebody else has found.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <memory>
#include <vector>

#include <grapeshot/plugin/soft_contacts.hpp>
#include <grapeshot/scf/tracker.hpp>

namespace grapeshot::soft {

struct ExactComparison {
    double seconds = 0;       ///< of this thread's processor time, of the traversal alone
    std::size_t contacts = 0;  ///< pairs of triangles within the distance
    std::size_t covered = 0;   ///< of these, with a reported contact within the radius
};

class ExactPeer {
  public:
    /// @param surface as it stands now, at rest @param how as the surface collides with itself: thickness and exclusion
    ExactPeer(const btSoftBody& surface, const SelfCollision& how);

    /// Of the positions that nodes have now. @param radius m
    ExactComparison compare(const btSoftBody& surface, const std::vector<SoftContact>& reported, double radius);

  private:
    std::unique_ptr<BallTree> m_tree;
    std::unique_ptr<Tracker> m_tracker;
    TrackSettings m_settings;
    TrackResult m_found;
};

}  // namespace grapeshot::soft
