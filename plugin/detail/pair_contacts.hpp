// Contacts of one pair of shapes, kept from step to step; Bullet's manifolds come after.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <limits>
#include <memory>
#include <utility>

#include <grapeshot/narrowphase/pair_update.hpp>
#include <grapeshot/plugin/detail/shape_models.hpp>
#include <grapeshot/plugin/detail/solid_contacts.hpp>
#include <grapeshot/plugin/settings.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// The two shapes as a pair: A is a mesh, B another one or a solid.
struct PairShapes {
    const btCollisionObjectWrapper* a = nullptr;
    const btCollisionObjectWrapper* b = nullptr;
    std::shared_ptr<const ShapeModel> modelA;
    std::shared_ptr<const ShapeModel> modelB;  ///< null: B is a solid
    btScalar marginA = 0, marginB = 0;         ///< m
};

/// Lengths that follow from the shapes, m.
struct PairSize {
    float size = 1;       ///< half the diagonal of the smaller one's box
    float thickness = 0;  ///< motion of half of this in a step may carry one through the other
};
[[nodiscard]] PairSize sizeOf(const PairShapes& shapes);

/// What to look for in one step.
struct PairTask {
    const Settings* settings = nullptr;
    std::uint64_t pair = 0;  ///< see `pairKey`
    Budget budget;
    PairSize size;
    float maxDistance = 0;      ///< of the surfaces: margins and breaking threshold, m; contacts are kept up to it
    float breaking = 0;         ///< that threshold, m
    float closestDistance = 0;  ///< queries: the nearest points up to this distance, if nothing is nearer, m
    btScalar timeStep = 0;      ///< s; 0: no contacts ahead of time
    bool again = false;         ///< once more in the same step, because the budget ended the last call
};

class PairContacts {
  public:
    /// Fills `now()` and `ahead()`. On invalidInput both are empty.
    PairResult step(const PairShapes& shapes, const PairTask& task);
    /// The shapes are others now. Names of regions are not used again.
    void forget();
    /// The vertices moved; the triangles are the same.
    void forgetCandidates() { forgetSearch(m_state); }

    [[nodiscard]] const ContactSet& now() const { return m_state.contacts; }
    [[nodiscard]] bool touches() const;  ///< there are some now
    /// Contacts that the motion of the coming step will make.
    [[nodiscard]] const ContactSet& ahead() const { return m_ahead; }

    [[nodiscard]] const PairState& state() const { return m_state; }
    void restore(PairState state, ContactSet ahead) {
        m_state = std::move(state);
        m_ahead = std::move(ahead);
    }

  private:
    void findClosest(const PairShapes& shapes, const PairTask& task, const PairSettings& settings, const Pose& pose,
                     PairResult& result);

    PairState m_state;
    ContactSet m_ahead;
    bool m_swept = false;  // nothing ahead was left out in this step
};

/// `approach`: what the two may come nearer to each other by in the coming step, m.
[[nodiscard]] PairSettings pairSettings(const PairTask& task, float approach);
inline constexpr float anyApproach = std::numeric_limits<float>::infinity();  ///< where that is not known

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
