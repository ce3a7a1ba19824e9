// What MeshCollisionAlgorithm does, behind its pointer: looks at the two shapes anew in every step, since the program
// may have put other ones on the bodies, finds the contacts and hands them to Bullet.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

#include <array>
#include <memory>

#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/manifold_writer.hpp>
#include <grapeshot/plugin/detail/pair_contacts.hpp>
#include <grapeshot/plugin/detail/pair_importance.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

struct SavedPair;

/// A pair's share of one step, over as many calls as it took.
struct PairShare {
    std::uint64_t slice = 0;      ///< work units it was given
    std::uint64_t mandatory = 0;  ///< of these, whatever the budget
    PairResult result;
};

class PairProcessor {
  public:
    PairProcessor(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context, bool query);
    ~PairProcessor();
    PairProcessor(const PairProcessor&) = delete;
    PairProcessor& operator=(const PairProcessor&) = delete;

    /// Bullet's pass: computes the contacts, if that was not done ahead of it for these very shapes and poses, and
    /// writes them.
    void process(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                 const btDispatcherInfo& info, btManifoldResult& result);
    void collectManifolds(btManifoldArray& manifolds) const;
    /// The algorithm is destroyed: gives everything back, at once or, from within a callback of the program's that
    /// `process` has called, when that returns.
    void close();

    // Ahead of Bullet's pass, by a Dispatcher; pair_phases.cpp.

    [[nodiscard]] bool isOf(const Context& context) const { return m_context.get() == &context; }
    /// Serial; calls nothing of the program's. False if there is nothing to compute: shapes that are not ours or cannot
    /// be used or have been changed (Bullet's pass looks after the old contacts first), or a pair that the program's
    /// near callback did not let pass last time.
    bool prepare(btCollisionObject& body0, btCollisionObject& body1, const btDispatcherInfo& info);
    /// On any thread unless `needsBullet`. Touches nothing but this pair. A second call in a step goes on where the
    /// first was cut short.
    void compute(const Budget& budget) noexcept;
    /// After the last `compute` of the step.
    void settle();
    [[nodiscard]] bool needsBullet() const;  ///< calls functions of Bullet that may not be called from two threads
    [[nodiscard]] bool wasCutShort() const;  ///< and more work in this step is of use
    [[nodiscard]] const PairShare& share() const { return m_share; }
    [[nodiscard]] std::uint64_t key() const;
    [[nodiscard]] std::uint64_t mandatory() const;
    [[nodiscard]] std::uint64_t wanted() const;  ///< work units, as the last steps tell
    [[nodiscard]] std::uint32_t age() const { return m_age; }
    [[nodiscard]] PairTraits traits() const;

    /// Is it about a sample of a shape whose tree is being built, or what that was before an edit?
    [[nodiscard]] bool standsIn() const;

    // Between steps, to save and restore; pair_saving.cpp.

    /// Is there anything to save? Not for shapes that are not ours or cannot be used.
    [[nodiscard]] bool remembers() const;
    [[nodiscard]] const MeshModel* model(std::size_t body) const { return m_models[body]->mesh.get(); }
    [[nodiscard]] SavedPair saved() const;  ///< without keys
    /// For a pair that was just made. Its manifolds come afterwards, each in its place among those of all pairs.
    void restore(SavedPair pair, const btCollisionObject& body0, const btCollisionObject& body1);
    [[nodiscard]] ManifoldWriter& writer() { return m_writer; }

  private:
    using Bodies = std::array<const btCollisionObjectWrapper*, 2>;
    /// What is known ahead of Bullet's pass.
    struct Ahead;

    /// Are these, or what is to be done about them, others than last time?
    [[nodiscard]] bool isChanged(const btCollisionShape& shape0, const btCollisionShape& shape1) const;
    /// True if they were.
    bool bind(const Bodies& bodies);
    void delegate(const Bodies& bodies, const btDispatcherInfo& info, btManifoldResult& result);
    void dropDelegate();
    [[nodiscard]] bool findModels(const Bodies& bodies, bool rebound, PairShapes& shapes, std::string& refusal);
    [[nodiscard]] PairTask task(const PairShapes& shapes, btScalar timeStep, btScalar closestDistance) const;
    [[nodiscard]] std::uint64_t mandatoryOf(const PairShapes& shapes, const PairTask& task) const;
    [[nodiscard]] btScalar breakingThreshold(const Bodies& bodies) const;
    [[nodiscard]] bool takeAhead(const Bodies& bodies, PairShapes& shapes);
    void processNow(const Bodies& bodies, const btDispatcherInfo& info, btManifoldResult& result);
    void addResult(PairResult more);
    void goOnBuilding();
    void look(const Bodies& bodies);
    void computeNow(const PairShapes& shapes, const PairTask& task);
    void write(const Bodies& bodies, const PairShapes& shapes, btManifoldResult& result);
    void report(const Bodies& bodies, const Written& written, const std::string* refusal);

    btDispatcher& m_dispatcher;
    std::shared_ptr<Context> m_context;
    bool m_query;
    std::uint64_t m_step = 0;
    std::uint64_t m_settingsVersion = 0;

    // What the rest was made for.
    std::array<const btCollisionShape*, 2> m_shapes{};
    std::array<int, 2> m_types{-1, -1};
    PairKind m_kind = PairKind::foreign;
    bool m_rebound = false;
    btScalar m_breaking = 0;
    std::array<std::shared_ptr<ShapeEntry>, 2> m_entries;
    std::array<std::shared_ptr<const ShapeModel>, 2> m_models;
    PairSize m_size;

    PairContacts m_contacts;
    ManifoldWriter m_writer;
    btPersistentManifold* m_shared;
    btCollisionAlgorithm* m_delegate = nullptr;

    // Of the schedule.
    std::unique_ptr<Ahead> m_ahead;
    PairShare m_share;
    std::uint64_t m_lastNeed = unlimited;  // work of the last step that got to the end
    std::uint32_t m_age = 0;               // see ScheduledPair::age
    std::uint32_t m_staleness = 0;         // steps since one got to the end
    bool m_cutShort = true;                // in the last step; or new
    bool m_unwanted = false;               // the program's near callback did not let it pass
    bool m_processing = false;
    bool m_closed = false;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
