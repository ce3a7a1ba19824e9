// What AdbCollisionAlgorithm does, behind its pointer: looks at the two shapes anew in every step, since the program
// may have put other ones on the bodies, finds the contacts and hands them to Bullet.
#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

#include <array>
#include <memory>

#include <grapeshot/plugin/detail/context.hpp>
#include <grapeshot/plugin/detail/manifold_writer.hpp>
#include <grapeshot/plugin/detail/pair_contacts.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

class PairProcessor {
  public:
    PairProcessor(const btCollisionAlgorithmConstructionInfo& info, std::shared_ptr<Context> context, bool query);
    ~PairProcessor();
    PairProcessor(const PairProcessor&) = delete;
    PairProcessor& operator=(const PairProcessor&) = delete;

    void process(const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1,
                 const btDispatcherInfo& info, btManifoldResult& result);
    void collectManifolds(btManifoldArray& manifolds) const;

  private:
    using Bodies = std::array<const btCollisionObjectWrapper*, 2>;

    /// True if the shapes are others than last time.
    bool bind(const Bodies& bodies);
    void delegate(const Bodies& bodies, const btDispatcherInfo& info, btManifoldResult& result);
    void dropDelegate();
    [[nodiscard]] bool findModels(const Bodies& bodies, bool rebound, PairShapes& shapes, std::string& refusal);
    [[nodiscard]] PairTask task(const PairShapes& shapes, const btDispatcherInfo& info,
                                const btManifoldResult& result) const;
    [[nodiscard]] btScalar breakingThreshold(const Bodies& bodies) const;
    void solve(const Bodies& bodies, const PairShapes& shapes, const btDispatcherInfo& info, btManifoldResult& result,
               PairStatistics& pair);
    void report(const PairStatistics& pair, const std::string* refusal);

    btDispatcher& m_dispatcher;
    std::shared_ptr<Context> m_context;
    bool m_query;
    std::uint64_t m_step = 0;
    std::uint64_t m_settingsVersion = 0;

    // What the rest was made for.
    std::array<const btCollisionShape*, 2> m_shapes{};
    std::array<int, 2> m_types{-1, -1};
    PairKind m_kind = PairKind::foreign;
    btScalar m_breaking = 0;
    std::array<std::shared_ptr<ShapeEntry>, 2> m_entries;
    std::array<std::shared_ptr<const ShapeModel>, 2> m_models;
    PairSize m_size;

    PairContacts m_contacts;
    ManifoldWriter m_writer;
    btPersistentManifold* m_shared;
    btCollisionAlgorithm* m_delegate = nullptr;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
