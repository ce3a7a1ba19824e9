// Contacts as they are found, each feature pair once; then without the redundant ones, in an order of their own.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/narrowphase/detail/key_table.hpp>
#include <grapeshot/narrowphase/surface_contact.hpp>

namespace grapeshot::detail {

class ContactCollector {
  public:
    void clear() {
        m_seen.clear();
        m_found.clear();
    }

    /// True the first time; later, a contact that was added under the key takes the lower triangle ids.
    bool isNew(const FeaturePairKey& key, std::uint32_t triangleA, std::uint32_t triangleB);
    /// Adds a contact under a key for which isNew was true.
    void add(const FeaturePairKey& key, const SurfaceContact& contact);

    /// Of the contacts of one corner in almost one direction only the shallowest (nearest to zero distance) stays: a
    /// corner above or below several faces of a curved surface. Not for round bodies.
    void thinCorners();
    /// Appends what is left, sorted by feature keys; of contacts at one place (within `merge`, m) in one direction the
    /// first.
    void finish(float merge, std::vector<SurfaceContact>& out);

  private:
    struct Found {
        FeaturePairKey key;
        SurfaceContact contact;
        bool alive = true;
    };

    void thinCornersOf(std::uint64_t FeaturePairKey::*side);
    void thinPlaces(float merge);

    KeyTable m_seen;
    std::vector<Found> m_found;
    std::vector<std::uint32_t> m_order;
};

}  // namespace grapeshot::detail
