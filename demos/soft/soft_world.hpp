// A world of soft bodies and rigid meshes as one value, which measures itself.
#pragma once

#include <BulletSoftBody/btSoftBody.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <scenes/canvas.hpp>
#include <scenes/shapes.hpp>
#include <scenes/true_penetration.hpp>

#include "carried_body.hpp"
#include "crossings.hpp"
#include "exact_peer.hpp"

namespace grapeshot::soft {

enum class Method {
    grapeshot,  ///< under its search budget: tracked and sampled where surfaces are tangled
    exact,      ///< the same without any budget: every traversal to its end
    bullet,     ///< Bullet's own: a slab per triangle, and nothing of a body with itself
};
[[nodiscard]] std::string_view name(Method method) noexcept;

constexpr double timeStep = 1.0 / 60;  // s

/// Of one step; times are of this thread's processor time, s.
struct StepRecord {
    double seconds = 0;
    double detectionSeconds = 0;  ///< of these, all that the dispatcher does: pairs, searches, contacts
    int contacts = 0;             ///< as the solver gets them
    int contactsOfSelf = 0;       ///< of these, between soft bodies or of one with itself
    double work = 0;              ///< units
    int sampled = 0;              ///< pairs that were tracked and sampled
    double missBound = 0;         ///< the worst of these, share; infinite: the budget ended before it was known
    int held = 0;                 ///< nodes below carried surfaces that did not go all of their way, see CrossingGuard
    double force = 0;             ///< on the driven body: its impulses over the step, N
    std::optional<ExactComparison> exact;
};

class World {
  public:
    /// @param seed of the samples @param work units that a pair, or a body with itself, may have in a step
    World(Method method, std::uint64_t seed, std::uint64_t work = std::numeric_limits<std::uint64_t>::max());
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    /// For the constructors of soft bodies.
    [[nodiscard]] btSoftBodyWorldInfo& info();
    /// @param margin m @param itself collides with itself, where the method can do that
    btSoftBody& add(std::unique_ptr<btSoftBody> body, double margin, const scenes::Colour& colour, bool itself);
    /// A carried surface that collides with itself. @throws Error if the method is Bullet's, which knows none
    btSoftBody& add(std::unique_ptr<CarriedBody> body, const SelfCollision& itself, const scenes::Colour& colour);
    /// In every such step the carried surface is searched to the end, too, and what was reported is compared with it.
    /// The time of that is not counted. @param radius within which a contact counts as reported, m
    void compareEvery(int steps, double radius);
    /// Only to be seen.
    void addScenery(const scenes::Mesh& mesh, const scenes::Colour& colour);
    /// A static mesh, or (driven) one that follows `drive` whatever is in its way.
    std::size_t add(const scenes::Mesh& mesh, const scenes::PoseD& pose, bool driven, const scenes::Colour& colour);
    /// Where the body will be at the end of the next step.
    void drive(std::size_t rigid, const scenes::PoseD& pose);
    StepRecord step();

    [[nodiscard]] Method method() const;
    [[nodiscard]] std::size_t softBodies() const;
    [[nodiscard]] std::size_t rigidBodies() const;
    [[nodiscard]] const btSoftBody& soft(std::size_t index) const;
    [[nodiscard]] btSoftBody& soft(std::size_t index);
    [[nodiscard]] Surface softSurface(std::size_t index) const;
    [[nodiscard]] Surface rigidSurface(std::size_t index) const;
    [[nodiscard]] const scenes::Colour& softColour(std::size_t index) const;
    [[nodiscard]] const scenes::Colour& rigidColour(std::size_t index) const;
    [[nodiscard]] std::size_t triangles() const;  ///< of all soft bodies

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot::soft
